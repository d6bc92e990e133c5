// Level of detail: from the derivatives of the coordinates to a pair of mip levels. D3D11.3 7.18.10, 7.18.11
#pragma once

#include "sim/math.h"
#include "sim/profile.h"
#include "sim/quad.h"
#include "sim/vec.h"
#include "texunit/sampler.h"
#include "texunit/view.h"

#include <limits>

namespace gnomon {

/// Derivatives of normalised coordinates per pixel.
template <class Real>
struct Gradients {
    Vec2<Real> dx;
    Vec2<Real> dy;
};

/// Of the quad each lane is in: coarse ones where the profile lets a quad share its level of detail. D3D11.3 22.4.15
template <class Real>
GNOMON_INLINE Gradients<Real> quad_gradients(const Vec2<Real>& uv, const Profile& profile) {
    if (profile.lod_sharing == LodSharing::Quad)
        return {{ddx_coarse(uv.x, profile.derivative_corner), ddx_coarse(uv.y, profile.derivative_corner)},
                {ddy_coarse(uv.x, profile.derivative_corner), ddy_coarse(uv.y, profile.derivative_corner)}};
    return {{ddx_fine(uv.x), ddx_fine(uv.y)}, {ddy_fine(uv.x), ddy_fine(uv.y)}};
}
/// Lanes whose gradients it takes from a lane of `bits`.
inline std::uint32_t quad_gradients_readers(std::uint32_t bits, const Profile& profile) {
    if (profile.lod_sharing == LodSharing::Quad)
        return ddx_coarse_readers(bits, profile.derivative_corner) | ddy_coarse_readers(bits, profile.derivative_corner);
    return ddx_fine_readers(bits) | ddy_fine_readers(bits);
}

/// log2(x) / 2 of x >= 0 with the mantissa for its logarithm. Mesa 22.3.6, lp_bld_arit.c, lp_build_fast_log2
inline Float half_log2_linear(Float x) {
    const Float finite = select(x < Float(std::numeric_limits<float>::infinity()), x, Float(0.0f));
    const Int bits = bits_of(finite);
    const Float exponent(shift_right_logical<23>(bits) - Int(128));
    return (exponent + float_of_bits((bits & Int(0x007fffff)) | Int(0x3f800000))) * Float(0.5f);
}
/// The same from x^2, whose bits as an integer are that logarithm. SwiftShader, SamplerCore.cpp, log2sqrt
inline Float half_log2_linear_of_square(Float x) { return (Float(bits_of(x * x)) - Float(1065353216.0f)) * Float(0x1p-25f); }

/// Level of detail of a squared scale factor, by the profile's logarithm.
template <class Real>
GNOMON_INLINE Real lod_of_square(const Real& squared, Log2Model model) {
    switch (model) {
        case Log2Model::Exact: return Real(0.5f) * log2(squared);
        case Log2Model::Linear2: return Real(half_log2_linear(to_float(squared)));
        case Log2Model::Linear4: return Real(half_log2_linear_of_square(to_float(squared)));
    }
    __builtin_unreachable();
}

/// What the derivatives say about a sample.
template <class Real>
struct LevelOfDetail {
    Real lod;                  // before bias and clamp
    bool anisotropic = false;  // only then the members below mean something
    Real ratio;                // of anisotropy, after its limit; at least 1
    Vec2<Real> major;          // line of the probes, from end to end, normalised coordinates
    Vec2<Real> minor;          // the ellipse's other axis after the limit: what elliptical filters take
    Int probes;                // 1 to 16

