#include "techniques/vsm.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::Rg32Float, Format::Rg16Float, Format::Rg16Unorm, Format::Rg8Unorm, Format::Rgba16Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

std::vector<Parameter> parameters() {
    return filtered_map_parameters() +
           std::vector{number("min-variance", 1e-5, 0, 1, "least variance of depth, which is in [0, 1]")} + bleed_parameters() +
           std::vector{whole("split-bits", 8, 1, 11, "bits of the coarse parts, where rgba16f holds each moment in two")};
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const CasterPrograms casters = make_caster_programs<VsmEncoding>("vsm.cast", "vsm.cast-distance");
    static const ReceiverPrograms programs = make_receiver_programs<VsmReceiver>("vsm.receive", "vsm.receive-cascades");
    const ParameterValues& chosen = settings.parameters;
    const bool splits = settings.format == Format::Rgba16Float;
    const VsmEncoding encoding{.split = {splits ? static_cast<float>(1 << chosen.whole("split-bits")) : 0.0f}};
    const VsmReceiver receiver{
        .split = encoding.split, .min_variance = chosen.number("min-variance"), .bleed = bleed_reduction(chosen)};
    return make_filtered_map_passes(device, settings, casters, programs, encoding, receiver);
}

}  // namespace

const Technique kVsm{.name = "vsm",
                     .summary = "variance shadow maps: filtered moments and Chebyshev's bound; rgba16f splits each in two",
                     .source = "[Donnelly06] sections 3 to 5, [Lauritzen08] chapter 3",
                     .formats = kFormats,
                     .filters = kFilters,
                     .parameters = parameters(),
                     .make = make};

const Technique kPsvsm{.name = "psvsm",
                       .summary = "parallel-split variance shadow maps: vsm in the map of the fragment's split",
                       .source = "[PSVSM]",
                       .formats = kFormats,
                       .filters = kFilters,
                       .parameters = parameters(),
                       .default_cascades = 4,
                       .make = make};

}  // namespace gnomon::techniques
