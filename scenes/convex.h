// Convex polyhedra with six faces: boxes and frustums, and what two of them have in common.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace gnomon::scenes {

/// Corner i lies at the low or high end along x, y and z as bits 0, 1 and 2 of i are 0 or 1.
using Hexahedron = std::array<glm::dvec3, 8>;

/// The corners of each face, around it.
inline constexpr std::array<std::array<std::size_t, 4>, 6> kHexahedronFaces{
    {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}}};

/// The part of a convex polygon where dot(plane, (p, 1)) >= 0. Sutherland and Hodgman.
std::vector<glm::dvec3> clip(const std::vector<glm::dvec3>& polygon, const glm::dvec4& plane);

/// What a clip-space matrix shows, in world space: clip volume -w <= x, y <= w, 0 <= z <= w. D3D11.3 15.4
Hexahedron frustum(const glm::dmat4& clip_from_world);

/// Points whose convex hull is the intersection; none where there is none.
std::vector<glm::dvec3> intersection(const Hexahedron& a, const Hexahedron& b);

}  // namespace gnomon::scenes
