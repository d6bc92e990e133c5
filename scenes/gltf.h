// glTF 2.0 and GLB, in and out.
#pragma once

#include "scenes/scene.h"

#include <filesystem>

namespace gnomon::scenes {

struct GltfOptions {
    bool automatic_view = false;  // choose camera and light even where the file has them
    bool ground = false;          // put the model on a ground plane below its lowest point, wide enough for its shadow
};

/// Reads a .gltf or .glb file. Throws Error with one line for anything malformed; warns once for valid features that are not
/// supported (skins, morph targets, Draco, textures). A camera or light that the file lacks is chosen from the bounds.
Scene load_gltf(const std::filesystem::path& path, const GltfOptions& options = {});

/// Writes a .glb that load_gltf reads back to the same scene, bit for bit. Throws Error when the file cannot be written and
/// removes it then; to replace a file in one step, write beside it and rename (studies::OutputFile).
void save_glb(const Scene& scene, const std::filesystem::path& path);

}  // namespace gnomon::scenes
