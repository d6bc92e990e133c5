// Passes and parameters of moment shadow maps. [Peters15]
#include "techniques/msm.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::Rgba32Float, Format::Rgba16Unorm, Format::Rgba16Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

std::vector<Parameter> parameters() {
    return filtered_map_parameters() +
           std::vector{word("bound", MomentBound::Hamburger,
                            "of all distributions with the moments, or of those with depths in [0, 1]"),
                       number("moment-bias", 0, 0, 1,
                              "share of the moments of no depth in particular; 0 takes 3e-6 of rgba32f, 3e-5 of rgba16unorm, "
                              "5e-3 of rgba16f"),
                       number("depth-offset", 0, 0, 1, "taken off the depth of receivers, which is in [0, 1]")} +
           bleed_parameters();
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const CasterPrograms casters = make_caster_programs<MsmEncoding>("msm.cast", "msm.cast-distance");
    static const ReceiverPrograms programs = make_receiver_programs<MsmReceiver>("msm.receive", "msm.receive-cascades");
    const ParameterValues& chosen = settings.parameters;
    const MsmEncoding encoding{.storage = {settings.format == Format::Rgba16Unorm ? 1 : 0}};
    const MsmReceiver receiver{.storage = encoding.storage,
                               .moment_bias = chosen.number("moment-bias"),
                               .depth_offset = chosen.number("depth-offset"),
                               .within_unit = chosen.word<MomentBound>("bound") == MomentBound::Hausdorff ? 1 : 0,
                               .bleed = bleed_reduction(chosen)};
    return make_filtered_map_passes(device, settings, casters, programs, encoding, receiver);
}

}  // namespace

float standard_moment_bias(Format format) {
    if (format == Format::Rgba16Unorm) return 3e-5f;
    return format == Format::Rgba16Float ? 5e-3f : 3e-6f;
}

const Technique kMsm{.name = "msm",
                     .summary = "moment shadow maps: four filtered moments and Hamburger's or Hausdorff's bound",
                     .source = "[Peters15]",
                     .formats = kFormats,
                     .filters = kFilters,
                     .parameters = parameters(),
                     .settle =
                         [](TechniqueSettings& settings) {
                             if (settings.parameters.number("moment-bias") == 0.0f)
                                 settings.parameters.settle("moment-bias",
                                                            static_cast<double>(standard_moment_bias(settings.format)));
                         },
                     .make = make};

}  // namespace gnomon::techniques
