// Values at pixels and samples from the planes of a primitive. D3D11.3 15.16.2, 16.4, 3.5.5
//
// Depth and the barycentrics of vertices 1 and 2 are planes in (dx, dy), the exact offset from vertex 0. The specification
// leaves the rounding of plane equations open; barycentrics keep constant attributes constant.
#pragma once

#include "pipeline/primitive.h"
#include "pipeline/samples.h"
#include "pipeline/wave.h"
#include "sim/double_lanes.h"

namespace gnomon {

/// How a varying is carried to the pixel functor. D3D11.3 16.4
enum class Interpolation : std::uint8_t {
    Perspective,          // "linear": of attribute / w and 1 / w, at the pixel centre
    PerspectiveCentroid,  // at the centroid. D3D11.3 3.5.5
    PerspectiveSample,    // at the sample; the functor then runs once per sample. D3D11.3 3.5.4
    Linear,               // "linear_noperspective": linear on the screen
    LinearCentroid,
    LinearSample,
    Flat,  // "constant": the provoking vertex's. D3D11.3 16.4, 8.14
};

constexpr bool is_centroid(Interpolation how) {
    return how == Interpolation::PerspectiveCentroid || how == Interpolation::LinearCentroid;
}
constexpr bool is_at_sample(Interpolation how) {
    return how == Interpolation::PerspectiveSample || how == Interpolation::LinearSample;
}
constexpr bool is_linear(Interpolation how) {
    return how == Interpolation::Linear || how == Interpolation::LinearCentroid || how == Interpolation::LinearSample;
}

/// A varyings struct names its modes, one per scalar in order, as `static constexpr std::array interpolation{...}`; without it
/// all are Perspective.
template <class Varyings>
constexpr Interpolation interpolation_of(std::size_t scalar) {
    if constexpr (requires { Varyings::interpolation; }) {
        return Varyings::interpolation[scalar];
    } else {
        (void)scalar;
        return Interpolation::Perspective;
    }
}

/// Exact offsets of positions from vertex 0, in pixels.
template <class Real>
struct PixelOffset {
    Real dx, dy;
};

/// Of the position (x, y) in 1/256 of each pixel.
template <class Real>
GNOMON_INLINE PixelOffset<Real> pixel_offset(const PixelLanes& pixels, Int x, Int y, std::int32_t x0, std::int32_t y0) {
    const Real subpixel(1.0f / kSubpixels);
    return {Real(shift_left<kSubpixelBits>(pixels.x) + (x - Int(x0))) * subpixel,
            Real(shift_left<kSubpixelBits>(pixels.y) + (y - Int(y0))) * subpixel};
}
/// The same in a row of quads, with less to compute.
template <class Real>
GNOMON_INLINE PixelOffset<Real> pixel_offset(const QuadRow& row, std::int32_t x, std::int32_t y, std::int32_t x0,
                                             std::int32_t y0) {
    const Real subpixel(1.0f / kSubpixels);
    return {Real(shift_left<kSubpixelBits>(lane_dx()) + Int(row.x * kSubpixels + x - x0)) * subpixel,
            Real(shift_left<kSubpixelBits>(lane_dy()) + Int(row.y * kSubpixels + y - y0)) * subpixel};
}
template <class Real>
GNOMON_INLINE PixelOffset<Real> centre_offset(const PixelLanes& pixels, std::int32_t x0, std::int32_t y0) {
    return pixel_offset<Real>(pixels, Int(kSubpixels / 2), Int(kSubpixels / 2), x0, y0);
}
template <class Real>
GNOMON_INLINE PixelOffset<Real> sample_offset(const PixelLanes& pixels, const SamplePosition& at, std::int32_t x0,
                                              std::int32_t y0) {
    return pixel_offset<Real>(pixels, Int(at.x * kSampleGrid), Int(at.y * kSampleGrid), x0, y0);
}
template <class Real>
GNOMON_INLINE PixelOffset<Real> sample_offset(const QuadRow& row, const SamplePosition& at, std::int32_t x0, std::int32_t y0) {
    return pixel_offset<Real>(row, at.x * kSampleGrid, at.y * kSampleGrid, x0, y0);
}

/// The centroid: the centre of pixels that are covered whole, else the first sample that is covered and in the sample mask; in
/// helper pixels the first sample of a partial sample mask, else the centre. D3D11.3 3.5.5
/// In 1/256 of each pixel.
inline PixelLanes centroid_position(const Wave& wave, const SamplePattern& pattern, std::uint32_t sample_mask) {
    const Int centre(kSubpixels / 2);
    Int x = centre;
    Int y = centre;
    const std::uint32_t wanted = sample_mask & pattern.all();
    if (wanted != pattern.all() && wanted != 0) {
        const SamplePosition& first = pattern.at[static_cast<std::size_t>(std::countr_zero(wanted))];
        x = Int(first.x * kSampleGrid);
        y = Int(first.y * kSampleGrid);
    }
    std::uint32_t whole = kAllLanes;
    for (int s = pattern.count - 1; s >= 0; --s) {
        const auto i = static_cast<std::size_t>(s);
        whole &= wave.samples.covered[i];
        if ((wanted >> s & 1u) == 0) continue;
        const Mask covered = Mask::from_bits(wave.samples.covered[i]);
        x = select(covered, Int(pattern.at[i].x * kSampleGrid), x);
        y = select(covered, Int(pattern.at[i].y * kSampleGrid), y);
    }
    const Mask all = Mask::from_bits(whole);
    return {select(all, centre, x), select(all, centre, y)};
}

/// Depth at an offset from the origin of its plane, in the order of operations of the profile. Each operation rounds
/// monotonically, so the extremes over a rectangle are at its corners.
template <class Real, class Scalar>
GNOMON_INLINE Real interpolate_depth(const Primitive<Scalar>& p, const PixelOffset<Real>& at, PlaneEquations equations) {
    switch (equations) {
        case PlaneEquations::Barycentric: break;
        case PlaneEquations::Llvmpipe:
            return fused_multiply_add(Real(p.z_dy), at.dy, fused_multiply_add(Real(p.z_dx), at.dx, Real(p.z0)));
        case PlaneEquations::SwiftShader: return at.dx * Real(p.z_dx) + (Real(p.z0) + at.dy * Real(p.z_dy));
    }
    return Real(p.z0) + (at.dx * Real(p.z_dx) + at.dy * Real(p.z_dy));
}

/// Depth at a position inside each pixel (of a PixelLanes or a QuadRow), with the bias of a profile that adds it to every
/// fragment.
template <class Real, class Scalar, class Pixels>
GNOMON_INLINE Real fragment_depth(const Primitive<Scalar>& p, const Pixels& pixels, const SamplePosition& at,
                                  PlaneEquations equations) {
    const Real z = interpolate_depth(p, sample_offset<Real>(pixels, at, p.z_origin.x, p.z_origin.y), equations);
    return p.z_bias != Scalar(0) ? z + Real(p.z_bias) : z;
}

/// Barycentrics of vertices 1 and 2: linear on the screen, and perspective-correct with w.
template <class Real>
struct LinearBarycentrics {
    Real l1, l2;
};
template <class Real>
struct Barycentrics {
    Real b1, b2, w;
};

template <class Real, class Scalar>
GNOMON_INLINE LinearBarycentrics<Real> interpolate_linear(const Primitive<Scalar>& p, const PixelOffset<Real>& at) {
    return {at.dx * Real(p.l1_dx) + at.dy * Real(p.l1_dy), at.dx * Real(p.l2_dx) + at.dy * Real(p.l2_dy)};
}
template <class Real, class Scalar>
GNOMON_INLINE Barycentrics<Real> interpolate_barycentrics(const Primitive<Scalar>& p, const LinearBarycentrics<Real>& l) {
    const Real inv_w = Real(p.inv_w[0]) + (l.l1 * Real(p.inv_w[1] - p.inv_w[0]) + l.l2 * Real(p.inv_w[2] - p.inv_w[0]));
    const Real w = Real(Scalar(1)) / inv_w;
    return {l.l1 * Real(p.inv_w[1]) * w, l.l2 * Real(p.inv_w[2]) * w, w};
}

/// A position that varyings are evaluated at.
template <class Real>
struct EvaluationPoint {
    LinearBarycentrics<Real> linear;
    Barycentrics<Real> perspective;
};

template <class Real, class Scalar>
GNOMON_INLINE EvaluationPoint<Real> evaluation_point(const Primitive<Scalar>& p, const PixelOffset<Real>& at) {
    const LinearBarycentrics<Real> linear = interpolate_linear(p, at);
    return {linear, interpolate_barycentrics(p, linear)};
}

/// One varying at the position its mode asks for.
template <Interpolation kHow, class Real, class Scalar>
GNOMON_INLINE Real interpolate(const Primitive<Scalar>& p, std::size_t i, const EvaluationPoint<Real>& at) {
    if constexpr (kHow == Interpolation::Flat) {
        return Real(p.flat[i]);
    } else {
        const Scalar a0 = p.varyings[0][i];
        const Real d1(p.varyings[1][i] - a0);
        const Real d2(p.varyings[2][i] - a0);
        if constexpr (is_linear(kHow)) {
            return Real(a0) + (at.linear.l1 * d1 + at.linear.l2 * d2);
        } else {
            return Real(a0) + (at.perspective.b1 * d1 + at.perspective.b2 * d2);
        }
    }
}

/// Varyings of a wave as the pixel functor sees them; `Varyings` is a struct of Reals. Points that no mode asks for may be any.
template <class Varyings, class Real, class Scalar>
GNOMON_INLINE Varyings interpolate_varyings(const Primitive<Scalar>& p, const EvaluationPoint<Real>& centre,
                                            const EvaluationPoint<Real>& centroid, const EvaluationPoint<Real>& sample) {
    if constexpr (std::is_empty_v<Varyings>) {
        return Varyings{};
    } else {
        static_assert(sizeof(Varyings) % sizeof(Real) == 0);
        return [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
            const auto value = [&]<std::size_t kScalar>(std::integral_constant<std::size_t, kScalar>) {
                constexpr Interpolation kHow = interpolation_of<Varyings>(kScalar);
                return interpolate<kHow>(p, kScalar, is_at_sample(kHow) ? sample : is_centroid(kHow) ? centroid : centre);
            };
            const std::array<Real, sizeof...(kIndex)> values{value(std::integral_constant<std::size_t, kIndex>{})...};
            return std::bit_cast<Varyings>(values);
        }(std::make_index_sequence<sizeof(Varyings) / sizeof(Real)>());
    }
}

/// All modes of a varyings struct.
template <class Varyings, class Real>
constexpr auto interpolations() {
    return []<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
        return std::array<Interpolation, sizeof...(kIndex)>{interpolation_of<Varyings>(kIndex)...};
    }(std::make_index_sequence<sizeof(Varyings) / sizeof(Real)>());
}

/// The modes that decide how a functor is run.
template <class Varyings, class Real>
constexpr bool any_interpolation(bool (*is)(Interpolation)) {
    bool found = false;
    if constexpr (!std::is_empty_v<Varyings>)
        for (std::size_t i = 0; i < sizeof(Varyings) / sizeof(Real); ++i) found = found || is(interpolation_of<Varyings>(i));
    return found;
}

}  // namespace gnomon
