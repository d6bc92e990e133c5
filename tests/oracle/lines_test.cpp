// The line oracle against itself: diamonds against the closed form, strips, and cases worked by hand.
// D3D11.3 3.4.3, 3.4.5, 3.4.6
#include "tests/oracle/lines.h"
#include "tests/oracle/triangles.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <map>

using namespace oracle;

namespace {

constexpr PixelRect kRect{-2, -2, 12, 12};

std::string describe(const Point& a, const Point& b) { return fmt::format("({}, {}) -> ({}, {}) / 256", a.x, a.y, b.x, b.y); }

std::string describe(const std::vector<Pixel>& pixels) {
    std::string text;
    for (const Pixel& p : pixels) text += fmt::format(" ({}, {})", p.x, p.y);
    return text;
}

void check_both(const Point& a, const Point& b) {
    const auto asked = aliased_line(a, b, kRect);
    const auto crossed = aliased_line_by_crossings(a, b, kRect);
    if (asked != crossed) FAIL(describe(a, b) << "\n  diamonds: " << describe(asked) << "\n  crossings:" << describe(crossed));
}

}  // namespace

TEST_CASE("diamonds have the lower edges and the bottom corner", "[oracle][3.4.3]") {
    const Pixel p{2, 3};
    const auto at = [](std::int64_t u, std::int64_t v) { return Point{2 * 256 + 128 + u, 3 * 256 + 128 + v}; };
    for (const bool y_major : {false, true}) {
        CHECK(in_diamond(p, at(0, 0), y_major));
        CHECK(in_diamond(p, at(127, 0), y_major));
        CHECK(in_diamond(p, at(0, 128), y_major));
        CHECK(in_diamond(p, at(64, 64), y_major));
        CHECK(in_diamond(p, at(-64, 64), y_major));
        CHECK(in_diamond(p, at(-127, 1), y_major));
        CHECK_FALSE(in_diamond(p, at(0, -128), y_major));
        CHECK_FALSE(in_diamond(p, at(-128, 0), y_major));
        CHECK_FALSE(in_diamond(p, at(64, -64), y_major));
        CHECK_FALSE(in_diamond(p, at(-64, -64), y_major));
        CHECK_FALSE(in_diamond(p, at(65, 64), y_major));
        CHECK(in_diamond(p, at(128, 0), y_major) == y_major);
    }
}

TEST_CASE("no two diamonds share a point, and every pixel centre has one", "[oracle][3.4.3]") {
    for (const bool y_major : {false, true})
        for (std::int64_t y = 256; y <= 512; y += 4)
            for (std::int64_t x = 256; x <= 512; x += 4) {
                int found = 0;
                for (int j = 0; j < 3; ++j)
                    for (int i = 0; i < 3; ++i) found += in_diamond({i, j}, {x, y}, y_major);
                REQUIRE(found <= 1);
            }
}

TEST_CASE("the closed form of aliased lines is the diamond rule", "[oracle][3.4.3]") {
    for (std::uint64_t index = 0; index < 60000; ++index) {
        Random random(index);
        const auto [a, b] = random_line(random, {.width = 9, .height = 7});
        INFO("case " << index);
        check_both(a, b);
    }
    // Every pair of ends on the 1/4 grid of a few pixels.
    for (std::int64_t i = 0; i < 81; ++i)
        for (std::int64_t j = 0; j < 17 * 17; ++j)
            check_both({512 + i % 9 * 64, 512 + i / 9 * 64}, {256 + j % 17 * 64, 256 + j / 17 * 64});
}

TEST_CASE("one end over every grid position of a pixel", "[oracle][3.4.3]") {
    for (std::int64_t y = 0; y <= 256; ++y)
        for (std::int64_t x = 0; x <= 256; ++x)
            for (const Point& other :
                 {Point{1300, 900}, {640, 640}, {512, 640}, {640, 512}, {0, 256}, {300, 1500}, {513, 513}}) {
                check_both({512 + x, 512 + y}, other);
                check_both(other, {512 + x, 512 + y});
            }
}

