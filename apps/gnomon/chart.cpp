// gnomon chart: the test scenes of texture filters as pictures.
#include "commands.h"

#include "parse.h"
#include "sim/error.h"
#include "sim/parallel.h"
#include "studies/filter_charts.h"
#include "studies/image_io.h"
#include "studies/output_folder.h"
#include "terminal.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace gnomon::cli {

namespace {

using studies::ChartEntry;
using studies::ChartFilter;
using studies::ChartScene;

struct ChartOptions {
    std::string scene = "all";
    std::string profile = "d3d11";
    std::string filter = "trilinear,aniso";
    std::string max_aniso;
    std::string format = "rgba8unorm";
    std::string size = "512x512";
    std::string threads = "0";
    std::string out;
};

/// What the options ask for, checked.
struct ChartPlan {
    std::vector<ChartScene> scenes;
    std::vector<Profile> profiles;
    std::vector<ChartFilter> filters;
    int max_anisotropy = 16;
    Format format = Format::Rgba8Unorm;
    int width = 0;
    int height = 0;
    int threads = 0;
};

/// "a,b,c": at least one part, none twice.
std::vector<std::string> parts_of(const std::string& text, std::string_view option) {
    std::vector<std::string> parts;
    for (std::size_t first = 0; first <= text.size();) {
        const std::size_t comma = std::min(text.find(',', first), text.size());
        parts.push_back(text.substr(first, comma - first));
        if (parts.back().empty()) fail("{} {}: expected names with one comma between them", option, text);
        if (std::ranges::count(parts, parts.back()) > 1) fail("{} {}: '{}' is there twice", option, text, parts.back());
        first = comma + 1;
    }
    return parts;
}

/// Names of profiles become names of files.
Profile chart_profile(const std::string& name) {
    Profile profile = load_profile(name);
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_';
    };
    if (profile.name.empty() || !std::ranges::all_of(profile.name, plain))
        fail("--profile {}: its name '{}' cannot be part of a file name; expected letters, digits, '-', '.' and '_'", name,
             profile.name);
    return profile;
}

ChartPlan plan_of(const ChartOptions& options) {
    ChartPlan plan;
    if (options.scene == "all") {
        for (const auto& entry : kEnumNames<ChartScene>) plan.scenes.push_back(entry.value);
    } else {
        plan.scenes.push_back(enum_from_name<ChartScene>(options.scene, "--scene"));
    }
    for (const std::string& name : parts_of(options.profile, "--profile")) {
        plan.profiles.push_back(chart_profile(name));
        if (std::ranges::count(plan.profiles, plan.profiles.back().name, &Profile::name) > 1)
            fail("--profile {}: two profiles are called '{}'", options.profile, plan.profiles.back().name);
    }
    for (const std::string& name : parts_of(options.filter, "--filter"))
        plan.filters.push_back(enum_from_name<ChartFilter>(name, "--filter"));
    if (!options.max_aniso.empty()) {
        if (std::ranges::find(plan.filters, ChartFilter::Aniso) == plan.filters.end())
            fail("--max-aniso {}: needs --filter aniso", options.max_aniso);
        plan.max_anisotropy = parse_int(options.max_aniso, "--max-aniso", 1, 16);
    }
    plan.format = enum_from_name<Format>(options.format, "--format");
    if (format_info(plan.format).is_integer()) fail("--format {}: holds integers, which filters do not read", options.format);
    std::tie(plan.width, plan.height) = parse_size(options.size, "--size");
    plan.threads = parse_int(options.threads, "--threads", 0, kMaxThreads);
    return plan;
}

std::vector<ChartEntry> entries_of(const ChartPlan& plan) {
    std::vector<ChartEntry> entries;
    for (const ChartScene scene : plan.scenes)
        for (const Profile& profile : plan.profiles)
            for (const ChartFilter filter : plan.filters)
                entries.push_back(
                    {.scene = std::string(name_of(scene)),
                     .profile = profile.name,
                     .filter = std::string(name_of(filter)),
                     .elliptical = studies::is_elliptical(studies::chart_sampler(filter, plan.max_anisotropy), profile)});
    return entries;
}

/// Every file of a run, the page last.
std::vector<std::string> files_of(const std::vector<ChartEntry>& entries) {
    std::vector<std::string> files;
    for (const ChartEntry& entry : entries)
        for (const std::string_view suffix : {studies::kPictureSuffix, studies::kLodSuffix, studies::kProbesSuffix})
            files.push_back(chart_file(entry, suffix));
    files.emplace_back("index.html");
    return files;
}

