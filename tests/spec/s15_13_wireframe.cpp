// D3D11.3 15.13: wireframe draws the edges of a triangle as lines, by its facing and by the line mode; edges that clipping made
// are not drawn.
#include "tests/oracle/clipping.h"
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

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

TEST_CASE("edges of a clipped wireframe triangle take the bias of their own post-clip triangle", "[raster][15.13][15.10]") {
    // Corner 0 is cut off by the near plane, which leaves (cut, corner 1, corner 2, cut) in two triangles. The step of a D32
    // bias follows the largest depth of each: every triangle with an edge at corner 2 has its depth of 0.9.
    const std::array<Point, 3> t{Point{16 * 256, 2 * 256 + 64}, Point{28 * 256, 28 * 256}, Point{4 * 256, 28 * 256}};
    const std::array<float, 3> z{-0.5f, 0.05f, 0.9f};
    constexpr float kSteps = 4096;
    for (std::size_t turn = 0; turn < 3; ++turn)
        for (const bool mirrored : {false, true}) {
            std::vector<RasterVertex> vertices;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t corner = (mirrored ? 2 - i + turn : i + turn) % 3;
                vertices.push_back(vertex_at(t[corner], {0, 0, 32, 32}, 1.0f));
                vertices.back().clip[2] = z[corner];
            }
            const auto depths = [&](int steps) {
                Canvas canvas(mark_program(), Profile{}, {.width = 32, .height = 32, .depth = Format::D32Float});
                canvas.clear();
                Draw draw = canvas.draw_of(vertices);
                draw.raster.fill = FillMode::Wireframe;
                draw.raster.depth_bias = steps;
                draw.depth_state = {.test = true, .write = true, .compare = CompareOp::Always};
                canvas.execute(draw);
                std::vector<float> values;
                for (int y = 0; y < 32; ++y)
                    for (int x = 0; x < 32; ++x) values.push_back(std::bit_cast<float>(canvas.depth_code({x, y})));
                return values;
            };
            const auto plain = depths(0);
            const auto biased = depths(static_cast<int>(kSteps));
            // The lower edge, corner 1 to corner 2, and what is left of the one from corner 2 up; the joint of it with the cut
            // and the right end, where the third edge is drawn over it, are left out.
            int checked = 0;
            for (int y = 21; y < 32; ++y)
                for (int x = 0; x < 26; ++x) {
                    const auto i = static_cast<std::size_t>(y * 32 + x);
                    if (plain[i] == 1.0f || (x > 12 && y < 27)) continue;
                    ++checked;
                    INFO("turn " << turn << ", mirrored " << mirrored << ", pixel (" << x << ", " << y << ")");
                    CHECK(std::fabs(biased[i] - plain[i] - kSteps * 0x1p-24f) <= 0x1p-23f);
                }
            CHECK(checked > 25);
        }
}