    LevelOfDetail(const Real& level) : lod(level) {}  // isotropic: sample_l
};

/// Isotropic level of detail of derivatives in texels of level 0: log2 of the profile's scale factor. D3D11.3 7.18.11
template <class Real>
GNOMON_INLINE Real isotropic_lod(const Vec2<Real>& dx, const Vec2<Real>& dy, const Profile& profile) {
    switch (profile.lod_rule) {
        case LodRule::Longest: return lod_of_square(max(dot(dx, dx), dot(dy, dy)), profile.log2_model);
        case LodRule::Box: {
            const Real longest = max(max(abs(dx.x), abs(dx.y)), max(abs(dy.x), abs(dy.y)));
            return lod_of_square(longest * longest, profile.log2_model);
        }
        case LodRule::Area: return lod_of_square(abs(dx.x * dy.y - dx.y * dy.x), profile.log2_model);
    }
    __builtin_unreachable();
}

/// The levels a sample reads.
template <class Real>
struct LevelPair {
    Mask magnify;   // the level of detail is at most 0 after the clamp: the mag filter
    Int level;      // the finer level, of the view
    Real fraction;  // weight of the next coarser level, [0, 1); 0 unless the mip filter is linear
    Real clamped;   // the level of detail after bias, clamp and conversion to fixed point
};

/// Conversion to the profile's fixed point, for levels within +-1000.
template <class Real>
GNOMON_INLINE Real quantised_lod(const Real& lod, const Profile& profile) {
    const int bits = profile.lod_fraction_bits;
    if (bits == kExactBits) return lod;
    const Real scale(static_cast<float>(1 << bits));
    const Real shifted = clamp(lod, Real(-1000.0f), Real(1000.0f)) * scale;
    const Int fixed = profile.lod_rounding == FixedRounding::NearestEven ? bounded_round_to_int(shifted)
                                                                         : bounded_truncate_to_int(floor(shifted));
    return Real(fixed) / scale;
}

/// The nearest whole level of a level of detail that is not negative. D3D11.3 7.18.10
template <class Real>
GNOMON_INLINE Int nearest_level(const Real& lod, MipTie tie) {
    switch (tie) {
        case MipTie::Up: {  // not lod + 1/2, which rounds to 1 just below 1/2
            const Real whole = floor(lod);
            return bounded_truncate_to_int(whole) + select(lod - whole >= Real(0.5f), Int(1), Int(0));
        }
        case MipTie::Down: return Int(0) - bounded_truncate_to_int(floor(Real(0.5f) - lod));  // ceil(lod + 1/2) - 1
        case MipTie::Even: return bounded_round_to_int(lod);
    }
    __builtin_unreachable();
}

/// Bias, clamp, conversion to fixed point and choice of levels; min or mag is decided after the conversion, for which 7.18.10
/// ("if not already in fixed point form") leaves room. NaN becomes the sampler's upper clamp, as IEEE min has it.
/// `bias` is the instruction's. D3D11.3 7.18.10, 7.18.11, 5.8
template <class Real>
GNOMON_INLINE LevelPair<Real> select_levels(const Real& lod, const Real& bias, const Sampler& sampler, const TextureView& view,
                                            const Profile& profile) {
    // D3D11.3 7.18.11: max(MinLOD, min(MaxLOD, LOD)), then the resource's own lower limit.
    const Real biased = (lod + Real(sampler.lod_bias)) + bias;
    const Real limited = max(Real(sampler.min_lod), min(Real(sampler.max_lod), biased));
    const Real clamped = quantised_lod(max(Real(view.min_lod()), limited), profile);
    LevelPair<Real> pair{.magnify = clamped <= Real(0.0f), .level = Int(0), .fraction = Real(0.0f), .clamped = clamped};
    if (sampler.mip == MipFilter::Base) return pair;

    const Int last(view.levels() - 1);
    const Real available = clamp(clamped, Real(0.0f), Real(last));
    if (sampler.mip == MipFilter::Nearest) {
        pair.level = clamp(nearest_level(available, profile.mip_tie), Int(0), last);
    } else {
        const Real whole = floor(available);
        pair.level = bounded_truncate_to_int(whole);
        pair.fraction = available - whole;
    }
    return pair;
}

}  // namespace gnomon
