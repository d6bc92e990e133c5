#include "techniques/shadow_map.h"

#include "pipeline/program.h"
#include "techniques/depth_map_passes.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kMapFormats{Format::D32Float, Format::D24, Format::D16};
constexpr std::array kMapFilters{MapFilter::Nearest};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const Program program = make_program<ReceiverVertex, ShadowMapReceiver>("shadow-map.receive");
    const ShadowMapReceiver receiver{.sampler = {.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest}};
    return std::make_unique<DepthMapPasses<ShadowMapReceiver>>(device, settings, program, receiver);
}

}  // namespace

const Technique kShadowMap{.name = "shadow-map",
                           .summary = "one nearest-texel depth comparison",
                           .source = "[Donnelly06] section 4 method 1, [Williams78]",
                           .formats = kMapFormats,
                           .filters = kMapFilters,
                           .default_taps = 0,
                           .default_slope_bias = 2.0f,
                           .make = make};

}  // namespace gnomon::techniques
