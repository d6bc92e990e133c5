// The coverage oracle against itself: its two formulations, the specification's sentences, cases worked by hand.
// D3D11.3 3.4.2.1, 15.7, 15.11.1, 19.2.4
#include "tests/oracle/coverage.h"
#include "tests/oracle/triangles.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <set>

using namespace oracle;

namespace {

std::string describe(const SnappedTriangle& t) {
    return fmt::format("({}, {}) ({}, {}) ({}, {}) / 256", t[0].x, t[0].y, t[1].x, t[1].y, t[2].x, t[2].y);
}

/// Both formulations over a rectangle. Returns the samples covered.
std::uint64_t check_both(const SnappedTriangle& t, const PixelRect& rect, const SamplePattern& pattern, std::uint64_t index) {
    const Masks spans = coverage(t, rect, pattern);
    for (int y = rect.top; y < rect.bottom; ++y)
        for (int x = rect.left; x < rect.right; ++x) {
            const std::uint32_t expected = mask_by_definition(t, x, y, pattern);
            if (spans.at(x, y) != expected)
                FAIL(fmt::format("case {}, {} samples, pixel ({}, {}): spans {:#x}, definition {:#x}\n{}", index, pattern.count,
                                 x, y, spans.at(x, y), expected, describe(t)));
        }
    return spans.samples();
}

}  // namespace

TEST_CASE("standard sample patterns share no row and no column", "[oracle][19.2.4]") {
    for (const int count : kSampleCounts) {
        const SamplePattern pattern = standard_pattern(count);
        REQUIRE(pattern.count == count);
        std::set<int> columns;
        std::set<int> rows;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            const auto [x, y] = pattern.positions[i];
            CHECK((x >= 0 && x < 16 && y >= 0 && y < 16));
            columns.insert(x);
            rows.insert(y);
        }
        CHECK(columns.size() == static_cast<std::size_t>(count));
        CHECK(rows.size() == static_cast<std::size_t>(count));
    }
    CHECK(standard_pattern(4).at(2, 3, 1) == Point{2 * 256 + 224, 3 * 256 + 96});
    CHECK(center_pattern(8).at(0, 0, 7) == Point{128, 128});
}

TEST_CASE("the oracle's spans are the definition, random triangles", "[oracle][3.4.2]") {
    for (const int count : kSampleCounts) {
        const TriangleTarget target{.width = 9, .height = 7, .pattern = standard_pattern(count)};
        std::array<std::uint64_t, kTriangleKinds.size()> covered{};
        for (std::uint64_t index = 0; index < 8000; ++index) {
            const TriangleCase c = triangle_case(index, target);
            covered[static_cast<std::size_t>(c.kind)] += check_both(c.triangle, target.rect(), target.pattern, index);
        }
        for (const TriangleKind kind : kTriangleKinds) {
            INFO(name_of(kind) << ", " << count << " samples");
            CHECK((covered[static_cast<std::size_t>(kind)] != 0) == (kind != TriangleKind::ZeroArea));
        }
    }
}

TEST_CASE("the oracle's spans are the definition, complete sets", "[oracle][3.4.2]") {
    for (const CompleteSet& set : complete_sets()) {
        std::uint64_t covered = 0;
        // A stride that is coprime to the size visits other rows and columns each time round.
        for (std::uint64_t i = 0; i < set.size; i += 499)
            covered += check_both(set.triangle(i), {0, 0, 4, 4}, standard_pattern(16), i);
        INFO(set.name);
        CHECK(covered > 0);
    }
    CHECK(complete_sets()[0].size == 1585176);
    CHECK(complete_sets()[1].size == 1002252);
    CHECK(complete_sets()[2].size == 531441);
}

