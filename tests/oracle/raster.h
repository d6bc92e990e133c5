// Which pixel centres a triangle covers, and the documented depth plane: the slow way, one pixel and one edge at a time, on
// exact integers. D3D11.3 3.4.1, 3.4.2.1, 15.6
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace oracle {

/// A vertex on the snapped grid, 1/256 pixel.
struct Point {
    std::int64_t x, y;

    bool operator==(const Point&) const = default;
};

/// Twice the signed area of p, q, r; positive when they turn clockwise on a screen whose y points down.
inline std::int64_t turn(const Point& p, const Point& q, const Point& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

/// Whether s belongs to the side of line pq on which r lies. On the line itself the top-left rule decides: a top edge is
/// exactly horizontal with the triangle below it; a left edge is not horizontal and has the triangle to its right.
/// D3D11.3 3.4.2.1
inline bool on_inner_side(const Point& p, const Point& q, const Point& r, const Point& s) {
    const std::int64_t inner = turn(p, q, r);
    const std::int64_t here = turn(p, q, s);
    if (here != 0) return (here > 0) == (inner > 0);
    if (p.y == q.y) return r.y > p.y;
    // x of the line at r's row against r.x, without dividing.
    const Point& upper = p.y < q.y ? p : q;
    const Point& lower = p.y < q.y ? q : p;
    return (lower.x - upper.x) * (r.y - upper.y) < (r.x - upper.x) * (lower.y - upper.y);
}

/// Whether the triangle owns the point.
inline bool covers(const std::array<Point, 3>& t, const Point& s) {
    if (turn(t[0], t[1], t[2]) == 0) return false;
    return on_inner_side(t[0], t[1], t[2], s) && on_inner_side(t[1], t[2], t[0], s) && on_inner_side(t[2], t[0], t[1], s);
}

/// Whether it owns the centre of pixel (x, y).
inline bool covers_pixel(const std::array<Point, 3>& t, int x, int y) {
    return covers(t, {std::int64_t{x} * 256 + 128, std::int64_t{y} * 256 + 128});
}

/// Viewport transform of one axis in fp32 as D3D11.3 15.6 writes it (`ndc` grows to the right or downwards), then the nearest
/// multiple of 2^-bits, ties to even. D3D11.3 3.4.1
inline std::int64_t snap(float ndc, int origin, int size, int bits) {
    const float position = (ndc + 1.0f) * static_cast<float>(size) * 0.5f + static_cast<float>(origin);
    const double scaled = static_cast<double>(position) * static_cast<double>(1 << bits);
    double whole = std::floor(scaled);
    const double rest = scaled - whole;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<std::int64_t>(whole) * (256 >> bits);
}

/// The depth plane of pipeline/interpolate.h and triangle.h in the arithmetic it documents: slopes from exact integers in
/// double, rounded once; then z0 + (dx z_dx + dy z_dy) in fp32 over the offset from vertex 0.
struct DepthPlane {
    Point origin;
    float z0, z_dx, z_dy;

    DepthPlane(std::array<Point, 3> t, std::array<float, 3> z) {
        // Clockwise order, vertex 0 stays.
        if (turn(t[0], t[1], t[2]) < 0) {
            std::swap(t[1], t[2]);
            std::swap(z[1], z[2]);
        }
        const double per_pixel = 256.0 / static_cast<double>(turn(t[0], t[1], t[2]));
        const double l1_dx = static_cast<double>(t[2].y - t[0].y) * per_pixel;
        const double l1_dy = static_cast<double>(t[0].x - t[2].x) * per_pixel;
        const double l2_dx = static_cast<double>(t[0].y - t[1].y) * per_pixel;
        const double l2_dy = static_cast<double>(t[1].x - t[0].x) * per_pixel;
        const auto d1 = static_cast<double>(z[1] - z[0]);
        const auto d2 = static_cast<double>(z[2] - z[0]);
        origin = t[0];
        z0 = z[0];
        z_dx = static_cast<float>(d1 * l1_dx + d2 * l2_dx);
        z_dy = static_cast<float>(d1 * l1_dy + d2 * l2_dy);
    }

    [[nodiscard]] float at(int x, int y) const {
        const float dx = static_cast<float>(std::int64_t{x} * 256 + 128 - origin.x) * (1.0f / 256.0f);
        const float dy = static_cast<float>(std::int64_t{y} * 256 + 128 - origin.y) * (1.0f / 256.0f);
        return z0 + (dx * z_dx + dy * z_dy);
    }
};

/// floor(z (2^bits - 1) + 1/2) for z clamped to [0, 1], NaN as 0, on integers only. D3D11.3 3.2.3.6
inline std::uint32_t unorm_code(float z, int bits) {
    if (!(z > 0.0f)) return 0;
    if (z >= 1.0f) return (1u << bits) - 1u;
    int exponent = 0;
    const float fraction = std::frexp(z, &exponent);  // z = fraction 2^exponent, fraction in [1/2, 1)
    const auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 24));
    const int shift = 24 - exponent;  // z = mantissa / 2^shift, shift >= 24
    if (shift > 62) return 0;         // far below half of the smallest code
    const unsigned __int128 scaled = static_cast<unsigned __int128>(mantissa) * ((1u << bits) - 1u);
    const unsigned __int128 half = static_cast<unsigned __int128>(1) << (shift - 1);
    return static_cast<std::uint32_t>((scaled + half) >> shift);
}

}  // namespace oracle
