// Does not compile: a pixel functor that discards without saying so. tests/CMakeLists.txt
#include "pipeline/program.h"

namespace {

struct Vertex {
    template <class Real>
    struct Input {
        gnomon::Vec4<Real> position;
    };
    template <class Real>
    using Varyings = gnomon::NoVaryings<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        return gnomon::VertexOutput{v.in.position, gnomon::NoVaryings<typename V::Real>{}};
    }
};

struct Pixel {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        f.discard(f.position.x < Real(4.0f));
        return gnomon::Vec4<Real>{};
    }
};

}  // namespace

const gnomon::Program kProgram = gnomon::make_program<Vertex, Pixel>("discards in secret");
