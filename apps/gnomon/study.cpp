// gnomon study: one question to many techniques, settings and scenes; a table.
#include "commands.h"

#include "parse.h"
#include "sim/error.h"
#include "sim/parallel.h"
#include "studies/output_folder.h"
#include "studies/result_files.h"
#include "studies/study.h"
#include "terminal.h"

#include <cstdio>

namespace gnomon::cli {

namespace {

struct StudyCommand {
    std::string name;
    std::vector<std::string> scenes;
    std::string size = "640x480";
    std::string reference = "area";
    std::string threads = "0";
    std::string out;
};

/// Both files of the rows so far.
void commit(studies::OutputFolder& folder, const studies::Study& study, const studies::StudyOptions& options,
            std::span<const studies::StudyRow> rows) {
    std::string text = studies::study_header();
    for (const studies::StudyRow& row : rows) text += studies::study_line(row);
    const std::string name(study.name);
    studies::write_text(folder.file(name + ".txt"), text);
    studies::write_text(folder.file(name + ".json"), studies::study_json(study, options, rows));
    folder.commit({name + ".txt", name + ".json"});
}

void run(const StudyCommand& command) {
    const studies::Study& study = studies::find_study(command.name);
    studies::StudyOptions options{.scenes = command.scenes};
    std::tie(options.width, options.height) = parse_size(command.size, "--size");
    options.truth = enum_from_name<studies::Truth>(command.reference, "--reference");
    if (options.truth == studies::Truth::None) fail("--reference none: a study measures errors; expected center or area");
    options.threads = parse_int(command.threads, "--threads", 0, kMaxThreads);
    catch_stop_signals();
    studies::OutputFolder folder(command.out);

    std::vector<studies::StudyRow> rows;
    fmt::print("{}", studies::study_header());
    std::fflush(stdout);
    try {
        ProgressLine line;
        studies::run_study(study, options, line.progress(), [&](const studies::StudyRow& row) {
            rows.push_back(row);
            line.print(studies::study_line(row));
        });
    } catch (...) {  // stopped, or a case failed: what is finished stays
        if (!rows.empty()) commit(folder, study, options, rows);
        throw;
    }
    commit(folder, study, options, rows);
}

}  // namespace

void add_study(CLI::App& app) {
    CLI::App* command = app.add_subcommand("study", "Put one question to many techniques, settings and scenes");
    const auto options = std::make_shared<StudyCommand>();
    command->add_option("name", options->name, "The study (gnomon list studies)")->type_name("NAME")->required();
    command->add_option("--scene", options->scenes, "Scenes or files instead of the study's own; may be repeated")
        ->type_name("NAME|FILE");
    command->add_option("--size", options->size, "Image in pixels")->type_name("WxH")->capture_default_str();
    command->add_option("--reference", options->reference, "Ray-traced truth: center or area")
        ->type_name("MODE")
        ->capture_default_str();
    command->add_option("--threads", options->threads, "Worker threads, 0 for all processors; changes no error")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--out", options->out, "Folder of the table; made when it is not there")->type_name("DIR")->required();
    command->footer(
        "DIR gets NAME.txt, the table as it is printed, and NAME.json with everything it takes to repeat a row by hand. "
        "Stopped\nwith Ctrl-C, the rows that are finished stay.\n"
        "  gnomon study equal-storage --out out/studies");
    command->callback([options] { run(*options); });
}

}  // namespace gnomon::cli
