// From what was asked for to what will run: scene and technique settings.
#include "scenes/procedural.h"
#include "studies/experiment.h"

#include <algorithm>
#include <iterator>
#include <system_error>

namespace gnomon::studies {

namespace {

using techniques::TechniqueRequest;

bool has_parameter(std::span<const techniques::Parameter> parameters, std::string_view name) {
    return std::ranges::find(parameters, name, &techniques::Parameter::name) != parameters.end();
}

/// Of the splits of a technique that has any.
bool has_split_parameter(const techniques::Technique& technique, const TechniqueRequest& request, std::string_view name) {
    return request.cascades.value_or(technique.default_cascades) > 0 && has_parameter(techniques::cascade_parameters(), name);
}

/// The parameters that a technique has, of those that were set; a value that it does not take is an error when it resolves
/// them.
techniques::ParameterTexts set_of(const techniques::Technique& technique, const TechniqueRequest& wanted) {
    techniques::ParameterTexts own;
    std::ranges::copy_if(wanted.set, std::back_inserter(own), [&](const auto& text) {
        return has_parameter(technique.parameters, text.first) || has_split_parameter(technique, wanted, text.first);
    });
    return own;
}

/// Throws Error for a parameter that no technique has.
void check_set(const TechniqueRequest& wanted) {
    const auto is_known = [&](const techniques::Technique& technique, std::string_view name) {
        return has_parameter(technique.parameters, name) || has_split_parameter(technique, wanted, name);
    };
    for (const auto& [name, text] : wanted.set)
        if (std::ranges::none_of(techniques::all_techniques(),
                                 [&](const techniques::Technique& technique) { return is_known(technique, name); }))
            fail("--set {}={}: no technique has a parameter of that name (gnomon list techniques shows them)", name, text);
}

/// One choice that a technique may not offer: takes it over into a request that lacks it.
using TakeChoice = void (*)(const TechniqueRequest& from, TechniqueRequest& to);

/// All techniques; a choice that one of them does not offer leaves its default there.
std::vector<PlannedRun> plan_all(const TechniqueRequest& wanted, const Profile& profile) {
    constexpr std::array<TakeChoice, 3> kChoices{
        [](const TechniqueRequest& from, TechniqueRequest& to) { to.format = from.format; },
        [](const TechniqueRequest& from, TechniqueRequest& to) { to.filter = from.filter; },
        [](const TechniqueRequest& from, TechniqueRequest& to) { to.anisotropy = from.anisotropy; }};
    check_set(wanted);
    std::array<std::string, kChoices.size()> refusals;  // the first one
    std::array<bool, kChoices.size()> taken{};
    std::vector<PlannedRun> runs;
    for (const techniques::Technique& technique : techniques::all_techniques()) {
        TechniqueRequest request = wanted;
        request.format.reset();
        request.filter.reset();
        request.anisotropy.reset();
        request.set = set_of(technique, wanted);
        (void)techniques::resolve_settings(technique, request, profile);
        for (std::size_t i = 0; i < kChoices.size(); ++i) {
            TechniqueRequest more = request;
            kChoices[i](wanted, more);
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

std::vector<PlannedRun> plan_runs(const RenderRequest& request, const Profile& profile) {
    if (request.technique == "all") return plan_all(request.choices, profile);
    const techniques::Technique& technique = techniques::find_technique(request.technique);
    return {{technique, techniques::resolve_settings(technique, request.choices, profile)}};
}

}  // namespace gnomon::studies
