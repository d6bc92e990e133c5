#include "techniques/shadow_map.h"

#include "pipeline/program.h"
#include "techniques/common/depth_map.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::D32Float, Format::D24, Format::D16};
constexpr std::array kNearest{MapFilter::Nearest};
constexpr std::array kBilinear{MapFilter::Bilinear};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs =
        make_receiver_programs<CompareReceiver>("shadow-map.receive", "shadow-map.receive-cascades");
    return make_depth_map_passes(device, settings, programs, CompareReceiver{.sampler = compare_sampler(settings)});
}

}  // namespace

const Technique kShadowMap{.name = "shadow-map",
                           .summary = "one nearest-texel depth comparison",
                           .source = "[Donnelly06] section 4 method 1, [Williams78]",
                           .formats = kFormats,
                           .filters = kNearest,
                           .parameters = depth_map_parameters(),
                           .default_slope_bias = 2.0f,
                           .make = make};

const Technique kPcfHardware{.name = "pcf-hw",
                             .summary = "the texture unit's bilinear filter of 2x2 comparisons",
                             .source = "[Donnelly06] section 4 method 2",
                             .formats = kFormats,
                             .filters = kBilinear,
                             .parameters = depth_map_parameters(),
                             .default_slope_bias = 3.0f,
                             .make = make};

const Technique kPssm{.name = "pssm",
                      .summary = "parallel-split shadow maps: one comparison in the map of the fragment's split",
                      .source = "[Zhang06], [PSVSM]",
                      .formats = kFormats,
                      .filters = kNearest,
                      .parameters = depth_map_parameters(),
                      .default_cascades = 4,
                      .default_slope_bias = 2.0f,
                      .make = make};

}  // namespace gnomon::techniques
