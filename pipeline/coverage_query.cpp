#include "pipeline/coverage_query.h"

#include "pipeline/binning.h"
#include "pipeline/outline.h"
#include "pipeline/triangle_walk.h"
#include "sim/error.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using Pieces = BinnedPrimitives<float>;

/// The triangle as the rasteriser takes it. Profiles with a transform or a clipping of their own get it as a draw would give it
/// to them, in clip space with w = 1.
Pieces pieces_of(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target, const SetupState& state,
                 const Profile& profile) {
    Pieces pieces;
    if (state.clipping == Clipping::GuardBand && state.viewport_arithmetic == ViewportArithmetic::D3d11) {
        std::array<SetupVertex<float>, 3> vertices;
        constexpr std::array<float, kPositionScalars> kNoRecord{};
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::vec2& at = corners[i];
            vertices[i].record = kNoRecord.data();
            vertices[i].screen = {
                .x = at.x, .y = at.y, .at = snap_position(at.x, at.y, profile), .z = 0.0f, .inv_w = 1.0f, .valid = true};
        }
        Primitive<float> triangle;
        if (set_up_triangle(vertices, PrimitiveHead<float>{}, state, triangle))
            pieces.chunks.emplace_back().pieces.push_back(triangle);
        return pieces;
    }

    VertexBlock<float> vertices;
    for (const glm::vec2& at : corners)
        for (const float scalar : {at.x * 2.0f / static_cast<float>(target.width) - 1.0f,
                                   1.0f - at.y * 2.0f / static_cast<float>(target.height), 0.0f, 1.0f})
            vertices.scalars.push_back(scalar);
    const Assembly assembly(VertexNumbers({}, IndexType::Uint32, 0, 3), Topology::TriangleList, ProvokingVertex::First, false);
    const auto tiles = [](int pixels) { return (pixels + kTileSize - 1) / kTileSize; };
    const BinningInput<float> input{.vertices = vertices,
                                    .assembly = assembly,
                                    .vertices_per_instance = 3,
                                    .state = state,
                                    .tiles_x = tiles(target.width),
                                    .tiles = tiles(target.width) * tiles(target.height)};
    Workers caller(1);
    AssemblyCursor first = assembly.begin();
    bin_primitives(input, first, 1, caller, profile.flush_denormals, ProjectedVertices<float>{}, pieces);
    return pieces;
}

/// Takes what one piece covers of one tile.
class Collector {
public:
    using Samples = LanesBySample<kMaxSamples>;

    Collector(const SamplePattern& pattern, const PixelRect& tile, std::vector<CoveredPixel>& out)
        : pattern_(pattern), tile_(tile), out_(out) {}

    void take(const Primitive<float>& piece, const CoverageTarget& target) {
        const PixelRect all{0, 0, target.width, target.height};
        if (piece.shape == PrimitiveShape::Triangle) {
            TriangleWalk<Samples, Collector>(pattern_, {tile_, all, tile_.x1}, *this).walk(piece.edges, piece.bounds);
            return;
        }
        const PixelRect area = intersect(piece.bounds, tile_);
        std::vector<TileBits> bits;
        bits.reserve(static_cast<std::size_t>(pattern_.count));
        for (std::size_t s = 0; s < static_cast<std::size_t>(pattern_.count); ++s)
            bits.push_back(outline_coverage(*piece.outline, pattern_.at[s], area, tile_.x0, tile_.y0));
        for (int y = area.y0; y < area.y1; ++y) {
            for (int x = area.x0; x < area.x1; ++x) {
                std::uint32_t mask = 0;
                for (std::size_t s = 0; s < bits.size(); ++s)
                    mask |=
                        static_cast<std::uint32_t>(bits[s].rows[static_cast<std::size_t>(y - tile_.y0)] >> (x - tile_.x0) & 1u)
                        << s;
                if (mask != 0) out_.push_back({x, y, mask});
            }
        }
    }

    // As TriangleWalk wants it.
    std::uint32_t hidden(int, std::uint32_t) const { return 0; }
    void begin_whole_block() {}
    void end_whole_block(int) {}
    void add(const QuadRow& row, std::uint32_t covered, const Samples& samples) {
        for (std::uint32_t rest = covered; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
            std::uint32_t mask = 0;
            for (std::size_t s = 0; s < static_cast<std::size_t>(pattern_.count); ++s)
                mask |= (samples.covered[s] >> lane & 1u) << s;
            out_.push_back({row.pixel_x(lane), row.pixel_y(lane), mask});
        }
    }

private:
    const SamplePattern& pattern_;
    PixelRect tile_;
    std::vector<CoveredPixel>& out_;
};

}  // namespace

void visit_covered_pixels(const std::array<glm::vec2, 3>& corners, const CoverageTarget& target, const Profile& profile,
                          const std::function<void(std::span<const CoveredPixel>)>& visit) {
    if (target.samples > profile.max_samples)
        fail("{} samples: profile {} has at most {}", target.samples, profile.name, profile.max_samples);
    const SamplePattern pattern = sample_pattern(profile, target.samples);
    const Viewport viewport{.width = static_cast<float>(target.width), .height = static_cast<float>(target.height)};
    const ViewportTransform transform =
        make_viewport_transform(viewport, nullptr, target.width, target.height, profile.clipping);
    const SetupState state{.raster = {.cull = CullMode::None},
                           .viewports = std::span(&transform, 1),
                           .samples = target.samples,
                           .subpixel_bits = profile.raster_subpixel_bits,
                           .viewport_arithmetic = profile.viewport_arithmetic,
                           .clipping = profile.clipping,
                           .winding_area = profile.winding_area,
                           .plane_equations = profile.plane_equations,
                           .sample_extent = sample_extent(pattern)};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec2& at = corners[i];
        if (!(std::fabs(at.x) <= kMaxPosition && std::fabs(at.y) <= kMaxPosition))
            fail("corner {} at ({}, {}): expected positions from -{} to {}", i, at.x, at.y, kMaxPosition, kMaxPosition);
    }
    const Pieces pieces = pieces_of(corners, target, state, profile);
    PixelRect bounds{target.width, target.height, 0, 0};
    for (const auto& chunk : pieces.chunks)
        for (const Primitive<float>& piece : chunk.pieces)
            bounds = {std::min(bounds.x0, piece.bounds.x0), std::min(bounds.y0, piece.bounds.y0),
                      std::max(bounds.x1, piece.bounds.x1), std::max(bounds.y1, piece.bounds.y1)};

    std::vector<CoveredPixel> covered;
    for (int y = bounds.y0 / kTileSize * kTileSize; y < bounds.y1; y += kTileSize) {
        covered.clear();
        for (int x = bounds.x0 / kTileSize * kTileSize; x < bounds.x1; x += kTileSize) {
            Collector collector(pattern, {x, y, x + kTileSize, y + kTileSize}, covered);
            for (const auto& chunk : pieces.chunks)
                for (const Primitive<float>& piece : chunk.pieces) collector.take(piece, target);
        }
        std::ranges::sort(covered, {}, [](const CoveredPixel& pixel) { return std::pair(pixel.y, pixel.x); });
        // Pieces of one triangle meet in pixels with several samples.
        std::size_t kept = 0;
        for (const CoveredPixel& pixel : covered) {
            if (kept > 0 && covered[kept - 1].x == pixel.x && covered[kept - 1].y == pixel.y) {
                covered[kept - 1].mask |= pixel.mask;
            } else {
                covered[kept++] = pixel;
            }
        }
        covered.resize(kept);
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
