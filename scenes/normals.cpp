// Normals of a shape: smooth across soft edges, split at creases, weighted as in [Max99].
#include "scenes/shapes.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>

namespace gnomon::scenes {

namespace {

struct Corner {
    std::uint32_t face;
    glm::dvec3 weighted;  // the face normal times the corner's weight
};

/// What one corner of a face adds to the normal of its vertex: the cross product of the two edges over the product of their
/// squared lengths. On a sphere this gives the exact normal, and it needs no angle. [Max99]
glm::dvec3 corner_normal(const glm::dvec3& at, const glm::dvec3& next, const glm::dvec3& previous) {
    const glm::dvec3 a = next - at;
    const glm::dvec3 b = previous - at;
    return glm::cross(a, b) / (glm::dot(a, a) * glm::dot(b, b));
}

glm::dvec3 unit(const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); }

}  // namespace

void append(Mesh& mesh, const Shape& shape, double crease_cos) {
    // Collect the normal of each face and what meets at each position.
    std::vector<glm::dvec3> face_normals;
    std::vector<std::vector<Corner>> corners_at(shape.positions.size());
    for (const glm::uvec3& t : shape.triangles) {
        const std::array<glm::dvec3, 3> p = {shape.positions[t.x], shape.positions[t.y], shape.positions[t.z]};
        const auto face = static_cast<std::uint32_t>(face_normals.size());
        face_normals.push_back(unit(glm::cross(p[1] - p[0], p[2] - p[0])));
        for (std::size_t i = 0; i < 3; ++i) {
            corners_at[t[static_cast<int>(i)]].push_back({face, corner_normal(p[i], p[(i + 1) % 3], p[(i + 2) % 3])});
        }
    }

    // Give every corner its normal; corners of one position with equal normals become one vertex.
    std::map<std::tuple<std::uint32_t, float, float, float>, std::uint32_t> vertex_of;
    for (std::uint32_t face = 0; face < shape.triangles.size(); ++face) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t point = shape.triangles[face][i];
            glm::dvec3 sum(0.0);
            for (const Corner& corner : corners_at[point]) {
                const bool smooth =
                    corner.face == face || glm::dot(face_normals[corner.face], face_normals[face]) >= crease_cos;
                if (smooth) sum += corner.weighted;
            }
            const glm::vec3 normal(unit(sum) + 0.0);  // + 0: no negative zeros
            const auto [found, is_new] =
                vertex_of.try_emplace({point, normal.x, normal.y, normal.z}, static_cast<std::uint32_t>(mesh.vertices.size()));
            if (is_new) mesh.vertices.push_back({shape.positions[point], normal});
            mesh.indices.push_back(found->second);
        }
    }
}

}  // namespace gnomon::scenes
