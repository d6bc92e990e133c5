// Passes and parameters of exponential shadow maps. [Salvi08], [Annen08]
#include "techniques/esm.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::R32Float, Format::R16Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const CasterPrograms casters = make_caster_programs<EsmEncoding>("esm.cast", "esm.cast-distance");
    static const ReceiverPrograms programs = make_receiver_programs<EsmReceiver>("esm.receive", "esm.receive-cascades");
    const EsmEncoding encoding{.exponent2 = positive_warp(settings.parameters.number("exponent")).exponent2};
    const EsmReceiver receiver{.warp = encoding, .bleed = bleed_reduction(settings.parameters)};
    return make_filtered_map_passes(device, settings, casters, programs, encoding, receiver);
}

}  // namespace

const Technique kEsm{
    .name = "esm",
    .summary = "exponential shadow maps: the filtered e^{cz} over that of the receiver",
    .source = "[Salvi08], [Annen08]",
    .formats = kFormats,
    .filters = kFilters,
    .parameters = filtered_map_parameters() +
                  std::vector{number("exponent", 80, 0, 400, "c of e^{cz}, z depth in [0, 1]"), clamp_parameter()} +
                  bleed_parameters(),
    .make = make};

}  // namespace gnomon::techniques
