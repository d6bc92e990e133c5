// Aliased lines: the pixels whose diamond the line leaves. D3D11.3 3.4.3
//
// The figure of 3.4.3 is given in words by "Rasterization Rules" (Direct3D 11 documentation): the diamond |u| + |v| < 1/2
// around a pixel centre owns its two lower edges and its bottom corner, for y-major lines its right corner too; a line covers
// the pixel if it meets the diamond and does not end in it.
#pragma once

#include "pipeline/primitive.h"

#include <cstdint>

namespace gnomon {

/// The pixels of one tile, a bit each.
struct TileBits {
    std::array<std::uint64_t, kTileSize> rows{};

    /// Those of the row of quads whose first pixel is (x, y).
    [[nodiscard]] std::uint32_t lanes(int x, int y) const {
        std::uint32_t lanes = 0;
        for (int q = 0; q < kQuadsPerWave; ++q) {
            const auto pair = [&](int row) {
                return static_cast<std::uint32_t>(rows[static_cast<std::size_t>(row)] >> (x + 2 * q) & 3u);
            };
            lanes |= (pair(y) | pair(y + 1) << 2) << (4 * q);
        }
        return lanes;
    }

    void set(int x, int y, bool value) {
        const std::uint64_t bit = std::uint64_t{1} << x;
        rows[static_cast<std::size_t>(y)] =
            value ? rows[static_cast<std::size_t>(y)] | bit : rows[static_cast<std::size_t>(y)] & ~bit;
    }
};

/// The pixels in `area`, a part of the tile at (tile_x, tile_y), that the line covers.
inline TileBits line_coverage(const GridPoint& from, const GridPoint& to, const PixelRect& area, int tile_x, int tile_y) {
    TileBits bits;
    constexpr std::int64_t kHalf = kSubpixels / 2;
    const std::int64_t dx = std::int64_t{to.x} - from.x;
    const std::int64_t dy = std::int64_t{to.y} - from.y;
    const bool y_major = std::abs(dy) > std::abs(dx);
    const auto set = [&](std::int64_t x, std::int64_t y, bool value) {
        if (x >= area.x0 && x < area.x1 && y >= area.y0 && y < area.y1)
            bits.set(static_cast<int>(x) - tile_x, static_cast<int>(y) - tile_y, value);
    };
    const auto floor_div = [](std::int64_t n, std::int64_t d) {
        return n / d - static_cast<std::int64_t>((n % d != 0) && ((n < 0) != (d < 0)));
    };

    // Where the line crosses the centre of a column (row), it crosses one diamond there: the one that holds (top, bottom] or,
    // of y-major lines, (left, right] of that position.
    const auto crossing = [&](std::int64_t centre, std::int64_t major0, std::int64_t d_major, std::int64_t minor0,
                              std::int64_t d_minor) {
        const std::int64_t numerator = minor0 * d_major + (centre - major0) * d_minor;  // position * d_major
        // ceil(position / 256) - 1
        return -floor_div(-numerator, d_major * kSubpixels) - 1;
    };
    if (y_major) {
        const auto [low, high] = std::minmax(from.y, to.y);
        for (std::int64_t y = area.y0; y < area.y1; ++y) {
            const std::int64_t centre = y * kSubpixels + kHalf;
            if (centre >= low && centre <= high) set(crossing(centre, from.y, dy, from.x, dx), y, true);
        }
    } else {
        const auto [low, high] = std::minmax(from.x, to.x);
        for (std::int64_t x = area.x0; x < area.x1; ++x) {
            const std::int64_t centre = x * kSubpixels + kHalf;
            if (centre >= low && centre <= high) set(x, crossing(centre, from.x, dx, from.y, dy), true);
        }
    }

    // It also leaves the diamond it starts in, and never the one it ends in.
    const auto set_diamond_of = [&](const GridPoint& p, bool value) {
        const std::int64_t px = p.x >> kSubpixelBits;
        const std::int64_t py = p.y >> kSubpixelBits;
        for (std::int64_t y = py - 1; y <= py; ++y) {
            for (std::int64_t x = px - 1; x <= px; ++x) {
                const std::int64_t u = p.x - (x * kSubpixels + kHalf);
                const std::int64_t v = p.y - (y * kSubpixels + kHalf);
                const std::int64_t distance = std::abs(u) + std::abs(v);
                if (distance < kHalf || (distance == kHalf && (v > 0 || (y_major && u == kHalf)))) set(x, y, value);
            }
        }
    };
    set_diamond_of(from, true);
    set_diamond_of(to, false);
    return bits;
}

}  // namespace gnomon
