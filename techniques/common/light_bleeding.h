// Less light where a bound is loose: cutting off its tail. [Lauritzen08] 3.4 ("clamp out light that falls below some minimum")
#pragma once

#include "sim/enum_names.h"
#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "techniques/common/parameters.h"

namespace gnomon::techniques {

enum class BleedCut {
    Linstep,  // what is left is stretched over [0, 1]: saturate((p - amount) / (1 - amount)). [Lauritzen07] 8.4.2
    Clamp,    // what is left stays as it is
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::BleedCut>{EnumName{techniques::BleedCut::Linstep, "linstep"},
                                                             EnumName{techniques::BleedCut::Clamp, "clamp"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// What is taken off a bound; part of receivers' constants.
struct BleedReduction {
    float amount = 0.0f;  // [0, 1): visibility up to here becomes 0
    float scale = 1.0f;   // 1 / (1 - amount) of Linstep
    int clamps = 0;       // 1: Clamp

    static constexpr auto fields() {
        using B = BleedReduction;
        return std::tuple{Field{"amount", &B::amount}, Field{"scale", &B::scale}, Field{"clamps", &B::clamps}};
    }

    template <class Real>
    [[nodiscard]] Real operator()(const Real& bound) const {
        if (amount == 0.0f) return bound;
        const Real least(amount);
        if (clamps != 0) return select(bound < least, Real(0.0f), bound);
        return saturate((bound - least) * Real(scale));
    }
};

/// The parameters bleed-reduction and bleed-cut, and what they say.
std::vector<Parameter> bleed_parameters();
BleedReduction bleed_reduction(const ParameterValues& parameters);

}  // namespace gnomon::techniques
