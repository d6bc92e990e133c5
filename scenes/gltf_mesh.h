// One glTF primitive as a triangle list. glTF 2.0 section 3.7.2
#pragma once

#include "scenes/scene.h"

#include <optional>
#include <string>

namespace tinygltf {
class Model;
struct Primitive;
}  // namespace tinygltf

namespace gnomon::scenes {

/// Positions, normals (flat ones where the file has none, section 3.7.2.1) and triangles of a primitive; base colour from its
/// material. Nothing, with a warning, for what cannot be drawn: points, lines, Draco without a fallback. `mirrored` turns the
/// winding over, for instances whose transform does so again. Throws Error for anything malformed.
std::optional<Mesh> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& name,
                                   bool mirrored, const std::string& file);

}  // namespace gnomon::scenes
