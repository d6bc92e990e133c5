// Meshes of the watertightness tests have the properties their tests rely on. D3D11.3 3.4.2.1, 15.4
#include "tests/oracle/meshes.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace oracle;

namespace {

constexpr int kSize = 16;
constexpr PixelRect kRect{0, 0, kSize, kSize};

std::vector<Point> snapped(const ClipMesh& mesh) {
    std::vector<Point> points;
    for (const ClipVertex& v : mesh.vertices) {
        const float w = clip_float(v.w);
        points.push_back({snap(clip_float(v.x) / w, 0, kSize, 8), snap(-clip_float(v.y) / w, 0, kSize, 8)});
    }
    return points;
}

template <class Visit>
void for_each_sample(const SamplePattern& pattern, Visit visit) {
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            for (int i = 0; i < pattern.count; ++i) visit(x, y, i);
}

}  // namespace

TEST_CASE("a subdivision covers every sample of its rectangle once", "[oracle][3.4.2]") {
    std::size_t triangles = 0;
    for (std::uint64_t index = 0; index < 300; ++index) {
        Random random(index);
        const SamplePattern pattern = standard_pattern(kSampleCounts[index % 5]);
        const Point top_left{random.between(-600, 1500), random.between(-600, 1500)};
        const Point bottom_right{top_left.x + random.between(300, 4000), top_left.y + random.between(300, 4000)};
        const SnappedMesh mesh = random_subdivision(random, top_left, bottom_right, 120, pattern);
        triangles += mesh.triangles.size();
        SampleCounts counts(kRect, pattern);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            REQUIRE(facing(mesh.triangle(i)) == Facing::Front);
            counts.add(mesh.triangle(i));
        }
        for_each_sample(pattern, [&](int x, int y, int i) {
            const Point s = pattern.at(x, y, i);
            const bool inside = s.x >= top_left.x && s.x < bottom_right.x && s.y >= top_left.y && s.y < bottom_right.y;
            INFO("case " << index << ", pixel (" << x << ", " << y << "), sample " << i);
            REQUIRE(counts.front(x, y, i) == inside);
            REQUIRE(counts.back(x, y, i) == 0);
        });
    }
    CHECK(triangles > 300 * 50);
}

TEST_CASE("solids are closed and face outwards", "[oracle]") {
    const auto volume = [](const Solid& solid) {
        std::int64_t six = 0;
        for (const auto& [i, j, k] : solid.triangles) {
            const auto& a = solid.vertices[i];
            const auto& b = solid.vertices[j];
            const auto& c = solid.vertices[k];
            six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
        }
        return six;
    };
    for (const int faces : {4, 8, 20}) {
        CHECK(sphere(faces, 0).triangles.size() == static_cast<std::size_t>(faces));
        for (int levels = 0; levels < 4; ++levels) {
            const Solid solid = sphere(faces, levels);
            CHECK(is_closed(solid.triangles));
            CHECK(volume(solid) > 0);
            CHECK(2 * solid.vertices.size() == solid.triangles.size() + 4);
        }
    }
    for (std::uint64_t index = 0; index < 200; ++index) {
        Random random(index);
        const Solid solid = random_solid(random);
        INFO("case " << index);
        REQUIRE(is_closed(solid.triangles));
        REQUIRE(volume(solid) > 0);
    }
    std::vector<Corners> open = sphere(4, 1).triangles;
    open.pop_back();
    CHECK_FALSE(is_closed(open));
}

