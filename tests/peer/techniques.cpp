// The table of techniques. Biases are the defaults of techniques/shadow_map.cpp and pcf.cpp.
#include "tests/peer/techniques.h"

#include "sim/error.h"

#include <fmt/ranges.h>

namespace gnomon::peer {
const std::vector<NamedTechnique>& named_techniques() {
    using enum Technique;
    using enum MapFilter;
    static const std::vector<NamedTechnique> kTechniques = {
        {"none", {.technique = None}},
        {"shadow-map", {.technique = ShadowMap, .depth_bias_slope = 2}},
        {"pcf-bilinear", {.technique = Pcf, .filter = Bilinear, .depth_bias_slope = 3}},
        {"pcf-3x3", {.technique = Pcf, .depth_bias_slope = 3, .taps = 3}},
        {"pcf-5x5", {.technique = Pcf, .depth_bias_slope = 3, .taps = 5}},
        {"pcf-bilinear-3x3", {.technique = Pcf, .filter = Bilinear, .depth_bias_slope = 3, .taps = 3}},
        {"vsm-rg32f-bilinear", {.technique = Vsm, .filter = Bilinear}},
        {"vsm-rg32f-trilinear", {.technique = Vsm, .filter = Trilinear}},
        {"vsm-rg16f-trilinear", {.technique = Vsm, .filter = Trilinear, .moment_format = MomentFormat::Rg16f}},
        {"vsm-rg32f-bilinear-blur-3x3", {.technique = Vsm, .filter = Bilinear, .blur_kernel = gaussian_kernel(3)}},
        {"vsm-rg32f-trilinear-blur-3x3", {.technique = Vsm, .filter = Trilinear, .blur_kernel = gaussian_kernel(3)}},
        {"vsm-rg32f-16x", {.technique = Vsm, .filter = Trilinear, .max_anisotropy = 16}},
    };
    return kTechniques;
}

const TechniqueOptions& technique_named(std::string_view name) {
    std::vector<std::string> names;
    for (const NamedTechnique& known : named_techniques()) {
        if (known.name == name) return known.options;
        names.push_back(known.name);
    }
    fail("unknown technique '{}'; expected one of {}", name, fmt::join(names, ", "));
}

}  // namespace gnomon::peer
