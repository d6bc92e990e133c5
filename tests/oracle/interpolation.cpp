// Exact barycentrics, running error bounds, depth bias. D3D11.3 3.5.5, 15.5, 15.10, 15.16.2, 16.5.3
#include "tests/oracle/interpolation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace oracle {

namespace {

using Real = long double;

/// Half an ULP of 1 in fp32, and what is lost below the normal range.
constexpr Real kUnit = 0x1p-24L;
constexpr Real kFlushed = 0x1p-126L;

/// The result of one operation that was given inexact operands.
Rounded rounded(Real value, Real inherited, int roundings = 1) {
    const Real reach = std::fabs(value) + inherited;
    // Results that are zero for sure lose nothing.
    return reach == 0 ? Rounded{} : Rounded{value, inherited + roundings * kUnit * reach + kFlushed};
}

/// Changes of the barycentrics of vertices 1 and 2 per pixel.
struct Gradients {
    Real l1_dx, l1_dy, l2_dx, l2_dy;
};

Gradients gradients(const SnappedTriangle& t) {
    const Real per_pixel = 256 / static_cast<Real>(turn(t[0], t[1], t[2]));
    return {static_cast<Real>(t[2].y - t[0].y) * per_pixel, static_cast<Real>(t[0].x - t[2].x) * per_pixel,
            static_cast<Real>(t[0].y - t[1].y) * per_pixel, static_cast<Real>(t[1].x - t[0].x) * per_pixel};
}

Rounded pixels(std::int64_t grid) { return Rounded::nearest(static_cast<Real>(grid) / 256); }

}  // namespace

Point pixel_center(int x, int y) { return {std::int64_t{x} * 256 + 128, std::int64_t{y} * 256 + 128}; }

Point centroid_point(int x, int y, std::uint32_t covered, std::uint32_t sample_mask, const SamplePattern& pattern) {
    const std::uint32_t mask = sample_mask & pattern.all();
    if ((covered & pattern.all()) == pattern.all()) return pixel_center(x, y);
    const std::uint32_t candidates = (covered & mask) != 0 ? covered & mask : mask != pattern.all() ? mask : 0;
    return candidates == 0 ? pixel_center(x, y) : pattern.at(x, y, std::countr_zero(candidates));
}

Point snapped_offset_point(int x, int y, int dx, int dy) {
    const auto four_bits = [](int v) { return ((v & 15) ^ 8) - 8; };
    const Point center = pixel_center(x, y);
    return {center.x + four_bits(dx) * 16, center.y + four_bits(dy) * 16};
}

Barycentric barycentric(const SnappedTriangle& t, const Point& p) {
    return {{turn(p, t[1], t[2]), turn(t[0], p, t[2]), turn(t[0], t[1], p)}, turn(t[0], t[1], t[2])};
}

long double linear(const Barycentric& b, const std::array<float, 3>& v) {
    Real sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += static_cast<Real>(b.weight[i]) * static_cast<Real>(v[i]);
    return sum / static_cast<Real>(b.area);
}

long double perspective(const Barycentric& b, const std::array<float, 3>& v, const std::array<float, 3>& w) {
    Real sum = 0;
    Real inverse = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real part = static_cast<Real>(b.weight[i]) / static_cast<Real>(w[i]);
        sum += part * static_cast<Real>(v[i]);
        inverse += part;
    }
    return sum / inverse;
}

long double perspective_w(const Barycentric& b, const std::array<float, 3>& w) {
    Real inverse = 0;
    for (std::size_t i = 0; i < 3; ++i) inverse += static_cast<Real>(b.weight[i]) / static_cast<Real>(w[i]);
    return static_cast<Real>(b.area) / inverse;
}

long double line_parameter(const Point& a, const Point& b, const Point& p) {
    const std::int64_t dx = b.x - a.x;
    const std::int64_t dy = b.y - a.y;
    return static_cast<Real>((p.x - a.x) * dx + (p.y - a.y) * dy) / static_cast<Real>(dx * dx + dy * dy);
}

Slopes slopes(const SnappedTriangle& t, const std::array<float, 3>& v) {
    const Gradients g = gradients(t);
    const Real d1 = static_cast<Real>(v[1]) - static_cast<Real>(v[0]);
    const Real d2 = static_cast<Real>(v[2]) - static_cast<Real>(v[0]);
    return {d1 * g.l1_dx + d2 * g.l2_dx, d1 * g.l1_dy + d2 * g.l2_dy};
}

Rounded Rounded::exactly(float v) { return {static_cast<Real>(v), 0}; }

Rounded Rounded::nearest(long double v) {
    return static_cast<Real>(static_cast<float>(v)) == v ? Rounded{v, 0} : Rounded{v, kUnit * std::fabs(v) + kFlushed};
}

bool Rounded::allows(float v) const { return std::fabs(static_cast<Real>(v) - value) <= error; }

Rounded operator+(const Rounded& a, const Rounded& b) { return rounded(a.value + b.value, a.error + b.error); }
Rounded operator-(const Rounded& a, const Rounded& b) { return rounded(a.value - b.value, a.error + b.error); }
Rounded operator*(const Rounded& a, const Rounded& b) {
    return rounded(a.value * b.value, std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error);
}

