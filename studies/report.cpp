#include "studies/report.h"

#include "studies/configuration.h"

namespace gnomon::studies {

namespace {

using traces::Json;

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
    json["configuration"] = configuration_json(result.request, result.settings, result.profile);
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
    return file_text(json);
}

}  // namespace gnomon::studies
