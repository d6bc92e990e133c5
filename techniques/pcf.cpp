#include "techniques/pcf.h"

#include "pipeline/program.h"
#include "techniques/depth_map_passes.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kMapFormats{Format::D32Float, Format::D24, Format::D16};
constexpr std::array kMapFilters{MapFilter::Bilinear, MapFilter::Nearest};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const Program program = make_program<ReceiverVertex, PcfReceiver>("pcf.receive");
    const TexelFilter filter = settings.filter == MapFilter::Nearest ? TexelFilter::Nearest : TexelFilter::Linear;
    const PcfReceiver receiver{.sampler = {.min = filter, .mag = filter}, .taps = settings.taps};
    return std::make_unique<DepthMapPasses<PcfReceiver>>(device, settings, program, receiver);
}

}  // namespace

const Technique kPcf{.name = "pcf",
                     .summary = "the mean of NxN comparisons, each nearest or hardware bilinear",
                     .source = "[Donnelly06] section 4 methods 2 to 4, [Reeves87]",
                     .formats = kMapFormats,
                     .filters = kMapFilters,
                     .default_taps = 1,
                     .max_taps = 31,
                     .default_slope_bias = 3.0f,
                     .make = make};

}  // namespace gnomon::techniques
