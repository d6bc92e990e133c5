// Random and complete sets of snapped triangles.
#include "tests/oracle/triangles.h"

#include <algorithm>
#include <cmath>

namespace oracle {

namespace {

std::int64_t limited(std::int64_t v) { return std::clamp(v, -kFarthest, kFarthest); }

/// A grid position up to `margin` outside the target.
Point anywhere(Random& random, const TriangleTarget& target, std::int64_t margin) {
    const std::int64_t x = random.between(-margin, std::int64_t{target.width} * 256 + margin);
    const std::int64_t y = random.between(-margin, std::int64_t{target.height} * 256 + margin);
    return {x, y};
}

/// A sample of the target or just outside it.
Point any_sample(Random& random, const TriangleTarget& target) {
    const int x = random.integer(-1, target.width);
    const int y = random.integer(-1, target.height);
    return target.pattern.at(x, y, random.integer(0, target.pattern.count - 1));
}

/// A corner of a pixel, the middle of one of its sides or a sample.
Point special_point(Random& random, const TriangleTarget& target) {
    if (!random.chance(3)) return any_sample(random, target);
    const std::int64_t x = random.between(-2, 2 * target.width + 2) * 128;
    const std::int64_t y = random.between(-2, 2 * target.height + 2) * 128;
    return {x, y};
}

Point near(Random& random, const Point& p, std::int64_t reach) {
    const std::int64_t x = random.between(-reach, reach);
    const std::int64_t y = random.between(-reach, reach);
    return {limited(p.x + x), limited(p.y + y)};
}

Point far_away(Random& random) {
    const std::int64_t x = random.between(-kFarthest, kFarthest);
    const std::int64_t y = random.between(-kFarthest, kFarthest);
    return {x, y};
}

Point far_or_near(Random& random, const TriangleTarget& target) {
    const int where = random.integer(0, 3);
    if (where == 0) return anywhere(random, target, 512);
    Point p = far_away(random);
    // Corners and sides of the whole range.
    if (where == 1) p.x = random.chance(2) ? -kFarthest : kFarthest;
    if (where == 1 && random.chance(2)) p.y = random.chance(2) ? -kFarthest : kFarthest;
    return p;
}

SnappedTriangle sliver(Random& random, const TriangleTarget& target) {
    const Point p = random.chance(4) ? far_away(random) : anywhere(random, target, 4096);
    const Point q = anywhere(random, target, random.chance(2) ? 256 : 8192);
    const std::int64_t t = random.between(-1024, 2048);
    const Point on_line{p.x + (q.x - p.x) * t / 1024, p.y + (q.y - p.y) * t / 1024};
    return {p, q, near(random, on_line, 2)};
}

/// Both ends of an edge are the same whole vector, times whole numbers, away from a sample.
SnappedTriangle edge_through(Random& random, const TriangleTarget& target) {
    const Point sample = any_sample(random, target);
    const std::int64_t dx = random.between(-300, 300);
    const std::int64_t dy = random.between(-300, 300);
    const std::int64_t before = random.between(0, 6);
    const std::int64_t after = random.between(before == 0 ? 1 : 0, 6);
    return {Point{sample.x - before * dx, sample.y - before * dy}, Point{sample.x + after * dx, sample.y + after * dy},
            anywhere(random, target, 768)};
}

SnappedTriangle axis_aligned(Random& random, const TriangleTarget& target) {
    const bool on_samples = random.chance(2);
    const Point p = on_samples ? any_sample(random, target) : special_point(random, target);
    const Point q = on_samples ? any_sample(random, target) : special_point(random, target);
    return {p, Point{q.x, p.y}, random.chance(2) ? Point{p.x, q.y} : q};
}

SnappedTriangle without_area(Random& random, const TriangleTarget& target) {
    const Point p = special_point(random, target);
    const Point step{random.between(-300, 300), random.between(-300, 300)};
    const std::int64_t m = random.between(-8, 8);
    const std::int64_t n = random.between(-8, 8);
    return {p, Point{p.x + m * step.x, p.y + m * step.y}, Point{p.x + n * step.x, p.y + n * step.y}};
}

SnappedTriangle of_kind(Random& random, TriangleKind kind, const TriangleTarget& target) {
    const auto three = [](auto&& make) {
        const Point a = make();
        const Point b = make();
        const Point c = make();
        return SnappedTriangle{a, b, c};
    };
    switch (kind) {
        case TriangleKind::Ordinary: return three([&] { return anywhere(random, target, 512); });
        case TriangleKind::SubPixel: {
            const Point middle = anywhere(random, target, 128);
            const std::int64_t reach = random.chance(2) ? 300 : 40;
            return three([&] { return near(random, middle, reach); });
        }
        case TriangleKind::Sliver: return sliver(random, target);
        case TriangleKind::Huge: return three([&] { return far_or_near(random, target); });
        case TriangleKind::OnSamples: return three([&] { return special_point(random, target); });
        case TriangleKind::EdgeThrough: return edge_through(random, target);
        case TriangleKind::AxisAligned: return axis_aligned(random, target);
        case TriangleKind::ZeroArea: return without_area(random, target);
    }
    return {};
}

// --- Complete sets --------------------------------------------------------------------------------------------------------

constexpr std::array<std::array<Point, 2>, 24> kFixedEdges{{
    // Around the cell, far and near, in general position.
    {{{0, 0}, {1024, 3}}},
    {{{1000, 17}, {37, 1001}}},
    {{{-3000, 511}, {5000, 640}}},
    {{{390, -2000}, {300, 4000}}},
    {{{100, 900}, {900, 950}}},
    {{{700, 100}, {650, 1000}}},
    // Axis aligned through the centre, through samples, along the cell's sides.
    {{{0, 384}, {1024, 384}}},
    {{{384, 0}, {384, 1024}}},
    {{{0, 352}, {1024, 352}}},
    {{{352, 0}, {352, 1024}}},
    {{{0, 256}, {1024, 256}}},
    {{{256, 0}, {256, 1024}}},
    {{{0, 512}, {1024, 512}}},
    {{{512, 0}, {512, 1024}}},
    // Diagonals through the centre and through corners of the cell.
    {{{0, 0}, {1024, 1024}}},
    {{{1024, -256}, {-256, 1024}}},
    {{{128, 256}, {640, 512}}},
    {{{0, 512}, {512, 0}}},
    // Short edges beside and inside the cell.
    {{{384, 384}, {385, 384}}},
    {{{383, 384}, {384, 385}}},
    {{{255, 300}, {255, 310}}},
    {{{513, 400}, {520, 403}}},
    // As long as 16.8 allows.
    {{{-kFarthest, -kFarthest}, {kFarthest, kFarthest}}},
    {{{-kFarthest, kFarthest}, {kFarthest, -kFarthest + 512}}},
}};

constexpr std::array<Point, 12> kFixedCorners{{{384, 384},
                                               {256, 256},
                                               {512, 256},
                                               {352, 288},
                                               {0, 0},
                                               {1024, 384},
                                               {384, 1024},
                                               {1000, 900},
                                               {385, 383},
                                               {-kFarthest, 384},
                                               {300, kFarthest},
                                               {kFarthest, -kFarthest}}};

/// Point `index` of a grid of (n + 1)^2 over the cell.
Point cell_point(std::uint64_t index, std::uint64_t n) {
    const auto x = static_cast<std::int64_t>(index % (n + 1) * (256 / n));
    const auto y = static_cast<std::int64_t>(index / (n + 1) * (256 / n));
    return {256 + x, 256 + y};
}

constexpr std::uint64_t grid_size(std::uint64_t n) { return (n + 1) * (n + 1); }

SnappedTriangle one_corner_swept(std::uint64_t index) {
    const auto& edge = kFixedEdges[index / grid_size(256)];
    return {edge[0], edge[1], cell_point(index % grid_size(256), 256)};
}

SnappedTriangle two_corners_swept(std::uint64_t index) {
    constexpr std::uint64_t n = grid_size(16);
    return {kFixedCorners[index / (n * n)], cell_point(index / n % n, 16), cell_point(index % n, 16)};
}

SnappedTriangle three_corners_swept(std::uint64_t index) {
    constexpr std::uint64_t n = grid_size(8);
    return {cell_point(index / (n * n), 8), cell_point(index / n % n, 8), cell_point(index % n, 8)};
}

}  // namespace

std::string_view name_of(TriangleKind kind) {
    switch (kind) {
        case TriangleKind::Ordinary: return "ordinary";
        case TriangleKind::SubPixel: return "sub-pixel";
        case TriangleKind::Sliver: return "sliver";
        case TriangleKind::Huge: return "huge";
        case TriangleKind::OnSamples: return "on samples";
        case TriangleKind::EdgeThrough: return "edge through a sample";
        case TriangleKind::AxisAligned: return "axis aligned";
        case TriangleKind::ZeroArea: return "zero area";
    }
    return "";
}

SnappedTriangle random_triangle(Random& random, TriangleKind kind, const TriangleTarget& target) {
    SnappedTriangle t = of_kind(random, kind, target);
    std::rotate(t.begin(), t.begin() + random.integer(0, 2), t.end());
    if (random.chance(2)) std::swap(t[1], t[2]);
    return t;
}

TriangleCase triangle_case(std::uint64_t index, const TriangleTarget& target) {
    Random random(index);
    const TriangleKind kind = kTriangleKinds[index % kTriangleKinds.size()];
    return {kind, random_triangle(random, kind, target)};
}

std::array<SnappedTriangle, 2> random_neighbours(Random& random, TriangleKind kind, const TriangleTarget& target) {
    while (true) {
        const SnappedTriangle one = random_triangle(random, kind, target);
        const SnappedTriangle other =
            random_triangle(random, kind == TriangleKind::ZeroArea ? TriangleKind::Sliver : kind, target);
        for (const Point& far : other) {
            const std::int64_t side = turn(one[0], one[1], one[2]);
            const std::int64_t opposite = turn(one[0], one[1], far);
            if (kind == TriangleKind::ZeroArea || (side > 0 && opposite < 0) || (side < 0 && opposite > 0))
                return {one, SnappedTriangle{one[1], one[0], far}};
        }
    }
}

const std::array<CompleteSet, 3>& complete_sets() {
    static constexpr std::array<CompleteSet, 3> sets{
        CompleteSet{"one corner swept", grid_size(256) * kFixedEdges.size(), one_corner_swept},
        CompleteSet{"two corners swept", grid_size(16) * grid_size(16) * kFixedCorners.size(), two_corners_swept},
        CompleteSet{"three corners swept", grid_size(8) * grid_size(8) * grid_size(8), three_corners_swept}};
    return sets;
}

float ndc_of(std::int64_t grid, int origin, int size) {
    return static_cast<float>((static_cast<double>(grid) / 256.0 - origin) * 2.0 / size - 1.0);
}

PlacedVertex place(Random& random, const Point& wanted, const PixelRect& viewport, int subpixel_bits) {
    const int width = viewport.right - viewport.left;
    const int height = viewport.bottom - viewport.top;
    const float w = random.chance(3) ? std::ldexp(1.0f, random.integer(-3, 3)) : 1.0f;
    const float x = ndc_of(wanted.x, viewport.left, width);
    const float y = ndc_of(wanted.y, viewport.top, height);
    return {{x * w, -y * w, 0.5f * w, w},
            {snap(x, viewport.left, width, subpixel_bits), snap(y, viewport.top, height, subpixel_bits)}};
}

std::array<Point, 2> random_line(Random& random, const TriangleTarget& target) {
    // Multiples of a quarter pixel: corners and middles of the edges of diamonds, corners and centres of pixels.
    const auto special = [&] {
        const std::int64_t x = random.between(-4, 4 * target.width + 4) * 64;
        const std::int64_t y = random.between(-4, 4 * target.height + 4) * 64;
        return Point{x, y};
    };
    const Point a = random.chance(2) ? special() : anywhere(random, target, 512);
    const std::int64_t length = random.chance(2) ? random.between(-300, 300) : random.between(-40, 40) * 64;
    switch (random.integer(0, 7)) {
        case 0: return {a, special()};
        case 1: return {a, anywhere(random, target, 512)};
        case 2: return {a, near(random, a, 300)};
        case 3: return {a, far_away(random)};
        case 4: return {far_away(random), a};
        case 5: return {a, random.chance(2) ? Point{a.x + length, a.y} : Point{a.x, a.y + length}};
        case 6: return {a, Point{a.x + length, random.chance(2) ? a.y + length : a.y - length}};
        default: return {a, random.chance(4) ? a : near(random, special(), 1)};
    }
}

}  // namespace oracle