TEST_CASE("lines worked by hand", "[oracle][3.4.3]") {
    const auto line = [](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by) {
        return aliased_line({ax, ay}, {bx, by}, kRect);
    };
    using Pixels = std::vector<Pixel>;
    // From centre to centre: the start is drawn, the end is not.
    CHECK(line(128, 128, 896, 128) == Pixels{{0, 0}, {1, 0}, {2, 0}});
    CHECK(line(896, 128, 128, 128) == Pixels{{1, 0}, {2, 0}, {3, 0}});
    CHECK(line(128, 128, 128, 896) == Pixels{{0, 0}, {0, 1}, {0, 2}});
    // Exactly between two rows, or two columns: the upper, the left.
    CHECK(line(0, 256, 768, 256) == Pixels{{0, 0}, {1, 0}, {2, 0}});
    CHECK(line(256, 0, 256, 768) == Pixels{{0, 0}, {0, 1}, {0, 2}});
    // Diagonals along the edges of diamonds have one pixel a column: lower edges belong, upper edges do not.
    CHECK(line(0, 128, 768, 896) == Pixels{{0, 0}, {1, 1}, {2, 2}});
    CHECK(line(128, 256, 768, -384) == Pixels{{2, -2}, {1, -1}, {0, 0}});
    // A line that never leaves the diamond it starts in, and one that is a point.
    CHECK(line(100, 128, 150, 140).empty());
    CHECK(line(128, 128, 128, 128).empty());
    // A right corner: outside for an x-major line that ends there, so that the pixel is left; inside for a y-major one.
    CHECK(line(128, 128, 256, 128) == Pixels{{0, 0}});
    CHECK(line(192, 0, 256, 128) == Pixels{});
    CHECK(line(256, 128, 300, 400) == Pixels{{0, 0}});
    // The bottom corner holds x-major and y-major ends.
    CHECK(line(128, 128, 128, 256).empty());
    CHECK(line(128, 256, 128, 512) == Pixels{{0, 0}});
}

TEST_CASE("strips draw each column once, joints included", "[oracle][3.4.3]") {
    // x-major strips that never turn back, then y-major ones.
    for (std::uint64_t index = 0; index < 20000; ++index) {
        Random random(index);
        const bool y_major = index % 2 == 1;
        std::map<int, int> times;
        Point at{random.between(0, 256), random.between(512, 2048)};
        const Point start = at;
        for (int i = 0; i < 6; ++i) {
            const std::int64_t step = random.chance(2) ? random.between(1, 600) : random.between(1, 8) * 64;
            const std::int64_t limit = y_major ? step - 1 : step;
            std::int64_t across = random.between(-limit, limit);
            if (random.chance(3)) across = across / 64 * 64;
            const Point next{at.x + step, at.y + across};
            const auto turned = [&](const Point& p) { return y_major ? Point{p.y, p.x} : p; };
            for (const Pixel& p : aliased_line(turned(at), turned(next), {-20, -20, 60, 60})) ++times[y_major ? p.y : p.x];
            at = next;
        }
        for (const auto& [column, count] : times) {
            INFO("case " << index << ", column or row " << column);
            REQUIRE(count == 1);
            REQUIRE((column == times.begin()->first || times.contains(column - 1)));
        }
        // Every centre strictly inside, with the ends' own columns as the diamonds say.
        const auto columns = static_cast<std::int64_t>(times.size());
        REQUIRE(std::llabs(columns * 256 - (at.x - start.x)) <= 512);
    }
}

TEST_CASE("a joint on a right corner is drawn twice from x-major to y-major only", "[oracle][3.4.3]") {
    const PixelRect rect{0, 0, 4, 4};
    const Point corner{256, 128};
    const Pixel pixel{0, 0};
    CHECK(line_draws({0, 128}, corner, pixel));
    CHECK(line_draws(corner, {256, 512}, pixel));
    CHECK_FALSE(line_draws({256, -256}, corner, pixel));
    CHECK_FALSE(line_draws(corner, {512, 128}, pixel));
    CHECK(aliased_line(corner, {512, 128}, rect) == std::vector<Pixel>{{1, 0}});
}

