// Passes and parameters of convolution shadow maps. [Annen07]
#include "techniques/csm.h"

#include "pipeline/program.h"

#include <fmt/format.h>

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::Rgba8Unorm, Format::Rgba16Unorm, Format::Rgba16Float, Format::Rgba32Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

std::vector<Parameter> parameters() {
    return filtered_map_parameters() +
           std::vector{whole("terms", 8, 1, kMaxFourierTerms,
                             "M, terms of the series; two to a texture, and 1, 2, 4 or 8 textures are made"),
                       number("attenuation", 0.5, 0, 100, "alpha: term k is scaled by exp(-alpha (k/M)^2) against ringing"),
                       number("range", 0, 0, 1, "depth 1 in half periods; 0: 1 - 1/(2M), clear of the period's other step"),
                       number("offset", 0, 0, 0.25, "towards the light, of depth, which is in [0, 1]"),
                       number("sharpness", 1, 0.5, 100, "scale of visibility; 1: a surface in its own light is just lit")};
}

/// Two terms per target.
template <std::size_t kTargets>
std::unique_ptr<ShadowPasses> make_with(Device& device, const TechniqueSettings& settings) {
    static const std::array names{fmt::format("csm.cast-{}", 2 * kTargets), fmt::format("csm.cast-distance-{}", 2 * kTargets)};
    static const CasterPrograms casters = make_caster_programs<CsmEncoding<kTargets>>(names[0], names[1]);
    static const ReceiverPrograms programs = make_receiver_programs<CsmReceiver>("csm.receive", "csm.receive-cascades");
    const CsmSetup setup = csm_setup(settings.parameters);
    const CsmEncoding<kTargets> encoding{.range = setup.reconstruction.range};
    const CsmReceiver receiver{.series = setup.series, .reconstruction = setup.reconstruction};
    return make_filtered_map_passes(device, settings, casters, programs, encoding, receiver);
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    const int terms = settings.parameters.whole("terms");
    if (terms <= 2) return make_with<1>(device, settings);
    if (terms <= 4) return make_with<2>(device, settings);
    if (terms <= 8) return make_with<4>(device, settings);
    return make_with<8>(device, settings);
}

float standard_range(int terms) { return 1.0f - 0.5f / static_cast<float>(terms); }

void settle(TechniqueSettings& settings) {
    ParameterValues& chosen = settings.parameters;
    if (chosen.number("range") == 0.0f) chosen.settle("range", static_cast<double>(standard_range(chosen.whole("terms"))));
}

}  // namespace

CsmSetup csm_setup(const ParameterValues& chosen) {
    const int terms = chosen.whole("terms");
    CsmSetup setup{.series = fourier_series(terms, static_cast<double>(chosen.number("attenuation")))};
    CsmReconstruction& r = setup.reconstruction;

    // The cut series first gets where it wants 1/(2M) from its step. Half a period on stands the next one, the other way round.
    r.range = chosen.number("range");
    if (r.range == 0.0f) r.range = standard_range(terms);

    // A surface in its own light comes out lit: 2 without an offset.
    r.offset = chosen.number("offset");
    const double own = setup.series.at(static_cast<double>(r.range) * static_cast<double>(r.offset));
    r.scale = static_cast<float>(static_cast<double>(chosen.number("sharpness")) / own);
    return setup;
}

const Technique kCsm{.name = "csm",
                     .summary = "convolution shadow maps: the shadow test as a Fourier series of M terms in 8 bits",
                     .source = "[Annen07]",
                     .formats = kFormats,
                     .filters = kFilters,
                     .parameters = parameters(),
                     .settle = settle,
                     .make = make};

}  // namespace gnomon::techniques