TEST_CASE("closed solids in front of the camera are entered as often as left", "[oracle][3.4.2]") {
    std::uint64_t covered = 0;
    for (std::uint64_t index = 0; index < 500; ++index) {
        Random random(index);
        const SamplePattern pattern = standard_pattern(kSampleCounts[index % 5]);
        const Solid solid = random_solid(random);
        const ClipMesh mesh = random_view(random, solid, ViewKind::InFront);
        REQUIRE(std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                            [](const ClipVertex& v) { return v.w > 0 && v.z >= 0 && v.z <= v.w; }));
        const std::vector<Point> points = snapped(mesh);
        SampleCounts counts(kRect, pattern);
        for (const auto& [a, b, c] : mesh.triangles) counts.add(SnappedTriangle{points[a], points[b], points[c]});
        for_each_sample(pattern, [&](int x, int y, int i) {
            covered += static_cast<std::uint64_t>(counts.front(x, y, i));
            INFO("case " << index << ", pixel (" << x << ", " << y << "), sample " << i);
            REQUIRE(counts.front(x, y, i) == counts.back(x, y, i));
        });
    }
    CHECK(covered > 100000);
}

TEST_CASE("what the clipping oracle counts of a solid", "[oracle][15.4]") {
    // Convex solids: in front of the planes once in, once out; cut by the near plane possibly a back face alone, by the far
    // plane a front face alone.
    std::array<std::array<std::uint64_t, 4>, kViewKinds.size()> seen{};
    for (std::uint64_t index = 0; index < 400; ++index) {
        Random random(index);
        const ViewKind kind = kViewKinds[index % kViewKinds.size()];
        const Solid solid = random.chance(2) ? random_hull(random, 12) : sphere(8, 1);
        const ClipMesh mesh = random_view(random, solid, kind);
        std::vector<ClippedTriangle> triangles;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) triangles.emplace_back(mesh.triangle(i), kRect);
        for_each_sample(standard_pattern(1), [&](int x, int y, int i) {
            const Tally sum = tally(triangles, standard_pattern(1).at(x, y, i));
            if (sum.close > 0) return;
            INFO("case " << index << ", pixel (" << x << ", " << y << ")");
            REQUIRE((sum.front <= 1 && sum.back <= 1));
            if (kind == ViewKind::InFront) REQUIRE(sum.front == sum.back);
            if (kind == ViewKind::FarCuts) REQUIRE(sum.front >= sum.back);
            ++seen[static_cast<std::size_t>(kind)][static_cast<std::size_t>(2 * sum.front + sum.back)];
        });
    }
    const auto count = [&](ViewKind kind, std::size_t what) { return seen[static_cast<std::size_t>(kind)][what]; };
    CHECK(count(ViewKind::InFront, 3) > 1000);
    CHECK(count(ViewKind::NearCuts, 1) > 1000);
    CHECK(count(ViewKind::FarCuts, 2) > 1000);
    CHECK(count(ViewKind::Inside, 1) > 1000);
}

TEST_CASE("the difference of front and back faces is exact on edges too", "[oracle][15.4]") {
    std::uint64_t on_edges = 0;
    std::uint64_t opened = 0;
    for (std::uint64_t index = 0; index < 400; ++index) {
        Random random(index);
        const ViewKind kind = kViewKinds[index % kViewKinds.size()];
        const Solid solid = random_solid(random);
        const bool clip = index % 8 < 6;
        const ClipMesh mesh = random_view(random, solid, kind);
        std::vector<ClippedTriangle> triangles;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            triangles.emplace_back(mesh.triangle(i), kRect, clip ? DepthClip::On : DepthClip::Off);
        const SamplePattern pattern = standard_pattern(2);
        for_each_sample(pattern, [&](int x, int y, int i) {
            const Point s = pattern.at(x, y, i);
            const Tally sum = tally(triangles, s);
            const SignedCount difference = signed_count(triangles, s);
            INFO("case " << index << ", pixel (" << x << ", " << y << "), sample " << i);
            if (kind == ViewKind::InFront) REQUIRE(difference.count == 0);
            if (sum.close == 0) {
                REQUIRE(difference.count == sum.front - sum.back);
                REQUIRE(difference.sure);
            } else {
                on_edges += difference.sure;
            }
            opened += difference.count != 0;
            if (kind == ViewKind::NearCuts) REQUIRE(difference.count <= 0);
        });
    }
    CHECK(on_edges > 1000);
    CHECK(opened > 5000);
}
