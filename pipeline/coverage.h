// Which pixels of a tile a triangle covers: exact edge functions in 32 bits, tested tile, block and wave at a time.
// D3D11.3 3.4.2
#pragma once

#include "pipeline/triangle.h"
#include "pipeline/wave.h"

#include <algorithm>
#include <array>

namespace gnomon {

/// The edges of a triangle relative to one tile. An edge that crosses the tile has |value| <= 63 (|a| + |b|) < 2^31 at every
/// pixel of it, so 32 bits are exact; an edge that the whole tile is inside of is dropped (a = b = value = 0).
struct TileEdges {
    std::array<std::int32_t, 3> a;
    std::array<std::int32_t, 3> b;
    std::array<std::int32_t, 3> value;  // at the tile's first pixel
    bool outside = false;               // no pixel of the tile is covered

    TileEdges(const std::array<Edge, 3>& edges, int tile_x, int tile_y) {
        constexpr std::int64_t kReach = kTileSize - 1;
        for (std::size_t i = 0; i < 3; ++i) {
            const Edge& e = edges[i];
            const std::int64_t origin = std::int64_t{e.a} * tile_x + std::int64_t{e.b} * tile_y + e.c;
            const std::int64_t least = origin + (std::min(e.a, 0) + std::int64_t{std::min(e.b, 0)}) * kReach;
            const std::int64_t most = origin + (std::max(e.a, 0) + std::int64_t{std::max(e.b, 0)}) * kReach;
            if (most < 0) outside = true;
            const bool inside = least >= 0;
            a[i] = inside ? 0 : e.a;
            b[i] = inside ? 0 : e.b;
            value[i] = inside || most < 0 ? 0 : static_cast<std::int32_t>(origin);
        }
    }
};

/// The same edges relative to one 8x8 block.
struct BlockEdges {
    std::array<std::int32_t, 3> value;  // at the block's first pixel
    bool outside = false;

    BlockEdges(const TileEdges& tile, int dx, int dy) {
        for (std::size_t i = 0; i < 3; ++i) {
            value[i] = tile.value[i] + tile.a[i] * dx + tile.b[i] * dy;
            const std::int32_t most = value[i] + (std::max(tile.a[i], 0) + std::max(tile.b[i], 0)) * (kBlockSize - 1);
            outside = outside || most < 0;
        }
    }
};

/// Edge values of the lanes of a wave, less the value at its first pixel.
struct LaneSteps {
    std::array<Int, 3> step;

    explicit LaneSteps(const TileEdges& tile) {
        for (std::size_t i = 0; i < 3; ++i) step[i] = Int(tile.a[i]) * lane_dx() + Int(tile.b[i]) * lane_dy();
    }
};

/// Lanes inside all three edges, for the row of quads at (dx, dy) inside a block.
inline std::uint32_t coverage(const TileEdges& tile, const BlockEdges& block, const LaneSteps& lanes, int dx, int dy) {
    const auto value = [&](std::size_t i) { return Int(block.value[i] + tile.a[i] * dx + tile.b[i] * dy) + lanes.step[i]; };
    return ((value(0) | value(1) | value(2)) >= Int(0)).bits();
}

/// Lanes of the row of quads at (x, y) that lie inside a rectangle.
inline std::uint32_t lanes_inside(const PixelRect& rect, int x, int y) {
    const Int px = Int(x) + lane_dx();
    const Int py = Int(y) + lane_dy();
    return ((px >= Int(rect.x0)) & (px < Int(rect.x1)) & (py >= Int(rect.y0)) & (py < Int(rect.y1))).bits();
}

}  // namespace gnomon
