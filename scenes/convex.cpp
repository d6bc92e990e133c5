// Boxes and frustums, cut by each other's planes.
#include "scenes/convex.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace gnomon::scenes {

namespace {

std::vector<glm::dvec3> face_of(const Hexahedron& solid, const std::array<std::size_t, 4>& corners) {
    std::vector<glm::dvec3> polygon;
    polygon.reserve(corners.size());
    for (const std::size_t corner : corners) polygon.push_back(solid[corner]);
    return polygon;
}

/// The planes of the faces, positive inside.
std::array<glm::dvec4, 6> planes_of(const Hexahedron& solid) {
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& corner : solid) middle += corner / 8.0;
    std::array<glm::dvec4, 6> planes{};
    for (std::size_t i = 0; i < planes.size(); ++i) {
        // Diagonals, for a side of a frustum may be next to nothing.
        const std::vector<glm::dvec3> p = face_of(solid, kHexahedronFaces[i]);
        const glm::dvec3 normal = glm::cross(p[2] - p[0], p[3] - p[1]);
        const glm::dvec4 plane(normal, -glm::dot(normal, 0.25 * (p[0] + p[1] + p[2] + p[3])));
        planes[i] = glm::dot(plane, glm::dvec4(middle, 1.0)) < 0 ? -plane : plane;
    }
    return planes;
}

/// The corners of what the faces of `solid` show inside of `planes`.
void append_clipped_faces(const Hexahedron& solid, const std::array<glm::dvec4, 6>& planes, std::vector<glm::dvec3>& points) {
    for (const auto& face : kHexahedronFaces) {
        std::vector<glm::dvec3> polygon = face_of(solid, face);
        for (const glm::dvec4& plane : planes) polygon = clip(polygon, plane);
        points.insert(points.end(), polygon.begin(), polygon.end());
    }
}

}  // namespace

std::vector<glm::dvec3> clip(const std::vector<glm::dvec3>& polygon, const glm::dvec4& plane) {
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 a = polygon[i];
        const glm::dvec3 b = polygon[(i + 1) % polygon.size()];
        const double side_a = glm::dot(plane, glm::dvec4(a, 1.0));
        const double side_b = glm::dot(plane, glm::dvec4(b, 1.0));
        if (side_a >= 0) kept.push_back(a);
        if ((side_a >= 0) != (side_b >= 0)) kept.push_back(a + (b - a) * (side_a / (side_a - side_b)));
    }
    return kept;
}

Hexahedron frustum(const glm::dmat4& clip_from_world) {
    const glm::dmat4 world_from_clip = glm::inverse(clip_from_world);
    Hexahedron corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec4 corner =
            world_from_clip * glm::dvec4((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : 0.0, 1.0);
        corners[i] = glm::dvec3(corner) / corner.w;
    }
    return corners;
}

std::vector<glm::dvec3> intersection(const Hexahedron& a, const Hexahedron& b) {
    // Every corner of the intersection lies on a face of one of the two.
    std::vector<glm::dvec3> points;
    append_clipped_faces(a, planes_of(b), points);
    append_clipped_faces(b, planes_of(a), points);
    return points;
}

}  // namespace gnomon::scenes
