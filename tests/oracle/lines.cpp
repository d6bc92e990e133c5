// Diamonds, line rectangles and point squares on exact integers. D3D11.3 3.4.3, 3.4.5, 3.4.6
#include "tests/oracle/lines.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace oracle {

namespace {

using Wide = __int128;

constexpr std::int64_t kHalf = 128;

/// A point relative to a pixel's centre.
struct Offset {
    std::int64_t u, v;
};

Offset offset(const Pixel& pixel, const Point& p) {
    return {p.x - (std::int64_t{pixel.x} * 256 + kHalf), p.y - (std::int64_t{pixel.y} * 256 + kHalf)};
}

/// Whether some t in [0, 1] has f0 + t (f1 - f0) < kHalf for all four sums: the segment meets the open diamond.
bool meets_inside(const Offset& a, const Offset& b) {
    // The open interval (low, high) of t, as fractions with positive denominators; the segment's own ends are included.
    Wide low_n = -1, low_d = 1, high_n = 2, high_d = 1;
    for (const std::int64_t su : {1, -1})
        for (const std::int64_t sv : {1, -1}) {
            const Wide f0 = su * a.u + sv * a.v - kHalf;
            const Wide slope = su * (b.u - a.u) + sv * (b.v - a.v);
            if (slope == 0) {
                if (f0 >= 0) return false;
                continue;
            }
            // f0 + t slope < 0
            const Wide n = slope > 0 ? -f0 : f0;
            const Wide d = slope > 0 ? slope : -slope;
            if (slope > 0 && n * high_d < high_n * d) {
                high_n = n;
                high_d = d;
            }
            if (slope < 0 && n * low_d > low_n * d) {
                low_n = n;
                low_d = d;
            }
        }
    return low_n * high_d < high_n * low_d && low_n < low_d && high_n > 0;
}

/// Whether the segment meets the lower edge u side + v = kHalf, bottom corner included, outer corner as told.
bool meets_lower_edge(const Offset& a, const Offset& b, int side, bool with_corner) {
    const auto on_edge = [&](Wide u_n, Wide d) {  // u = u_n / d, measured towards the outer corner
        return u_n >= 0 && (with_corner ? u_n <= kHalf * d : u_n < kHalf * d);
    };
    const Wide f0 = side * a.u + a.v - kHalf;
    const Wide f1 = side * b.u + b.v - kHalf;
    if (f0 == f1) {
        if (f0 != 0) return false;
        // Along the edge's line: the interval of u against [0, kHalf) or [0, kHalf].
        const Wide near = std::min(side * a.u, side * b.u);
        const Wide far = std::max(side * a.u, side * b.u);
        return far >= 0 && (with_corner ? near <= kHalf : near < kHalf);
    }
    // t = f0 / (f0 - f1)
    Wide n = f0;
    Wide d = f0 - f1;
    if (d < 0) {
        n = -n;
        d = -d;
    }
    if (n < 0 || n > d) return false;
    return on_edge(side * (a.u * d + n * (b.u - a.u)), d);
}

bool meets_diamond(const Point& a, const Point& b, const Pixel& pixel, bool y_major) {
    const Offset from = offset(pixel, a);
    const Offset to = offset(pixel, b);
    return meets_inside(from, to) || meets_lower_edge(from, to, 1, y_major) || meets_lower_edge(from, to, -1, false);
}

/// ceil(n / d) - 1, d > 0: the cell (k, k + 1] that holds n / d.
std::int64_t cell(Wide n, Wide d) {
    Wide q = n / d;
    if (n % d > 0) ++q;
    return static_cast<std::int64_t>(q) - 1;
}

/// The pixel whose diamond holds p: one of the four around it, or none (false).
bool diamond_at(const Point& p, bool y_major, Pixel& found) {
    for (int dy = -1; dy <= 0; ++dy)
        for (int dx = -1; dx <= 0; ++dx) {
            const Pixel pixel{static_cast<int>((p.x >> 8) + dx), static_cast<int>((p.y >> 8) + dy)};
            if (in_diamond(pixel, p, y_major)) {
                found = pixel;
                return true;
            }
        }
    return false;
}

/// The sign of (at + 0.7 * 65536 d / sqrt(length2)) - twice / 2, by squares: 0.7 * 65536 = 7 * 2^15 / 5.
int compare_corner(std::int64_t at, std::int64_t d, Wide length2, std::int64_t twice) {
    const std::int64_t distance = twice - 2 * at;
    if (d == 0 || distance == 0 || (d > 0) != (distance > 0)) {
        const std::int64_t difference = d != 0 ? d : -distance;
        return difference > 0 ? 1 : difference < 0 ? -1 : 0;
    }
    const Wide moved = (Wide{d} * d * 49) << 32;
    const Wide limit = Wide{distance} * distance * 25 * length2;
    const int longer = moved > limit ? 1 : moved < limit ? -1 : 0;
    return d > 0 ? longer : -longer;
}

/// One coordinate of a corner on the grid: at + 0.7 * 65536 d / sqrt(length2) to the nearest multiple of 256, ties to even.
std::int64_t snapped_corner(std::int64_t at, std::int64_t d, Wide length2) {
    // Search upwards from below; the estimate only saves steps.
    const double estimate =
        static_cast<double>(at) + 45875.2 * static_cast<double>(d) / std::sqrt(static_cast<double>(length2));
    auto k = static_cast<std::int64_t>(std::floor(estimate / 256)) - 2;
    while (compare_corner(at, d, length2, 2 * (k * 256) + 256) > 0) ++k;
    const bool tie = compare_corner(at, d, length2, 2 * (k * 256) + 256) == 0;
    return tie && k % 2 != 0 ? k + 1 : k;
}

}  // namespace

