// `fence`: thin bars receding to the horizon; far away many texels of the shadow map fall into one pixel. [Lauritzen08]
// figure 2.2
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace gnomon::scenes {

namespace {

constexpr double kPanelLength = 3.2;
constexpr int kBars = 16;  // per panel, every 0.2 m
constexpr int kPanels = 30;
constexpr double kHeight = 1.5;

/// One panel from the origin towards -z: a post, two rails and the bars.
Mesh panel() {
    Mesh mesh{.name = "panel", .vertices = {}, .indices = {}, .base_color = {0.55f, 0.38f, 0.22f}};
    append(mesh, box({-0.06, 0, -0.06}, {0.06, kHeight + 0.15, 0.06}), kFlat);
    for (const double y : {0.25, 1.2}) append(mesh, box({0.025, y, -kPanelLength}, {0.06, y + 0.08, 0}), kFlat);
    for (int i = 0; i < kBars; ++i) {
        const double z = -kPanelLength * (i + 0.5) / kBars;
        append(mesh, box({-0.02, 0.08, z - 0.035}, {0.02, kHeight, z + 0.035}), kFlat);
    }
    return mesh;
}

}  // namespace

Scene make_fence() {
    Scene scene;
    scene.name = "fence";
    Mesh ground{.name = "ground", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.72f)};
    append(ground, grid({-50, 0, 10}, {100, 0, 0}, {0, 0, -110}, 20, 22), kFlat);
    scene.meshes = {ground, panel()};
    scene.instances.push_back({.mesh = 0});

    // Two rows of the same panels, from behind the camera to the horizon.
    for (const float row : {-1.8f, 3.4f}) {
        for (int i = 0; i < kPanels; ++i) {
            Instance instance{.mesh = 1};
            instance.world_from_object[3] = glm::vec4(row, 0.0f, static_cast<float>(3.2 - kPanelLength * i), 1.0f);
            scene.instances.push_back(instance);
        }
    }

    scene.camera.world_from_camera = looking_at({0.9, 1.7, 4.5}, {0.6, 0.75, -6.0});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(48));
    scene.camera.znear = 0.1f;
    scene.camera.zfar = 150.0f;
    scene.light.kind = LightKind::Directional;
    scene.light.world_from_light = looking_at({-6.0, 6.5, -4.0}, {0, 0, 0});
    return scene;
}

}  // namespace gnomon::scenes
