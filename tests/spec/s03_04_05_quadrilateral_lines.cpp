// D3D11.3 3.4.5: with the quadrilateral line mode a line is a rectangle of width 1.4 whose corners are snapped, whatever the
// sample count.
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::FinePoint;
using oracle::Random;

namespace {

constexpr int kSize = 16;  // pixels: 1/65536 pixel is exact in clip space and back

RasterVertex fine_vertex(const FinePoint& p, float layer) {
    const auto ndc = [](std::int64_t fine) { return static_cast<float>(fine - 65536 * kSize / 2) / (65536.0f * kSize / 2); };
    return {.clip = {ndc(p.x), -ndc(p.y), 0.5f, 1.0f}, .a = 1.0f, .layer = layer};
}

std::uint64_t check_lines(int samples, const std::vector<std::array<FinePoint, 2>>& lines) {
    constexpr std::size_t kLayers = 256;
    const auto pattern = oracle::standard_pattern(samples);
    Canvas canvas(mark_program(), Profile{}, {.width = kSize, .height = kSize, .samples = samples, .layers = kLayers});
    std::uint64_t drawn = 0;
    for (std::size_t begin = 0; begin < lines.size(); begin += kLayers) {
        const std::size_t end = std::min(lines.size(), begin + kLayers);
        std::vector<RasterVertex> vertices;
        for (std::size_t i = begin; i < end; ++i)
            for (const FinePoint& p : lines[i]) vertices.push_back(fine_vertex(p, static_cast<float>(i - begin)));
        canvas.clear();
        Draw draw = canvas.draw_of(vertices);
        draw.topology = Topology::LineList;
        draw.raster.lines = LineMode::Quadrilateral;
        canvas.execute(draw);
        for (std::size_t i = begin; i < end; ++i) {
            const auto corners = oracle::line_rectangle(lines[i][0], lines[i][1]);
            const auto expected = oracle::quadrilateral_coverage(corners, canvas.rect(), pattern);
            drawn += expected.samples();
            const std::string wrong = difference(expected, canvas.masks(1.0f, static_cast<int>(i - begin)));
            if (!wrong.empty())
                FAIL(fmt::format("{} samples, line {} from ({}, {})/65536 to ({}, {})/65536: {}", samples, i, lines[i][0].x,
                                 lines[i][0].y, lines[i][1].x, lines[i][1].y, wrong));
        }
    }
    return drawn;
}

}  // namespace

TEST_CASE("lines between grid points as rectangles", "[raster][lines][3.4.5]") {
    for (const int samples : oracle::kSampleCounts) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        std::vector<std::array<FinePoint, 2>> lines;
        for (std::uint64_t seed = 0; lines.size() < 1024; ++seed) {
            Random random(seed * 5);
            const auto line = oracle::random_line(random, target);
            // As far as 24 bits hold 1/65536 pixel.
            const auto near = [](const oracle::Point& p) { return std::abs(p.x) < 32 * 256 && std::abs(p.y) < 32 * 256; };
            if (near(line[0]) && near(line[1]))
                lines.push_back({FinePoint{line[0].x * 256, line[0].y * 256}, FinePoint{line[1].x * 256, line[1].y * 256}});
        }
        CHECK(check_lines(samples, lines) > 1000);
    }
}

TEST_CASE("corners are made from ends that are not snapped", "[raster][lines][3.4.5][3.4.1]") {
    std::uint64_t differ = 0;
    for (const int samples : {1, 4, 16}) {
        std::vector<std::array<FinePoint, 2>> lines;
        for (std::uint64_t seed = 0; seed < 1024; ++seed) {
            Random random(seed * 7 + 3);
            const auto fine = [&] {
                const std::int64_t x = random.between(-65536, (kSize + 1) * 65536);
                const std::int64_t y = random.between(-65536, (kSize + 1) * 65536);
                return FinePoint{x, y};
            };
            const FinePoint a = fine();
            const FinePoint b = fine();
            lines.push_back({a, b});
            const auto on_grid = [](const FinePoint& p) { return FinePoint{(p.x + 128) / 256 * 256, (p.y + 128) / 256 * 256}; };
            differ += oracle::line_rectangle(a, b) != oracle::line_rectangle(on_grid(a), on_grid(b));
        }
        CHECK(check_lines(samples, lines) > 10000);
    }
    CHECK(differ > 1000);  // the order of snapping and widening shows
}

TEST_CASE("a line without length draws nothing as a rectangle", "[raster][lines][3.4.5]") {
    const FinePoint p{5 * 65536 + 1234, 6 * 65536};
    CHECK(check_lines(4, {{p, p}}) == 0);
}
