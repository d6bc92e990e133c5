// D3D11.3 15.13: wireframe draws the edges of a triangle as lines, by its facing and by the line mode; edges that clipping made
// are not drawn.
#include "tests/oracle/clipping.h"
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Masks;
using oracle::Point;
using oracle::Random;

namespace {

Masks outline(const oracle::SnappedTriangle& t, LineMode mode, const oracle::PixelRect& rect,
              const oracle::SamplePattern& pattern) {
    Masks masks(rect);
    for (std::size_t i = 0; i < 3; ++i) {
        const Point& a = t[i];
        const Point& b = t[(i + 1) % 3];
        if (mode == LineMode::Aliased) {
            for (const oracle::Pixel& pixel : oracle::aliased_line(a, b, rect)) masks.at(pixel.x, pixel.y) = pattern.all();
        } else {
            const auto corners = oracle::line_rectangle({a.x * 256, a.y * 256}, {b.x * 256, b.y * 256});
            const Masks edge = oracle::quadrilateral_coverage(corners, rect, pattern);
            for (const auto& pixel : oracle::covered_pixels(edge)) masks.at(pixel.x, pixel.y) |= pixel.mask;
        }
    }
    return masks;
}

}  // namespace

TEST_CASE("wireframe is three lines of the line mode", "[raster][15.13]") {
    for (const LineMode mode : {LineMode::Aliased, LineMode::Quadrilateral})
        for (const int samples : {1, 4}) {
            const oracle::TriangleTarget target{.width = 24, .height = 24, .pattern = oracle::standard_pattern(samples)};
            Canvas canvas(identify_program(), Profile{}, {.width = 24, .height = 24, .samples = samples});
            std::uint64_t drawn = 0;
            for (std::uint64_t seed = 0; seed < 200; ++seed) {
                Random random(seed);
                // Positions that 24 pixels hold exactly: multiples of 3/256 pixel are multiples of 1/1024 in clip space.
                const auto corner = [&] {
                    const std::int64_t x = random.between(-200, 2248);
                    const std::int64_t y = random.between(-200, 2248);
                    return Point{x * 3, y * 3};
                };
                const oracle::SnappedTriangle t{corner(), corner(), corner()};
                const bool front = oracle::facing(t) == oracle::Facing::Front;
                for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back}) {
                    canvas.clear();
                    Draw draw = canvas.draw_of({vertex_at(t[0], canvas.rect(), 1.0f), vertex_at(t[1], canvas.rect(), 1.0f),
                                                vertex_at(t[2], canvas.rect(), 1.0f)});
                    draw.raster.fill = FillMode::Wireframe;
                    draw.raster.lines = mode;
                    draw.raster.cull = cull;
                    draw.raster.front_counter_clockwise = false;
                    canvas.execute(draw);
                    const bool culled = cull == (front ? CullMode::Front : CullMode::Back);
                    const Masks expected = culled ? Masks(target.rect()) : outline(t, mode, target.rect(), target.pattern);
                    drawn += expected.samples();
                    const Masks got = canvas.masks(1.0f);
                    const std::string wrong = difference(expected, got);
                    if (!wrong.empty())
                        FAIL(fmt::format("{}, {} samples, seed {}, cull {}: {}\n  {}", gnomon::name_of(mode), samples, seed,
                                         gnomon::name_of(cull), wrong, describe(t)));
                    // The lines face as their triangle does.
                    for (const auto& pixel : oracle::covered_pixels(got)) {
                        const int s = std::countr_zero(pixel.mask);
                        REQUIRE(canvas.value(1, 0, {pixel.x, pixel.y, s}) == (front ? 1.0f : 0.0f));
                    }
                }
            }
            CHECK(drawn > 5000);
        }
}

TEST_CASE("clipping a wireframe triangle opens it", "[raster][15.13][15.4]") {
    // Corner 0 has z < 0: the edge from 1 to 2 stays whole, the cut at z = 0 is not drawn.
    Canvas canvas(mark_program(), Profile{}, {.width = 32, .height = 32});
    const std::array<Point, 3> t{Point{16 * 256, 2 * 256 + 64}, Point{28 * 256, 28 * 256}, Point{4 * 256, 28 * 256}};
    std::vector<RasterVertex> vertices;
    for (const Point& p : t) vertices.push_back(vertex_at(p, canvas.rect(), 1.0f));
    vertices[0].clip[2] = -0.5f;  // the others at 0.5: the cut is half way
    for (const bool depth_clip : {true, false}) {
        canvas.clear();
        Draw draw = canvas.draw_of(vertices);
        draw.raster.fill = FillMode::Wireframe;
        draw.raster.depth_clip = depth_clip;
        canvas.execute(draw);
        const Masks whole = outline({t[0], t[1], t[2]}, LineMode::Aliased, canvas.rect(), oracle::standard_pattern(1));
        const Masks drawn = canvas.masks(1.0f);
        if (!depth_clip) {
            CHECK(difference(whole, drawn).empty());
            continue;
        }
        const auto cut = static_cast<int>((t[0].y + t[1].y) / 2 / 256);
        int above = 0;
        int below = 0;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                above += y < cut && drawn.at(x, y) != 0;
                if (y <= cut + 1) continue;
                below += drawn.at(x, y) != 0;
                INFO("pixel (" << x << ", " << y << ")");
                REQUIRE(drawn.at(x, y) == whole.at(x, y));
            }
        CHECK(above == 0);
        CHECK(below > 40);
        // The row of the cut has the two sides in it and nothing between.
        CHECK(drawn.at(16, cut) == 0);
    }
}
