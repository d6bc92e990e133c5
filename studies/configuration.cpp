// What a run was told, as JSON and as text.
#include "studies/configuration.h"

#include <iterator>

namespace gnomon::studies {

namespace {

using traces::Json;
using traces::json_of;

/// By name; words as words.
Json parameters_json(const techniques::ParameterValues& values) {
    Json json = Json::object();
    for (const auto& [parameter, value, is_set] : values.entries()) {
        if (parameter.kind == techniques::ParameterKind::Word) {
            json[std::string(parameter.name)] = techniques::text_of(parameter, value);
        } else {
            json[std::string(parameter.name)] = value;
        }
    }
    return json;
}

}  // namespace

Json configuration_json(const RenderRequest& request, const techniques::TechniqueSettings& settings, const Profile& profile) {
    Json json;
    json["scene"] = request.scene;
    json["ground"] = request.file_options.ground;
    json["auto_view"] = request.file_options.automatic_view;
    json["technique"] = request.technique;
    json["map"] = settings.map_size;
    json["size"] = {request.width, request.height};
    json["format"] = name_of(settings.format);
    json["filter"] = name_of(settings.filter);
    json["map_samples"] = settings.map_samples;
    json["aniso"] = settings.anisotropy;
    json["cascades"] = settings.cascades;
    json["parameters"] = parameters_json(settings.parameters);
    json["depth_bias"] = settings.depth_bias;
    json["slope_bias"] = json_of(settings.slope_bias);
    json["reference"] = name_of(request.truth);
    json["seed"] = request.seed;
    json["profile"] = Json::parse(profile_to_json(profile));
    return json;
}

std::string file_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string settings_text(const std::string& technique_name, const techniques::TechniqueSettings& settings) {
    std::string text = fmt::format("{}, map {}, {}, {}", technique_name, settings.map_size, name_of(settings.format),
                                   name_of(settings.filter));
    auto out = std::back_inserter(text);
    if (settings.map_samples > 1) fmt::format_to(out, ", {} samples", settings.map_samples);
    if (settings.anisotropy > 1) fmt::format_to(out, ", aniso {}", settings.anisotropy);
    if (settings.cascades > 0) fmt::format_to(out, ", {} cascades", settings.cascades);
    for (const auto& [parameter, value, is_set] : settings.parameters.entries())
        fmt::format_to(out, ", {} {}", parameter.name, techniques::text_of(parameter, value));
    if (settings.depth_bias != 0) fmt::format_to(out, ", depth bias {}", settings.depth_bias);
    if (settings.slope_bias != 0.0f) fmt::format_to(out, ", slope bias {}", settings.slope_bias);
    return text;
}

std::string grouped(std::uint64_t value) {
    const std::string digits = fmt::format("{}", value);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text.push_back(',');
        text.push_back(digits[i]);
    }
    return text;
}

}  // namespace gnomon::studies
