#include "scenes/gltf_mesh.h"

#include "scenes/gltf_accessor.h"
#include "sim/error.h"

#include <tiny_gltf.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gnomon::scenes {

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Corners in drawing order to triangles of one winding. glTF 2.0 section 3.7.2.1
Triangles assemble(const std::vector<std::uint32_t>& corners, int mode, const std::string& where) {
    Triangles triangles;
    const std::size_t count = corners.size();
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (count % 3 != 0) fail("{}: {} corners, expected a multiple of 3 for a triangle list", where, count);
        for (std::size_t i = 0; i < count; i += 3) triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
        return triangles;
    }
    if (count < 3) fail("{}: {} corners, expected at least 3", where, count);
    for (std::size_t i = 0; i + 2 < count; ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            triangles.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
        } else {
            triangles.push_back({corners[i + 1], corners[i + 2], corners[0]});
        }
    }
    return triangles;
}

glm::vec3 unit_or_zero(const glm::dvec3& v) {
    const double length2 = glm::dot(v, v);
    return length2 > 0 && std::isfinite(length2) ? glm::vec3(v / std::sqrt(length2)) : glm::vec3(0.0f);
}

/// The normal of a triangle wound counter-clockwise, or up where it has no area.
glm::vec3 face_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = unit_or_zero(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
    return normal == glm::vec3(0.0f) ? glm::vec3(0.0f, 1.0f, 0.0f) : normal;
}

std::vector<glm::vec3> as_vectors(const std::vector<float>& floats) {
    std::vector<glm::vec3> vectors(floats.size() / 3);
    for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = {floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]};
    return vectors;
}

bool is_unit(const glm::vec3& v) { return std::fabs(glm::dot(glm::dvec3(v), glm::dvec3(v)) - 1.0) < 1e-2; }

/// Unshares every corner and gives it the normal of its face.
void make_flat(Mesh& mesh, const std::vector<glm::vec3>& positions, const Triangles& triangles) {
    for (const auto& [a, b, c] : triangles) {
        const glm::vec3 normal = face_normal(positions[a], positions[b], positions[c]);
        for (const std::uint32_t corner : {a, b, c}) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back({positions[corner], normal});
        }
    }
}

glm::vec3 base_color(const tinygltf::Model& model, int material, const std::string& file, std::vector<std::string>& notes) {
    if (material < 0) return {0.8f, 0.8f, 0.8f};
    if (static_cast<std::size_t>(material) >= model.materials.size())
        fail("{}: material {}, expected 0 to {}", file, material, static_cast<std::ptrdiff_t>(model.materials.size()) - 1);
    const auto& pbr = model.materials[static_cast<std::size_t>(material)].pbrMetallicRoughness;
    if (pbr.baseColorTexture.index >= 0) notes.push_back("textures are not supported; base colour factors stand in for them");
    if (pbr.baseColorFactor.size() != 4) return {1.0f, 1.0f, 1.0f};
    glm::vec3 color;
    for (int c = 0; c < 3; ++c) {
        const double value = pbr.baseColorFactor[static_cast<std::size_t>(c)];
        if (!(value >= 0 && value <= 1)) fail("{}: materials[{}]: baseColorFactor {}, expected 0 to 1", file, material, value);
        color[c] = static_cast<float>(value);
    }
    return color;
}

}  // namespace

std::optional<Mesh> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& name,
                                   bool mirrored, const std::string& file, std::vector<std::string>& notes) {
    const std::string where = fmt::format("{}: mesh '{}'", file, name);
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) fail("{}: mode {}, expected 0 to 6", where, mode);
    if (mode < TINYGLTF_MODE_TRIANGLES) {
        notes.push_back("points and lines are not supported and left out");
        return std::nullopt;
    }
    if (!primitive.targets.empty()) notes.push_back("morph targets are not supported; meshes keep their rest shape");

    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) {
        notes.push_back(fmt::format("mesh '{}' has no positions and is left out", name));
        return std::nullopt;
    }
    const bool draco = primitive.extensions.contains("KHR_draco_mesh_compression");
    const auto has_data = [&](int accessor) {
        return accessor >= 0 && static_cast<std::size_t>(accessor) < model.accessors.size() &&
               model.accessors[static_cast<std::size_t>(accessor)].bufferView >= 0;
    };
    if (draco && !has_data(position->second)) {
        notes.push_back("Draco compression is not supported; meshes without a fallback are left out");
        return std::nullopt;
    }

    // Corners and triangles.
    const std::vector<glm::vec3> positions = as_vectors(read_floats(model, position->second, 3, file));
    for (std::size_t i = 0; i < positions.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(positions[i][c]))
                fail("{}: position {} is {}, expected finite numbers", where, i, positions[i][c]);
    std::vector<std::uint32_t> corners;
    if (primitive.indices >= 0) {
        corners = read_indices(model, primitive.indices, file);
    } else {
        for (std::uint32_t i = 0; i < positions.size(); ++i) corners.push_back(i);
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
        if (corners[i] >= positions.size())
            fail("{}: index {} is {}, but there are {} vertices", where, i, corners[i], positions.size());
    Triangles triangles = assemble(corners, mode, where);
    if (mirrored)
        for (auto& triangle : triangles) std::swap(triangle[1], triangle[2]);

    // Normals: the file's where they are unit vectors, else flat ones.
    Mesh mesh{.name = name, .vertices = {}, .indices = {}, .base_color = base_color(model, primitive.material, file, notes)};
    const auto normal = primitive.attributes.find("NORMAL");
    if (normal == primitive.attributes.end()) {
        make_flat(mesh, positions, triangles);
        return mesh;
    }
    const std::vector<glm::vec3> normals = as_vectors(read_floats(model, normal->second, 3, file));
    if (normals.size() != positions.size()) fail("{}: {} normals for {} positions", where, normals.size(), positions.size());
    for (const glm::vec3& n : normals) {
        if (is_unit(n)) continue;
        notes.push_back(fmt::format("mesh '{}' has normals that are not unit vectors; flat ones stand in for them", name));
        make_flat(mesh, positions, triangles);
        return mesh;
    }
    for (std::size_t i = 0; i < positions.size(); ++i) mesh.vertices.push_back({positions[i], normals[i]});
    for (const auto& triangle : triangles) mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
    return mesh;
}

}  // namespace gnomon::scenes
