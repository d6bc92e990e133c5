// D3D11.3 3.4.2.1, 3.5.4: the samples of a triangle are those of exact integer arithmetic, for random triangles of every kind,
// complete sets, subdivided rectangles and closed solids, at every sample count.
#include "pipeline/coverage_query.h"
#include "sim/parallel.h"
#include "tests/oracle/meshes.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <atomic>
#include <mutex>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Masks;
using oracle::Random;
using oracle::SnappedTriangle;
using oracle::TriangleTarget;

namespace {

/// What the query says, compared with the oracle: empty, or the first difference. Adds what is covered to `covered`.
std::string query_difference(const SnappedTriangle& t, const TriangleTarget& target, Masks& expected, std::uint64_t& covered) {
    static const Profile profile;
    expected.clear();
    oracle::add_coverage(expected, t, target.pattern);
    std::array<glm::vec2, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = {static_cast<float>(t[i].x) / 256.0f, static_cast<float>(t[i].y) / 256.0f};
    const auto pixels =
        covered_pixels(corners, {.width = target.width, .height = target.height, .samples = target.pattern.count}, profile);
    Masks drawn(target.rect());
    for (const CoveredPixel& pixel : pixels) drawn.at(pixel.x, pixel.y) = pixel.mask;
    covered += pixels.size();
    return difference(expected, drawn);
}

/// Runs check(case, masks, covered) for [begin, end) in pieces on all processors and reports the first failure.
template <class Check>
std::uint64_t check_range(std::uint64_t begin, std::uint64_t end, const TriangleTarget& target, const Check& check) {
    constexpr std::uint64_t kPiece = 4096;
    Workers workers;
    std::mutex mutex;
    std::string failure;
    std::atomic<std::uint64_t> covered{0};
    workers.for_each((end - begin + kPiece - 1) / kPiece, [&](std::size_t piece) {
        Masks masks(target.rect());
        std::uint64_t here = 0;
        const std::uint64_t first = begin + piece * kPiece;
        for (std::uint64_t i = first; i < std::min(end, first + kPiece); ++i) {
            const std::string difference = check(i, masks, here);
            if (difference.empty()) continue;
            const std::lock_guard lock(mutex);
            if (failure.empty()) failure = difference;
            break;
        }
        covered += here;
    });
    if (!failure.empty()) FAIL(failure);
    return covered;
}

void check_random(int samples, std::uint64_t begin, std::uint64_t end) {
    const TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
    const std::uint64_t covered = check_range(begin, end, target, [&](std::uint64_t i, Masks& masks, std::uint64_t& sum) {
        const oracle::TriangleCase c = oracle::triangle_case(i, target);
        const std::string wrong = query_difference(c.triangle, target, masks, sum);
        if (wrong.empty()) return wrong;
        return fmt::format("{} samples, case {} ({}): {}\n  {}", samples, i, oracle::name_of(c.kind), wrong,
                           describe(c.triangle));
    });
    CHECK(covered > 5 * (end - begin));  // of 256 pixels
}

void check_complete(int samples, std::uint64_t stride) {
    const TriangleTarget target{.width = 4, .height = 4, .pattern = oracle::standard_pattern(samples)};
    for (const oracle::CompleteSet& set : oracle::complete_sets()) {
        const std::uint64_t covered =
            check_range(0, set.size / stride, target, [&](std::uint64_t k, Masks& masks, std::uint64_t& sum) {
                const SnappedTriangle t = set.triangle(k * stride);
                const std::string wrong = query_difference(t, target, masks, sum);
                if (wrong.empty()) return wrong;
                return fmt::format("{} samples, {} number {}: {}\n  {}", samples, set.name, k * stride, wrong, describe(t));
            });
        CHECK(covered > set.size / stride / 20);
    }
}

}  // namespace

