// The table of techniques. Biases are the defaults of Gnomon's techniques of these names.
#include "tests/peer/techniques.h"

#include "sim/error.h"

#include <fmt/ranges.h>

namespace gnomon::peer {
namespace {

// Halves round w^2, the square of a warp, by up to 2^-11 of it, and the mean, hence its square, by 2^-10. This variance of
// depth is 4 c^2 1e-4 w^2 > 2^-7 w^2 for both warps.
constexpr float kHalfVariance = 1e-4f;

}  // namespace

const std::vector<NamedTechnique>& named_techniques() {
    using enum Technique;
    using enum MapFilter;
    using enum MomentFormat;
    static const std::vector<NamedTechnique> kTechniques = {
        {"none", {.technique = None}},
        {"shadow-map", {.technique = ShadowMap, .depth_bias_slope = 2}},
        {"pcf-bilinear", {.technique = Pcf, .filter = Bilinear, .depth_bias_slope = 3}},
        {"pcf-3x3", {.technique = Pcf, .depth_bias_slope = 3, .taps = 3}},
        {"pcf-5x5", {.technique = Pcf, .depth_bias_slope = 3, .taps = 5}},
        {"pcf-bilinear-3x3", {.technique = Pcf, .filter = Bilinear, .depth_bias_slope = 3, .taps = 3}},
        {"vsm-rg32f-bilinear", {.technique = Vsm, .filter = Bilinear}},
        {"vsm-rg32f-trilinear", {.technique = Vsm, .filter = Trilinear}},
        {"vsm-rg16f-trilinear", {.technique = Vsm, .filter = Trilinear, .moment_format = Rg16f}},
        {"vsm-rg32f-bilinear-blur-3x3", {.technique = Vsm, .filter = Bilinear, .blur_kernel = gaussian_kernel(3)}},
        {"vsm-rg32f-trilinear-blur-3x3", {.technique = Vsm, .filter = Trilinear, .blur_kernel = gaussian_kernel(3)}},
        {"vsm-rg32f-16x", {.technique = Vsm, .filter = Trilinear, .max_anisotropy = 16}},
        {"vsm-rg16f-16x", {.technique = Vsm, .filter = Trilinear, .moment_format = Rg16f, .max_anisotropy = 16}},
        {"evsm4-rgba32f-trilinear", {.technique = Evsm4, .filter = Trilinear, .moment_format = Rgba32f}},
        {"evsm4-rgba16f-trilinear",
         {.technique = Evsm4,
          .filter = Trilinear,
          .moment_format = Rgba16f,
          .min_variance = kHalfVariance,
          .positive_exponent = largest_exponent(Encoding::Float16)}},
        {"evsm4-rgba32f-trilinear-blur-3x3",
         {.technique = Evsm4, .filter = Trilinear, .moment_format = Rgba32f, .blur_kernel = gaussian_kernel(3)}},
        {"evsm4-rgba32f-16x", {.technique = Evsm4, .filter = Trilinear, .moment_format = Rgba32f, .max_anisotropy = 16}},
        {"evsm4-rgba16f-16x",
         {.technique = Evsm4,
          .filter = Trilinear,
          .moment_format = Rgba16f,
          .max_anisotropy = 16,
          .min_variance = kHalfVariance,
          .positive_exponent = largest_exponent(Encoding::Float16)}},
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
