// gnomon render: a scene through one technique or all, measured, into a folder.
#include "commands.h"

#include "parse.h"
#include "request_options.h"
#include "scenes/camera_path.h"
#include "sim/error.h"
#include "studies/experiment.h"
#include "studies/report.h"
#include "studies/result_files.h"
#include "studies/sequence.h"
#include "terminal.h"
#include "traces/command_log.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <optional>

namespace gnomon::cli {

namespace {

namespace fs = std::filesystem;

struct RenderOptions {
    RequestOptions asked;
    std::string out;
    std::string log_commands;
    bool counters = false;
    std::optional<int> frames;
    std::string path;  // empty: not given
};

/// A log of commands that appears at its path when all of it is written.
class CommandLogFile {
public:
    explicit CommandLogFile(const std::string& path)
        : what_("--log-commands " + path), file_(path, what_), stream_(file_.staging(), std::ios::binary), log_(stream_) {}

    void write(const Command& command) { log_.write(command); }
    void commit() {
        stream_.close();
        if (!stream_) fail("{}: cannot be written", what_);
        file_.commit();
    }

private:
    std::string what_;
    studies::OutputFile file_;
    std::ofstream stream_;
    traces::CommandLog log_;
};

void print_result(const studies::RenderResult& result, const RenderOptions& options) {
    fmt::print("{}", studies::report_text(result));
    if (options.counters) fmt::print("\n{}", studies::counters_text(result));
}

/// One technique straight into the folder.
void render_one(studies::Experiment& experiment, const RenderOptions& options) {
    studies::OutputFolder folder(options.out);
    folder.check_replaceable(studies::result_file_names());
    std::optional<CommandLogFile> log;
    if (!options.log_commands.empty()) log.emplace(options.log_commands);
    std::optional<studies::RenderResult> result;
    {
        ProgressLine line;
        const Progress progress = line.progress();
        const auto on_command = [&](const Command& command) {
            if (log) log->write(command);
        };
        result = experiment.run(experiment.runs().front(), progress, on_command);
        progress.step("writing", 0, 0);
        studies::write_result(folder, *result, experiment.truth(progress));
        progress.step("writing", 0, 0);
    }
    folder.commit(studies::result_file_names());
    if (log) log->commit();
    print_result(*result, options);
}

/// Every technique into its own folder; each is complete as soon as it is there.
void render_all(studies::Experiment& experiment, const RenderOptions& options) {
    const auto folder_of = [&](const studies::PlannedRun& run) { return fs::path(options.out) / run.technique.name; };
    const studies::CreatedFolders root(options.out, "--out " + options.out);
    for (const studies::PlannedRun& run : experiment.runs())
        studies::OutputFolder(folder_of(run)).check_replaceable(studies::result_file_names());

    std::vector<studies::RenderResult> results;
    for (const studies::PlannedRun& run : experiment.runs()) {
        studies::OutputFolder folder(folder_of(run));
        std::optional<studies::RenderResult> result;
        {
            ProgressLine line;
            const Progress progress = line.progress();
            result = experiment.run(run, progress);
            progress.step("writing", 0, 0);
            studies::write_result(folder, *result, experiment.truth(progress));
            progress.step("writing", 0, 0);
        }
        folder.commit(studies::result_file_names());
        print_result(*result, options);
        fmt::print("\n");
        std::fflush(stdout);
        result->color = {};
        result->visibility = {};
        result->derivatives = {};
        results.push_back(std::move(*result));
    }
    fmt::print("{}", studies::comparison_text(results));
}

/// Frames of a moving camera, and one table.
void render_sequence(const RenderOptions& options, const studies::RenderRequest& render) {
    studies::SequenceRequest request{.render = render, .frames = *options.frames};
    if (!options.path.empty()) request.path = options.path;
    studies::Sequence sequence(request);
    studies::OutputFolder folder(options.out);
    folder.check_replaceable(studies::sequence_file_names(folder, request.frames));

    fmt::print("{}", studies::sequence_header(sequence));
    std::fflush(stdout);
    try {
        ProgressLine line;
        sequence.run(line.progress(), [&](const studies::SequenceRow& row, const studies::SequencePictures& pictures) {
            studies::write_frame(folder, row.frame, pictures);
            line.print(studies::sequence_line(row));
        });
    } catch (...) {  // stopped, or a frame failed: what is finished stays
        if (!sequence.rows().empty()) studies::commit_sequence(folder, sequence);
        throw;
    }
    studies::commit_sequence(folder, sequence);
    fmt::print("{}", studies::sequence_footer(sequence));
}

/// Throws Error for options that do not go with those of a sequence.
void check_sequence(const RenderOptions& options) {
    if (!options.frames) {
        if (!options.path.empty()) fail("--path {}: moves the camera of a sequence; expected --frames N with it", options.path);
        return;
    }
    if (options.asked.request.technique == "all") fail("--frames: renders one technique, not all of them");
    if (!options.log_commands.empty()) fail("--log-commands: records one frame, not a sequence (--frames)");
    if (options.counters) fail("--counters: counts one frame, not a sequence (--frames)");
    if (options.asked.request.derivatives) fail("--derivatives: shows one frame, not a sequence (--frames)");
}

void render(const RenderOptions& options) {
    const studies::RenderRequest request = options.asked.checked();
    if (request.technique == "all" && !options.log_commands.empty())
        fail("--log-commands: records one technique, not all of them");
    check_sequence(options);
    catch_stop_signals();
    if (options.frames) {
        render_sequence(options, request);
        return;
    }
    studies::Experiment experiment(request);
    if (request.technique == "all") {
        render_all(experiment, options);
    } else {
        render_one(experiment, options);
    }
}

void add_sequence_options(CLI::App& command, RenderOptions& options) {
    constexpr auto kGroup = "Moving camera";
    command
        .add_option_function<std::string>(
            "--frames",
            [&options](const std::string& text) { options.frames = parse_int(text, "--frames", 1, studies::kMaxFrames); },
            fmt::format("Render a sequence of 1 to {} frames and measure how steady shadows are", studies::kMaxFrames))
        ->type_name("N")
        ->group(kGroup);
    std::string names;
    for (const scenes::CameraPath& path : scenes::camera_paths())
        names += fmt::format("{}{}", names.empty() ? "" : ", ", path.name);
    command.add_option("--path", options.path, fmt::format("How the camera moves over the sequence: {} [walk]", names))
        ->type_name("NAME")
        ->group(kGroup);
}

void add_output_options(CLI::App& command, RenderOptions& options) {
    constexpr auto kGroup = "Output";
    command.add_option("--out", options.out, "Folder of the results; made when it is not there")
        ->type_name("DIR")
        ->required()
        ->group(kGroup);
    command
        .add_flag("--counters", options.counters,
                  "Print what every pass counted, and the bytes it read and wrote by resource (report.json always has both)")
        ->group(kGroup);
    command
        .add_flag("--derivatives", options.asked.request.derivatives,
                  "Write derivatives.png: which pixels took derivatives over helper, discarded or inactive lanes")
        ->group(kGroup);
    command.add_option("--log-commands", options.log_commands, "Write every device command of a frame as a line of JSON")
        ->type_name("FILE")
        ->group(kGroup);
}

}  // namespace

void add_render(CLI::App& app) {
    CLI::App* command = app.add_subcommand("render", "Render a scene with a shadow technique and measure it");
    const auto options = std::make_shared<RenderOptions>();
    add_scene_options(*command, options->asked);
    add_truth_options(*command, options->asked);
    add_technique_options(*command, options->asked,
                          "Shadow technique, or 'all': then an option that a technique does not take leaves it at its default");
    add_sequence_options(*command, *options);
    add_machine_options(*command, options->asked);
    for (const char* name : {"--scene", "--technique"}) command->get_option(name)->required();
    add_output_options(*command, *options);
    command->footer(
        "DIR gets color.png, visibility.exr and .png, reference.exr and .png, difference.png (white right, red too bright,\n"
        "blue too dark) and report.json; with --derivatives also derivatives.png. With --technique all each technique has a "
        "folder of its own in DIR.\n"
        "With --frames it gets frames/0000_color.png, _visibility.exr and _difference.png and so on, and the table as "
        "sequence.txt\n"
        "and sequence.json. Stopped with Ctrl-C, the frames that are finished stay.\n\n"
        "Examples:\n"
        "  gnomon render --scene car --technique vsm --map 512 --blur 5 --out out/car\n"
        "  gnomon render --scene bench --technique all --reference area --out out/bench\n"
        "  gnomon render --scene model.glb --ground --technique pcf --taps 5 --profile ideal --out out/model\n"
        "  gnomon render --scene city --technique vsm --cascades 4 --set snap=on --frames 32 --path walk --out out/walk");
    command->callback([options] { render(*options); });
}

}  // namespace gnomon::cli
