// The clipping oracle against a second formulation that does make clipped vertices, and against the coverage oracle where
// nothing is clipped. D3D11.3 15.4
#include "tests/oracle/clipping.h"
#include "tests/oracle/meshes.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace oracle;

namespace {

using Where = ClippedTriangle::Where;
using Real = long double;

constexpr PixelRect kViewport{3, -2, 19, 10};

struct Vertex {
    Real x, y, z, w;
};

/// Sutherland and Hodgman's algorithm, one plane: keeps distance >= 0.
template <class Distance>
std::vector<Vertex> cut(const std::vector<Vertex>& polygon, Distance distance) {
    std::vector<Vertex> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vertex& a = polygon[i];
        const Vertex& b = polygon[(i + 1) % polygon.size()];
        const Real da = distance(a);
        const Real db = distance(b);
        if (da >= 0) kept.push_back(a);
        if ((da < 0) != (db < 0)) {
            const Real t = da / (da - db);
            kept.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z), a.w + t * (b.w - a.w)});
        }
    }
    return kept;
}

struct Clipped {
    std::vector<std::pair<Real, Real>> corners;  // grid steps

    Clipped(const std::array<ClipVertex, 3>& t, DepthClip depth_clip) {
        std::vector<Vertex> polygon;
        for (const ClipVertex& v : t)
            polygon.push_back({static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z), static_cast<Real>(v.w)});
        // So near the eye that what is lost is beyond any viewport; not on the eye, where nothing can be divided.
        polygon = cut(polygon, [](const Vertex& v) { return v.w - 1e-6L; });
        if (depth_clip == DepthClip::On) {
            polygon = cut(polygon, [](const Vertex& v) { return v.z; });
            polygon = cut(polygon, [](const Vertex& v) { return v.w - v.z; });
        }
        for (const Vertex& v : polygon)
            corners.emplace_back((v.x / v.w + 1) * (kViewport.right - kViewport.left) * 128 + kViewport.left * 256,
                                 (1 - v.y / v.w) * (kViewport.bottom - kViewport.top) * 128 + kViewport.top * 256);
    }

    /// Distance to the nearest side's line, positive on the inner side of all; and the signed area.
    [[nodiscard]] std::pair<Real, Real> distance(const Point& s) const {
        Real area = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto& [ax, ay] = corners[i];
            const auto& [bx, by] = corners[(i + 1) % corners.size()];
            area += ax * by - ay * bx;
        }
        Real nearest = 1e30L;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto& [ax, ay] = corners[i];
            const auto& [bx, by] = corners[(i + 1) % corners.size()];
            const Real length = std::hypot(bx - ax, by - ay);
            if (length < 1e-9L) continue;
            const Real d = ((bx - ax) * (static_cast<Real>(s.y) - ay) - (by - ay) * (static_cast<Real>(s.x) - ax)) / length;
            nearest = std::min(nearest, area > 0 ? d : -d);
        }
        return {nearest, area};
    }
};

std::string describe(const std::array<ClipVertex, 3>& t) {
    std::string text;
    for (const ClipVertex& v : t) text += fmt::format("  ({}, {}, {}, {}) / 4096\n", v.x, v.y, v.z, v.w);
    return text;
}

}  // namespace

TEST_CASE("signs of homogeneous functions say what clipping leaves", "[oracle][15.4]") {
    std::array<std::uint64_t, 3> counts{};
    std::uint64_t facings = 0;
    for (std::uint64_t index = 0; index < 20000; ++index) {
        Random random(index);
        const ClipKind kind = kClipKinds[index % kClipKinds.size()];
        const DepthClip depth_clip = index / 5 % 2 == 0 ? DepthClip::On : DepthClip::Off;
        const auto t = random_clip_triangle(random, kind);
        const ClippedTriangle exact(t, kViewport, depth_clip);
        if (exact.edge_on()) continue;
        const Clipped clipped(t, depth_clip);
        for (int i = 0; i < 40; ++i) {
            const Point s{random.between(kViewport.left * 256, kViewport.right * 256),
                          random.between(kViewport.top * 256, kViewport.bottom * 256)};
            const Where where = exact.at(s, 1);
            ++counts[static_cast<std::size_t>(where)];
            if (clipped.corners.size() < 3) {
                if (where == Where::Inside) FAIL("case " << index << ": inside of nothing\n" << describe(t));
                continue;
            }
            const auto [distance, area] = clipped.distance(s);
            // A border moves by one step per axis: by 1 to sqrt(2) steps.
            const bool wrong = (where == Where::Inside && distance < 0.99L) || (where == Where::Outside && distance > -0.99L);
            if (wrong && std::fabs(area) > 1e-3L && std::fabs(area) < 1e24L)
                FAIL("case " << index << ", (" << s.x << ", " << s.y << "): " << (where == Where::Inside ? "inside" : "outside")
                             << ", distance " << static_cast<double>(distance) << ", area " << static_cast<double>(area) << '\n'
                             << describe(t));
            if (where == Where::Inside && std::fabs(area) > 1) {
                ++facings;
                REQUIRE((exact.facing() == Facing::Front) == (area > 0));
            }
        }
    }
    CHECK(counts[static_cast<std::size_t>(Where::Inside)] > 20000);
    CHECK(counts[static_cast<std::size_t>(Where::Outside)] > 20000);
    CHECK(counts[static_cast<std::size_t>(Where::Close)] > 100);
    CHECK(facings > 20000);
}

