// View and projection matrices, computed in double and rounded to float once. Clip space as in D3D11.3 15.4.
#include "scenes/view.h"

#include "scenes/convex.h"
#include "sim/error.h"
#include "sim/scalar_math.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace gnomon::scenes {

namespace {

// Near and far planes stand off what they enclose by this share of the enclosed depth, so that neither rounding nor a depth
// bias clips a surface which lies on the bounds (the occluder and the receiver of `planes` do).
constexpr double kDepthMargin = 1.0 / 64;

// A spot's near plane is not nearer than this share of its far plane: [Lauritzen08] and others store depth linearly, but the
// depth buffer of the light pass is z/w, whose resolution at the far plane falls with znear / zfar.
constexpr double kNearestOverFarthest = 1.0 / 1000;

/// The inverse of a rigid matrix: the rotation transposed, the position turned and negated.
glm::dmat4 rigid_inverse(const glm::mat4& world_from_local) {
    const glm::dmat4 m(world_from_local);
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(m));
    glm::dmat4 inverse(rotation);
    inverse[3] = glm::dvec4(-(rotation * glm::dvec3(m[3])), 1.0);
    return inverse;
}

/// x and y scaled by `cot_x`, `cot_y`; z/w from 0 at znear to 1 at zfar; w = -z_view.
glm::mat4 perspective(double cot_x, double cot_y, double znear, double zfar) {
    glm::dmat4 m(0.0);
    m[0][0] = cot_x;
    m[1][1] = cot_y;
    m[2][2] = zfar / (znear - zfar);
    m[2][3] = -1.0;
    m[3][2] = znear * zfar / (znear - zfar);
    return glm::mat4(m);
}

struct DepthRange {
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = -std::numeric_limits<double>::infinity();

    void include(double depth) {
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    [[nodiscard]] bool empty() const { return nearest > farthest; }
};

Hexahedron corners_in(const glm::dmat4& view_from_world, const Bounds& bounds) {
    Hexahedron corners;
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec4 corner_ws((i & 1) ? bounds.upper.x : bounds.lower.x, (i & 2) ? bounds.upper.y : bounds.lower.y,
                                   (i & 4) ? bounds.upper.z : bounds.lower.z, 1.0);
        corners[i] = glm::dvec3(view_from_world * corner_ws);
    }
    return corners;
}

/// The depths at which the infinite pyramid |x|, |y| <= tan_half * -z meets the box. Every vertex of their intersection lies on
/// a face of the box or is the apex; an apex inside shows as a face that reaches behind it, and the near limit takes over.
DepthRange depths_inside(const Hexahedron& corners, double tan_half) {
    const std::array<glm::dvec4, 4> sides = {
        {{1, 0, -tan_half, 0}, {-1, 0, -tan_half, 0}, {0, 1, -tan_half, 0}, {0, -1, -tan_half, 0}}};
    DepthRange range;
    for (const auto& face : kHexahedronFaces) {
        std::vector<glm::dvec3> polygon;
        for (const std::size_t corner : face) polygon.push_back(corners[corner]);
        for (const glm::dvec4& side : sides) polygon = clip(polygon, side);
        for (const glm::dvec3& p : polygon) range.include(-p.z);
    }

    // The apex is inside when it lies on the inner side of all faces: between opposite ones in each direction of the box.
    const glm::dvec3 origin = corners[0];
    bool apex_inside = true;
    for (const std::size_t along : {1u, 2u, 4u}) {
        const glm::dvec3 edge = corners[along] - origin;
        const double position = glm::dot(-origin, edge);
        apex_inside = apex_inside && position >= 0 && position <= glm::dot(edge, edge);
    }
    if (apex_inside) range.include(0.0);
    return range;
}

View spot_view(const Light& light, const Bounds& bounds) {
    const glm::dmat4 view_from_world = rigid_inverse(light.world_from_light);
    const double tan_half = scalar::tan(static_cast<double>(light.outer_cone_rad));
    DepthRange range = depths_inside(corners_in(view_from_world, bounds), tan_half);
    if (range.empty() || !(range.farthest > 0))
        range = {.nearest = 0.0, .farthest = 1.0};  // it lights nothing: any frustum does

    const double margin = std::max(kDepthMargin * (range.farthest - range.nearest), range.farthest * kNearestOverFarthest);
    const double zfar = range.farthest + margin;
    const double znear = std::max(range.nearest - margin, zfar * kNearestOverFarthest);
    View view;
    view.view_from_world = glm::mat4(view_from_world);
    view.clip_from_view = perspective(1.0 / tan_half, 1.0 / tan_half, znear, zfar);
    view.znear = static_cast<float>(znear);
    view.zfar = static_cast<float>(zfar);
    view.position_ws = glm::vec3(light.world_from_light[3]);
    view.direction_ws = -glm::vec3(light.world_from_light[2]);
    return view;
}

