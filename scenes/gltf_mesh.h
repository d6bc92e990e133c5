// One glTF primitive as a triangle list. glTF 2.0 section 3.7.2
#pragma once

#include "scenes/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
struct Primitive;
}  // namespace tinygltf

namespace gnomon::scenes {

/// Positions, normals (flat ones where the file has none, section 3.7.2.1) and triangles of a primitive; base colour from its
/// material. Nothing for what cannot be drawn: points, lines, Draco without a fallback; `notes` says what was left out or stood
/// in for. `mirrored` turns the winding over, for instances whose transform does so again. Throws Error for anything malformed.
std::optional<Mesh> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& name,
                                   bool mirrored, const std::string& file, std::vector<std::string>& notes);

}  // namespace gnomon::scenes
