// Options to a RenderRequest.
#include "request_options.h"

#include "parse.h"
#include "sim/error.h"
#include "sim/parallel.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace gnomon::cli {

namespace {

/// "name=value", name by name. Throws Error.
techniques::ParameterTexts parse_set(const std::vector<std::string>& texts) {
    techniques::ParameterTexts set;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos) fail("--set {}: expected NAME=VALUE", text);
        set.emplace_back(text.substr(0, equals), text.substr(equals + 1));
        if (std::ranges::count(set, set.back().first, &std::pair<std::string, std::string>::first) > 1)
            fail("--set {}: {} is set twice", text, set.back().first);
    }
    return set;
}

}  // namespace

studies::RenderRequest RequestOptions::checked() const {
    studies::RenderRequest all = request;
    all.choices.set = parse_set(set_texts);
    return all;
}

void add_scene_options(CLI::App& command, RequestOptions& options) {
    studies::RenderRequest& request = options.request;
    constexpr auto kGroup = "Scene and truth";
    command.add_option("--scene", request.scene, "Built-in scene (gnomon list scenes), or a .gltf or .glb file")
        ->type_name("NAME|FILE")
        ->group(kGroup);
    command.add_flag("--ground", request.file_options.ground, "Put the model of a file on a ground plane")->group(kGroup);
    command
        .add_flag("--auto-view", request.file_options.automatic_view, "Choose camera and light even where the file has them")
        ->group(kGroup);
    command
        .add_option_function<std::string>(
            "--size",
            [&request](const std::string& text) { std::tie(request.width, request.height) = parse_size(text, "--size"); },
            "Image in pixels [1024x768]")
        ->type_name("WxH")
        ->group(kGroup);
}

void add_truth_options(CLI::App& command, RequestOptions& options) {
    studies::RenderRequest& request = options.request;
    constexpr auto kGroup = "Scene and truth";
    command
        .add_option_function<std::string>(
            "--reference",
            [&request](const std::string& text) { request.truth = enum_from_name<studies::Truth>(text, "--reference"); },
            "Ray-traced truth: none, center (a ray per pixel) or area (64 rays per pixel) [center]")
        ->type_name("MODE")
        ->group(kGroup);
    command
        .add_option_function<std::string>(
            "--seed", [&request](const std::string& text) { request.seed = parse_u64(text, "--seed"); },
            "Seed of the rays of --reference area [1]")
        ->type_name("N")
        ->group(kGroup);
}

void add_technique_options(CLI::App& command, RequestOptions& options, const std::string& about) {
    techniques::TechniqueRequest& choices = options.request.choices;
    constexpr auto kGroup = "Technique (gnomon list techniques shows what each takes, and its defaults)";
    const auto add = [&](const std::string& name, const char* type, const std::string& help, auto take) {
        command.add_option_function<std::string>(name, take, help)->type_name(type)->group(kGroup);
    };
    command.add_option("--technique", options.request.technique, about)->type_name("NAME")->group(kGroup);
    add("--map", "N", "Shadow map in texels per side, of each split where there are several, 1 to 16384 [1024]",
        [&choices](const std::string& text) { choices.map_size = parse_int(text, "--map", 1, kMaxTextureSize); });
    add("--format", "F", "Texel format of the map (gnomon list formats)",
        [&choices](const std::string& text) { choices.format = enum_from_name<Format>(text, "--format"); });
    add("--filter", "KIND", "How the map is filtered: nearest, bilinear, trilinear or shader-bilinear",
        [&choices](const std::string& text) { choices.filter = enum_from_name<techniques::MapFilter>(text, "--filter"); });
    add("--aniso", "N", "Limit of the anisotropy of the filter, 1 to 16",
        [&choices](const std::string& text) { choices.anisotropy = parse_int(text, "--aniso", 1, 16); });
    add("--cascades", "N", "Maps, one for each split of the view frustum, 1 to 8; 0: one map of all that the light sees",
        [&choices](const std::string& text) { choices.cascades = parse_int(text, "--cascades", 0, techniques::kMaxCascades); });
    add("--map-samples", "N", "Samples per texel of the light pass, 1 to 16 [1]",
        [&choices](const std::string& text) { choices.map_samples = parse_int(text, "--map-samples", 1, 16); });
    command
        .add_option("--set", options.set_texts,
                    "A parameter of the technique (gnomon list techniques --verbose); may be repeated")
        ->type_name("NAME=VALUE")
        ->group(kGroup);
    for (const char* name : {"taps", "blur", "min-variance"})
        add(fmt::format("--{}", name), "X", fmt::format("Short for --set {}=X", name),
            [&options, name](const std::string& text) { options.set_texts.push_back(fmt::format("{}={}", name, text)); });
    add("--depth-bias", "N", "Depth bias of the light pass, in steps of the depth format", [&choices](const std::string& text) {
        choices.depth_bias = parse_int(text, "--depth-bias", std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
    });
    add("--slope-bias", "X", "Slope-scaled depth bias of the light pass",
        [&choices](const std::string& text) { choices.slope_bias = parse_number(text, "--slope-bias"); });
}

void add_machine_options(CLI::App& command, RequestOptions& options) {
    constexpr auto kGroup = "Machine";
    command.add_option("--profile", options.request.profile, "Hardware profile (gnomon list profiles), or a JSON file [d3d11]")
        ->type_name("NAME|FILE")
        ->group(kGroup);
    command
        .add_option_function<std::string>(
            "--threads",
            [&options](const std::string& text) { options.request.threads = parse_int(text, "--threads", 0, kMaxThreads); },
            "Worker threads, 0 for all processors; changes no result [0]")
        ->type_name("N")
        ->group(kGroup);
}

}  // namespace gnomon::cli
