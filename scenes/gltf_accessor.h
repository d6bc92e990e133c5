// Accessors of a glTF file as plain numbers, every size and offset checked before use. glTF 2.0 section 3.6.2
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace gnomon::scenes {

/// `components` floats per element. Throws Error ("<file>: accessors[3]: what, what was expected") for anything out of range
/// and for component types other than float.
std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components, const std::string& file);

/// Unsigned scalars of 8, 16 or 32 bits. Throws Error.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor, const std::string& file);

}  // namespace gnomon::scenes
