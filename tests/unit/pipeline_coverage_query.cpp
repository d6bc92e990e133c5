#include "pipeline/coverage_query.h"
#include "tests/oracle/triangles.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Clip positions of a corner in pixels, as coverage_query.cpp makes them.
RasterVertex vertex_at(const glm::vec2& at, const CanvasDesc& canvas, int layer) {
    return {.clip = {at.x * 2.0f / static_cast<float>(canvas.width) - 1.0f,
                     1.0f - at.y * 2.0f / static_cast<float>(canvas.height), 0.5f, 1.0f},
            .a = 1.0f,
            .layer = static_cast<float>(layer)};
}

/// What is clipped at the guard band gets new corners, which are rounded.
bool reaches_guard_band(const oracle::SnappedTriangle& t) {
    constexpr std::int64_t kReach = std::int64_t{32'000} * 256;
    return std::ranges::any_of(t, [](const oracle::Point& p) { return std::abs(p.x) > kReach || std::abs(p.y) > kReach; });
}

}  // namespace

TEST_CASE("draws of every profile cover what the query says", "[raster][coverage][3.4.2]") {
    constexpr int kLayers = 256;
    std::uint64_t covered = 0;
    for (const Profile& profile : profile_presets()) {
        for (const int samples : oracle::kSampleCounts) {
            if (samples > profile.max_samples || (samples > 1 && !profile.multisamples_float))
                continue;  // the marks are floats
            const CanvasDesc desc{.width = 64, .height = 64, .samples = samples, .layers = kLayers};
            Canvas canvas(mark_program(), profile, desc);
            canvas.clear();
            const oracle::TriangleTarget target{desc.width, desc.height, oracle::standard_pattern(samples)};
            std::vector<std::array<glm::vec2, 3>> triangles;
            std::vector<RasterVertex> vertices;
            for (std::uint64_t i = 0; static_cast<int>(triangles.size()) < kLayers; ++i) {
                const oracle::SnappedTriangle t = oracle::triangle_case(i, target).triangle;
                if (reaches_guard_band(t)) continue;
                const auto layer = static_cast<int>(triangles.size());
                auto& corners = triangles.emplace_back();
                for (std::size_t c = 0; c < 3; ++c) {
                    corners[c] = {static_cast<float>(t[c].x) / 256.0f, static_cast<float>(t[c].y) / 256.0f};
                    vertices.push_back(vertex_at(corners[c], desc, layer));
                }
            }
            canvas.execute(canvas.draw_of(vertices));
            for (int layer = 0; layer < kLayers; ++layer) {
                oracle::Masks expected(canvas.rect());
                const auto& corners = triangles[static_cast<std::size_t>(layer)];
                for (const CoveredPixel& pixel : covered_pixels(corners, {desc.width, desc.height, samples}, profile)) {
                    expected.at(pixel.x, pixel.y) = pixel.mask;
                    ++covered;
                }
                INFO(fmt::format("profile {}, {} samples, triangle {}", profile.name, samples, layer));
                CHECK(difference(expected, canvas.masks(1.0f, layer)).empty());
            }
        }
    }
    CHECK(covered > 1'000'000);
}