bool is_y_major(const Point& a, const Point& b) { return std::llabs(b.y - a.y) > std::llabs(b.x - a.x); }

bool in_diamond(const Pixel& pixel, const Point& p, bool y_major) {
    const auto [u, v] = offset(pixel, p);
    const std::int64_t distance = std::llabs(u) + std::llabs(v);
    if (distance != kHalf) return distance < kHalf;
    return v > 0 || (y_major && u == kHalf);
}

bool line_draws(const Point& a, const Point& b, const Pixel& pixel) {
    if (a == b) return false;
    const bool y_major = is_y_major(a, b);
    return meets_diamond(a, b, pixel, y_major) && !in_diamond(pixel, b, y_major);
}

std::vector<Pixel> aliased_line(const Point& a, const Point& b, const PixelRect& rect) {
    const auto pixel = [](std::int64_t grid) { return static_cast<int>(grid >> 8); };
    const PixelRect near{pixel(std::min(a.x, b.x)) - 1, pixel(std::min(a.y, b.y)) - 1, pixel(std::max(a.x, b.x)) + 2,
                         pixel(std::max(a.y, b.y)) + 2};
    const PixelRect asked = intersection(rect, near);
    std::vector<Pixel> drawn;
    for (int y = asked.top; y < asked.bottom; ++y)
        for (int x = asked.left; x < asked.right; ++x)
            if (line_draws(a, b, {x, y})) drawn.push_back({x, y});
    return drawn;
}

std::vector<Pixel> aliased_line_by_crossings(const Point& a, const Point& b, const PixelRect& rect) {
    if (a == b) return {};
    const bool y_major = is_y_major(a, b);
    // m runs along the major axis, n across it.
    const auto m = [&](const Point& p) { return y_major ? p.y : p.x; };
    const auto n = [&](const Point& p) { return y_major ? p.x : p.y; };
    std::vector<Pixel> drawn;
    const Point& first = m(a) < m(b) ? a : b;
    const Point& last = m(a) < m(b) ? b : a;
    // Columns or rows of the rectangle whose centres lie between the ends; m(first) < m(last) also where |dx| = |dy|.
    const std::int64_t begin = std::max<std::int64_t>((m(first) - kHalf + 255) >> 8, y_major ? rect.top : rect.left);
    const std::int64_t end_of_rect = y_major ? rect.bottom : rect.right;
    for (std::int64_t k = begin; k * 256 + kHalf <= m(last) && k < end_of_rect; ++k) {
        const Wide d = m(last) - m(first);
        const Wide across = Wide{n(first)} * d + Wide{n(last) - n(first)} * (k * 256 + kHalf - m(first));
        const std::int64_t other = cell(across, d * 256);
        drawn.push_back(y_major ? Pixel{static_cast<int>(other), static_cast<int>(k)}
                                : Pixel{static_cast<int>(k), static_cast<int>(other)});
    }
    Pixel end{};
    if (diamond_at(a, y_major, end)) drawn.push_back(end);
    const bool ends_inside = diamond_at(b, y_major, end);
    std::erase_if(drawn, [&](const Pixel& p) { return (ends_inside && p == end) || !rect.contains(p.x, p.y); });
    std::sort(drawn.begin(), drawn.end(), [](const Pixel& p, const Pixel& q) { return p.y != q.y ? p.y < q.y : p.x < q.x; });
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
    return drawn;
}

std::array<Point, 4> line_rectangle(const FinePoint& a, const FinePoint& b) {
    const std::int64_t dx = b.x - a.x;
    const std::int64_t dy = b.y - a.y;
    // Without length there is no direction: one point, four times.
    const Wide length2 = std::max<Wide>(Wide{dx} * dx + Wide{dy} * dy, 1);
    const auto corner = [&](const FinePoint& p, int sign) {
        return Point{snapped_corner(p.x, sign * dy, length2), snapped_corner(p.y, -sign * dx, length2)};
    };
    return {corner(a, 1), corner(b, 1), corner(b, -1), corner(a, -1)};
}

std::array<Point, 4> point_square(const Point& center) {
    return {Point{center.x - kHalf, center.y - kHalf}, Point{center.x + kHalf, center.y - kHalf},
            Point{center.x + kHalf, center.y + kHalf}, Point{center.x - kHalf, center.y + kHalf}};
}

Masks quadrilateral_coverage(const std::array<Point, 4>& corners, const PixelRect& rect, const SamplePattern& pattern) {
    Masks masks(rect);
    add_coverage(masks, {corners[0], corners[1], corners[2]}, pattern);
    add_coverage(masks, {corners[0], corners[2], corners[3]}, pattern);
    return masks;
}

}  // namespace oracle
