#include "techniques/pcf.h"

#include "pipeline/program.h"
#include "techniques/common/depth_map.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::D32Float, Format::D24, Format::D16};
constexpr std::array kNearest{MapFilter::Nearest};
constexpr std::array kBilinear{MapFilter::Bilinear};
std::vector<Parameter> parameters() {
    return depth_map_parameters() +
           std::vector{
               whole("taps", 3, 1, kMaxPcfTaps, "comparisons per axis, one texel apart"),
               word("weights", PcfWeights::Box, "of the comparisons; a Gaussian as wide as that of a blur with as many taps")};
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs = make_receiver_programs<PcfReceiver>("pcf.receive", "pcf.receive-cascades");
    const int taps = settings.parameters.whole("taps");
    const PcfReceiver receiver{.sampler = compare_sampler(settings),
                               .taps = taps,
                               .weights = pcf_weights(settings.parameters.word<PcfWeights>("weights"), taps)};
    return make_depth_map_passes(device, settings, programs, receiver);
}

}  // namespace

std::array<float, kMaxPcfTaps> pcf_weights(PcfWeights weights, int taps) {
    std::array<float, kMaxPcfTaps> values{};
    const GaussianKernel gaussian = gaussian_kernel(taps);
    for (std::size_t i = 0; i < static_cast<std::size_t>(taps); ++i)
        values[i] = weights == PcfWeights::Box ? 1.0f / static_cast<float>(taps) : gaussian.weights[i];
    return values;
}

const Technique kPcf{.name = "pcf",
                     .summary = "the weighted mean of NxN nearest-texel comparisons",
                     .source = "[Donnelly06] section 4 method 3, [Reeves87]",
                     .formats = kFormats,
                     .filters = kNearest,
                     .parameters = parameters(),
                     .default_slope_bias = 3.0f,
                     .make = make};

const Technique kPcfBilinear{.name = "pcf-bilinear",
                             .summary = "the weighted mean of NxN bilinear comparisons",
                             .source = "[Donnelly06] section 4 method 4, [Reeves87]",
                             .formats = kFormats,
                             .filters = kBilinear,
                             .parameters = parameters(),
                             .default_slope_bias = 3.0f,
                             .make = make};

}  // namespace gnomon::techniques
