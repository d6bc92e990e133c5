// Sizes of the raster hierarchy: tiles are binned and run in parallel, blocks are tested against hierarchical depth.
#pragma once

#include "sim/lanes.h"

namespace gnomon {

inline constexpr int kTileSize = 64;                           // pixels per side
inline constexpr int kBlockSize = 8;                           // pixels per side
inline constexpr int kBlocksPerTile = kTileSize / kBlockSize;  // in a row, and rows
inline constexpr int kBlockRowBits = 3;
static_assert(kBlocksPerTile == 1 << kBlockRowBits);

/// A wave covers a row of quads inside a block.
inline constexpr int kWaveWidth = 2 * kQuadsPerWave;  // pixels
inline constexpr int kWaveHeight = 2;                 // pixels
static_assert(kWaveWidth <= kBlockSize);

/// Pixels [x0, x1) x [y0, y1).
struct PixelRect {
    int x0 = 0;
    int y0 = 0;
    int x1 = 0;
    int y1 = 0;

    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
};

inline PixelRect intersect(const PixelRect& a, const PixelRect& b) {
    return {a.x0 > b.x0 ? a.x0 : b.x0, a.y0 > b.y0 ? a.y0 : b.y0, a.x1 < b.x1 ? a.x1 : b.x1, a.y1 < b.y1 ? a.y1 : b.y1};
}

}  // namespace gnomon
