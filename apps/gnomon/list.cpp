// gnomon list: what there is to choose from.
#include "commands.h"

#include "scenes/camera_path.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "sim/profile.h"
#include "studies/seams/cases.h"
#include "studies/study.h"
#include "techniques/technique.h"
#include "texunit/format.h"

#include <algorithm>
#include <cstdio>

namespace gnomon::cli {

namespace {

template <NamedEnum E>
std::string joined(std::span<const E> values) {
    std::string all;
    for (const E value : values) {
        all += all.empty() ? "" : ", ";
        all += name_of(value);
    }
    return all;
}

void list_scenes() {
    fmt::print("scenes (--scene; a .gltf or .glb file works too)\n");
    for (const scenes::ProceduralScene& scene : scenes::procedural_scenes())
        fmt::print("  {:<14} {}\n  {:<14} {} triangles\n", scene.name, scene.summary, "", scene.make().triangle_count());
}

/// "rg32f 8, rg16f 4": bytes per texel of the map in each format.
std::string storage_of(const techniques::Technique& technique) {
    std::string all;
    for (const Format format : technique.formats) {
        const auto settings = techniques::resolve_settings(technique, {.map_size = 64, .format = format});
        all += fmt::format("{}{} {:g}", all.empty() ? "" : ", ", name_of(format),
                           techniques::storage_per_texel(technique, settings));
    }
    return all;
}

void list_parameters(std::span<const techniques::Parameter> parameters, bool verbose) {
    if (!verbose) {
        std::string set;
        for (const techniques::Parameter& p : parameters)
            set += fmt::format("{}{}={}", set.empty() ? "" : ", ", p.name, techniques::text_of(p, p.standard));
        if (!set.empty()) fmt::print("  {:<14} --set    {}\n", "", set);
        return;
    }
    for (const techniques::Parameter& p : parameters)
        fmt::print("  {:<14} --set {}={}: {}; {}\n", "", p.name, techniques::text_of(p, p.standard), p.summary,
                   techniques::range_of(p));
}

void list_techniques(bool verbose) {
    fmt::print("techniques (--technique; 'all' is every one; defaults come first{})\n",
               verbose ? "" : "; --verbose explains the parameters");
    for (const techniques::Technique& t : techniques::all_techniques()) {
        fmt::print("  {:<14} {}\n", t.name, t.summary);
        fmt::print("  {:<14} source   {}\n", "", t.source);
        fmt::print("  {:<14} --format {} (bytes per texel of the map)\n", "", storage_of(t));
        fmt::print("  {:<14} --filter {}; --aniso {} (1 to 16); --cascades {} (0 to {})\n", "", joined(t.filters),
                   t.default_anisotropy, t.default_cascades, techniques::kMaxCascades);
        fmt::print("  {:<14} --depth-bias {}, --slope-bias {}\n", "", t.default_depth_bias, t.default_slope_bias);
        list_parameters(t.parameters, verbose);
    }
    fmt::print("  with --cascades N every technique takes besides\n");
    list_parameters(techniques::cascade_parameters(), verbose);
}

void list_profiles(bool verbose) {
    fmt::print("profiles (--profile; a JSON file works too{})\n",
               verbose ? "" : "; --verbose shows every field and its source");
    for (const Profile& profile : profile_presets()) {
        fmt::print("  {:<14} {}\n", profile.name, profile.summary);
        if (!verbose) continue;
        const auto said = provenance_of(profile.name);
        for_each_field(profile, [&](std::string_view name, const auto& value) {
            const auto entry = std::ranges::find(said, name, &Provenance::field);
            if (entry == said.end()) return;
            fmt::print("    {:<20} {:<13} {:<11} {}\n", name, field_text(value), name_of(entry->certainty), entry->source);
        });
    }
}

void list_formats() {
    fmt::print("formats (--format; which ones a technique takes: gnomon list techniques)\n");
    fmt::print("  {:<14} {:>10} {:>14} {:>12} {:>15}\n", "", "components", "bits/component", "bytes/texel", "bytes as stored");
    for (const FormatInfo& format : kFormats)
        fmt::print("  {:<14} {:>10} {:>14} {:>12} {:>15}{}\n", format.name, format.components, format.bits_per_component,
                   format.components * format.bits_per_component / 8, format.bytes_per_texel,
                   format.has_stencil ? "  and a byte of stencil" : "");
}

void list_studies() {
    fmt::print("studies (gnomon study NAME)\n");
    for (const studies::Study& study : studies::all_studies())
        fmt::print("  {:<14} {}\n  {:<14} {} cases on {}; source {}\n", study.name, study.summary, "", study.cases.size(),
                   fmt::join(study.scenes, ", "), study.source);
}

void list_seams() {
    fmt::print("seams (gnomon seam --case NAME; the splits of a scene: gnomon seam --scene NAME)\n");
    for (const studies::SeamCase& seam : studies::all_seam_cases())
        fmt::print("  {:<14} {}\n  {:<14} cures {}; source {}\n  {:<14} {}\n", seam.name, seam.summary, "",
                   fmt::join(seam.cures, ", "), seam.source, "", seam.expectation);
}

void list_paths() {
    fmt::print("paths of the camera (gnomon render --frames N --path NAME)\n");
    for (const scenes::CameraPath& path : scenes::camera_paths()) fmt::print("  {:<14} {}\n", path.name, path.summary);
}

struct ListOptions {
    std::string what;
    bool verbose = false;
};

void list(const ListOptions& options) {
    const bool everything = options.what.empty();
    const auto chosen = [&](std::string_view name) { return everything || options.what == name; };
    if (chosen("scenes")) list_scenes();
    if (chosen("techniques")) list_techniques(options.verbose);
    if (chosen("studies")) list_studies();
    if (chosen("seams")) list_seams();
    if (chosen("paths")) list_paths();
    if (chosen("profiles")) list_profiles(options.verbose);
    if (chosen("formats")) list_formats();
}

}  // namespace

void add_list(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("list", "Show scenes, techniques, studies, seams, camera paths, profiles and formats");
    const auto options = std::make_shared<ListOptions>();
    command
        ->add_option("what", options->what,
                     "scenes, techniques, studies, seams, paths, profiles or formats; all of them without it")
        ->type_name("WHAT");
    command->add_flag("--verbose", options->verbose,
                      "Explain every parameter of every technique, and every field of every profile with its source");
    command->callback([options] {
        constexpr std::array<std::string_view, 8> kWhat{"",      "scenes", "techniques", "studies",
                                                        "seams", "paths",  "profiles",   "formats"};
        if (std::ranges::find(kWhat, options->what) == kWhat.end())
            fail("list {}: expected scenes, techniques, studies, seams, paths, profiles or formats", options->what);
        list(*options);
    });
}

}  // namespace gnomon::cli
