// D3D11.3 3.4.6: a point is a square of width 1 around its snapped position, by the rule of triangles for every sample.
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;

namespace {

/// Draws every point alone, a layer each, in a target of 4 x 4 pixels; returns the samples drawn.
std::uint64_t check_points(int samples, const std::vector<Point>& points) {
    constexpr std::size_t kLayers = 2048;
    const auto pattern = oracle::standard_pattern(samples);
    Canvas canvas(mark_program(), Profile{}, {.width = 4, .height = 4, .samples = samples, .layers = kLayers});
    std::uint64_t drawn = 0;
    for (std::size_t begin = 0; begin < points.size(); begin += kLayers) {
        const std::size_t end = std::min(points.size(), begin + kLayers);
        std::vector<RasterVertex> vertices;
        for (std::size_t i = begin; i < end; ++i)
            vertices.push_back(vertex_at(points[i], canvas.rect(), 1.0f, static_cast<float>(i - begin)));
        canvas.clear();
        Draw draw = canvas.draw_of(vertices);
        draw.topology = Topology::PointList;
        draw.raster.cull = CullMode::Back;  // points have no facing
        canvas.execute(draw);
        for (std::size_t i = begin; i < end; ++i) {
            const auto expected = oracle::quadrilateral_coverage(oracle::point_square(points[i]), canvas.rect(), pattern);
            drawn += expected.samples();
            const std::string wrong = difference(expected, canvas.masks(1.0f, static_cast<int>(i - begin)));
            if (!wrong.empty()) FAIL(fmt::format("{} samples, point {}: {}", samples, describe(points[i]), wrong));
        }
    }
    return drawn;
}

/// Positions of the cell of pixel (1, 1), its borders included.
std::vector<Point> cell(int step) {
    std::vector<Point> points;
    for (int i = 0; i < 257 * 257; i += step) points.push_back({256 + i % 257, 256 + i / 257});
    return points;
}

}  // namespace

TEST_CASE("points at positions of a cell", "[raster][points][3.4.6]") {
    for (const int samples : oracle::kSampleCounts) {
        const auto points = cell(17);
        CHECK(check_points(samples, points) > points.size() * static_cast<unsigned>(samples) * 9 / 10);
    }
}
TEST_CASE("points at every position of a cell", "[.][sweep][raster-sweep][3.4.6]") {
    for (const int samples : oracle::kSampleCounts) CHECK(check_points(samples, cell(1)) > 60000);
}

TEST_CASE("a point covers one pixel at one sample: on a border the left or the upper one", "[raster][points][3.4.6]") {
    Canvas canvas(mark_program(), Profile{}, {.width = 4, .height = 4});
    for (const Point& p : {Point{512, 512}, Point{512, 513}, Point{513, 512}, Point{640, 640}, Point{511, 1}, Point{1, 1023}}) {
        canvas.clear();
        Draw draw = canvas.draw_of({vertex_at(p, canvas.rect(), 1.0f)});
        draw.topology = Topology::PointList;
        canvas.execute(draw);
        const auto covered = oracle::covered_pixels(canvas.masks(1.0f));
        INFO(describe(p));
        REQUIRE(covered.size() == 1);
        CHECK(covered[0].x == (p.x + 255) / 256 - 1);
        CHECK(covered[0].y == (p.y + 255) / 256 - 1);
    }
}

TEST_CASE("points whose centre is outside the viewport still cover what reaches in", "[raster][points][3.4.6][15.4]") {
    std::vector<Point> points;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        Random random(seed);
        const std::int64_t x = random.between(-200, 4 * 256 + 200);
        const std::int64_t y = random.chance(2) ? random.between(-200, 0) : random.between(4 * 256, 4 * 256 + 200);
        points.push_back(random.chance(2) ? Point{x, y} : Point{y, x});
    }
    CHECK(check_points(8, points) > 500);
}

TEST_CASE("a point's centre is snapped before it becomes a square", "[raster][points][3.4.6][3.4.1]") {
    // In a viewport of one pixel, x = (1/2 + e) / 256 is ndc 2 x - 1. Nearest even: 1/2 goes to 0, a little more to 1. At 0 the
    // square's left edge is half a pixel outside, and the pixel's centre lies on its right edge, which is not part of it.
    const auto covers = [](float x_px) {
        Canvas canvas(mark_program(), Profile{}, {.width = 1, .height = 1});
        Draw draw = canvas.draw_of({{.clip = {2.0f * x_px - 1.0f, 0.0f, 0.5f, 1.0f}, .a = 1.0f}});
        draw.topology = Topology::PointList;
        canvas.execute(draw);
        return canvas.masks(1.0f).samples() == 1;
    };
    CHECK_FALSE(covers(0.5f / 256.0f));
    CHECK(covers(0.5f / 256.0f + 0x1p-22f));
    CHECK(covers(1.5f / 256.0f));
}
