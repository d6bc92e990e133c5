// Building blocks of the procedural scenes: closed solids and open grids, wound counter-clockwise seen from outside.
#pragma once

#include "scenes/scene.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace gnomon::scenes {

/// Positions and triangles without normals: what shapes are made of before `append` gives them normals.
struct Shape {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

/// An axis-aligned box.
Shape box(const glm::dvec3& lower, const glm::dvec3& upper);

/// A straight bar of rectangular section from `a` to `b`: `width` across `side` (made perpendicular to the bar), `depth` across
/// the third direction.
Shape bar(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& side, double width, double depth);

/// A closed frustum of a cone around the axis from `a` to `b`; a cylinder when both radii are equal. Radii > 0, sides >= 3.
Shape tube(const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b, int sides);

/// An ellipsoid with `slices` meridians and `stacks` bands from pole to pole along y.
Shape ellipsoid(const glm::dvec3& center, const glm::dvec3& radii, int slices, int stacks);

/// The closed outline `profile` (x: radius > 0, y: offset along the axis) turned around the z axis.
Shape revolution(const std::vector<glm::dvec2>& profile, int segments);

/// A tube through rings of equally many points, each end closed by a fan around the middle of its ring.
Shape loft(const std::vector<std::vector<glm::dvec3>>& rings);

/// An open grid of `count_u` by `count_v` cells spanned from `origin`; the front is the side that cross(u, v) points to.
Shape grid(const glm::dvec3& origin, const glm::dvec3& u, const glm::dvec3& v, int count_u, int count_v);

/// Adds a shape to a mesh. Corners share a smooth normal with the neighbouring faces whose normals have a cosine of at least
/// `crease_cos` with theirs; 1 or more gives flat faces. Normals are weighted as in [Max99].
void append(Mesh& mesh, const Shape& shape, double crease_cos);

inline constexpr double kFlat = 2.0;     // every face its own normal
inline constexpr double kSmooth = 0.7;   // edges up to 45 degrees are smooth
inline constexpr double kRounded = 0.4;  // edges up to 66 degrees are smooth: thin tubes of few sides

}  // namespace gnomon::scenes
