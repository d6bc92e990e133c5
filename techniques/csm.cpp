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
                       number("attenuation", 1, 0, 100, "alpha: term k is scaled by exp(-alpha (k/M)^2) against ringing"),
                       number("offset", 0, 0, 0.25, "towards the light, of depth, which is in [0, 1]"),
                       number("sharpness", 1, 0.5, 100, "scale of visibility; 1: a surface in its own light is just lit")};
}

/// Two terms per target.
template <int kTargets>
std::unique_ptr<ShadowPasses> make_with(Device& device, const TechniqueSettings& settings) {
    static const std::array names{fmt::format("csm.cast-{}", 2 * kTargets), fmt::format("csm.cast-distance-{}", 2 * kTargets)};
    static const CasterPrograms casters = make_caster_programs<CsmEncoding<kTargets>>(names[0], names[1]);
    static const Program program = make_program<ReceiverVertex, CsmReceiver>("csm.receive");
    const ParameterValues& chosen = settings.parameters;
    CsmReceiver receiver{.series = fourier_series(chosen.whole("terms"), static_cast<double>(chosen.number("attenuation")))};
    receiver.reconstruction = csm_reconstruction(receiver.series, chosen.number("offset"), chosen.number("sharpness"));
    return std::make_unique<FilteredMapPasses<CsmEncoding<kTargets>, CsmReceiver>>(device, settings, casters, program,
                                                                                   CsmEncoding<kTargets>{}, receiver);
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    const int terms = settings.parameters.whole("terms");
    if (terms <= 2) return make_with<1>(device, settings);
    if (terms <= 4) return make_with<2>(device, settings);
    if (terms <= 8) return make_with<4>(device, settings);
    return make_with<8>(device, settings);
}

}  // namespace

CsmReconstruction csm_reconstruction(const FourierSeries& series, float offset, float sharpness) {
    const double lit = series.at(static_cast<double>(offset));
    return {.offset = offset, .scale = static_cast<float>(static_cast<double>(sharpness) / lit)};
}

const Technique kCsm{.name = "csm",
                     .summary = "convolution shadow maps: the shadow test as a Fourier series of M terms in 8 bits",
                     .source = "[Annen07]",
                     .formats = kFormats,
                     .filters = kFilters,
                     .parameters = parameters(),
                     .make = make};

}  // namespace gnomon::techniques
