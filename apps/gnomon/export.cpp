// gnomon export: a built-in scene as glTF.
#include "commands.h"

#include "scenes/gltf.h"
#include "sim/error.h"
#include "studies/experiment.h"
#include "studies/output_folder.h"

#include <cstdio>

namespace gnomon::cli {

namespace {

struct ExportOptions {
    std::string scene;
    std::string out;
    scenes::GltfOptions file_options{};
};

void export_scene(const ExportOptions& options) {
    if (std::filesystem::path(options.out).extension() != ".glb")
        fail("--out {}: expected a name that ends in .glb", options.out);
    const scenes::Scene scene = studies::find_scene(options.scene, options.file_options);
    studies::OutputFile file(options.out, "--out " + options.out);
    scenes::save_glb(scene, file.staging());
    file.commit();
    fmt::print("{}: {} triangles in {} meshes, {} instances\n", options.out, scene.triangle_count(), scene.meshes.size(),
               scene.instances.size());
}

}  // namespace

void add_export(CLI::App& app) {
    CLI::App* command = app.add_subcommand("export", "Write a scene as binary glTF 2.0");
    const auto options = std::make_shared<ExportOptions>();
    command->add_option("--scene", options->scene, "Built-in scene (gnomon list scenes), or a .gltf or .glb file")
        ->type_name("NAME|FILE")
        ->required();
    command->add_flag("--ground", options->file_options.ground, "Put the model of a file on a ground plane");
    command->add_flag("--auto-view", options->file_options.automatic_view,
                      "Choose camera and light even where the file has them");
    command->add_option("--out", options->out, "The file to write")->type_name("FILE.glb")->required();
    command->footer("Rendering the file gives the same bytes as rendering the scene.");
    command->callback([options] { export_scene(*options); });
}

}  // namespace gnomon::cli
