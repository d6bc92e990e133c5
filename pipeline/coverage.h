// Which samples of a tile a triangle covers: exact edge functions in 32 bits, tested tile, block and wave at a time.
// D3D11.3 3.4.2, 3.5.4
#pragma once

#include "pipeline/primitive.h"
#include "pipeline/samples.h"
#include "pipeline/wave.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace gnomon {

/// The edges of a triangle relative to one tile, at the sample 0 of its pixels. An edge that crosses the tile has
/// |value| <= 64 (|a| + |b|) < 2^31 at every sample of it, as |a| and |b| are at most 65534 * 256, so 32 bits are exact; an
/// edge that the whole tile is inside of is dropped (a = b = value = 0).
struct TileEdges {
    std::array<std::int32_t, 3> a;
    std::array<std::int32_t, 3> b;
    std::array<std::int32_t, 3> value;  // at sample 0 of the tile's first pixel
    bool outside = false;               // no sample of the tile is covered
    bool inside = true;                 // every one is
    // Values at the other samples, less `value`, and the extremes of that over the samples.
    std::array<std::array<std::int32_t, kMaxSamples>, 3> at_sample;
    std::array<std::int32_t, 3> least{};
    std::array<std::int32_t, 3> most{};

    /// Short edges relative to any pixel, nothing dropped.
    static TileEdges around(const std::array<Edge, 3>& edges, const SamplePattern& pattern, int x, int y) {
        TileEdges around;
        around.inside = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const Edge& e = edges[i];
            const auto constant = [&](std::size_t s) {
                return e.at_sample(pattern.at[s].x * kSampleGrid, pattern.at[s].y * kSampleGrid);
            };
            const std::int64_t first = constant(0);
            around.a[i] = e.a;
            around.b[i] = e.b;
            around.value[i] = static_cast<std::int32_t>(std::int64_t{e.a} * x + std::int64_t{e.b} * y + first);
            for (std::size_t s = 1; s < static_cast<std::size_t>(pattern.count); ++s)
                around.at_sample[i][s] = static_cast<std::int32_t>(constant(s) - first);
        }
        return around;
    }

    TileEdges(const std::array<Edge, 3>& edges, const SamplePattern& pattern, int tile_x, int tile_y) {
        constexpr std::int64_t kReach = kTileSize - 1;
        const auto samples = static_cast<std::size_t>(pattern.count);
        for (std::size_t i = 0; i < 3; ++i) {
            const Edge& e = edges[i];
            const std::int64_t origin = std::int64_t{e.a} * tile_x + std::int64_t{e.b} * tile_y;
            const auto constant = [&](std::size_t s) {
                return e.at_sample(pattern.at[s].x * kSampleGrid, pattern.at[s].y * kSampleGrid);
            };
            const std::int64_t first = constant(0);
            std::int64_t low = first;
            std::int64_t high = first;
            for (std::size_t s = 1; s < samples; ++s) {
                const std::int64_t c = constant(s);
                low = std::min(low, c);
                high = std::max(high, c);
                at_sample[i][s] = static_cast<std::int32_t>(c - first);
            }
            const bool dropped = origin + low + (std::min(e.a, 0) + std::int64_t{std::min(e.b, 0)}) * kReach >= 0;
            if (origin + high + (std::max(e.a, 0) + std::int64_t{std::max(e.b, 0)}) * kReach < 0) outside = true;
            inside = inside && dropped;
            if (dropped || outside) {
                a[i] = b[i] = value[i] = 0;
                if (samples > 1) at_sample[i].fill(0);
                continue;
            }
            a[i] = e.a;
            b[i] = e.b;
            value[i] = static_cast<std::int32_t>(origin + first);
            least[i] = static_cast<std::int32_t>(low - first);
            most[i] = static_cast<std::int32_t>(high - first);
        }
    }

private:
    TileEdges() = default;
};

/// Whether the edges of a triangle of few pixels are also short, so that their values anywhere near it fit in 32 bits: a large
/// triangle in a small viewport has few pixels, too.
inline bool has_short_edges(const std::array<Edge, 3>& edges) {
    constexpr std::int32_t kShort = 1 << 14;  // 64 pixels
    return std::ranges::all_of(edges, [](const Edge& e) { return std::abs(e.a) <= kShort && std::abs(e.b) <= kShort; });
}

/// The blocks of a tile as bits, or as lanes: row by row, kBlocksPerTile in each.
struct BlockBits {
    std::uint32_t outside = 0;  // no sample of the block is covered
    std::uint32_t inside = 0;   // every one is
};

/// Where blocks n, n + 1, ... of a tile lie to the edges, a block per lane.
inline BlockBits classify_blocks(const TileEdges& tile, int n) {
    if (tile.inside) return {0, kAllLanes};
    const Int block = Int(n) + lane_index();
    const Int x = block & Int(kBlocksPerTile - 1);
    const Int y = shift_right_logical<kBlockRowBits>(block);
    constexpr std::int32_t kReach = kBlockSize - 1;
    Int most(0);   // negative where the most inner sample is outside an edge
    Int least(0);  // negative where the most outer one is
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t a = tile.a[i];
        const std::int32_t b = tile.b[i];
        const Int value = Int(tile.value[i]) + x * Int(a * kBlockSize) + y * Int(b * kBlockSize);
        most = most | (value + Int(tile.most[i] + (std::max(a, 0) + std::max(b, 0)) * kReach));
        least = least | (value + Int(tile.least[i] + (std::min(a, 0) + std::min(b, 0)) * kReach));
    }
    return {(most < Int(0)).bits(), (least >= Int(0)).bits()};
}

/// Edge values of the lanes of a wave, less the value at its first pixel.
struct LaneSteps {
    std::array<Int, 3> step;

    explicit LaneSteps(const TileEdges& tile) {
        for (std::size_t i = 0; i < 3; ++i) step[i] = Int(tile.a[i]) * lane_dx() + Int(tile.b[i]) * lane_dy();
    }
};

/// The three edge functions at sample 0 of the row of quads at (dx, dy) from where they are `base`.
inline std::array<Int, 3> edge_values(const TileEdges& tile, const std::array<std::int32_t, 3>& base, const LaneSteps& lanes,
                                      int dx, int dy) {
    const auto value = [&](std::size_t i) { return Int(base[i] + tile.a[i] * dx + tile.b[i] * dy) + lanes.step[i]; };
    return {value(0), value(1), value(2)};
}

/// Lanes whose sample 0 is inside all three edges.
inline std::uint32_t coverage(const std::array<Int, 3>& values) {
    return ((values[0] | values[1] | values[2]) >= Int(0)).bits();
}
/// Lanes whose sample s > 0 is.
inline std::uint32_t coverage(const std::array<Int, 3>& values, const TileEdges& tile, std::size_t s) {
    const auto value = [&](std::size_t i) { return values[i] + Int(tile.at_sample[i][s]); };
    return ((value(0) | value(1) | value(2)) >= Int(0)).bits();
}

/// Lanes of the row of quads at (x, y) that lie inside a rectangle.
inline std::uint32_t lanes_inside(const PixelRect& rect, int x, int y) {
    const Int px = Int(x) + lane_dx();
    const Int py = Int(y) + lane_dy();
    return ((px >= Int(rect.x0)) & (px < Int(rect.x1)) & (py >= Int(rect.y0)) & (py < Int(rect.y1))).bits();
}

}  // namespace gnomon
