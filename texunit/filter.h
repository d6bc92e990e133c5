// Texels to a value: bilinear within a level, linear between levels, the mean over probes. D3D11.3 7.18.8, 7.18.10, 5.9.4.5.6
#pragma once

#include "sim/profile.h"
#include "texunit/footprint.h"

#include <array>
#include <limits>

namespace gnomon {

/// a (1 - w) + b w with a term of weight 0 left out: what is left of an infinity. D3D11.3 7.18.8, 7.18.16.2
template <class Real>
Real weighted_sum(const Real& a, const Real& b, const Real& weight) {
    const Real zero(0.0f);
    const Real rest = Real(1.0f) - weight;
    return select(rest > zero, a * rest, zero) + select(weight > zero, b * weight, zero);
}

/// a + w (b - a), which keeps constants constant and is monotone in w, as D3D11.3 7.18.16.3 asks and the sum of products does
/// not (DEVIATION(D3D11.3 7.18.8), tests/spec/s07_18_16_invariants.cpp; BilinearForm::Products is that sum). Where that is not
/// finite (infinities cancel in it, differences overflow), the weighted sum decides.
template <class Real>
GNOMON_INLINE Real lerp(const Real& a, const Real& b, const Real& weight) {
    const Real result = a + weight * (b - a);
    const Mask finite = abs(result) < Real(std::numeric_limits<float>::infinity());
    if (all(finite)) [[likely]]
        return result;
    return select(finite, result, weighted_sum(a, b, weight));
}

/// How one instruction combines taps and levels.
struct Blend {
    BilinearForm form = BilinearForm::Lerp;
    TexelCarry carry = TexelCarry::Texel;
    bool rounds_to_codes = false;  // operands are 8-bit codes and results are rounded to codes. UnormFilter::Llvmpipe
};

/// a (1 - w) + b w for codes: the weight cut to 8 bits, the product rounded. Mesa 22.3.6 lp_bld_arit.c, lp_build_lerp_simple
template <class Real>
Real rounded_lerp(const Real& a, const Real& b, const Real& weight) {
    const Real steps = floor(weight * Real(256.0f));
    return a + floor((steps * (b - a) + Real(128.0f)) * Real(1.0f / 256.0f));
}

/// By what `Tap` knows when it is compiled, the rest by `how`.
template <class Tap, class Real>
GNOMON_INLINE Real blend(const Real& a, const Real& b, const Real& weight, const Blend& how) {
    if constexpr (Tap::kIsFinite) return a + weight * (b - a);
    if constexpr (Tap::kStandard) return lerp(a, b, weight);
    if (how.rounds_to_codes) [[unlikely]]
        return rounded_lerp(a, b, weight);
    switch (how.form) {
        case BilinearForm::Lerp: return lerp(a, b, weight);
        case BilinearForm::Products: return a * (Real(1.0f) - weight) + b * weight;
        case BilinearForm::PlainLerp: return a + weight * (b - a);
        case BilinearForm::FusedLerp: return fused_multiply_add(weight, b - a, a);
    }
    __builtin_unreachable();
}

/// The texels of a footprint, component by component.
template <std::size_t kCount, class Value>
using Texels = std::array<std::array<Value, kCount>, 4>;

/// Where a cube has no texel, the mean of its three neighbours or of the adjacent two stands in. D3D11.3 7.18.12
template <std::size_t kCount, class Real>
[[gnu::noinline]] void fill_corners(const Footprint<Real>& f, CubeCorner rule, Texels<kCount, Real>& t) {
    const Texels<kCount, Real> faces = t;
    const bool three = rule == CubeCorner::ThreeTexels;
    const Real third(3.0f);
    const Real half(0.5f);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t c = 0; c < kCount; ++c) {
            // As the first plus differences, so that equal texels stay what they are.
            const Real& beside = faces[i ^ 1][c];
            const Real& above = faces[i ^ 2][c];
            const Real& across = faces[i ^ 3][c];
            const Real mean =
                three ? beside + ((above - beside) + (across - beside)) / third : beside + (above - beside) * half;
            // Where differences overflow or infinities meet, the shares themselves.
            const Real shares = three ? (beside / third + above / third) + across / third : beside * half + above * half;
            t[i][c] = select(f.corner[i], select(mean - mean == Real(0.0f), mean, shares), t[i][c]);
        }
    }
}

/// What `tap(byte_offset, outside)` returns for the texels of a footprint.
template <std::size_t kCount, class Value, class Real, class Tap>
GNOMON_INLINE Texels<kCount, Value> read_texels(const Footprint<Real>& f, CubeCorner corner_rule, const Tap& tap) {
    if (!f.linear) {
        Texels<kCount, Value> t;
        t[0] = tap(f.offset[0], f.outside[0]);
        return t;
    }
    Texels<kCount, Value> t{tap(f.offset[0], f.outside[0]), tap(f.offset[1], f.outside[1]), tap(f.offset[2], f.outside[2]),
                            tap(f.offset[3], f.outside[3])};
    if constexpr (!std::is_same_v<Value, Int>) {
        if (f.has_corner) [[unlikely]]
            fill_corners(f, corner_rule, t);
    }
    return t;
}

