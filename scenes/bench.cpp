// `bench`: a tree (A) over a slatted bench (B) over the ground (C): the penumbra of A on B bleeds onto C. [Lauritzen08] 3.3
//
// The leaves are far above the bench and the bench is close to the ground: Delta x / Delta y of figure 3.4 is about 8.
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/street_furniture.h"
#include "scenes/tree.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::scenes {

Scene make_bench() {
    Scene scene;
    scene.name = "bench";
    Mesh ground{.name = "ground", .vertices = {}, .indices = {}, .base_color = {0.66f, 0.68f, 0.60f}};
    append(ground, grid({-30, 0, 30}, {60, 0, 0}, {0, 0, -60}, 16, 16), kFlat);
    Mesh wood{.name = "wood", .vertices = {}, .indices = {}, .base_color = {0.62f, 0.42f, 0.24f}};
    Mesh iron{.name = "iron", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.12f)};
    Mesh bark{.name = "bark", .vertices = {}, .indices = {}, .base_color = {0.30f, 0.22f, 0.16f}};
    Mesh foliage{.name = "foliage", .vertices = {}, .indices = {}, .base_color = {0.22f, 0.48f, 0.14f}};
    append_bench(wood, iron);
    append_tree(bark, foliage, {.foot = {-0.9, 0, -1.0}});
    scene.meshes = {ground, wood, iron, bark, foliage};
    for (std::uint32_t mesh = 0; mesh < 5; ++mesh) scene.instances.push_back({.mesh = mesh});

    // The light is behind the tree, so that leaves, bench and ground line up and the shadow falls towards the camera.
    scene.camera.world_from_camera = looking_at({2.6, 1.75, 4.4}, {0.0, 0.75, 0.0});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(42));
    scene.camera.znear = 0.1f;
    scene.camera.zfar = 80.0f;
    scene.light.kind = LightKind::Spot;
    scene.light.world_from_light = looking_at({-3.2, 10.5, -4.2}, {0.1, 0.6, 0.2});
    scene.light.outer_cone_rad = static_cast<float>(scalar::radians(22));
    return scene;
}

}  // namespace gnomon::scenes
