// What the parameters of light-bleeding reduction say. [Lauritzen08] 3.4
#include "techniques/common/light_bleeding.h"

namespace gnomon::techniques {

std::vector<Parameter> bleed_parameters() {
    return {number("bleed-reduction", 0, 0, 0.99, "visibility up to which a bound counts as shadow"),
            word("bleed-cut", BleedCut::Linstep, "what becomes of more: stretched over [0, 1], or left alone")};
}

BleedReduction bleed_reduction(const ParameterValues& parameters) {
    const float amount = parameters.number("bleed-reduction");
    const BleedCut cut = parameters.word<BleedCut>("bleed-cut");
    return {.amount = amount, .scale = 1.0f / (1.0f - amount), .clamps = cut == BleedCut::Clamp ? 1 : 0};
}

}  // namespace gnomon::techniques