/// D3D11.3 7.18.8. Lanes of weight 1 (TexelCarry::Weight) get the right or lower texel exactly.
template <class Tap, std::size_t kCount, class Real>
GNOMON_INLINE std::array<Real, kCount> bilinear(const Texels<kCount, Real>& t, const Real& u, const Real& v, const Blend& how) {
    std::array<Real, kCount> result;
    const Real one(1.0f);
    const bool carries = how.carry == TexelCarry::Weight;
#pragma GCC unroll 4
    for (std::size_t c = 0; c < kCount; ++c) {
        if (Tap::kStandard || how.form != BilinearForm::Products || how.rounds_to_codes) {
            Real left = t[0][c];
            Real left_below = t[2][c];
            if (carries) {
                left = select(u == one, t[1][c], left);
                left_below = select(u == one, t[3][c], left_below);
            }
            Real upper = blend<Tap>(left, t[1][c], u, how);
            const Real lower = blend<Tap>(left_below, t[3][c], u, how);
            if (carries) upper = select(v == one, lower, upper);
            result[c] = blend<Tap>(upper, lower, v, how);
        } else {
            const Real floor_u = one - u;
            const Real floor_v = one - v;
            result[c] = ((t[0][c] * floor_u * floor_v + t[2][c] * floor_u * v) + t[1][c] * u * floor_v) + t[3][c] * u * v;
        }
    }
    return result;
}

/// The smallest or largest of the texels whose weight is not 0. D3D11.3 5.9.4.5.6
template <std::size_t kCount, class Real>
std::array<Real, kCount> extreme(const Texels<kCount, Real>& t, const Real& u, const Real& v, Reduction reduction) {
    const Real zero(0.0f);
    const Real one(1.0f);
    const std::array<Mask, 4> counts{(u < one) & (v < one), (u > zero) & (v < one), (u < one) & (v > zero),
                                     (u > zero) & (v > zero)};
    std::array<Real, kCount> result;
    for (std::size_t c = 0; c < kCount; ++c) {
        result[c] = Real(std::numeric_limits<float>::quiet_NaN());  // loses against every number
        for (std::size_t i = 0; i < 4; ++i) {
            const Real candidate = reduction == Reduction::Minimum ? min(result[c], t[i][c]) : max(result[c], t[i][c]);
            result[c] = select(counts[i], candidate, result[c]);
        }
    }
    return result;
}

/// Two levels. Weight 0 gives exactly `fine`, so that a coarser level that nobody needs cannot leak its NaN in.
/// D3D11.3 7.18.10, 7.18.16.2
template <class Tap, std::size_t kCount, class Real>
GNOMON_INLINE std::array<Real, kCount> mix_levels(const std::array<Real, kCount>& fine, const std::array<Real, kCount>& coarse,
                                                  const Real& fraction, Reduction reduction, const Blend& how) {
    std::array<Real, kCount> result;
#pragma GCC unroll 4
    for (std::size_t c = 0; c < kCount; ++c) {
        const Real mixed = Tap::kStandard || reduction == Reduction::Average ? blend<Tap>(fine[c], coarse[c], fraction, how)
                           : reduction == Reduction::Minimum                 ? min(fine[c], coarse[c])
                                                                             : max(fine[c], coarse[c]);
        result[c] = select(fraction > Real(0.0f), mixed, fine[c]);
    }
    return result;
}

/// The mean of probes one at a time: m + (x - m) / k keeps constants constant and stays between smallest and largest; where it
/// is not finite (infinities meet, differences overflow), the sum of x / N decides.
template <std::size_t kCount, class Real>
class ProbeMean {
public:
    explicit ProbeMean(Reduction reduction) : reduction_(reduction) {}

    /// Lanes not in `active` have had their last probe.
    GNOMON_INLINE void add(const std::array<Real, kCount>& probe, const Real& weight, Mask active) {
        const Real share = Real(1.0f) / Real(static_cast<float>(++count_));
        for (std::size_t c = 0; c < kCount; ++c) {
            Real next = probe[c];
            if (count_ > 1) {
                next = reduction_ == Reduction::Average   ? mean_[c] + (probe[c] - mean_[c]) * share
                       : reduction_ == Reduction::Minimum ? min(mean_[c], probe[c])
                                                          : max(mean_[c], probe[c]);
                mean_[c] = select(active, next, mean_[c]);
                sum_[c] = select(active, sum_[c] + probe[c] * weight, sum_[c]);
            } else {
                mean_[c] = next;
                sum_[c] = probe[c] * weight;
            }
        }
    }
    [[nodiscard]] std::array<Real, kCount> mean() const {
        if (reduction_ != Reduction::Average) return mean_;
        std::array<Real, kCount> result = mean_;
        for (std::size_t c = 0; c < kCount; ++c) {
            const Mask finite = abs(mean_[c]) < Real(std::numeric_limits<float>::infinity());
            if (!all(finite)) result[c] = select(finite, mean_[c], sum_[c]);
        }
        return result;
    }

private:
    Reduction reduction_;
    int count_ = 0;
    std::array<Real, kCount> mean_;
    std::array<Real, kCount> sum_;
};

}  // namespace gnomon
