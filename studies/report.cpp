#include "studies/report.h"

#include "traces/json_values.h"

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

Json configuration_json(const RenderResult& result) {
    const RenderRequest& request = result.request;
    Json json;
    json["scene"] = request.scene;
    json["ground"] = request.file_options.ground;
    json["auto_view"] = request.file_options.automatic_view;
    json["technique"] = request.technique;
    json["map"] = result.settings.map_size;
    json["size"] = {request.width, request.height};
    json["format"] = name_of(result.settings.format);
    json["filter"] = name_of(result.settings.filter);
    json["map_samples"] = result.settings.map_samples;
    json["aniso"] = result.settings.anisotropy;
    json["cascades"] = result.settings.cascades;
    json["parameters"] = parameters_json(result.settings.parameters);
    json["depth_bias"] = result.settings.depth_bias;
    json["slope_bias"] = json_of(result.settings.slope_bias);
    json["reference"] = name_of(request.truth);
    json["seed"] = request.seed;
    json["profile"] = Json::parse(profile_to_json(result.profile));
    return json;
}

template <HasFields T>
Json fields_json(const T& values) {
    Json json;
    for_each_field(values, [&](std::string_view name, const auto& value) { json[std::string(name)] = value; });
    return json;
}

/// One entry per pass, then their sum as "frame".
Json counters_json(const RenderResult& result) {
    Counters frame;
    Json json;
    for (const PassResult& pass : result.passes) {
        frame += pass.counters;
        json[pass.name] = fields_json(pass.counters);
    }
    json["frame"] = fields_json(frame);
    return json;
}

/// One entry per pass, in it one per resource that the pass touched, in bytes.
Json traffic_json(const RenderResult& result) {
    Json json;
    for (const PassResult& pass : result.passes) {
        json[pass.name] = Json::object();
        for (const ResourceTraffic& resource : pass.traffic)
            json[pass.name][resource.label] = {{"read", resource.bytes.read}, {"written", resource.bytes.written}};
    }
    return json;
}

/// One entry per pass, then their sum as "frame", and what the truth took.
Json timings_json(const RenderResult& result) {
    Json json;
    for (const PassResult& pass : result.passes) json[pass.name] = pass.milliseconds;
    json["frame"] = result.frame_ms;
    if (result.metrics) json["reference"] = result.truth_ms;
    return json;
}

}  // namespace

std::string version() { return GNOMON_VERSION; }

std::string report_json(const RenderResult& result) {
    Json json;
    json["gnomon"] = version();
    json["configuration"] = configuration_json(result);
    json["scene"] = {
        {"triangles", result.scene.triangles}, {"meshes", result.scene.meshes}, {"instances", result.scene.instances}};
    json["map_bytes_per_texel"] = result.bytes_per_texel;
    json["map_texels"] = fields_json(result.map);
    json["metrics"] = result.metrics ? fields_json(*result.metrics) : Json();
    json["counters"] = counters_json(result);
    json["traffic"] = traffic_json(result);
    json["timings_ms"] = timings_json(result);
    json["hashes"] = {{"visibility", result.hashes.visibility},
                      {"depth", result.hashes.depth},
                      {"color", result.hashes.color},
                      {"map", result.hashes.map}};
    json["host"] = {{"threads", result.host.threads},
                    {"lanes", result.host.lanes},
                    {"target", result.host.target},
                    {"compiler", result.host.compiler}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gnomon::studies
