// Studies from cases to rows, and rows as text and JSON.
#include "studies/study.h"

#include "studies/configuration.h"
#include "studies/report.h"

#include <algorithm>
#include <memory>

namespace gnomon::studies {

namespace {

using traces::Json;

StudyRow measure_case(Experiment& experiment, const StudyCase& what, const Profile& profile, const Progress& progress) {
    const techniques::Technique& technique = techniques::find_technique(what.technique);
    const PlannedRun plan{technique, techniques::resolve_settings(technique, what.request, profile)};
    const RenderResult result = experiment.run(plan, progress);
    StudyRow row{.scene = result.request.scene,
                 .what = what,
                 .bytes_per_texel = result.bytes_per_texel,
                 .metrics = result.metrics,
                 .map = result.map};
    for (const PassResult& pass : result.passes) (pass.name == "camera" ? row.camera_ms : row.map_ms) += pass.milliseconds;
    return row;
}

/// Throws Error for what no row could be measured with: now, not after hours of other rows.
void check_names(const Study& study, const std::vector<std::string>& scenes) {
    for (const std::string& scene : scenes) (void)find_scene(scene, {});
    for (const StudyCase& what : study.cases)
        (void)techniques::resolve_settings(techniques::find_technique(what.technique), what.request,
                                           load_profile(what.profile));
}

Json row_json(const StudyRow& row) {
    const techniques::TechniqueRequest& request = row.what.request;
    Json json;
    json["scene"] = row.scene;
    json["group"] = row.what.group;
    json["label"] = row.what.label;
    json["technique"] = row.what.technique;
    json["profile"] = row.what.profile;
    json["map"] = request.map_size;
    json["map_samples"] = request.map_samples;
    json["format"] = request.format ? Json(name_of(*request.format)) : Json();
    json["filter"] = request.filter ? Json(name_of(*request.filter)) : Json();
    json["aniso"] = request.anisotropy ? Json(*request.anisotropy) : Json();
    json["cascades"] = request.cascades ? Json(*request.cascades) : Json();
    json["set"] = Json::object();
    for (const auto& [name, value] : request.set) json["set"][name] = value;
    json["map_bytes_per_texel"] = row.bytes_per_texel;
    json["metrics"] = row.metrics ? fields_json(*row.metrics) : Json();
    json["map_texels"] = fields_json(row.map);
    json["timings_ms"] = {{"map", row.map_ms}, {"camera", row.camera_ms}};
    return json;
}

}  // namespace

const Study& find_study(std::string_view name) {
    std::string names;
    for (const Study& study : all_studies()) {
        if (study.name == name) return study;
        names += names.empty() ? "" : ", ";
        names += study.name;
    }
    fail("study '{}': not known; expected one of {}", name, names);
}

void run_study(const Study& study, const StudyOptions& options, const Progress& progress,
               const std::function<void(const StudyRow&)>& on_row) {
    // One experiment per scene and profile, made at its first case, so that the truth is traced once for all cases.
    const std::vector<std::string>& scenes = options.scenes.empty() ? study.scenes : options.scenes;
    check_names(study, scenes);
    for (const std::string& scene : scenes) {
        std::vector<std::pair<std::string, std::unique_ptr<Experiment>>> experiments;
        for (const StudyCase& what : study.cases) {
            auto at = std::ranges::find(experiments, what.profile, [](const auto& entry) { return entry.first; });
            if (at == experiments.end()) {
                RenderRequest request{.scene = scene, .technique = what.technique, .choices = what.request};
                request.width = options.width;
                request.height = options.height;
                request.profile = what.profile;
                request.truth = options.truth;
                request.threads = options.threads;
                experiments.emplace_back(what.profile, std::make_unique<Experiment>(request));
                at = experiments.end() - 1;
            }
            on_row(measure_case(*at->second, what, load_profile(what.profile), progress));
        }
    }
}

std::string study_header() {
    return fmt::format("{:<10} {:<12} {:<28} {:>7} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9}\n", "scene", "group", "case", "B/texel",
                       "rmse", "leak", "acne", "p99", "saturated", "inf, nan");
}

std::string study_line(const StudyRow& row) {
    const auto text = [&](double Metrics::* metric) {
        return row.metrics ? fmt::format("{:.5f}", *row.metrics.*metric) : std::string("-");
    };
    return fmt::format("{:<10} {:<12} {:<28} {:>7.4g} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9}\n", row.scene, row.what.group,
                       row.what.label, row.bytes_per_texel, text(&Metrics::rmse), text(&Metrics::leak), text(&Metrics::acne),
                       text(&Metrics::p99), row.map.saturated, row.map.infinite + row.map.nan);
}

std::string study_json(const Study& study, const StudyOptions& options, std::span<const StudyRow> rows) {
    Json json;
    json["gnomon"] = version();
    json["study"] = study.name;
    json["source"] = study.source;
    json["size"] = {options.width, options.height};
    json["reference"] = name_of(options.truth);
    json["rows"] = Json::array();
    for (const StudyRow& row : rows) json["rows"].push_back(row_json(row));
    return file_text(json);
}

}  // namespace gnomon::studies
