// Functors whose fields() leaves out a data member do not compile: how that is known.
#include "pipeline/program.h"

#include <catch2/catch.hpp>

#include <array>

using namespace gnomon;

TEST_CASE("fields() names every member or does not compile", "[errors]") {
    struct One {
        TextureId a;
        static constexpr auto fields() { return std::tuple{Field{"a", &One::a}}; }
    };
    struct Hidden {
        TextureId a;
        TextureLevels b;
        static constexpr auto fields() { return std::tuple{Field{"a", &Hidden::a}}; }
    };
    struct Everything {
        float f;
        int i;
        glm::vec2 two;
        glm::vec4 four;
        glm::mat4 matrix;
        std::array<float, 5> list;
        One nested;
        MultisampledTexture samples;
        Sampler sampler;
        TextureLevels levels;
        static constexpr auto fields() {
            using E = Everything;
            return std::tuple{Field{"f", &E::f},
                              Field{"i", &E::i},
                              Field{"two", &E::two},
                              Field{"four", &E::four},
                              Field{"matrix", &E::matrix},
                              Field{"list", &E::list},
                              Field{"nested", &E::nested},
                              Field{"samples", &E::samples},
                              Field{"sampler", &E::sampler},
                              Field{"levels", &E::levels}};
        }
    };
    struct Nothing {
        static constexpr auto fields() { return std::tuple{}; }
    };
    // Members of bases are a functor's own, and an empty base is none.
    struct Behind : Nothing {
        int i;
        static constexpr auto fields() { return std::tuple{Field{"i", &Behind::i}}; }
    };
    struct Derived : One {
        int i;
        static constexpr auto fields() { return std::tuple{Field{"a", &Derived::a}, Field{"i", &Derived::i}}; }
    };
    struct Same : One {};
    struct Forgets : One {
        TextureId b;
    };
    struct ForgetsBehind : Nothing {
        TextureId b;
    };
    STATIC_REQUIRE(names_every_member<Behind>());
    STATIC_REQUIRE(names_every_member<Derived>());
    STATIC_REQUIRE(names_every_member<Same>());
    STATIC_REQUIRE_FALSE(names_every_member<Forgets>());
    STATIC_REQUIRE_FALSE(names_every_member<ForgetsBehind>());
    STATIC_REQUIRE(names_every_member<Nothing>());
    STATIC_REQUIRE(names_every_member<One>());
    STATIC_REQUIRE_FALSE(names_every_member<Hidden>());
    STATIC_REQUIRE(names_every_member<Everything>());
    STATIC_REQUIRE(names_every_member<Sampler>());
    STATIC_REQUIRE(names_every_member<RasterState>());
    STATIC_REQUIRE(names_every_member<StencilState>());
}
