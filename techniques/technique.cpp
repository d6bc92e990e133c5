#include "techniques/technique.h"

#include "techniques/gaussian.h"
#include "techniques/pcf.h"
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

}  // namespace

std::span<const Technique> all_techniques() {
    static const std::array techniques{kShadowMap, kPcf, kVsm};
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

void check_filter(const Profile& profile, const TechniqueSettings& settings) {
    const FormatInfo& format = format_info(settings.format);
    if (settings.filter != MapFilter::Nearest && !filters_format(format, profile))
        fail("--filter {}: profile {} does not filter {}; expected nearest, or another --format", name_of(settings.filter),
             profile.name, format.name);
}

TechniqueSettings resolve_settings(const Technique& technique, const TechniqueRequest& request) {
    if (request.map_size < 1 || request.map_size > kMaxTextureSize)
        fail("--map {}: expected 1 to {} texels", request.map_size, kMaxTextureSize);
    TechniqueSettings settings{.map_size = request.map_size,
                               .format = choose(request.format, technique.formats, "--format", technique.name),
                               .filter = choose(request.filter, technique.filters, "--filter", technique.name),
                               .taps = technique.default_taps,
                               .blur = 1,
                               .min_variance = technique.default_min_variance,
                               .depth_bias = request.depth_bias.value_or(technique.default_depth_bias),
                               .slope_bias = request.slope_bias.value_or(technique.default_slope_bias)};
    if (request.taps) {
        if (technique.max_taps == 0) fail("--taps {}: {} takes no taps", *request.taps, technique.name);
        if (*request.taps < 1 || *request.taps > technique.max_taps)
            fail("--taps {}: expected 1 to {} per axis", *request.taps, technique.max_taps);
        settings.taps = *request.taps;
    }
    if (request.blur) {
        if (technique.max_blur == 0) fail("--blur {}: {} cannot be blurred before filtering", *request.blur, technique.name);
        if (*request.blur < 1 || *request.blur > technique.max_blur || *request.blur % 2 == 0)
            fail("--blur {}: expected an odd number of taps from 1 to {}", *request.blur, technique.max_blur);
        settings.blur = *request.blur;
    }
    if (request.min_variance) {
        if (technique.default_min_variance == 0.0f) fail("--min-variance: {} has no variance", technique.name);
        if (!(*request.min_variance >= 0.0f && *request.min_variance <= 1.0f))
            fail("--min-variance {}: expected 0 to 1", *request.min_variance);
        settings.min_variance = *request.min_variance;
    }
    return settings;
}

}  // namespace gnomon::techniques
