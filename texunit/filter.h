// Taps to a value: bilinear within a level, linear between levels. D3D11.3 7.18.8, 7.18.10
#pragma once

#include "sim/profile.h"
#include "texunit/footprint.h"

#include <array>

namespace gnomon {

/// a (1 - w) + b w with a term of weight 0 left out: what is left of an infinity. D3D11.3 7.18.8, 7.18.16.2
template <class Real>
Real weighted_sum(const Real& a, const Real& b, const Real& weight) {
    const Real zero(0.0f);
    const Real rest = Real(1.0f) - weight;
    return select(rest > zero, a * rest, zero) + select(weight > zero, b * weight, zero);
}

/// a + w (b - a), which keeps constants constant and is monotone in w. D3D11.3 7.18.16.3
/// Where that makes a NaN (infinities cancel in it), the weighted sum decides.
template <class Real>
GNOMON_INLINE Real lerp(const Real& a, const Real& b, const Real& weight) {
    const Real result = a + weight * (b - a);
    const Mask nan = is_nan(result);
    if (none(nan)) [[likely]]
        return result;
    return select(nan, weighted_sum(a, b, weight), result);
}

/// Filters what `tap(byte_offset, outside)` returns for the texels of a footprint, component by component.
template <std::size_t kCount, class Real, class Tap>
GNOMON_INLINE std::array<Real, kCount> filter_footprint(const Footprint<Real>& f, BilinearForm form, const Tap& tap) {
    if (!f.linear) return tap(f.column[0] + f.row[0], f.column_outside[0] | f.row_outside[0]);

    const auto at = [&](std::size_t x, std::size_t y) {
        return tap(f.column[x] + f.row[y], f.column_outside[x] | f.row_outside[y]);
    };
    const auto t00 = at(0, 0);
    const auto t10 = at(1, 0);
    const auto t01 = at(0, 1);
    const auto t11 = at(1, 1);

    std::array<Real, kCount> result;
    for (std::size_t c = 0; c < kCount; ++c) {
        if (form == BilinearForm::Lerp) {
            result[c] = lerp(lerp(t00[c], t10[c], f.fraction_u), lerp(t01[c], t11[c], f.fraction_u), f.fraction_v);
        } else {
            const Real floor_u = Real(1.0f) - f.fraction_u;
            const Real floor_v = Real(1.0f) - f.fraction_v;
            result[c] = ((t00[c] * floor_u * floor_v + t01[c] * floor_u * f.fraction_v) + t10[c] * f.fraction_u * floor_v) +
                        t11[c] * f.fraction_u * f.fraction_v;
        }
    }
    return result;
}

/// Weight 0 gives exactly `fine`, so that a coarser level that nobody needs cannot leak its NaN in. D3D11.3 7.18.16.2
template <std::size_t kCount, class Real>
GNOMON_INLINE std::array<Real, kCount> mix_levels(const std::array<Real, kCount>& fine, const std::array<Real, kCount>& coarse,
                                                  const Real& fraction) {
    std::array<Real, kCount> result;
    for (std::size_t c = 0; c < kCount; ++c)
        result[c] = select(fraction > Real(0.0f), lerp(fine[c], coarse[c], fraction), fine[c]);
    return result;
}

}  // namespace gnomon
