// gnomon seam: the quad whose lanes go apart, what it does to the level of detail, and what every cure makes of it.
#include "commands.h"

#include "request_options.h"
#include "sim/error.h"
#include "sim/profile.h"
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
    studies::SeamConfiguration configuration;
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
            .configuration = {{"scene", request->scene},
                              {"technique", request->technique},
                              {"cascades", std::to_string(cascades)},
                              {"map", std::to_string(plan->settings.map_size)},
                              {"size", fmt::format("{}x{}", request->width, request->height)},
                              {"profile", profile->name}}};
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
            .configuration = {{"case", std::string(seam.name)}, {"profile", profile->name}}};
}

/// The pictures of one cure, and their names.
std::vector<std::string> write_pictures(const studies::OutputFolder& folder, const studies::SeamRun& run) {
    std::vector<std::string> names;
    const auto add = [&](std::string_view picture, const studies::ByteImage& image) {
        names.push_back(fmt::format("{}-{}.png", run.cure, picture));
        studies::write_png(folder.file(names.back()), image);
    };
    for (const studies::SeamPicture& picture : studies::seam_pictures(run.image)) add(picture.name, picture.image);
    studies::FloatImage values{run.image.width, run.image.height, {}};
    for (const studies::SeamPixel& pixel : run.image.pixels) values.values.push_back(pixel.drawn() ? pixel.value : 1.0f);
    add("value", studies::grey_image(values));
    return names;
}

void run(const SeamOptions& options) {
    const bool is_case = !options.case_name.empty();
    if (is_case == !options.asked.request.scene.empty())
        fail("seam: expected either --scene and --technique, or --case (gnomon list seams)");
    const SeamSubject subject = is_case ? case_subject(options) : split_subject(options);
    std::vector<std::string_view> cures = subject.cures;
    if (options.cure != "all") {
        if (std::ranges::find(cures, options.cure) == cures.end())
            fail("--cure {}: expected all or one of {}", options.cure, fmt::join(cures, ", "));
        cures = {options.cure};
    }
    catch_stop_signals();
    studies::OutputFolder folder(options.out);

    std::vector<studies::SeamRun> runs;
    std::vector<std::string> names;
    const auto commit = [&] {
        std::string text = studies::seam_header();
        for (const studies::SeamRun& seam : runs) text += studies::seam_line(seam);
        studies::write_text(folder.file("seams.txt"), text);
        studies::write_text(folder.file("seams.json"), studies::seam_json(subject.configuration, runs));
        names.insert(names.end(), {"seams.txt", "seams.json"});
        folder.commit(names);
    };
    fmt::print("{}", studies::seam_header());
    std::fflush(stdout);
    try {
        ProgressLine line;
        const Progress progress = line.progress();
        const studies::SeamImage uncured = subject.draw("none", progress);
        const studies::SeamImage reference = subject.draw(subject.reference, progress);
        for (const std::string_view cure : cures) {
            studies::SeamRun seam{.cure = std::string(cure), .image = subject.draw(cure, progress), .measures = {}};
            seam.measures = studies::measure_seam(seam.image, uncured, reference);
            const std::vector<std::string> written = write_pictures(folder, seam);
            names.insert(names.end(), written.begin(), written.end());
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
    command->add_option("--cure", options->cure, "One cure, or all [all]")->type_name("NAME|all");
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
    command->callback([options] { run(*options); });
}

}  // namespace gnomon::cli
