// The plate over the ground, and the boxes on a tessellated ground.
#include "tests/peer/test_scenes.h"

#include "scenes/shapes.h"
#include "scenes/view.h"

namespace gnomon::peer {
namespace {

// A horizontal square that faces up, from the corner of least x and greatest z.
scenes::Mesh square(const char* name, const glm::dvec3& corner, double width, const glm::vec3& color) {
    scenes::Mesh mesh{.name = name, .vertices = {}, .indices = {}, .base_color = color};
    append(mesh, scenes::grid(corner, {width, 0, 0}, {0, 0, -width}, 1, 1), scenes::kFlat);
    return mesh;
}

}  // namespace

scenes::Scene two_planes() {
    scenes::Scene scene;
    scene.name = "two planes";
    scene.meshes = {square("ground", {-4, 0, 4}, 8, glm::vec3(0.8f)), square("plate", {0, 1, 0}, 2, {0.8f, 0.4f, 0.2f})};
    scene.instances = {{.mesh = 0}, {.mesh = 1}};
    scene.camera.world_from_camera = scenes::looking_at({0, 4, 7}, {0, 0, 0});
    scene.light.kind = scenes::LightKind::Directional;
    scene.light.world_from_light = scenes::looking_at({0, 5, 0}, {0, 0, 0});
    return scene;
}

scenes::Scene boxes() {
    scenes::Scene scene;
    scene.name = "boxes";
    scenes::Mesh mesh{.name = "boxes", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.7f)};
    append(mesh, scenes::grid({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}, 64, 64), scenes::kFlat);
    for (int row = 0; row < 12; ++row)
        for (int column = 0; column < 12; ++column) {
            const glm::dvec3 corner(-9.0 + 1.5 * column, 0.01, -9.0 + 1.5 * row);
            const double height = 0.4 + 0.2 * ((3 * row + 5 * column) % 7);
            append(mesh, scenes::box(corner, corner + glm::dvec3(0.6, height, 0.6)), scenes::kFlat);
        }
    scene.meshes = {mesh};
    scene.instances = {{.mesh = 0}};
    scene.camera.world_from_camera = scenes::looking_at({9, 7, 12}, {0, 0, 1});
    scene.light.world_from_light = scenes::looking_at({-12, 16, 6}, {0, 0, 0});
    return scene;
}

}  // namespace gnomon::peer