TEST_CASE("random triangles cover the samples of exact arithmetic", "[raster][3.4.2.1][3.5.4]") {
    for (const int samples : oracle::kSampleCounts) check_random(samples, 0, 25000);
}
TEST_CASE("a million random triangles per sample count", "[.][sweep][raster-sweep][3.4.2.1]") {
    for (const int samples : oracle::kSampleCounts) check_random(samples, 0, 1000000);
}

// 97 is prime to the sizes of all sets.
TEST_CASE("some of every complete set of triangles in a cell", "[raster][3.4.2.1]") {
    for (const int samples : oracle::kSampleCounts) check_complete(samples, 97);
}
TEST_CASE("every sub-pixel position of one, two and three corners", "[.][sweep][raster-sweep][3.4.2.1]") {
    for (const int samples : oracle::kSampleCounts) check_complete(samples, 1);
}

TEST_CASE("draws cover what the oracle says, with w, both windings and every sample count", "[raster][3.4.2.1][3.5.4]") {
    constexpr int kLayers = 256;
    for (const int samples : oracle::kSampleCounts) {
        const TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(mark_program(), Profile{}, {.samples = samples, .layers = kLayers});
        for (int batch = 0; batch < 6; ++batch) {
            canvas.clear();
            std::vector<RasterVertex> vertices;
            std::vector<SnappedTriangle> snapped;
            for (int layer = 0; layer < kLayers; ++layer) {
                const auto index = static_cast<std::uint64_t>(batch * kLayers + layer);
                const oracle::TriangleCase c = oracle::triangle_case(index, target);
                Random random(index ^ 0x5eed);
                SnappedTriangle& t = snapped.emplace_back();
                for (std::size_t i = 0; i < 3; ++i) {
                    const oracle::PlacedVertex placed = oracle::place(random, c.triangle[i], target.rect());
                    vertices.push_back(vertex_of(placed, 1.0f, static_cast<float>(layer)));
                    t[i] = placed.snapped;
                }
            }
            canvas.execute(canvas.draw_of(vertices));
            for (int layer = 0; layer < kLayers; ++layer) {
                const SnappedTriangle& t = snapped[static_cast<std::size_t>(layer)];
                const std::string wrong =
                    difference(oracle::coverage(t, target.rect(), target.pattern), canvas.masks(1.0f, layer));
                if (!wrong.empty())
                    FAIL(fmt::format("{} samples, case {}: {}\n  {}", samples, batch * kLayers + layer, wrong, describe(t)));
            }
        }
    }
}

TEST_CASE("draws across tiles and blocks cover what the oracle says", "[raster][3.4.2.1][3.5.4]") {
    for (const int samples : oracle::kSampleCounts) {
        const TriangleTarget target{.width = 134, .height = 70, .pattern = oracle::standard_pattern(samples)};
        Canvas canvas(mark_program(), Profile{}, {.width = target.width, .height = target.height, .samples = samples});
        for (std::uint64_t index = 0; index < 160; ++index) {
            const oracle::TriangleCase c = oracle::triangle_case(index, target);
            Random random(index);
            std::vector<RasterVertex> vertices;
            SnappedTriangle t;
            for (std::size_t i = 0; i < 3; ++i) {
                const oracle::PlacedVertex placed = oracle::place(random, c.triangle[i], target.rect());
                vertices.push_back(vertex_of(placed, static_cast<float>(index)));
                t[i] = placed.snapped;
            }
            canvas.execute(canvas.draw_of(vertices));
            const std::string wrong =
                difference(oracle::coverage(t, target.rect(), target.pattern), canvas.masks(static_cast<float>(index)));
            if (!wrong.empty())
                FAIL(fmt::format("{} samples, case {} ({}): {}\n  {}", samples, index, oracle::name_of(c.kind), wrong,
                                 describe(t)));
        }
    }
}

namespace {

/// Adds 1 to every sample that a triangle facing the kept way covers.
Draw counting(Draw draw, CullMode culled) {
    draw.raster.cull = culled;
    draw.raster.front_counter_clockwise = false;
    draw.output.blend[0] = {.enable = true, .src = BlendFactor::One, .dst = BlendFactor::One};
    return draw;
}

}  // namespace

