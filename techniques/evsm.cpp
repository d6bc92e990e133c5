// Passes and parameters of exponential variance shadow maps. [Lauritzen08] 4.2
#include "techniques/evsm.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats2{Format::Rg32Float, Format::Rg16Float};
constexpr std::array kFormats4{Format::Rgba32Float, Format::Rgba16Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

/// Defaults as [MJP] Shadows has them, on depths in [-1, 1] too; the positive one is held at the limit of the format.
const Parameter kPositive = number("positive", 40, 0, 200, "exponent c of the warp e^{cx}, x = 2 depth - 1 in [-1, 1]");
const Parameter kNegative = number("negative", 5, 0, 200, "exponent c of the warp -e^{-cx}");

/// The floor of 1e-7: evsm2 on bench (map 512) leaks 0.068, 0.017, 0.012 and 0.012 with 1e-5 to 1e-8; less gains nothing, and
/// halves begin to show acne.
std::vector<Parameter> shared_parameters() {
    return std::vector{clamp_parameter(),
                       number("min-variance", 1e-7, 0, 1, "least variance of depth, which is in [0, 1], before the warp")} +
           bleed_parameters();
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings, int warps) {
    static const CasterPrograms casters = make_caster_programs<EvsmEncoding>("evsm.cast", "evsm.cast-distance");
    static const ReceiverPrograms programs = make_receiver_programs<EvsmReceiver>("evsm.receive", "evsm.receive-cascades");
    const ParameterValues& chosen = settings.parameters;
    const EvsmEncoding encoding{.positive = positive_warp(chosen.number("positive")),
                                .negative = negative_warp(warps == 2 ? chosen.number("negative") : 0.0f),
                                .warps = warps};
    const EvsmReceiver receiver{
        .warp = encoding, .min_variance = chosen.number("min-variance"), .bleed = bleed_reduction(chosen)};
    return make_filtered_map_passes(device, settings, casters, programs, encoding, receiver);
}

}  // namespace

const Technique kEvsm2{.name = "evsm2",
                       .summary = "exponential variance shadow maps with the positive warp: two moments of e^{cx}",
                       .source = "[Lauritzen08] 4.2",
                       .formats = kFormats2,
                       .filters = kFilters,
                       .parameters = filtered_map_parameters() + std::vector{kPositive} + shared_parameters(),
                       .settle = [](TechniqueSettings& settings) { settle_exponent(settings, "positive", 2); },
                       .make = [](Device& device, const TechniqueSettings& settings) { return make(device, settings, 1); }};

const Technique kEvsm4{.name = "evsm4",
                       .summary = "exponential variance shadow maps: the smaller bound of e^{cx} and -e^{-cx}",
                       .source = "[Lauritzen08] 4.2",
                       .formats = kFormats4,
                       .filters = kFilters,
                       .parameters = filtered_map_parameters() + std::vector{kPositive, kNegative} + shared_parameters(),
                       .settle =
                           [](TechniqueSettings& settings) {
                               settle_exponent(settings, "positive", 2);
                               settle_exponent(settings, "negative", 2);
                           },
                       .make = [](Device& device, const TechniqueSettings& settings) { return make(device, settings, 2); }};

}  // namespace gnomon::techniques
