// The interpolation oracle against itself: positions, homogeneous coordinates, its own bounds, depth bias by hand.
// D3D11.3 3.5.5, 15.5, 15.10, 16.5.3
#include "tests/oracle/interpolation.h"
#include "tests/oracle/triangles.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace oracle;

namespace {

constexpr TriangleTarget kTarget{.width = 16, .height = 16, .pattern = standard_pattern(16)};

struct Case {
    SnappedTriangle t;
    std::array<float, 3> v, w;
    Point p;
};

/// A triangle with area, values and w, and a point inside it or at most a few pixels away. Nothing if it came out without area.
bool make_case(std::uint64_t index, Case& c) {
    Random random(index);
    const TriangleKind kind = index % 3 == 0 ? TriangleKind::SubPixel : TriangleKind::Ordinary;
    c.t = random_triangle(random, kind, kTarget);
    for (std::size_t i = 0; i < 3; ++i) {
        c.v[i] = random.in(-4.0f, 4.0f);
        c.w[i] = std::ldexp(random.in(1.0f, 2.0f), random.integer(-3, 3));
    }
    const std::int64_t u = random.between(0, 256);
    const std::int64_t v = random.between(0, 256 - u);
    c.p = {c.t[0].x + ((c.t[1].x - c.t[0].x) * u + (c.t[2].x - c.t[0].x) * v) / 256,
           c.t[0].y + ((c.t[1].y - c.t[0].y) * u + (c.t[2].y - c.t[0].y) * v) / 256};
    return std::llabs(turn(c.t[0], c.t[1], c.t[2])) > 256;
}

}  // namespace

TEST_CASE("barycentrics give positions back", "[oracle][15.16.2]") {
    for (std::uint64_t index = 0; index < 20000; ++index) {
        Random random(index);
        const SnappedTriangle t = random_triangle(random, kTriangleKinds[index % kTriangleKinds.size()], kTarget);
        const Point p{random.between(-100, 4200), random.between(-100, 4200)};
        const Barycentric b = barycentric(t, p);
        INFO("case " << index);
        REQUIRE(b.weight[0] + b.weight[1] + b.weight[2] == b.area);
        __int128 x = 0;
        __int128 y = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            x += static_cast<__int128>(b.weight[i]) * t[i].x;
            y += static_cast<__int128>(b.weight[i]) * t[i].y;
        }
        REQUIRE((x == static_cast<__int128>(b.area) * p.x && y == static_cast<__int128>(b.area) * p.y));
    }
}

TEST_CASE("perspective values solve the homogeneous equations", "[oracle][15.5]") {
    std::uint64_t checked = 0;
    for (std::uint64_t index = 0; index < 20000; ++index) {
        Case c;
        if (!make_case(index, c)) continue;
        const Barycentric b = barycentric(c.t, c.p);
        // Rounding may have put the point outside, where 1 / w goes through 0.
        if (std::any_of(b.weight.begin(), b.weight.end(), [&](std::int64_t w) { return (w < 0) != (b.area < 0) && w != 0; }))
            continue;
        ++checked;
        INFO("case " << index);
        // w from its own interpolation and as an attribute.
        const long double w = perspective_w(b, c.w);
        REQUIRE(std::fabs(perspective(b, c.w, c.w) - w) <= 1e-15L * w);
        // Clip-space x = screen x times w is linear in the plane: interpolated, over w, it is the screen position.
        long double x = 0;
        long double inverse = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const long double weight = static_cast<long double>(b.weight[i]) / static_cast<long double>(c.w[i]);
            x += weight * static_cast<long double>(c.t[i].x) * static_cast<long double>(c.w[i]);
            inverse += weight;
        }
        REQUIRE(std::fabs(x / inverse / w - static_cast<long double>(c.p.x)) < 1e-9L);
        // Equal w: perspective is linear.
        const std::array<float, 3> flat{2, 2, 2};
        REQUIRE(std::fabs(perspective(b, c.v, flat) - linear(b, c.v)) < 1e-14L);
    }
    CHECK(checked > 10000);
}

TEST_CASE("fp32 planes stay within their bounds", "[oracle][15.16.2]") {
    long double closest = 0;
    for (std::uint64_t index = 0; index < 50000; ++index) {
        Case c;
        if (!make_case(index, c)) continue;
        const Barycentric b = barycentric(c.t, c.p);
        const Rounded bound = plane_bound(c.t, c.v, c.p);
        const Slopes s = slopes(c.t, {c.v[0], c.v[0] + (c.v[1] - c.v[0]), c.v[0] + (c.v[2] - c.v[0])});
        const float dx = static_cast<float>(c.p.x - c.t[0].x) / 256.0f;
        const float dy = static_cast<float>(c.p.y - c.t[0].y) / 256.0f;
        const float value = c.v[0] + (dx * static_cast<float>(s.dx) + dy * static_cast<float>(s.dy));
        INFO("case " << index);
        REQUIRE(std::fabs(bound.value - linear(b, c.v)) <= 1e-12L * (1 + bound.error * 0x1p24L));
        REQUIRE(bound.allows(value));
        closest = std::max(closest, std::fabs(static_cast<long double>(value) - bound.value) / bound.error);
    }
    CHECK(closest > 0.1L);
}

