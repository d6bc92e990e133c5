// Files with KHR_draco_mesh_compression: the parser refuses primitives whose accessors have no data, so they are taken out
// first.
#pragma once

#include <string>
#include <vector>

namespace gnomon::scenes {

/// Removes from a .gltf or .glb in memory every Draco-compressed primitive that has no uncompressed fallback; true if there was
/// one. Leaves anything that is not a well-formed file as it is: the parser will say what is wrong with it.
bool drop_draco_primitives(std::vector<unsigned char>& bytes, bool binary);

}  // namespace gnomon::scenes
