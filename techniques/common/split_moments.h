// Two numbers in four components: each as a coarse part and the rest, which filters leave whole. [Donnelly06] 5.3 ("splitting
// each 32-bit float into two 16-bit floats ... and recombining them after the texture lookup"); [Lauritzen07] 8.5.2
#pragma once

#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "sim/vec.h"
#include "techniques/common/moments.h"

namespace gnomon::techniques {

/// x = coarse + fine / factor, with coarse a multiple of 1 / factor and fine in [0, 1). A 16-bit float has 11 bits: a factor of
/// 2^8 leaves three of them to the coarse part for what filters make of it.
struct MomentSplit {
    float factor = 0.0f;  // a power of two; 0: not split

    static constexpr auto fields() { return std::tuple{Field{"factor", &MomentSplit::factor}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> store(const Moments<Real>& m) const {
        if (factor == 0.0f) return {m.first, m.second, Real(0.0f), Real(1.0f)};
        const Real whole_first = floor(m.first * Real(factor));
        const Real whole_second = floor(m.second * Real(factor));
        const Real unit(1.0f / factor);
        return {whole_first * unit, whole_second * unit, m.first * Real(factor) - whole_first,
                m.second * Real(factor) - whole_second};
    }
    template <class Real>
    [[nodiscard]] Moments<Real> restore(const Vec4<Real>& texel) const {
        if (factor == 0.0f) return {texel.x, texel.y};
        const Real unit(1.0f / factor);
        return {texel.x + texel.z * unit, texel.y + texel.w * unit};
    }
};

}  // namespace gnomon::techniques
