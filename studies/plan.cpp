// From what was asked for to what will run: scene and technique settings.
#include "scenes/procedural.h"
#include "studies/experiment.h"

#include <algorithm>
#include <system_error>

namespace gnomon::studies {

namespace {

/// One optional choice: takes it out of a request, and puts it back.
struct Choice {
    void (*copy)(const techniques::TechniqueRequest& from, techniques::TechniqueRequest& to);
};

template <auto kMember>
constexpr Choice choice() {
    return {[](const techniques::TechniqueRequest& from, techniques::TechniqueRequest& to) { to.*kMember = from.*kMember; }};
}

/// Every choice that a technique may not offer.
constexpr std::array kChoices{choice<&techniques::TechniqueRequest::format>(), choice<&techniques::TechniqueRequest::filter>(),
                              choice<&techniques::TechniqueRequest::taps>(), choice<&techniques::TechniqueRequest::blur>(),
                              choice<&techniques::TechniqueRequest::min_variance>()};

/// All techniques; a choice that one of them does not offer leaves its default there.
std::vector<PlannedRun> plan_all(const techniques::TechniqueRequest& wanted) {
    const techniques::TechniqueRequest always{.map_size = wanted.map_size,
                                              .format = {},
                                              .filter = {},
                                              .taps = {},
                                              .blur = {},
                                              .min_variance = {},
                                              .depth_bias = wanted.depth_bias,
                                              .slope_bias = wanted.slope_bias};
    std::array<bool, kChoices.size()> taken{};
    std::array<std::string, kChoices.size()> refusals;
    std::vector<PlannedRun> runs;
    for (const techniques::Technique& technique : techniques::all_techniques()) {
        techniques::TechniqueRequest request = always;
        for (std::size_t i = 0; i < kChoices.size(); ++i) {
            techniques::TechniqueRequest alone = always;
            kChoices[i].copy(wanted, alone);
            try {
                (void)techniques::resolve_settings(technique, alone);
                kChoices[i].copy(wanted, request);
                taken[i] = true;
            } catch (const Error& error) {
                if (refusals[i].empty()) refusals[i] = error.what();
            }
        }
        runs.push_back({technique, techniques::resolve_settings(technique, request)});
    }
    for (std::size_t i = 0; i < kChoices.size(); ++i)
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

std::vector<PlannedRun> plan_runs(const RenderRequest& request) {
    if (request.technique == "all") return plan_all(request.choices);
    const techniques::Technique& technique = techniques::find_technique(request.technique);
    return {{technique, techniques::resolve_settings(technique, request.choices)}};
}

}  // namespace gnomon::studies
