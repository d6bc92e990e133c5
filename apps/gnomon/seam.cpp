// gnomon seam: the quad whose lanes go apart, what it does to the level of detail, and what every cure makes of it.
#include "commands.h"

#include "request_options.h"
#include "sim/error.h"
#include "sim/profile.h"
#include "studies/configuration.h"
#include "studies/image_io.h"
#include "studies/output_folder.h"
#include "studies/result_files.h"
#include "studies/seams/cases.h"
#include "studies/seams/report.h"
#include "studies/seams/splits.h"
#include "terminal.h"

#include <algorithm>
#include <cstdio>
#include <functional>

namespace gnomon::cli {

namespace {

struct SeamOptions {
    RequestOptions asked;
    std::string case_name;
    std::string cure = "all";
    std::string out;
};

/// What is looked at: its cures, and how one of them is drawn.
struct SeamSubject {
    std::vector<std::string_view> cures;  // "none" first
    std::string_view reference;
    std::function<studies::SeamImage(std::string_view cure, const Progress&)> draw;
    traces::Json configuration;
};

/// Splits are what a technique without them is given.
constexpr int kCascades = 4;

SeamSubject split_subject(const SeamOptions& options) {
    auto request = std::make_shared<studies::RenderRequest>(options.asked.checked());
    if (request->technique == "all") fail("--technique all: expected one technique (gnomon list techniques)");
    for (const auto& [name, value] : request->choices.set)
        if (name == "cure") fail("--set cure={}: a seam is drawn with all cures, or with the one that --cure names", value);
    const techniques::Technique& technique = techniques::find_technique(request->technique);
    if (!request->choices.cascades && technique.default_cascades == 0) request->choices.cascades = kCascades;

    auto profile = std::make_shared<Profile>(load_profile(request->profile));
    auto plan = std::make_shared<studies::PlannedRun>(studies::plan_runs(*request, *profile).front());
    auto scene = std::make_shared<scenes::Scene>(studies::find_scene(request->scene, request->file_options));
    const int cascades = plan->settings.cascades;
    if (cascades == 0)
        fail("--cascades 0: {} has no splits then; expected 1 to {}", request->technique, techniques::kMaxCascades);
    return {.cures = studies::split_cures(),
            .reference = "explicit-gradients",
            .draw =
                [=](std::string_view cure, const Progress& progress) {
                    return studies::draw_split_seams(*scene, *profile, *request, *plan, cure, progress);
                },
            .configuration = studies::configuration_json(*request, plan->settings, *profile)};
}

SeamSubject case_subject(const SeamOptions& options) {
    const studies::SeamCase& seam = studies::find_seam_case(options.case_name);
    auto profile = std::make_shared<Profile>(load_profile(options.asked.request.profile));
    const int threads = options.asked.request.threads;
    return {.cures = seam.cures,
            .reference = seam.reference,
            .draw =
                [=, &seam](std::string_view cure, const Progress& progress) {
                    Device device(*profile, threads);
                    device.set_stop(progress.stop);
                    device.set_observer([&](const Command&) { progress.step(cure, 0, 0); });
                    return seam.draw(device, cure);
                },
            .configuration = {{"case", seam.name}, {"profile", traces::Json::parse(profile_to_json(*profile))}}};
}

constexpr std::string_view kValue = "value";

std::string picture_name(std::string_view cure, std::string_view picture) { return fmt::format("{}-{}.png", cure, picture); }

/// Every file that a seam with these cures may write, the table last.
std::vector<std::string> file_names(const std::vector<std::string_view>& cures) {
    std::vector<std::string> names;
    for (const std::string_view cure : cures) {
        for (const std::string_view picture : studies::seam_picture_names()) names.push_back(picture_name(cure, picture));
        names.push_back(picture_name(cure, kValue));
    }
    names.insert(names.end(), {"seams.txt", "seams.json"});
    return names;
}

void write_pictures(const studies::OutputFolder& folder, const studies::SeamRun& run) {
    for (const studies::SeamPicture& picture : studies::seam_pictures(run.image))
        studies::write_png(folder.file(picture_name(run.cure, picture.name)), picture.image);
    studies::FloatImage values{run.image.width, run.image.height, {}};
    for (const studies::SeamPixel& pixel : run.image.pixels) values.values.push_back(pixel.drawn() ? pixel.value : 1.0f);
    studies::write_png(folder.file(picture_name(run.cure, kValue)), studies::grey_image(values));
}

/// Throws Error for options that a small case has no use for.
void check_case_options(const CLI::App& command) {
    for (const char* name :
         {"--scene", "--ground", "--auto-view", "--size", "--technique", "--map", "--format", "--filter", "--aniso",
          "--cascades", "--map-samples", "--set", "--taps", "--blur", "--min-variance", "--depth-bias", "--slope-bias"})
        if (command.get_option(name)->count() > 0) fail("{}: says how a scene is drawn; --case draws none", name);
}

void run(const SeamOptions& options, const CLI::App& command) {
    const bool is_case = !options.case_name.empty();
    if (is_case) check_case_options(command);
    if (!is_case && options.asked.request.scene.empty())
        fail("seam: expected --scene, or --case (gnomon list seams names the cases)");
    const SeamSubject subject = is_case ? case_subject(options) : split_subject(options);
    std::vector<std::string_view> cures = subject.cures;
    if (options.cure != "all") {
        if (std::ranges::find(cures, options.cure) == cures.end())
            fail("--cure {}: expected all or one of {}", options.cure, fmt::join(cures, ", "));
        cures = {options.cure};
    }
    catch_stop_signals();
    studies::OutputFolder folder(options.out);
    folder.check_replaceable(file_names(subject.cures));

    std::vector<studies::SeamRun> runs;
    const auto commit = [&] {
        std::string text = studies::seam_header();
        for (const studies::SeamRun& seam : runs) text += studies::seam_line(seam);
        studies::write_text(folder.file("seams.txt"), text);
        studies::write_text(folder.file("seams.json"), studies::seam_json(subject.configuration, runs));
        folder.commit(file_names(subject.cures));
    };
    fmt::print("{}", studies::seam_header());
    std::fflush(stdout);
    try {
        ProgressLine line;
        const Progress progress = line.progress();
        const studies::SeamImage uncured = subject.draw("none", progress);
        const studies::SeamImage reference = subject.draw(subject.reference, progress);
        for (const std::string_view cure : cures) {
            studies::SeamRun seam{.cure = std::string(cure), .image = {}, .measures = {}};
            seam.image = cure == "none" ? uncured : cure == subject.reference ? reference : subject.draw(cure, progress);
            seam.measures = studies::measure_seam(seam.image, uncured, reference);
            write_pictures(folder, seam);
            seam.image.pixels.clear();
            runs.push_back(std::move(seam));
            line.print(studies::seam_line(runs.back()));
        }
    } catch (...) {  // stopped: what is finished stays
        if (!runs.empty()) commit();
        throw;
    }
    commit();
}

}  // namespace

void add_seam(CLI::App& app) {
    CLI::App* command = app.add_subcommand("seam", "Find the quads whose lanes go apart, and compare the cures");
    const auto options = std::make_shared<SeamOptions>();
    options->asked.request.scene.clear();
    options->asked.request.technique = "psvsm";
    command->add_option("--case", options->case_name, "A small case instead of a scene (gnomon list seams)")->type_name("NAME");
    command
        ->add_option("--cure", options->cure,
                     "One cure (none, quad-min, ...; of a small case as gnomon list seams shows them), or all [all]")
        ->type_name("NAME|all");
    add_scene_options(*command, options->asked);
    add_technique_options(*command, options->asked, "Shadow technique [psvsm]; without --cascades it gets 4 splits");
    add_machine_options(*command, options->asked);
    command->add_option("--out", options->out, "Folder of table and pictures; made when it is not there")
        ->type_name("DIR")
        ->required();
    command->footer(
        "DIR gets seams.txt, seams.json and, for each cure, CURE-choice.png (which split, layer, page, ...), "
        "CURE-disagreeing.png,\nCURE-lod-error.png (red too coarse, blue too fine), CURE-lod.png, CURE-probes.png, "
        "CURE-derivatives.png and\nCURE-value.png. docs/seams.md explains the columns.\n\n"
        "Examples:\n"
        "  gnomon seam --scene city --technique psvsm --out out/seam\n"
        "  gnomon seam --scene fence --technique lvsm --cascades 8 --cure quad-min --out out/seam\n"
        "  gnomon seam --case atlas --out out/atlas");
    command->callback([options, command] { run(*options, *command); });
}

}  // namespace gnomon::cli
