// Values at pixel centres from the planes of a triangle. D3D11.3 15.16.2, 3.5.6
//
// Depth and the barycentrics of vertices 1 and 2 are planes in (dx, dy), the exact offset of the pixel centre from vertex 0.
// The specification leaves the rounding of plane equations open; barycentrics keep constant attributes constant.
#pragma once

#include "pipeline/triangle.h"
#include "pipeline/wave.h"
#include "sim/double_lanes.h"

namespace gnomon {

/// Exact offsets of pixel centres from vertex 0, in pixels.
template <class Real>
struct PixelOffset {
    Real dx, dy;
};

template <class Real>
PixelOffset<Real> pixel_offset(const Wave& wave, std::int32_t x0, std::int32_t y0) {
    const Int x = shift_left<kSubpixelBits>(wave.x) + Int(kSubpixels / 2 - x0);
    const Int y = shift_left<kSubpixelBits>(wave.y) + Int(kSubpixels / 2 - y0);
    const Real subpixel(1.0f / kSubpixels);
    return {Real(x) * subpixel, Real(y) * subpixel};
}

template <class Real, class Scalar>
Real interpolate_depth(const Triangle<Scalar>& t, const PixelOffset<Real>& p) {
    return Real(t.z0) + (p.dx * Real(t.z_dx) + p.dy * Real(t.z_dy));
}

/// The same expression at one point. Each operation rounds monotonically, so its extremes over a rectangle are at the corners.
template <class Scalar>
Scalar depth_at(const Triangle<Scalar>& t, int x, int y) {
    const auto offset = [](int pixel, std::int32_t origin) {
        return static_cast<Scalar>(pixel * kSubpixels + kSubpixels / 2 - origin) * Scalar(1.0 / kSubpixels);
    };
    return t.z0 + (offset(x, t.x0) * t.z_dx + offset(y, t.y0) * t.z_dy);
}

/// Perspective-correct barycentrics of vertices 1 and 2, and w.
template <class Real>
struct Barycentrics {
    Real b1, b2, w;
};

template <class Real, class Scalar>
Barycentrics<Real> interpolate_barycentrics(const Triangle<Scalar>& t, const PixelOffset<Real>& p) {
    const Real l1 = p.dx * Real(t.l1_dx) + p.dy * Real(t.l1_dy);
    const Real l2 = p.dx * Real(t.l2_dx) + p.dy * Real(t.l2_dy);
    const Real inv_w = Real(t.inv_w[0]) + (l1 * Real(t.inv_w[1] - t.inv_w[0]) + l2 * Real(t.inv_w[2] - t.inv_w[0]));
    const Real w = Real(Scalar(1)) / inv_w;
    return {l1 * Real(t.inv_w[1]) * w, l2 * Real(t.inv_w[2]) * w, w};
}

/// Varyings of a wave as the pixel functor sees them; `Varyings` is a struct of Reals.
template <class Varyings, class Real, class Scalar>
Varyings interpolate_varyings(const Triangle<Scalar>& t, const Barycentrics<Real>& b) {
    if constexpr (std::is_empty_v<Varyings>) {
        return Varyings{};
    } else {
        static_assert(sizeof(Varyings) % sizeof(Real) == 0);
        std::array<Real, sizeof(Varyings) / sizeof(Real)> values;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const Scalar a0 = t.varyings[0][i];
            values[i] = Real(a0) + (b.b1 * Real(t.varyings[1][i] - a0) + b.b2 * Real(t.varyings[2][i] - a0));
        }
        return std::bit_cast<Varyings>(values);
    }
}

}  // namespace gnomon
