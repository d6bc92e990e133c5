// A clipped polygon, snapped to the grid, as triangles that share no pixel: ear clipping on exact integers.
//
// Clipping leaves a convex polygon, snapping can bend it by a grid step, and then the pieces of a plain fan overlap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// A position on the 16.8 grid, 1/256 pixel.
struct GridPoint {
    std::int32_t x = 0;
    std::int32_t y = 0;

    bool operator==(const GridPoint&) const = default;
};

/// Twice the signed area, positive when a, b, c turn clockwise with y down.
inline std::int64_t signed_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

/// Corners of the triangles as indices into `polygon`, in its own winding. Together they cover the polygon once; corners that
/// span no area make no triangle.
std::vector<std::array<std::size_t, 3>> triangulate(std::span<const GridPoint> polygon);

}  // namespace gnomon
