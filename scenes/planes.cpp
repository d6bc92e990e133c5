// `planes`: one planar occluder at depth d1, one planar receiver at depth d2. [Donnelly06] 3.1
//
// The light looks straight down, so that each plane has one linear depth over the whole map. The occluder covers the light's
// view up to a straight edge, which is slanted in its plane: along the edge every share of coverage from 0 to 1 occurs.
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::scenes {

namespace {

constexpr double kLightHeight = 4.0;
constexpr double kOccluderHeight = 1.5;
constexpr double kExtent = 6.0;  // both planes reach well past the light's frustum, so that filters never see the end of one
constexpr double kEdgeAtMiddle = 0.15;  // x of the occluder's edge at z = 0; not 0, which is a texel boundary of the map
constexpr double kEdgeSlope = 0.13;     // x per z along the edge; no simple fraction, so that texels are cut everywhere

}  // namespace

Scene make_planes() {
    Scene scene;
    scene.name = "planes";

    Mesh receiver{.name = "receiver", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.8f)};
    append(receiver, grid({-kExtent, 0, kExtent}, {2 * kExtent, 0, 0}, {0, 0, -2 * kExtent}, 1, 1), kFlat);

    const auto edge = [](double z) { return kEdgeAtMiddle + kEdgeSlope * z; };
    Shape half_plane;
    half_plane.positions = {glm::dvec3(-kExtent, kOccluderHeight, kExtent), glm::dvec3(edge(kExtent), kOccluderHeight, kExtent),
                            glm::dvec3(edge(-kExtent), kOccluderHeight, -kExtent),
                            glm::dvec3(-kExtent, kOccluderHeight, -kExtent)};
    half_plane.triangles = {{0, 1, 2}, {0, 2, 3}};
    Mesh occluder{.name = "occluder", .vertices = {}, .indices = {}, .base_color = {0.8f, 0.45f, 0.2f}};
    append(occluder, half_plane, kFlat);

    scene.meshes = {receiver, occluder};
    scene.instances = {Instance{.mesh = 0}, Instance{.mesh = 1}};

    // From the lit side, high enough to see the top of the occluder and low enough to look far under it.
    scene.camera.world_from_camera = looking_at({3.6, 2.4, 1.6}, {-0.1, 0.3, 0.0});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(45));
    scene.camera.znear = 0.25f;
    scene.camera.zfar = 25.0f;
    scene.light.kind = LightKind::Spot;
    scene.light.world_from_light = looking_at({0, kLightHeight, 0}, {0, 0, 0});
    scene.light.outer_cone_rad = static_cast<float>(scalar::radians(32));
    return scene;
}

}  // namespace gnomon::scenes
