// One tile of one draw: triangles in order, blocks, quads, depth, pixel functor, targets.
#pragma once

#include "pipeline/coverage.h"
#include "pipeline/depth.h"
#include "pipeline/fragment.h"
#include "pipeline/interpolate.h"
#include "pipeline/output.h"
#include "pipeline/vertex_stage.h"

#include <optional>
#include <type_traits>

namespace gnomon {

/// The pixel functor of a depth-only program.
struct NoPixelFunctor {};

/// Colours a pixel functor returns: one Vec4, or an array of them.
template <class Real>
std::array<Vec4<Real>, 1> as_array(const Vec4<Real>& color) {
    return {color};
}
template <class Real, std::size_t kCount>
const std::array<Vec4<Real>, kCount>& as_array(const std::array<Vec4<Real>, kCount>& colors) {
    return colors;
}

/// What every tile of a draw shares.
struct TileState {
    PixelRect viewport;
    Texture* depth_texture = nullptr;
    DepthState depth_state;
    std::span<Texture* const> color;
    TextureTable textures;
    const Profile* profile = nullptr;
};

template <class Real, class VertexFunctor, class PixelFunctor>
class TileRaster {
public:
    using Scalar = typename Real::Scalar;
    using Varyings = typename VertexFunctor::template Varyings<Real>;

    TileRaster(const PixelFunctor& functor, const TileState& state, int tile_x, int tile_y, Counters* counters)
        : functor_(functor), state_(state), tile_{tile_x, tile_y, tile_x + kTileSize, tile_y + kTileSize}, counters_(counters) {
        if (state.depth_texture != nullptr) {
            const Texture& depth = *state.depth_texture;
            const PixelRect limit = intersect(tile_, {0, 0, depth.width(0), depth.height(0)});
            depth_.emplace(*state.depth_texture, state.depth_state);
            hierarchy_.emplace(*depth_, tile_x, tile_y, limit);
        }
    }

    void draw(const Triangle<Scalar>& triangle) {
        const TileEdges edges(triangle.edges, tile_.x0, tile_.y0);
        if (edges.outside) return;
        if (counters_ != nullptr) ++counters_->tiles;
        const LaneSteps steps(edges);
        const PixelRect area = intersect(triangle.bounds, tile_);

        // Blocks that the bounds touch, in rows.
        for (int y = area.y0 & ~(kBlockSize - 1); y < area.y1; y += kBlockSize) {
            for (int x = area.x0 & ~(kBlockSize - 1); x < area.x1; x += kBlockSize) {
                const BlockEdges block(edges, x - tile_.x0, y - tile_.y0);
                if (block.outside || hidden(triangle, x, y)) continue;
                draw_block(triangle, edges, block, steps, area, x, y);
            }
        }
        if (!packer_.empty()) shade(triangle, packer_.take());
    }

private:
    /// Hierarchical depth: the triangle's nearest depth over the block against the farthest one stored.
    bool hidden(const Triangle<Scalar>& triangle, int x, int y) {
        if (!hierarchy_) return false;
        const int near_x = triangle.z_dx > 0 ? x : x + kBlockSize - 1;
        const int near_y = triangle.z_dy > 0 ? y : y + kBlockSize - 1;
        const std::int32_t nearest = depth_code_scalar(depth_at(triangle, near_x, near_y), depth_->type());
        const bool rejected = hierarchy_->rejects((x - tile_.x0) / kBlockSize, (y - tile_.y0) / kBlockSize, nearest);
        if (rejected && counters_ != nullptr) ++counters_->blocks_rejected;
        return rejected;
    }

    void draw_block(const Triangle<Scalar>& triangle, const TileEdges& edges, const BlockEdges& block, const LaneSteps& steps,
                    const PixelRect& area, int x, int y) {
        const bool whole = x >= area.x0 && y >= area.y0 && x + kBlockSize <= area.x1 && y + kBlockSize <= area.y1;
        for (int dy = 0; dy < kBlockSize; dy += kWaveHeight) {
            for (int dx = 0; dx < kBlockSize; dx += kWaveWidth) {
                std::uint32_t covered = coverage(edges, block, steps, dx, dy);
                if (covered != 0 && !whole) covered &= lanes_inside(area, x + dx, y + dy);
                if (covered == 0) continue;
                add(triangle, x + dx, y + dy, covered);
            }
        }
    }

    /// A full row of quads goes straight on; loose quads are packed.
    void add(const Triangle<Scalar>& triangle, int x, int y, std::uint32_t covered) {
        if (quad_any(covered) == kAllLanes) {
            shade(triangle, row_wave(x, y, covered));
            return;
        }
        for (int q = 0; q < kQuadsPerWave; ++q) {
            const std::uint32_t mask = covered >> (4 * q) & 0xfu;
            if (mask == 0) continue;
            packer_.add(x + 2 * q, y, mask);
            if (packer_.full()) shade(triangle, packer_.take());
        }
    }

    void shade(const Triangle<Scalar>& triangle, const Wave& wave) {
        const PixelOffset<Real> offset = pixel_offset<Real>(wave, triangle.x0, triangle.y0);
        const Real z = interpolate_depth(triangle, offset);
        std::uint32_t passed = wave.covered;
        if (depth_) passed = test_depth(wave, z);
        if (counters_ != nullptr) count(wave, passed);
        if (passed == 0) return;
        if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>) {
            const Barycentrics<Real> barycentrics = interpolate_barycentrics(triangle, offset);
            const auto varyings = interpolate_varyings<Varyings>(triangle, barycentrics);
            const Vec4<Real> position{Real(wave.x) + Real(0.5f), Real(wave.y) + Real(0.5f), z, barycentrics.w};
            const FragmentContext<Real, Varyings> context(varyings, position, passed, state_.textures, *state_.profile,
                                                          counters_);
            const auto result = functor_(context);
            const auto& colors = as_array(result);
            for (std::size_t i = 0; i < colors.size(); ++i)
                write_color(*state_.color[i], wave, passed, colors[i], *state_.profile);
        }
    }

    /// Early depth: test and write before the functor runs, which is safe as no functor changes depth or coverage.
    std::uint32_t test_depth(const Wave& wave, const Real& z) {
        const Int code = depth_code(z, depth_->type());
        Int stored;
        const std::uint32_t passed = depth_->test(wave, code, stored);
        if (passed != 0 && state_.depth_state.write) {
            depth_->write(wave, code, stored, passed);
            for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q)
                hierarchy_->forget(wave.quad_x[q], wave.quad_y[q]);
        }
        return passed;
    }

    void count(const Wave& wave, std::uint32_t passed) {
        const auto lanes = [](std::uint32_t bits) { return static_cast<std::uint64_t>(std::popcount(bits)); };
        counters_->samples_covered += lanes(wave.covered);
        counters_->samples_passed += lanes(passed);
        counters_->quads_early_killed += static_cast<std::uint64_t>(wave.quads) - lanes(quad_any(passed)) / 4;
        if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>) {
            const std::uint64_t shaded = lanes(quad_any(passed));
            counters_->quads_shaded += shaded / 4;
            counters_->lanes_shaded += lanes(passed);
            counters_->lanes_helper += shaded - lanes(passed);
        }
    }

    const PixelFunctor& functor_;
    const TileState& state_;
    PixelRect tile_;
    Counters* counters_;
    std::optional<DepthTarget> depth_;
    std::optional<HierarchicalDepth> hierarchy_;
    QuadPacker packer_;
};

}  // namespace gnomon
