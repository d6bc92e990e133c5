// Polygons as SwiftShader fills them: every edge gives the rows it crosses a left or a right end, the last one that does.
// SwiftShader SetupRoutine.cpp (its scanline conversion has exact remainders)
//
// Of a convex polygon this is the top-left rule (D3D11.3 3.4.2.1). Clipping leaves a convex polygon, snapping can bend it.
#pragma once

#include "pipeline/line.h"
#include "pipeline/samples.h"

#include <algorithm>
#include <utility>

namespace gnomon {

/// The pixels in `area`, a part of the tile at (tile_x, tile_y), whose sample at `at` the polygon covers.
inline TileBits outline_coverage(const Outline& outline, const SamplePosition& at, const PixelRect& area, int tile_x,
                                 int tile_y) {
    const auto rounded_up = [](std::int64_t n, std::int64_t d) { return n > 0 ? (n + d - 1) / d : -(-n / d); };
    const std::int64_t offset_x = std::int64_t{at.x} * kSampleGrid;
    const std::int64_t offset_y = std::int64_t{at.y} * kSampleGrid;
    std::array<std::int64_t, kTileSize> left{};
    std::array<std::int64_t, kTileSize> right{};
    const std::size_t count = outline.points.size();
    for (std::size_t i = 0; i < count; ++i) {
        GridPoint a = outline.points[i];
        GridPoint b = outline.points[(i + 1) % count];
        if (!outline.counter_clockwise) std::swap(a, b);
        if (a.y == b.y) continue;
        const bool is_right = b.y < a.y;
        if (is_right) std::swap(a, b);

        // Rows from the first sample at or below its upper end to the last above its lower one.
        const std::int64_t dx = std::int64_t{b.x} - a.x;
        const std::int64_t dy = std::int64_t{b.y} - a.y;
        const std::int64_t first = std::max<std::int64_t>(rounded_up(a.y - offset_y, kSubpixels), area.y0);
        const std::int64_t end = std::min<std::int64_t>(rounded_up(b.y - offset_y, kSubpixels), area.y1);
        for (std::int64_t y = first; y < end; ++y) {
            const std::int64_t along = y * kSubpixels + offset_y - a.y;
            const std::int64_t x = rounded_up((a.x - offset_x) * dy + dx * along, dy * kSubpixels);
            (is_right ? right : left)[static_cast<std::size_t>(y - tile_y)] = std::clamp<std::int64_t>(x, area.x0, area.x1);
        }
    }

    TileBits bits;
    for (int y = area.y0; y < area.y1; ++y) {
        const auto row = static_cast<std::size_t>(y - tile_y);
        for (std::int64_t x = left[row]; x < right[row]; ++x) bits.set(static_cast<int>(x) - tile_x, y - tile_y, true);
    }
    return bits;
}

}  // namespace gnomon
