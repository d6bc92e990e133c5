#include "pipeline/triangulate.h"

#include <algorithm>

namespace gnomon {

namespace {

/// Whether p lies in or on triangle a, b, c of the winding `sign`.
bool inside(const GridPoint& p, const GridPoint& a, const GridPoint& b, const GridPoint& c, std::int64_t sign) {
    return sign * signed_area(a, b, p) >= 0 && sign * signed_area(b, c, p) >= 0 && sign * signed_area(c, a, p) >= 0;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> triangulate(std::span<const GridPoint> polygon) {
    // Its winding: the sign of the whole area.
    std::int64_t area = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) area += signed_area(polygon[0], polygon[i], polygon[i + 1]);
    std::vector<std::array<std::size_t, 3>> triangles;
    if (area == 0) return triangles;
    const std::int64_t sign = area > 0 ? 1 : -1;

    // Cut off corners that turn with the polygon and hold no other corner, until a triangle is left.
    std::vector<std::size_t> left(polygon.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
    while (left.size() >= 3) {
        bool cut = false;
        for (std::size_t i = 0; i < left.size() && !cut; ++i) {
            const std::array<std::size_t, 3> ear{left[(i + left.size() - 1) % left.size()], left[i],
                                                 left[(i + 1) % left.size()]};
            const GridPoint& a = polygon[ear[0]];
            const GridPoint& b = polygon[ear[1]];
            const GridPoint& c = polygon[ear[2]];
            const std::int64_t turn = sign * signed_area(a, b, c);
            if (turn < 0) continue;
            const bool empty = turn == 0 || std::ranges::none_of(left, [&](std::size_t other) {
                                   const GridPoint& p = polygon[other];
                                   return p != a && p != b && p != c && inside(p, a, b, c, sign);
                               });
            if (!empty) continue;
            if (turn > 0) triangles.push_back(ear);
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
            cut = true;
        }
        if (!cut) break;  // it crosses itself: slivers below a grid step
    }
    return triangles;
}

}  // namespace gnomon
