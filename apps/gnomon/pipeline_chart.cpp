// gnomon pipeline-chart: what the pipeline draws, as one picture.
#include "commands.h"

#include "parse.h"
#include "sim/error.h"
#include "sim/parallel.h"
#include "studies/image_io.h"
#include "studies/output_folder.h"
#include "studies/pipeline_chart.h"

#include <cstdio>

namespace gnomon::cli {

namespace {

struct PipelineChartOptions {
    std::string profile = "d3d11";
    std::string threads = "0";
    std::string out;
};

void pipeline_chart(const PipelineChartOptions& options) {
    if (std::filesystem::path(options.out).extension() != ".png")
        fail("--out {}: expected a name that ends in .png", options.out);
    const Profile profile = load_profile(options.profile);
    const studies::ByteImage chart = studies::pipeline_chart(profile, parse_int(options.threads, "--threads", 0, kMaxThreads));
    studies::OutputFile file(options.out, "--out " + options.out);
    studies::write_png(file.staging(), chart);
    file.commit();
    fmt::print("{}: {}x{} pixels, profile {}\n", options.out, chart.width, chart.height, profile.name);
}

}  // namespace

void add_pipeline_chart(CLI::App& app) {
    CLI::App* command = app.add_subcommand("pipeline-chart", "Draw what the pipeline does as one picture");
    const auto options = std::make_shared<PipelineChartOptions>();
    command->add_option("--out", options->out, "The file to write")->type_name("FILE.png")->required();
    command->add_option("--profile", options->profile, "Hardware profile, preset or JSON file")->capture_default_str();
    command->add_option("--threads", options->threads, "Worker threads, 0 for all processors; changes no result")
        ->type_name("N")
        ->capture_default_str();
    command->footer(
        "Panels: one sample and four samples per pixel, aliased lines and quadrilateral ones; wireframe, stencil shadow\n"
        "volumes, blending, and what derivatives are taken over (docs/architecture.md).");
    command->callback([options] { pipeline_chart(*options); });
}

}  // namespace gnomon::cli