Rounded divide(const Rounded& a, const Rounded& b, int roundings) {
    const Real least = std::fabs(b.value) - b.error;
    if (!(least > 0)) return {0, std::numeric_limits<Real>::infinity()};
    const Real quotient = a.value / b.value;
    return rounded(quotient, (a.error + std::fabs(quotient) * b.error) / least, roundings);
}

Rounded plane_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const Point& p, std::size_t origin,
                    long double slope_error) {
    const SnappedTriangle u{t[origin], t[(origin + 1) % 3], t[(origin + 2) % 3]};
    const std::array<float, 3> values{v[origin], v[(origin + 1) % 3], v[(origin + 2) % 3]};
    // Differences may have been rounded before the slopes were made of them.
    const Rounded d1 = Rounded::nearest(static_cast<Real>(values[1]) - static_cast<Real>(values[0]));
    const Rounded d2 = Rounded::nearest(static_cast<Real>(values[2]) - static_cast<Real>(values[0]));
    const Gradients g = gradients(u);
    const auto slope = [&](Real g1, Real g2) {
        Rounded s = Rounded::nearest(d1.value * g1 + d2.value * g2);
        s.error += d1.error * std::fabs(g1) + d2.error * std::fabs(g2);
        s.error += slope_error * (std::fabs(d1.value * g1) + std::fabs(d2.value * g2));
        return s;
    };
    const Rounded along_x = pixels(p.x - u[0].x) * slope(g.l1_dx, g.l2_dx);
    const Rounded along_y = pixels(p.y - u[0].y) * slope(g.l1_dy, g.l2_dy);
    return Rounded::exactly(values[0]) + (along_x + along_y);
}

namespace {

/// Barycentrics of vertices 1 and 2, linear on the screen.
struct LinearWeights {
    Rounded l1, l2;

    LinearWeights(const SnappedTriangle& t, const Point& p) {
        const Gradients g = gradients(t);
        const Rounded dx = pixels(p.x - t[0].x);
        const Rounded dy = pixels(p.y - t[0].y);
        l1 = dx * Rounded::nearest(g.l1_dx) + dy * Rounded::nearest(g.l1_dy);
        l2 = dx * Rounded::nearest(g.l2_dx) + dy * Rounded::nearest(g.l2_dy);
    }
};

/// v0 + (b1 (v1 - v0) + b2 (v2 - v0)).
Rounded weighted(const std::array<Rounded, 3>& v, const Rounded& b1, const Rounded& b2) {
    return v[0] + (b1 * (v[1] - v[0]) + b2 * (v[2] - v[0]));
}

std::array<Rounded, 3> numbers(const std::array<float, 3>& v) {
    return {Rounded::exactly(v[0]), Rounded::exactly(v[1]), Rounded::exactly(v[2])};
}

std::array<Rounded, 3> reciprocals(const std::array<float, 3>& w, int division_roundings) {
    std::array<Rounded, 3> inverse;
    for (std::size_t i = 0; i < 3; ++i) inverse[i] = divide(Rounded::exactly(1.0f), Rounded::exactly(w[i]), division_roundings);
    return inverse;
}

}  // namespace

Rounded linear_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const Point& p) {
    const LinearWeights l(t, p);
    return weighted(numbers(v), l.l1, l.l2);
}

Rounded perspective_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const std::array<float, 3>& w,
                          const Point& p, int division_roundings) {
    const LinearWeights l(t, p);
    const std::array<Rounded, 3> inverse = reciprocals(w, division_roundings);
    const Rounded w_here = divide(Rounded::exactly(1.0f), weighted(inverse, l.l1, l.l2), division_roundings);
    return weighted(numbers(v), l.l1 * inverse[1] * w_here, l.l2 * inverse[2] * w_here);
}

Rounded perspective_w_bound(const SnappedTriangle& t, const std::array<float, 3>& w, const Point& p) {
    const LinearWeights l(t, p);
    return divide(Rounded::exactly(1.0f), weighted(reciprocals(w, 1), l.l1, l.l2));
}

long double max_depth_slope(const SnappedTriangle& t, const std::array<float, 3>& z) {
    const Slopes s = slopes(t, z);
    return std::max(std::fabs(s.dx), std::fabs(s.dy));
}

long double bias_value(const DepthBias& bias, DepthKind kind, long double max_slope, float max_abs_z) {
    const auto step = [&]() -> Real {
        switch (kind) {
            case DepthKind::Unorm16: return static_cast<Real>(static_cast<float>(1.0 / 65535.0));
            case DepthKind::Unorm24: return static_cast<Real>(static_cast<float>(1.0 / 16777215.0));
            case DepthKind::Float32:
                return max_abs_z < std::numeric_limits<float>::min() ? 0 : std::ldexp(1.0L, std::ilogb(max_abs_z) - 23);
        }
        return 0;
    };
    Real value = static_cast<Real>(bias.constant) * step();
    if (bias.slope_scaled != 0) value += static_cast<Real>(bias.slope_scaled) * max_slope;
    const auto clamp = static_cast<Real>(bias.clamp);
    if (clamp > 0) value = std::min(clamp, value);
    if (clamp < 0) value = std::max(clamp, value);
    return value;
}

}  // namespace oracle
