#include "pipeline/coverage_query.h"

#include "pipeline/coverage.h"
#include "pipeline/setup.h"
#include "sim/error.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

/// Calls visit(x, y, masks by sample) for every row of quads of a tile that the triangle touches.
template <class Visit>
void visit_tile(const Primitive<float>& triangle, const SamplePattern& pattern, int tile_x, int tile_y, const Visit& visit) {
    const TileEdges edges(triangle.edges, pattern, tile_x, tile_y);
    if (edges.outside) return;
    const LaneSteps steps(edges);
    const PixelRect area = intersect(triangle.bounds, {tile_x, tile_y, tile_x + kTileSize, tile_y + kTileSize});
    for (int y = area.y0 & ~1; y < area.y1; y += kWaveHeight) {
        for (int x = area.x0 & ~(kBlockSize - 1); x < area.x1; x += kWaveWidth) {
            const BlockEdges here(edges, x - tile_x, y - tile_y);
            const auto values = edge_values(edges, here.value, steps, 0, 0);
            const std::uint32_t inside = lanes_inside(area, x, y);
            std::array<std::uint32_t, kMaxSamples> masks{};
            for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
                masks[s] = (s == 0 ? coverage(values) : coverage(values, edges, s)) & inside;
            visit(x, y, masks);
        }
    }
}

}  // namespace

void visit_covered_pixels(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target, const Profile& profile,
                          const std::function<void(std::span<const CoveredPixel>)>& visit) {
    if (target.samples > profile.max_samples)
        fail("{} samples: profile {} has at most {}", target.samples, profile.name, profile.max_samples);
    const SamplePattern pattern = sample_pattern(profile, target.samples);
    const Viewport viewport{.width = static_cast<float>(target.width), .height = static_cast<float>(target.height)};
    const ViewportTransform transform = make_viewport_transform(viewport, nullptr, target.width, target.height);
    const SetupState state{.raster = {},
                           .viewports = std::span(&transform, 1),
                           .subpixel_bits = profile.raster_subpixel_bits,
                           .sample_extent = sample_extent(pattern)};
    std::array<SetupVertex<float>, 3> vertices;
    constexpr std::array<float, kPositionScalars> kNoRecord{};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec2& at = corners[i];
        if (!(std::fabs(at.x) <= kMaxPosition && std::fabs(at.y) <= kMaxPosition))
            fail("corner {} at ({}, {}): expected positions from -{} to {}", i, at.x, at.y, kMaxPosition, kMaxPosition);
        vertices[i].record = kNoRecord.data();
        vertices[i].screen = {
            .x = at.x, .y = at.y, .at = snap_position(at.x, at.y, profile), .z = 0.0f, .inv_w = 1.0f, .valid = true};
    }

    Primitive<float> triangle;
    if (!set_up_triangle(vertices, PrimitiveHead<float>{}, state, triangle)) return;
    const PixelRect& bounds = triangle.bounds;
    std::vector<CoveredPixel> covered;
    for (int tile_y = bounds.y0 / kTileSize * kTileSize; tile_y < bounds.y1; tile_y += kTileSize) {
        covered.clear();
        for (int tile_x = bounds.x0 / kTileSize * kTileSize; tile_x < bounds.x1; tile_x += kTileSize) {
            visit_tile(triangle, pattern, tile_x, tile_y, [&](int x, int y, const auto& masks) {
                for (int i = 0; i < kLanes; ++i) {
                    std::uint32_t mask = 0;
                    for (int s = 0; s < pattern.count; ++s) mask |= (masks[static_cast<std::size_t>(s)] >> i & 1u) << s;
                    if (mask != 0) covered.push_back({x + i / 4 * 2 + (i & 1), y + (i >> 1 & 1), mask});
                }
            });
        }
        std::ranges::sort(covered, {}, [](const CoveredPixel& pixel) { return std::pair(pixel.y, pixel.x); });
        if (!covered.empty()) visit(covered);
    }
}

std::vector<CoveredPixel> covered_pixels(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target,
                                         const Profile& profile) {
    std::vector<CoveredPixel> covered;
    visit_covered_pixels(corners, target, profile, [&](std::span<const CoveredPixel> pixels) {
        covered.insert(covered.end(), pixels.begin(), pixels.end());
    });
    return covered;
}

}  // namespace gnomon