View directional_view(const Light& light, const Bounds& bounds) {
    // Bound the scene in the light's axes; where the light stands does not matter.
    glm::mat4 axes = light.world_from_light;
    axes[3] = glm::vec4(0, 0, 0, 1);
    const glm::dmat4 light_from_world = rigid_inverse(axes);
    glm::dvec3 lower(std::numeric_limits<double>::infinity());
    glm::dvec3 upper(-std::numeric_limits<double>::infinity());
    for (const glm::dvec3& corner : corners_in(light_from_world, bounds)) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], corner[axis]);
            upper[axis] = std::max(upper[axis], corner[axis]);
        }
    }
    const glm::dvec3 size = upper - lower;
    const double largest = std::max({size.x, size.y, size.z});
    glm::dvec3 padded(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        padded[axis] = size[axis] * (1 + 2 * kDepthMargin);
        if (!(size[axis] > largest * kNearestOverFarthest)) padded[axis] = largest > 0 ? largest * kNearestOverFarthest : 1.0;
    }

    // Put the eye in the middle of the near plane and map the padded box to the clip volume.
    const glm::dvec3 eye(0.5 * (lower.x + upper.x), 0.5 * (lower.y + upper.y), 0.5 * (lower.z + upper.z + padded.z));
    glm::dmat4 view_from_world = light_from_world;
    view_from_world[3] = glm::dvec4(-eye, 1.0);
    glm::dmat4 clip_from_view(1.0);
    clip_from_view[0][0] = 2.0 / padded.x;
    clip_from_view[1][1] = 2.0 / padded.y;
    clip_from_view[2][2] = -1.0 / padded.z;
    View view;
    view.view_from_world = glm::mat4(view_from_world);
    view.clip_from_view = glm::mat4(clip_from_view);
    view.znear = 0.0f;
    view.zfar = static_cast<float>(padded.z);
    view.position_ws = glm::vec3(glm::dmat3(axes) * eye);
    view.direction_ws = -glm::vec3(light.world_from_light[2]);
    return view;
}

}  // namespace

View camera_view(const Camera& camera, float aspect) {
    GNOMON_CHECK_LT(0.0f, aspect);
    GNOMON_CHECK_LT(0.0f, camera.znear);
    GNOMON_CHECK_LT(camera.znear, camera.zfar);
    const double cot_half = 1.0 / scalar::tan(0.5 * static_cast<double>(camera.yfov_rad));
    View view;
    view.view_from_world = glm::mat4(rigid_inverse(camera.world_from_camera));
    view.clip_from_view = perspective(cot_half / static_cast<double>(aspect), cot_half, static_cast<double>(camera.znear),
                                      static_cast<double>(camera.zfar));
    view.znear = camera.znear;
    view.zfar = camera.zfar;
    view.position_ws = glm::vec3(camera.world_from_camera[3]);
    view.direction_ws = -glm::vec3(camera.world_from_camera[2]);
    return view;
}

View light_view(const Light& light, const Bounds& bounds) {
    switch (light.kind) {
        case LightKind::Spot: return spot_view(light, bounds);
        case LightKind::Directional: return directional_view(light, bounds);
    }
    fail("light of unknown kind {}", static_cast<int>(light.kind));
}

glm::mat4 looking_at(const glm::dvec3& eye_ws, const glm::dvec3& target_ws) {
    const auto unit = [](const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); };
    const glm::dvec3 back = unit(eye_ws - target_ws);
    const glm::dvec3 right_of_y = glm::cross(glm::dvec3(0, 1, 0), back);
    const bool vertical = glm::dot(right_of_y, right_of_y) < 1e-12;  // closer than 1e-6 rad to straight up or down
    const glm::dvec3 right = unit(vertical ? glm::cross(glm::dvec3(0, 0, -1), back) : right_of_y);
    const glm::dvec3 up = glm::cross(back, right);
    return glm::mat4(glm::dmat4(glm::dvec4(right, 0.0), glm::dvec4(up, 0.0), glm::dvec4(back, 0.0), glm::dvec4(eye_ws, 1.0)));
}

}  // namespace gnomon::scenes
