// Cameras and lights as matrices. Clip space is Direct3D's: x and y in [-w, w] with y up, z in [0, w]. D3D11.3 15.4
#pragma once

#include "scenes/scene.h"

#include <glm/mat4x4.hpp>

namespace gnomon::scenes {

/// A viewpoint as the machine sees it. Matrices read right to left: clip = clip_from_view * view_from_world * world.
struct View {
    glm::mat4 view_from_world{1.0f};
    glm::mat4 clip_from_view{1.0f};
    float znear = 0;  // view-space distances of the clip planes along -z; the linear depth (-z_view - znear) / (zfar - znear)
    float zfar = 1;   // is 0 and 1 there
    glm::vec3 position_ws{0.0f};   // the eye; for a directional light the centre of its near plane
    glm::vec3 direction_ws{0.0f};  // unit, along the local -z

    [[nodiscard]] glm::mat4 clip_from_world() const { return clip_from_view * view_from_world; }
};

/// The camera's view for an image of this width / height.
View camera_view(const Camera& camera, float aspect);

/// The light's view with its frustum fitted to the scene: near and far planes around `bounds` (a spot keeps its cone:
/// the square frustum circumscribes the outer cone; a directional light gets the bounding rectangle).
View light_view(const Light& light, const Bounds& bounds);

/// The rigid matrix of a camera or light at `eye_ws` whose local -z points at `target_ws` (not the eye itself) and whose local
/// y leans towards world y; when it looks straight up or down, towards world -z.
glm::mat4 looking_at(const glm::dvec3& eye_ws, const glm::dvec3& target_ws);

}  // namespace gnomon::scenes
