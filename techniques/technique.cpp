#include "techniques/technique.h"

#include "sim/warn.h"
#include "techniques/common/cascade_setup.h"
#include "techniques/csm.h"
#include "techniques/esm.h"
#include "techniques/evsm.h"
#include "techniques/lvsm.h"
#include "techniques/msm.h"
#include "techniques/pcf.h"
#include "techniques/pcf_footprint.h"
#include "techniques/savsm.h"
#include "techniques/shadow_map.h"
#include "techniques/vsm.h"
#include "texunit/aniso.h"

#include <algorithm>

namespace gnomon::techniques {

namespace {

template <NamedEnum E>
std::string list_of(std::span<const E> values) {
    std::string all;
    for (const E value : values) {
        if (!all.empty()) all += ", ";
        all += name_of(value);
    }
    return all;
}

template <NamedEnum E>
E choose(const std::optional<E>& wanted, std::span<const E> offered, std::string_view option, std::string_view technique) {
    if (!wanted) return offered.front();
    if (std::ranges::find(offered, *wanted) == offered.end())
        fail("{} {}: {} does not offer it; expected one of {}", option, name_of(*wanted), technique, list_of(offered));
    return *wanted;
}

/// Throws Error unless the profile can render to so many samples.
void check_samples(int samples, const Profile& profile) {
    if (samples < 1 || samples > profile.max_samples || (samples & (samples - 1)) != 0)
        fail("--map-samples {}: expected 1, 2, 4, 8 or 16, and for profile {} up to {}", samples, profile.name,
             profile.max_samples);
}

MapFilter choose_filter(const Technique& technique, const TechniqueRequest& request, Format format, const Profile& profile) {
    const MapFilter wanted = choose(request.filter, technique.filters, "--filter", technique.name);
    const FormatInfo& info = format_info(format);
    const auto is_possible = [&](MapFilter filter) {
        const bool in_unit = filter == MapFilter::Bilinear || filter == MapFilter::Trilinear;
        return !in_unit || info.is_depth || filters_format(info, profile);
    };
    if (is_possible(wanted)) return wanted;
    if (request.anisotropy.value_or(1) > 1)
        fail("--aniso {}: profile {} does not filter {}; expected another --format", *request.anisotropy, profile.name,
             info.name);
    if (request.filter)
        fail("--filter {}: profile {} does not filter {}; expected shader-bilinear, nearest, or another --format",
             name_of(wanted), profile.name, info.name);
    const auto other = std::ranges::find_if(technique.filters, is_possible);
    if (other == technique.filters.end())
        fail("{}: profile {} does not filter {}; expected another --format", technique.name, profile.name, info.name);
    warn_once(
        fmt::format("{}: profile {} does not filter {}: filter {}", technique.name, profile.name, info.name, name_of(*other)));
    return *other;
}

/// The technique's own parameters, and those of splits where it has any.
ParameterValues parameter_values(const Technique& technique, int cascades, const ParameterTexts& set) {
    if (cascades > 0) return {technique.name, technique.parameters + cascade_parameters(), set};
    for (const auto& [name, text] : set)
        if (std::ranges::find(cascade_parameters(), name, &Parameter::name) != cascade_parameters().end())
            fail("--set {}={}: {} has no splits here; expected --cascades 1 to {} with it", name, text, technique.name,
                 kMaxCascades);
    return {technique.name, technique.parameters, set};
}

}  // namespace

std::span<const Technique> all_techniques() {
    static const std::array techniques{kShadowMap, kPcfHardware, kPcf,   kPcfBilinear, kPcfFootprint, kVsm,  kSavsm, kLvsm,
                                       kEsm,       kEvsm2,       kEvsm4, kCsm,         kMsm,          kPssm, kPsvsm};
    return techniques;
}

const Technique& find_technique(std::string_view name) {
    std::string names;
    for (const Technique& technique : all_techniques()) {
        if (technique.name == name) return technique;
        names += names.empty() ? "" : ", ";
        names += technique.name;
    }
    fail("technique '{}': not known; expected one of {}", name, names);
}

TechniqueSettings resolve_settings(const Technique& technique, const TechniqueRequest& request, const Profile& profile) {
    if (request.map_size < 1 || request.map_size > kMaxTextureSize)
        fail("--map {}: expected 1 to {} texels", request.map_size, kMaxTextureSize);
    const Format format = choose(request.format, technique.formats, "--format", technique.name);
    check_samples(request.map_samples, profile);
    const MapFilter filter = choose_filter(technique, request, format, profile);
    const int anisotropy = request.anisotropy.value_or(technique.default_anisotropy);
    if (anisotropy < 1 || anisotropy > 16) fail("--aniso {}: expected 1 to 16", anisotropy);
    if (anisotropy > 1 && filter == MapFilter::ShaderBilinear)
        fail("--aniso {}: {} is one sample in the shader; expected 1", anisotropy, name_of(filter));
    const int cascades = request.cascades.value_or(technique.default_cascades);
    if (cascades < 0 || cascades > kMaxCascades) fail("--cascades {}: expected 0 to {}", cascades, kMaxCascades);
    TechniqueSettings settings{.map_size = request.map_size,
                               .map_samples = request.map_samples,
                               .format = format,
                               .filter = filter,
                               .anisotropy = anisotropy,
                               .cascades = cascades,
                               .depth_bias = request.depth_bias.value_or(technique.default_depth_bias),
                               .slope_bias = request.slope_bias.value_or(technique.default_slope_bias),
                               .parameters = parameter_values(technique, cascades, request.set)};
    if (technique.settle != nullptr) technique.settle(settings);
    check_cascades(settings);
    return settings;
}

double storage_per_texel(const Device& device, std::span<const TextureId> maps, const TechniqueSettings& settings) {
    double bits = 0;
    for (const TextureId id : maps) {
        const Texture& texture = device.texture(id);
        const double held = 1.0 * texture.width(0) * texture.height(0) * texture.desc().layers;
        bits += held * texture.info().components * texture.info().bits_per_component;
    }
    double texels = 0;
    for (const int size : map_sizes(settings)) texels += 1.0 * size * size;
    return bits / (8.0 * texels);
}

double storage_per_texel(const Technique& technique, const TechniqueSettings& settings) {
    Device device(Profile{}, 1);
    const auto passes = technique.make(device, settings);
    return storage_per_texel(device, passes->maps(), settings);
}

}  // namespace gnomon::techniques