TEST_CASE("fp32 perspective stays within its bounds", "[oracle][15.5]") {
    long double closest = 0;
    for (std::uint64_t index = 0; index < 50000; ++index) {
        Case c;
        if (!make_case(index, c)) continue;
        const Barycentric b = barycentric(c.t, c.p);
        const Rounded bound = perspective_bound(c.t, c.v, c.w, c.p);
        const Slopes s1 = slopes(c.t, {0, 1, 0});
        const Slopes s2 = slopes(c.t, {0, 0, 1});
        const float dx = static_cast<float>(c.p.x - c.t[0].x) / 256.0f;
        const float dy = static_cast<float>(c.p.y - c.t[0].y) / 256.0f;
        const float l1 = dx * static_cast<float>(s1.dx) + dy * static_cast<float>(s1.dy);
        const float l2 = dx * static_cast<float>(s2.dx) + dy * static_cast<float>(s2.dy);
        const std::array<float, 3> inverse{1.0f / c.w[0], 1.0f / c.w[1], 1.0f / c.w[2]};
        const float w = 1.0f / (inverse[0] + (l1 * (inverse[1] - inverse[0]) + l2 * (inverse[2] - inverse[0])));
        const float b1 = l1 * inverse[1] * w;
        const float b2 = l2 * inverse[2] * w;
        const float value = c.v[0] + (b1 * (c.v[1] - c.v[0]) + b2 * (c.v[2] - c.v[0]));
        INFO("case " << index);
        REQUIRE(std::fabs(bound.value - perspective(b, c.v, c.w)) < 1e-9L);
        REQUIRE(bound.allows(value));
        closest = std::max(closest, std::fabs(static_cast<long double>(value) - bound.value) / bound.error);
    }
    CHECK(closest > 0.05L);
}

TEST_CASE("points project onto lines", "[oracle]") {
    CHECK(line_parameter({0, 0}, {1024, 0}, {256, 77}) == 0.25L);
    CHECK(line_parameter({1024, 0}, {0, 0}, {256, 77}) == 0.75L);
    CHECK(line_parameter({0, 0}, {512, 512}, {0, 512}) == 0.5L);
    CHECK(line_parameter({0, 0}, {256, 0}, {-256, 0}) == -1);
}

TEST_CASE("centroid is the centre, the first covered sample, or the first of a partial mask", "[oracle][3.5.5]") {
    const SamplePattern pattern = standard_pattern(4);
    const Point center = pixel_center(2, 3);
    const auto at = [&](std::uint32_t covered, std::uint32_t mask) { return centroid_point(2, 3, covered, mask, pattern); };
    CHECK(at(0xf, ~0u) == center);
    CHECK(at(0xf, 0x4) == center);
    CHECK(at(0xe, ~0u) == pattern.at(2, 3, 1));
    CHECK(at(0xe, 0xc) == pattern.at(2, 3, 2));
    CHECK(at(0x1, ~0u) == pattern.at(2, 3, 0));
    CHECK(at(0, ~0u) == center);
    CHECK(at(0, 0xf) == center);
    CHECK(at(0, 0xa) == pattern.at(2, 3, 1));
    CHECK(at(0x1, 0xa) == pattern.at(2, 3, 1));
    CHECK(at(0x1, 0) == center);
    CHECK(snapped_offset_point(2, 3, -8, 7) == Point{512, 768 + 240});
    CHECK(snapped_offset_point(2, 3, 8, 16) == Point{512, 768 + 128});
}

TEST_CASE("depth bias as the formulas have it", "[oracle][15.10]") {
    // z rises by 1/2 over 8 pixels in x and falls by 1/4 over 2 pixels in y.
    const SnappedTriangle t{Point{0, 0}, {8 * 256, 0}, {0, 2 * 256}};
    const std::array<float, 3> z{0.25f, 0.75f, 0.0f};
    CHECK(slopes(t, z).dx == 0.0625L);
    CHECK(slopes(t, z).dy == -0.125L);
    CHECK(max_depth_slope(t, z) == 0.125L);
    CHECK(bias_value({.constant = 3}, DepthKind::Unorm16, 0, 0) == 3 * static_cast<long double>(1.0f / 65535.0f));
    CHECK(bias_value({.constant = -2}, DepthKind::Unorm24, 0, 0) == -2 * static_cast<long double>(1.0f / 16777215.0f));
    CHECK(bias_value({.constant = 1}, DepthKind::Float32, 0, 0.75f) == 0x1p-24L);
    CHECK(bias_value({.constant = 5}, DepthKind::Float32, 0, 1.0f) == 5 * 0x1p-23L);
    CHECK(bias_value({.constant = 5}, DepthKind::Float32, 0, 0.0f) == 0);
    CHECK(bias_value({.slope_scaled = 2}, DepthKind::Unorm16, 0.125L, 0) == 0.25L);
    CHECK(bias_value({.slope_scaled = 2, .clamp = 0.125f}, DepthKind::Unorm16, 0.125L, 0) == 0.125L);
    CHECK(bias_value({.slope_scaled = -2, .clamp = 0.125f}, DepthKind::Unorm16, 0.125L, 0) == -0.25L);
    CHECK(bias_value({.slope_scaled = -2, .clamp = -0.125f}, DepthKind::Unorm16, 0.125L, 0) == -0.125L);
    // An edge-on primitive has an infinite slope; without a slope factor it does not matter.
    CHECK(bias_value({.constant = 1}, DepthKind::Float32, INFINITY, 0.5f) == 0x1p-24L);
}