void write_page(const std::filesystem::path& path, const std::vector<ChartEntry>& entries, const ChartPlan& plan) {
    std::ofstream stream(path, std::ios::binary);
    stream << studies::charts_html(entries,
                                   fmt::format("A texture of 256x256 texels in {}, pictures of {}x{} pixels, anisotropy up "
                                               "to {}. Click a picture for its full size.",
                                               name_of(plan.format), plan.width, plan.height, plan.max_anisotropy));
    stream.close();
    if (!stream) fail("{}: cannot be written", path.string());
}

/// Counts in `finished` what is drawn and written.
void draw_charts(const studies::OutputFolder& folder, const ChartPlan& plan, const std::vector<ChartEntry>& entries,
                 std::size_t& finished) {
    ProgressLine line;
    const Progress progress = line.progress();
    Workers workers(plan.threads);
    auto entry = entries.begin();
    for (const ChartScene scene : plan.scenes) {
        const studies::ChartView view{.scene = scene, .width = plan.width, .height = plan.height};
        for (const Profile& profile : plan.profiles) {
            const Texture texture = studies::chart_texture(scene, plan.format, profile, workers);
            for (const ChartFilter filter : plan.filters) {
                const Sampler sampler = studies::chart_sampler(filter, plan.max_anisotropy);
                const studies::Chart chart = studies::draw_chart(view, texture, sampler, profile, workers, progress);
                progress.step("writing", 0, 0);
                write_png(folder.file(chart_file(*entry, studies::kPictureSuffix)), chart.picture);
                write_png(folder.file(chart_file(*entry, studies::kLodSuffix)), chart.lod);
                write_png(folder.file(chart_file(*entry, studies::kProbesSuffix)), chart.probes);
                ++entry;
                ++finished;
            }
        }
    }
    progress.step("writing", 0, 0);
}

void chart(const ChartOptions& options) {
    const ChartPlan plan = plan_of(options);
    catch_stop_signals();
    const std::vector<ChartEntry> entries = entries_of(plan);
    const std::vector<std::string> files = files_of(entries);
    studies::OutputFolder folder(options.out);
    folder.check_replaceable(files);
    std::size_t finished = 0;
    try {
        draw_charts(folder, plan, entries, finished);
    } catch (const Stopped&) {
        if (finished > 0) folder.commit(files);  // without the page, which shows all of them
        throw;
    }
    write_page(folder.file(files.back()), entries, plan);
    folder.commit(files);
    fmt::print("{}: {} charts; index.html shows them\n", options.out, entries.size());
}

}  // namespace

void add_chart(CLI::App& app) {
    CLI::App* command = app.add_subcommand("chart", "Draw the test scenes of texture filters");
    const auto options = std::make_shared<ChartOptions>();
    command->add_option("--scene", options->scene, "Scene: " + names_of<ChartScene>() + ", or all")->capture_default_str();
    command->add_option("--profile", options->profile, "Hardware profiles, presets or JSON files, with commas between them")
        ->type_name("P[,P...]")
        ->capture_default_str();
    command->add_option("--filter", options->filter, "Filters, with commas between them: " + names_of<ChartFilter>())
        ->type_name("F[,F...]")
        ->capture_default_str();
    command->add_option("--max-aniso", options->max_aniso, "Limit of anisotropy, 1 to 16 (16)")->type_name("N");
    command->add_option("--format", options->format, "Texel format (gnomon list formats)")->capture_default_str();
    command->add_option("--size", options->size, "Picture in pixels")->type_name("WxH")->capture_default_str();
    command->add_option("--threads", options->threads, "Worker threads, 0 for all processors; changes no result")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--out", options->out, "Folder of the pictures; made when it is not there")
        ->type_name("DIR")
        ->required();
    command->footer(
        "plane:  a checkerboard to the horizon; shows moire, blur and anisotropy.\n"
        "tunnel: a colour per mip level; rings show the level of detail, their shape how it depends on the angle.\n"
        "angles: the plane in 24 directions.\n"
        "Per scene, profile and filter DIR gets the picture, _lod.png (grey magnified, then red, orange, yellow, green, cyan,\n"
        "blue, violet, pink, white for levels 0 to 8) and _probes.png (1 to 16 from dark blue to yellow; of elliptical "
        "filters\n"
        "texels, 4 to 512 and more in half octaves); index.html shows all of them.\n"
        "  gnomon chart --profile d3d11,nv40,ideal --filter bilinear,trilinear,aniso --out out/charts");
    command->callback([options] { chart(*options); });
}

}  // namespace gnomon::cli
