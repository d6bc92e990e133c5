// Level of detail: from the derivatives of the coordinates to a pair of mip levels. D3D11.3 7.18.10, 7.18.11
#pragma once

#include "sim/math.h"
#include "sim/profile.h"
#include "sim/quad.h"
#include "sim/vec.h"
#include "texunit/sampler.h"

namespace gnomon {

/// Isotropic level of detail of texture coordinates, before bias and clamp: log2 of the longer of the two derivative vectors
/// in texels of level 0. Implicit derivatives are the coarse ones. D3D11.3 7.18.11, 22.4.15
template <class Real>
GNOMON_INLINE Real implicit_lod(const Vec2<Real>& uv, int width, int height, const Profile& profile) {
    const Real w(static_cast<float>(width));
    const Real h(static_cast<float>(height));
    const bool shared = profile.lod_sharing == LodSharing::Quad;
    const Vec2<Real> dx{(shared ? ddx_coarse(uv.x) : ddx_fine(uv.x)) * w, (shared ? ddx_coarse(uv.y) : ddx_fine(uv.y)) * h};
    const Vec2<Real> dy{(shared ? ddy_coarse(uv.x) : ddy_fine(uv.x)) * w, (shared ? ddy_coarse(uv.y) : ddy_fine(uv.y)) * h};
    return Real(0.5f) * log2(max(dot(dx, dx), dot(dy, dy)));  // log2 of a length from its square
}

/// The levels a sample reads.
template <class Real>
struct LevelPair {
    Mask magnify;   // the level of detail is at most 0 after the clamp: the mag filter
    Int level;      // the finer level
    Real fraction;  // weight of the next coarser level, [0, 1); 0 unless the mip filter is linear
};

/// Bias, clamp, conversion to fixed point and choice of levels. NaN becomes the sampler's upper clamp, as IEEE min has it.
template <class Real>
GNOMON_INLINE LevelPair<Real> select_levels(const Real& lod, const Sampler& sampler, int levels, const Profile& profile) {
    // Bias and clamp; D3D11.3 7.18.11: max(MinLOD, min(MaxLOD, LOD)), and then what the texture has.
    Real clamped = max(Real(sampler.min_lod), min(Real(sampler.max_lod), lod + Real(sampler.lod_bias)));
    const int bits = profile.lod_fraction_bits;
    if (bits != kExactBits) {
        const Real scale(static_cast<float>(1 << bits));
        const Real limited = clamp(clamped, Real(-1000.0f), Real(1000.0f));
        clamped = Real(bounded_round_to_int(limited * scale)) / scale;
    }
    LevelPair<Real> pair{.magnify = clamped <= Real(0.0f), .level = Int(0), .fraction = Real(0.0f)};
    if (sampler.mip == MipFilter::Base) return pair;

    const Real last(static_cast<float>(levels - 1));
    const Real available = clamp(clamped, Real(0.0f), last);
    if (sampler.mip == MipFilter::Nearest) {
        pair.level = bounded_truncate_to_int(available + Real(0.5f));  // D3D11.3 7.18.10
        pair.level = min(pair.level, Int(levels - 1));
    } else {
        const Real whole = floor(available);
        pair.level = bounded_truncate_to_int(whole);
        pair.fraction = available - whole;
    }
    return pair;
}

}  // namespace gnomon