TEST_CASE("neighbours share no sample and lose none on their edge", "[oracle][3.4.2]") {
    std::uint64_t on_edge = 0;
    for (const int count : kSampleCounts) {
        const TriangleTarget target{.width = 8, .height = 8, .pattern = standard_pattern(count)};
        for (std::uint64_t index = 0; index < 8000; ++index) {
            Random random(index);
            const TriangleKind kind = kTriangleKinds[index % (kTriangleKinds.size() - 1)];
            const auto [one, other] = random_neighbours(random, kind, target);
            const Masks first = coverage(one, target.rect(), target.pattern);
            const Masks second = coverage(other, target.rect(), target.pattern);
            const Point& p = one[0];
            const Point& q = one[1];
            for (int y = 0; y < target.height; ++y)
                for (int x = 0; x < target.width; ++x) {
                    INFO("case " << index << ", " << count << " samples, pixel (" << x << ", " << y << ")");
                    if ((first.at(x, y) & second.at(x, y)) != 0) FAIL(describe(one) << " and " << describe(other));
                    for (int i = 0; i < count; ++i) {
                        // Strictly inside the shared edge exactly one of them has the sample.
                        const Point s = target.pattern.at(x, y, i);
                        const std::int64_t along = (s.x - p.x) * (q.x - p.x) + (s.y - p.y) * (q.y - p.y);
                        const std::int64_t length2 = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
                        if (turn(p, q, s) != 0 || along <= 0 || along >= length2) continue;
                        ++on_edge;
                        if (((first.at(x, y) ^ second.at(x, y)) >> i & 1u) == 0)
                            FAIL(describe(one) << " and " << describe(other));
                    }
                }
        }
    }
    CHECK(on_edge > 1000);
}

TEST_CASE("top and left edges belong to the triangle, others do not", "[oracle][3.4.2.1]") {
    const SamplePattern center = standard_pattern(1);
    const PixelRect rect{0, 0, 4, 4};
    const auto pixels = [&](const SnappedTriangle& t) { return covered_pixels(coverage(t, rect, center)); };
    // A right angle at the centre of pixel (1, 1), legs through centres: top and left edges are in, the slanted one is out.
    CHECK(pixels({Point{384, 384}, {384 + 512, 384}, {384, 384 + 512}}) ==
          std::vector<CoveredPixel>{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}});
    // Turned by half: the slanted edge is on the left and in, right and bottom edges are out.
    CHECK(pixels({Point{896, 896}, {384, 896}, {896, 384}}) == std::vector<CoveredPixel>{{2, 2, 1}});
    // A corner that is top and left at once is in; a corner where a left edge meets a right edge is not.
    CHECK(pixels({Point{384, 384}, {640, 384}, {400, 640}}).front() == CoveredPixel{1, 1, 1});
    CHECK(pixels({Point{384, 384}, {520, 520}, {270, 520}}).empty());
}

TEST_CASE("facing follows the snapped winding, no area faces back", "[oracle][15.11]") {
    const SnappedTriangle clockwise{Point{0, 0}, {256, 0}, {0, 256}};
    const SnappedTriangle counter{Point{0, 0}, {0, 256}, {256, 0}};
    const SnappedTriangle flat{Point{0, 0}, {256, 256}, {512, 512}};
    CHECK(facing(clockwise) == Facing::Front);
    CHECK(facing(counter) == Facing::Back);
    CHECK(facing(clockwise, true) == Facing::Back);
    CHECK(facing(counter, true) == Facing::Front);
    CHECK(facing(flat) == Facing::Back);
    CHECK(facing(flat, true) == Facing::Back);
}

TEST_CASE("the implied scissor floors every edge", "[oracle][15.7]") {
    CHECK(implicit_scissor(0, 0, 16, 8) == PixelRect{0, 0, 16, 8});
    CHECK(implicit_scissor(0.75f, -0.25f, 4.5f, 2.0f) == PixelRect{0, -1, 5, 1});
    CHECK(implicit_scissor(-0.5f, 1.5f, 1.0f, 1.5f) == PixelRect{-1, 1, 0, 3});
    CHECK(intersection({0, 0, 4, 4}, {2, -1, 9, 3}) == PixelRect{2, 0, 4, 3});
    CHECK(intersection({0, 0, 2, 2}, {2, 0, 4, 2}).empty());
}

TEST_CASE("positions come back from clip space", "[oracle][15.6]") {
    Random random(7);
    for (int i = 0; i < 100000; ++i) {
        const int size = 1 << random.integer(0, 10);
        const std::int64_t grid = random.between(-(1 << 23) + 128 * size, (1 << 23) - 128 * size);
        REQUIRE(snap(ndc_of(grid, 0, size), 0, size, 8) == grid);
        const Point wanted{grid, random.between(-9999, 9999)};
        const PlacedVertex placed = place(random, wanted, {0, 0, size, 16});
        REQUIRE(placed.snapped == wanted);
        REQUIRE(placed.clip[2] == 0.5f * placed.clip[3]);
    }
}