TEST_CASE("where nothing is clipped or rounded the clipping oracle is the coverage oracle", "[oracle][15.4]") {
    // Positions on the grid of a 16 x 16 viewport with w a power of two: x = (2 grid / 4096 - 1) w.
    const PixelRect viewport{0, 0, 16, 16};
    std::uint64_t inside = 0;
    std::uint64_t border = 0;
    for (std::uint64_t index = 0; index < 20000; ++index) {
        Random random(index);
        const TriangleTarget target{.width = 16, .height = 16, .pattern = standard_pattern(16)};
        const TriangleKind kind = index % 2 == 0 ? TriangleKind::Ordinary : TriangleKind::OnSamples;
        const SnappedTriangle snapped = random_triangle(random, kind, target);
        std::array<ClipVertex, 3> t{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int64_t w = std::int64_t{2048} << random.integer(0, 3);
            t[i] = {(snapped[i].x - 2048) * (w / 2048), (2048 - snapped[i].y) * (w / 2048), w / 2, w};
        }
        const ClippedTriangle exact(t, viewport);
        REQUIRE(exact.edge_on() == (turn(snapped[0], snapped[1], snapped[2]) == 0));
        if (exact.edge_on()) continue;
        REQUIRE(exact.facing() == facing(snapped));
        for (int i = 0; i < 20; ++i) {
            const int x = random.integer(0, 15);
            const int y = random.integer(0, 15);
            const Point s = target.pattern.at(x, y, random.integer(0, 15));
            const Where where = exact.at(s, 0);
            inside += where == Where::Inside;
            border += where == Where::Close;
            if (where == Where::Close) continue;
            INFO("case " << index);
            REQUIRE((where == Where::Inside) == covers(snapped, s));
        }
    }
    CHECK(inside > 20000);
    CHECK(border > 100);
}

TEST_CASE("depth planes cut where z is 0 and w", "[oracle][15.4]") {
    // A quarter plane whose z runs from -1 at the left to 3 at the right of the viewport: visible from a quarter to a half.
    const PixelRect viewport{0, 0, 16, 16};
    const std::array<ClipVertex, 3> t{ClipVertex{-1, 1, -1, 1}, {3, 1, 7, 1}, {-1, -3, -1, 1}};
    const ClippedTriangle on(t, viewport);
    const ClippedTriangle off(t, viewport, DepthClip::Off);
    for (int x = 0; x < 16; ++x) {
        const Point s{x * 256 + 128, 3 * 256 + 128};
        CHECK((on.at(s) == Where::Inside) == (x >= 4 && x < 8));
        CHECK(off.at(s) == Where::Inside);
    }
    CHECK(on.at({4 * 256, 900}, 0) == Where::Close);
    CHECK(on.at({8 * 256 + 2, 900}, 2) == Where::Close);
    CHECK(on.at({8 * 256 + 3, 900}, 2) == Where::Outside);
}

TEST_CASE("clip units are fp32 numbers", "[oracle]") {
    for (const std::int64_t v : {0, 1, -1, 4096, (1 << 22) - 1, -(1 << 22)}) CHECK(clip_integer(clip_float(v)) == v);
    CHECK_FALSE(clip_integer(0x1p-13f).has_value());
    CHECK_FALSE(clip_integer(2048.0f).has_value());
    CHECK_FALSE(clip_integer(NAN).has_value());
}
