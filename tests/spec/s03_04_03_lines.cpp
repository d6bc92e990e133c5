// D3D11.3 3.4.3: aliased lines draw the pixels whose diamond they leave, all samples of them, by themselves and in strips.
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Masks;
using oracle::Pixel;
using oracle::Point;
using oracle::Random;

namespace {

using Ends = std::array<Point, 2>;

Masks masks_of(const std::vector<Pixel>& pixels, const oracle::PixelRect& rect, const oracle::SamplePattern& pattern) {
    Masks masks(rect);
    for (const Pixel& pixel : pixels) masks.at(pixel.x, pixel.y) = pattern.all();
    return masks;
}

/// Draws every line alone, a layer each, and compares; returns the pixels drawn.
std::uint64_t check_lines(Canvas& canvas, const std::vector<Ends>& lines) {
    const auto pattern = oracle::standard_pattern(canvas.desc().samples);
    const auto layers = static_cast<std::size_t>(canvas.desc().layers);
    std::uint64_t drawn = 0;
    for (std::size_t begin = 0; begin < lines.size(); begin += layers) {
        const std::size_t end = std::min(lines.size(), begin + layers);
        std::vector<RasterVertex> vertices;
        for (std::size_t i = begin; i < end; ++i)
            for (const Point& p : lines[i])
                vertices.push_back(vertex_at(p, canvas.rect(), 1.0f, static_cast<float>(i - begin)));
        canvas.clear();
        Draw draw = canvas.draw_of(vertices);
        draw.topology = Topology::LineList;
        canvas.execute(draw);
        for (std::size_t i = begin; i < end; ++i) {
            const auto pixels = oracle::aliased_line(lines[i][0], lines[i][1], canvas.rect());
            drawn += pixels.size();
            const std::string wrong =
                difference(masks_of(pixels, canvas.rect(), pattern), canvas.masks(1.0f, static_cast<int>(i - begin)));
            if (!wrong.empty())
                FAIL(fmt::format("{} samples, line {} from {} to {}: {}", pattern.count, i, describe(lines[i][0]),
                                 describe(lines[i][1]), wrong));
        }
    }
    return drawn;
}

/// Beyond that the guard band cuts a line, and its direction then changes by less than the grid can hold. D3D11.3 3.4.3.1
bool in_guard_band(const Point& p) {
    constexpr std::int64_t kReach = std::int64_t{32765} * 256;
    return std::abs(p.x) <= kReach && std::abs(p.y) <= kReach;
}

}  // namespace

TEST_CASE("every line between points on the quarter-pixel grid of a pixel and around it", "[raster][lines][3.4.3]") {
    // 7 x 7 positions from (3/4, 3/4) to (9/4, 9/4): the diamond of pixel (1, 1) with its corners, edges and surroundings.
    std::vector<Ends> lines;
    const auto at = [](int i) { return Point{(3 + i % 7) * 64, (3 + i / 7) * 64}; };
    for (int a = 0; a < 49; ++a)
        for (int b = 0; b < 49; ++b) lines.push_back({at(a), at(b)});
    Canvas canvas(mark_program(), Profile{}, {.width = 4, .height = 4, .layers = 1024});
    CHECK(check_lines(canvas, lines) > 1000);
}

TEST_CASE("random aliased lines", "[raster][lines][3.4.3]") {
    for (const int samples : {1, 4, 16}) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(mark_program(), Profile{}, {.samples = samples, .layers = 256});
        std::vector<Ends> lines;
        for (std::uint64_t seed = 0; lines.size() < 4096u / static_cast<unsigned>(samples); ++seed) {
            Random random(seed);
            const Ends line = oracle::random_line(random, target);
            if (in_guard_band(line[0]) && in_guard_band(line[1])) lines.push_back(line);
        }
        CHECK(check_lines(canvas, lines) > lines.size());
    }
}

TEST_CASE("aliased lines go on across tiles", "[raster][lines][3.4.3]") {
    const oracle::TriangleTarget target{.width = 150, .height = 140};
    Canvas canvas(mark_program(), Profile{}, {.width = 150, .height = 140, .layers = 64});
    std::vector<Ends> lines;
    for (std::uint64_t seed = 0; lines.size() < 320; ++seed) {
        Random random(seed + 77);
        const Ends line = oracle::random_line(random, target);
        if (in_guard_band(line[0]) && in_guard_band(line[1])) lines.push_back(line);
    }
    CHECK(check_lines(canvas, lines) > lines.size());
}

TEST_CASE("a line strip draws what its lines draw, one after the other", "[raster][lines][3.4.3][8.10]") {
    Canvas canvas(mark_program(), Profile{}, {.width = 32, .height = 32});
    std::uint64_t drawn = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        std::vector<Point> joints;
        for (int i = 0; i < 12; ++i) {
            const std::int64_t x = random.between(-4, 132);
            const std::int64_t y = random.between(-4, 132);
            joints.push_back({x * 64, y * 64});
        }
        std::vector<RasterVertex> vertices;
        for (const Point& p : joints) vertices.push_back(vertex_at(p, canvas.rect(), 1.0f));
        std::vector<int> counts(32 * 32);
        for (std::size_t i = 0; i + 1 < joints.size(); ++i)
            for (const Pixel& pixel : oracle::aliased_line_by_crossings(joints[i], joints[i + 1], canvas.rect()))
                ++counts[static_cast<std::size_t>(pixel.y * 32 + pixel.x)];
        canvas.clear(0.0f);
        Draw draw = canvas.draw_of(vertices);
        draw.topology = Topology::LineStrip;
        draw.output.blend[0] = {.enable = true, .src = BlendFactor::One, .dst = BlendFactor::One};
        canvas.execute(draw);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                const int expected = counts[static_cast<std::size_t>(y * 32 + x)];
                drawn += static_cast<std::uint64_t>(expected);
                const float times = canvas.value(0, 0, {.x = x, .y = y});
                if (times != static_cast<float>(expected))
                    FAIL(fmt::format("seed {}: pixel ({}, {}) drawn {} times, expected {}", seed, x, y, times, expected));
            }
    }
    CHECK(drawn > 20000);
}

TEST_CASE("lines have no facing: they are never culled and always front", "[raster][lines][15.11]") {
    Canvas canvas(identify_program(), Profile{}, {});
    for (const LineMode lines : {LineMode::Aliased, LineMode::Quadrilateral})
        for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back})
            for (const bool turned : {false, true}) {
                const Point a{300, 700};
                const Point b{3000, 2000};
                canvas.clear();
                Draw draw = canvas.draw_of(
                    {vertex_at(turned ? b : a, canvas.rect(), 1.0f), vertex_at(turned ? a : b, canvas.rect(), 1.0f)});
                draw.topology = Topology::LineList;
                draw.raster.lines = lines;
                draw.raster.cull = cull;
                canvas.execute(draw);
                const Masks masks = canvas.masks(1.0f);
                CHECK(masks.samples() >= 10);
                for (const oracle::CoveredPixel& pixel : oracle::covered_pixels(masks))
                    CHECK(canvas.value(1, 0, {.x = pixel.x, .y = pixel.y}) == 1.0f);
            }
}
