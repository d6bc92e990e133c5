// From what was asked for to what will run: scene and technique settings.
#include "scenes/procedural.h"
#include "studies/experiment.h"

#include <algorithm>
#include <functional>
#include <system_error>

namespace gnomon::studies {

namespace {

using techniques::TechniqueRequest;

/// One choice that a technique may not offer: puts it into a request that lacks it.
struct Choice {
    std::function<void(TechniqueRequest&)> add;
};

/// Splits a request into what goes for every technique and the choices that may not.
std::pair<TechniqueRequest, std::vector<Choice>> split(const TechniqueRequest& wanted) {
    TechniqueRequest always = wanted;
    always.format.reset();
    always.filter.reset();
    always.anisotropy.reset();
    always.set.clear();
    std::vector<Choice> choices;
    if (wanted.format) choices.push_back({[format = wanted.format](TechniqueRequest& r) { r.format = format; }});
    if (wanted.filter) choices.push_back({[filter = wanted.filter](TechniqueRequest& r) { r.filter = filter; }});
    if (wanted.anisotropy) choices.push_back({[limit = wanted.anisotropy](TechniqueRequest& r) { r.anisotropy = limit; }});
    for (const auto& text : wanted.set) choices.push_back({[text](TechniqueRequest& r) { r.set.push_back(text); }});
    return {always, choices};
}

/// All techniques; a choice that one of them does not offer leaves its default there.
std::vector<PlannedRun> plan_all(const TechniqueRequest& wanted, const Profile& profile) {
    const auto [always, choices] = split(wanted);
    std::vector<std::string> refusals(choices.size());  // the first one
    std::vector<bool> taken(choices.size(), false);
    std::vector<PlannedRun> runs;
    for (const techniques::Technique& technique : techniques::all_techniques()) {
        TechniqueRequest request = always;
        for (std::size_t i = 0; i < choices.size(); ++i) {
            TechniqueRequest more = request;
            choices[i].add(more);
            try {
                (void)techniques::resolve_settings(technique, more, profile);
                request = more;
                taken[i] = true;
            } catch (const Error& error) {
                if (refusals[i].empty()) refusals[i] = error.what();
            }
        }
        runs.push_back({technique, techniques::resolve_settings(technique, request, profile)});
    }
    for (std::size_t i = 0; i < choices.size(); ++i)
        if (!taken[i]) throw Error(refusals[i]);
    return runs;
}

}  // namespace

scenes::Scene find_scene(const std::string& name_or_path, const scenes::GltfOptions& options) {
    std::string names;
    for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
        if (scene.name == name_or_path) {
            if (options.ground) fail("--ground: {} is a built-in scene; the option is for files", name_or_path);
            if (options.automatic_view) fail("--auto-view: {} is a built-in scene; the option is for files", name_or_path);
            return scene.make();
        }
        names += names.empty() ? "" : ", ";
        names += scene.name;
    }
    std::error_code error;
    const auto status = std::filesystem::status(name_or_path, error);
    if (!std::filesystem::exists(status)) fail("--scene '{}': neither a built-in scene ({}) nor a file", name_or_path, names);
    if (!std::filesystem::is_regular_file(status)) fail("--scene '{}': not a regular file", name_or_path);
    return scenes::load_gltf(name_or_path, options);
}

std::vector<PlannedRun> plan_runs(const RenderRequest& request, const Profile& profile) {
    if (request.technique == "all") return plan_all(request.choices, profile);
    const techniques::Technique& technique = techniques::find_technique(request.technique);
    return {{technique, techniques::resolve_settings(technique, request.choices, profile)}};
}

}  // namespace gnomon::studies
