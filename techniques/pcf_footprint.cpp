// Passes and parameters of percentage closer filtering over the pixel's extent. [Lauritzen08] 2.3
#include "techniques/pcf_footprint.h"

#include "pipeline/program.h"
#include "techniques/common/depth_map.h"

namespace gnomon::techniques {

/// What a sample of the filter is compared with.
enum class PcfReference { Pixel, Plane };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::PcfReference>{EnumName{techniques::PcfReference::Pixel, "pixel"},
                                                                 EnumName{techniques::PcfReference::Plane, "plane"}};
}  // namespace gnomon

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::D32Float, Format::D24, Format::D16};
constexpr std::array kFilters{MapFilter::Bilinear, MapFilter::Nearest};

std::vector<Parameter> parameters() {
    return depth_map_parameters() +
           std::vector{number("least-width", 1, 1, 64, "least side of the filter, texels"),
                       number("density", 1, 0.25, 8, "comparisons per texel of length"),
                       whole("most-taps", 64, 1, 1024, "comparisons per side of the footprint at most"),
                       word("reference", PcfReference::Pixel, "compare with the pixel's depth, or the receiver plane's")};
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs =
        make_receiver_programs<PcfFootprintReceiver>("pcf-footprint.receive", "pcf-footprint.receive-cascades");
    const ParameterValues& chosen = settings.parameters;
    TechniqueSettings isotropic = settings;
    isotropic.anisotropy = 1;  // the shader walks the footprint, not the texture unit
    const PcfFootprintReceiver receiver{.sampler = compare_sampler(isotropic),
                                        .anisotropy = static_cast<float>(settings.anisotropy),
                                        .least_width = chosen.number("least-width"),
                                        .density = chosen.number("density"),
                                        .most_taps = chosen.whole("most-taps"),
                                        .follows_plane = chosen.word<PcfReference>("reference") == PcfReference::Plane ? 1 : 0};
    return make_depth_map_passes(device, settings, programs, receiver);
}

}  // namespace

const Technique kPcfFootprint{.name = "pcf-footprint",
                              .summary = "comparisons over the pixel's projected extent: the costly yardstick",
                              .source = "[Lauritzen08] 2.3, [Reeves87]",
                              .formats = kFormats,
                              .filters = kFilters,
                              .parameters = parameters(),
                              .default_anisotropy = 16,
                              .default_slope_bias = 3.0f,
                              .make = make};

}  // namespace gnomon::techniques
