// Cures for the quad that straddles two splits: its lanes would take texture coordinates from two unrelated projections, and
// the difference of the two, which is the filter's size, would mean nothing. [PSVSM] "Texture coordinate derivatives"
#pragma once

#include "sim/enum_names.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "texunit/lod.h"

namespace gnomon::techniques {

enum class SeamCure {
    None,                  // each lane its own split, derivatives across the seam
    QuadMin,               // one split per quad: log2 of the difference of 2^split. [PSVSM]
    QuadMax,               // the same, one more
    QuadBroadcast,         // one split per quad: that of its top-left lane
    ExplicitGradients,     // each lane its own split; derivatives of every projection are taken first, then one is chosen
    DerivativeOfPosition,  // each lane its own split; derivatives of the position under the light, transformed by that split
    SampleAll,             // every split is sampled by all lanes, then one sample is chosen
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::SeamCure>{
    EnumName{techniques::SeamCure::None, "none"},
    EnumName{techniques::SeamCure::QuadMin, "quad-min"},
    EnumName{techniques::SeamCure::QuadMax, "quad-max"},
    EnumName{techniques::SeamCure::QuadBroadcast, "quad-broadcast"},
    EnumName{techniques::SeamCure::ExplicitGradients, "explicit-gradients"},
    EnumName{techniques::SeamCure::DerivativeOfPosition, "derivative-of-position"},
    EnumName{techniques::SeamCure::SampleAll, "sample-all"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// The largest difference of 2^split in the quad as derivative instructions show it: in x, in y, and in x of that in y. Of two
/// neighbours with splits x and x + 1 both compute 2^(x+1) - 2^x = 2^x. [PSVSM]
template <class F, class Real = typename F::Real>
Real power_difference(const F& f, const Real& split) {
    const Real power = f.exp2(split);
    const Real dx = abs(f.ddx(power));
    const Real dy = abs(f.ddy(power));
    const Real dxy = abs(f.ddx(dy));
    return max(dxy, max(dx, dy));
}

/// The smaller of two neighbouring splits in all lanes of a quad: log2(2^x) = x. [PSVSM]
///
/// Splits x and x + k differ by 2^x (2^k - 1): rounded, the logarithm is x for k = 1, x + 2 for k = 2 (log2 3 = 1.58) and x + k
/// beyond. Lanes agree where the quad has two splits and the derivatives see both: coarse ones do not read the lane opposite
/// to their corner. tests/techniques/psvsm_trick.cpp has all 4096 quads.
template <class F, class Real = typename F::Real>
Real quad_min_split(const F& f, const Real& split) {
    const Real difference = power_difference(f, split);
    const Real common = floor(f.log2(difference) + Real(0.5f));
    return select(difference > Real(0.0f), common, split);
}

/// The larger: 2^(x+k-1) <= 2^x (2^k - 1) < 2^(x+k) for every k >= 1, so that one more than the whole part of the logarithm is
/// x + k however far apart two splits are. Up to split 7 the logarithm stays 0.011 below x + k, so 1/512 on top of it keeps a
/// logarithm that is a little off, as those of hardware may be, from falling below a whole number.
template <class F, class Real = typename F::Real>
Real quad_max_split(const F& f, const Real& split) {
    const Real difference = power_difference(f, split);
    const Real common = floor(f.log2(difference) + Real(0x1p-9f)) + Real(1.0f);
    return select(difference > Real(0.0f), common, split);
}

/// Derivatives of s/q and t/q from those of s, t and q. (s/q)' = (s' - (s/q) q') / q
template <class F, class Real = typename F::Real>
Gradients<Real> projected_gradients(const F& f) {
    const auto& light = f.in.light;
    const Real inv_q = f.rcp(light.w);
    const Real u = light.x * inv_q;
    const Real v = light.y * inv_q;
    const Real qx = f.ddx(light.w);
    const Real qy = f.ddy(light.w);
    return {{(f.ddx(light.x) - u * qx) * inv_q, (f.ddx(light.y) - v * qx) * inv_q},
            {(f.ddy(light.x) - u * qy) * inv_q, (f.ddy(light.y) - v * qy) * inv_q}};
}

}  // namespace gnomon::techniques
