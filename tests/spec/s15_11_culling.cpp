// D3D11.3 15.11: facing by the winding of the snapped triangle, culling by facing, triangles without area (15.11.1), and
// IsFrontFace for the pixel functor.
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

TEST_CASE("triangles are culled by their facing, which the functor sees", "[raster][15.11]") {
    constexpr int kLayers = 128;
    const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(4)};
    Canvas canvas(identify_program(), Profile{}, {.samples = 4, .layers = kLayers});
    std::array<std::uint64_t, 2> seen{};
    for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back})
        for (const bool counter_clockwise : {false, true}) {
            std::vector<RasterVertex> vertices;
            std::vector<oracle::SnappedTriangle> snapped;
            for (int layer = 0; layer < kLayers; ++layer) {
                const oracle::TriangleCase c = oracle::triangle_case(static_cast<std::uint64_t>(layer) + 900, target);
                Random random(static_cast<std::uint64_t>(layer));
                oracle::SnappedTriangle& t = snapped.emplace_back();
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto placed = oracle::place(random, c.triangle[i], target.rect());
                    vertices.push_back(vertex_of(placed, 1.0f, static_cast<float>(layer)));
                    t[i] = placed.snapped;
                }
            }
            canvas.clear();
            Draw draw = canvas.draw_of(vertices);
            draw.raster.cull = cull;
            draw.raster.front_counter_clockwise = counter_clockwise;
            canvas.execute(draw);
            for (int layer = 0; layer < kLayers; ++layer) {
                const oracle::SnappedTriangle& t = snapped[static_cast<std::size_t>(layer)];
                const bool front = oracle::facing(t, counter_clockwise) == oracle::Facing::Front;
                oracle::Masks expected(target.rect());
                if (cull != (front ? CullMode::Front : CullMode::Back)) oracle::add_coverage(expected, t, target.pattern);
                const oracle::Masks drawn = canvas.masks(1.0f, layer);
                const std::string wrong = difference(expected, drawn);
                if (!wrong.empty())
                    FAIL(fmt::format("cull {}, ccw {}, case {}: {}\n  {}", gnomon::name_of(cull), counter_clockwise,
                                     layer + 900, wrong, describe(t)));
                for (int y = 0; y < 16; ++y)
                    for (int x = 0; x < 16; ++x)
                        for (int s = 0; s < 4; ++s) {
                            if ((drawn.at(x, y) >> s & 1u) == 0) continue;
                            ++seen[front ? 1 : 0];
                            if (canvas.value(1, 0, {x, y, s, layer}) != (front ? 1.0f : 0.0f))
                                FAIL("case " << layer + 900 << ", pixel (" << x << ", " << y << "), sample " << s << " faces "
                                             << canvas.value(1, 0, {x, y, s, layer}));
                        }
            }
        }
    CHECK(seen[0] > 10000);
    CHECK(seen[1] > 10000);
}

TEST_CASE("a triangle without area is a back face and draws nothing", "[raster][15.11][15.11.1]") {
    Canvas canvas(mark_program(), Profile{}, {});
    const oracle::TriangleTarget target;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        const auto t = oracle::random_triangle(random, oracle::TriangleKind::ZeroArea, target);
        std::vector<RasterVertex> vertices;
        for (const oracle::Point& p : t) vertices.push_back(vertex_of(oracle::place(random, p, target.rect()), 1.0f));
        for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back}) {
            Draw draw = canvas.draw_of(vertices);
            draw.raster.cull = cull;
            canvas.device().enable_counters(true);
            canvas.execute(draw);
            const Counters counters = canvas.device().take_counters();
            INFO("seed " << seed << ": " << describe(t));
            REQUIRE(counters.primitives_culled == 1);
            REQUIRE(counters.samples_covered == 0);
        }
    }
    // As wireframe its facing shows: culling of back faces removes it, of front faces does not.
    const std::vector<RasterVertex> flat{vertex_at({300, 300}, canvas.rect(), 1.0f),
                                         vertex_at({3000, 300}, canvas.rect(), 1.0f),
                                         vertex_at({1000, 300}, canvas.rect(), 1.0f)};
    for (const bool counter_clockwise : {false, true})
        for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back}) {
            canvas.clear();
            Draw draw = canvas.draw_of(flat);
            draw.raster.fill = FillMode::Wireframe;
            draw.raster.cull = cull;
            draw.raster.front_counter_clockwise = counter_clockwise;
            canvas.execute(draw);
            CHECK((canvas.masks(1.0f).samples() > 0) == (cull != CullMode::Back));
        }
}