TEST_CASE("a subdivided rectangle covers each of its samples once", "[raster][watertight][3.4.2.1]") {
    std::uint64_t triangles = 0;
    for (const int samples : oracle::kSampleCounts) {
        const oracle::SamplePattern pattern = oracle::standard_pattern(samples);
        Canvas canvas(mark_program(), Profile{}, {.width = 64, .height = 64, .samples = samples});
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            Random random(seed * 16 + static_cast<std::uint64_t>(samples));
            const oracle::Point from{random.between(-300, 5 * 256), random.between(-300, 5 * 256)};
            const oracle::Point to{random.between(50 * 256, 70 * 256), random.between(50 * 256, 70 * 256)};
            const oracle::SnappedMesh mesh = oracle::random_subdivision(random, from, to, 400, pattern);
            triangles += mesh.triangles.size();
            std::vector<RasterVertex> vertices;
            for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
                for (const oracle::Point& p : mesh.triangle(t)) vertices.push_back(vertex_at(p, canvas.rect(), 1.0f));
            canvas.clear(0.0f);
            canvas.execute(counting(canvas.draw_of(vertices), CullMode::Back));
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x)
                    for (int s = 0; s < samples; ++s) {
                        const oracle::Point at = pattern.at(x, y, s);
                        const bool inside = at.x >= from.x && at.x < to.x && at.y >= from.y && at.y < to.y;
                        const float drawn = canvas.value(0, 0, {.x = x, .y = y, .sample = s});
                        if (drawn != (inside ? 1.0f : 0.0f))
                            FAIL(fmt::format("{} samples, seed {}: sample {} of pixel ({}, {}) drawn {} times", samples, seed,
                                             s, x, y, drawn));
                    }
        }
    }
    CHECK(triangles > 10000);
}

TEST_CASE("closed solids cover each sample by as many front as back faces", "[raster][watertight][3.4.2.1]") {
    std::uint64_t covered = 0;
    for (const int samples : oracle::kSampleCounts) {
        Canvas front(mark_program(), Profile{}, {.width = 64, .height = 64, .samples = samples});
        Canvas back(mark_program(), Profile{}, {.width = 64, .height = 64, .samples = samples});
        for (std::uint64_t seed = 0; seed < 16; ++seed) {
            Random random(seed * 32 + static_cast<std::uint64_t>(samples));
            const bool convex = seed % 2 == 0;
            const oracle::Solid solid = convex ? oracle::sphere(20, 2) : oracle::random_solid(random);
            const oracle::ClipMesh mesh = oracle::random_view(random, solid, oracle::ViewKind::InFront);
            std::vector<RasterVertex> vertices;
            for (const oracle::Corners& corners : mesh.triangles)
                for (const std::uint32_t corner : corners) {
                    const oracle::ClipVertex& v = mesh.vertices[corner];
                    vertices.push_back({.clip = {oracle::clip_float(v.x), oracle::clip_float(v.y), oracle::clip_float(v.z),
                                                 oracle::clip_float(v.w)},
                                        .a = 1.0f});
                }
            front.clear(0.0f);
            back.clear(0.0f);
            front.execute(counting(front.draw_of(vertices), CullMode::Back));
            back.execute(counting(back.draw_of(vertices), CullMode::Front));
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x)
                    for (int s = 0; s < samples; ++s) {
                        const SampleAt at{.x = x, .y = y, .sample = s};
                        const float fronts = front.value(0, 0, at);
                        const float backs = back.value(0, 0, at);
                        covered += fronts > 0;
                        if (fronts != backs || (convex && fronts > 1))
                            FAIL(fmt::format("{} samples, seed {}: sample {} of pixel ({}, {}): {} front and {} back faces",
                                             samples, seed, s, x, y, fronts, backs));
                    }
        }
    }
    CHECK(covered > 100000);
}
