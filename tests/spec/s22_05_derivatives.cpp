// D3D11.3 22.5.2 to 22.5.5, 3.5.7: coarse and fine derivatives over 2x2 quads, through helper lanes at every edge.
#include "pipeline/program.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

struct ScreenValue {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    struct Varyings {
        Real a, b;
        static constexpr std::array interpolation{Interpolation::Linear, Interpolation::Linear};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{v.in.position, Varyings<Real>{v.in.a, v.in.b}};
    }
};

/// All six of a function of the pixel whose derivatives differ from lane to lane: g = x^2 + 16 y^2 + x y, exact in fp32.
struct AllDerivatives {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real x = f.position.x - Real(0.5f);
        const Real y = f.position.y - Real(0.5f);
        const Real g = x * x + y * y * Real(16.0f) + x * y;
        return std::array<Vec4<Real>, 3>{
            Vec4<Real>{f.ddx_coarse(g), f.ddy_coarse(g), f.ddx_fine(g), f.ddy_fine(g)},
            Vec4<Real>{f.ddx(g), f.ddy(g), f.ddx(f.in.a), f.ddy(f.in.a)},
            Vec4<Real>{f.ddx_fine(f.in.b), f.ddy_fine(f.in.b), f.ddx_coarse(f.in.b), f.ddy_coarse(f.in.b)}};
    }
};

const Program& derivative_program() {
    static const Program program = make_program<ScreenValue, AllDerivatives>("test.derivatives");
    return program;
}

float g(int x, int y) { return static_cast<float>(x * x + 16 * y * y + x * y); }

}  // namespace

TEST_CASE("coarse, fine and plain derivatives of every corner a profile may have",
          "[22.5.2][22.5.3][22.5.4][22.5.5][derivatives]") {
    constexpr int kSize = 32;
    // Triangles of every shape down to single pixels; every quad they touch has all four values, whichever lanes are covered.
    std::vector<std::array<std::array<float, 2>, 3>> triangles{{{{0, 0}, {64, 0}, {0, 64}}},
                                                               {{{3.2f, 1.1f}, {29.7f, 13.4f}, {5.5f, 30.2f}}},
                                                               {{{7, 7}, {8, 7}, {7, 9}}},
                                                               {{{2, 2}, {30, 3.5f}, {30, 4.5f}}},
                                                               {{{12.6f, 1}, {13.4f, 31}, {12.4f, 31}}}};
    for (const Arithmetic arithmetic : {Arithmetic::Fp32, Arithmetic::Fp64}) {
        for (const DerivativeCorner corner : {DerivativeCorner::TopLeft, DerivativeCorner::TopRight,
                                              DerivativeCorner::BottomLeft, DerivativeCorner::BottomRight}) {
            for (const PlainDerivative plain : {PlainDerivative::Coarse, PlainDerivative::Fine}) {
                for (const int samples : {1, 4}) {
                    Profile profile = load_profile("d3d11");
                    profile.arithmetic = arithmetic;
                    profile.derivative_corner = corner;
                    profile.plain_derivative = plain;
                    int partial = 0;
                    for (const auto& triangle : triangles) {
                        Canvas canvas(profile, kSize, kSize, samples, 2);
                        // a = 3 x + 5 y and b = -x + 2 y on the screen, in pixels: exact where the vertices are.
                        std::vector<TestVertex> v;
                        for (const auto& [x, y] : triangle)
                            v.push_back({x / 16.0f - 1.0f, 1.0f - y / 16.0f, 0.5f, 1.0f, 3.0f * x + 5.0f * y, 2.0f * y - x});
                        Draw draw = make_draw(derivative_program(), upload(canvas.device, v), 0, 3);
                        draw.pixel_constants = pixel_constants(id_program());  // neither has constants
                        for (std::size_t i = 0; i < 3; ++i) {
                            draw.color[i] = canvas.target(Format::Rgba32Float);
                            canvas.device.execute(ClearColor{draw.color[i], glm::vec4(-1e9f)});
                        }
                        canvas.device.execute(draw);
                        std::set<int> touched;
                        int covered = 0;
                        for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                            for (int s = 0; s < samples; ++s) {
                                const auto value = [&](std::size_t target, int c) {
                                    return canvas.value(draw.color[target].texture, i, c, 0, s);
                                };
                                if (value(0, 0) == -1e9f) continue;
                                const int x = static_cast<int>(i % kSize);
                                const int y = static_cast<int>(i / kSize);
                                if (touched.insert(y / 2 * kSize + x / 2).second) covered -= 4;
                                covered += s == 0 ? 1 : 0;
                                const int left = x & ~1;
                                const int top = y & ~1;
                                const int row =
                                    top + (corner == DerivativeCorner::BottomLeft || corner == DerivativeCorner::BottomRight);
                                const int column =
                                    left + (corner == DerivativeCorner::TopRight || corner == DerivativeCorner::BottomRight);
                                const float coarse_x = g(left + 1, row) - g(left, row);
                                const float coarse_y = g(column, top + 1) - g(column, top);
                                const float fine_x = g(left + 1, y) - g(left, y);
                                const float fine_y = g(x, top + 1) - g(x, top);
                                const bool is_fine = plain == PlainDerivative::Fine;
                                INFO("pixel " << x << ", " << y << ", corner " << name_of(corner));
                                REQUIRE(value(0, 0) == coarse_x);
                                REQUIRE(value(0, 1) == coarse_y);
                                REQUIRE(value(0, 2) == fine_x);
                                REQUIRE(value(0, 3) == fine_y);
                                REQUIRE(value(1, 0) == (is_fine ? fine_x : coarse_x));
                                REQUIRE(value(1, 1) == (is_fine ? fine_y : coarse_y));
                                // Extrapolated beyond the edge, a plane stays a plane: up to snapping and rounding.
                                REQUIRE(std::fabs(value(1, 2) - 3.0f) < 0.05f);
                                REQUIRE(std::fabs(value(1, 3) - 5.0f) < 0.05f);
                                REQUIRE(std::fabs(value(2, 0) + 1.0f) < 0.05f);
                                REQUIRE(std::fabs(value(2, 1) - 2.0f) < 0.05f);
                                REQUIRE(std::fabs(value(2, 2) + 1.0f) < 0.05f);
                                REQUIRE(std::fabs(value(2, 3) - 2.0f) < 0.05f);
                            }
                        }
                        CHECK(!touched.empty());
                        partial += covered < 0 ? 1 : 0;
                    }
                    CHECK(partial >= 4);
                }
            }
        }
    }
}