TEST_CASE("rectangles of lines are 1.4 wide and as long as the line", "[oracle][3.4.5]") {
    // Along an axis: 0.7 pixel is 179.2 grid steps.
    const auto across = line_rectangle({65536, 131072}, {5 * 65536, 131072});
    CHECK(across == std::array<Point, 4>{Point{256, 333}, {1280, 333}, {1280, 691}, {256, 691}});
    const auto flat = line_rectangle({0, 0}, {0, 0});
    CHECK((flat[0] == flat[1] && flat[1] == flat[2] && flat[2] == flat[3]));
    for (std::uint64_t index = 0; index < 100000; ++index) {
        Random random(index);
        const bool on_grid = index % 2 == 0;
        const std::int64_t reach = index % 8 < 4 ? 20 : 30000;
        const auto coordinate = [&] {
            return on_grid ? random.between(-reach * 256, reach * 256) * 256 : random.between(-reach * 65536, reach * 65536);
        };
        const FinePoint a{coordinate(), coordinate()};
        const FinePoint b{coordinate(), coordinate()};
        if (a == b) continue;
        const auto corners = line_rectangle(a, b);
        const auto dx = static_cast<long double>(b.x - a.x);
        const auto dy = static_cast<long double>(b.y - a.y);
        const long double scale = 179.2L / std::hypot(dx, dy);
        const auto check = [&](const Point& corner, const FinePoint& p, long double sign) {
            const long double x = static_cast<long double>(p.x) / 256 + sign * dy * scale;
            const long double y = static_cast<long double>(p.y) / 256 - sign * dx * scale;
            REQUIRE(std::fabs(static_cast<long double>(corner.x) - x) <= 0.5L + 1e-9L);
            REQUIRE(std::fabs(static_cast<long double>(corner.y) - y) <= 0.5L + 1e-9L);
        };
        INFO("case " << index);
        check(corners[0], a, 1);
        check(corners[1], b, 1);
        check(corners[2], b, -1);
        check(corners[3], a, -1);
        if (!on_grid) continue;
        REQUIRE(corners[0].x - corners[3].x == corners[1].x - corners[2].x);
        REQUIRE(corners[0].y + corners[3].y == 2 * (a.y / 256));
        REQUIRE(corners[1].x + corners[2].x == 2 * (b.x / 256));
    }
}

TEST_CASE("the diagonal of a quadrilateral does not matter", "[oracle][3.4.5]") {
    for (std::uint64_t index = 0; index < 4000; ++index) {
        Random random(index);
        const auto coordinate = [&] { return random.between(0, 8 * 256) * 256; };
        const FinePoint a{coordinate(), coordinate()};
        const FinePoint b{coordinate(), coordinate()};
        const auto corners = line_rectangle(a, b);
        const auto turned = std::array<Point, 4>{corners[1], corners[2], corners[3], corners[0]};
        const SamplePattern pattern = standard_pattern(kSampleCounts[index % 5]);
        INFO("case " << index);
        REQUIRE(quadrilateral_coverage(corners, kRect, pattern) == quadrilateral_coverage(turned, kRect, pattern));
    }
}

TEST_CASE("points are squares of one pixel", "[oracle][3.4.6]") {
    for (std::int64_t y = 512; y <= 768; y += 3)
        for (std::int64_t x = 512; x <= 768; ++x) {
            const auto square = point_square({x, y});
            const auto pixels = covered_pixels(quadrilateral_coverage(square, kRect, standard_pattern(1)));
            // ceil(x) - 1 in pixels
            const auto cell = [](std::int64_t grid) { return static_cast<int>((grid + 255) >> 8) - 1; };
            REQUIRE(pixels == std::vector<CoveredPixel>{{cell(x), cell(y), 1}});
            REQUIRE(quadrilateral_coverage(square, kRect, standard_pattern(16)).samples() == 16);
        }
}
