// `bench`: a tree (A) over a slatted bench (B) over the ground (C): the penumbra of A on B bleeds onto C. [Lauritzen08] 3.3
//
// The leaves are far above the bench and the bench is close to the ground: Delta x / Delta y of figure 3.4 is about 8.
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/tree.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::scenes {

namespace {

/// A park bench 1.8 m wide along x whose seat faces +z: slats with narrow gaps on two iron frames.
void append_bench(Mesh& wood, Mesh& iron) {
    constexpr double kHalfLength = 0.9;
    for (int i = 0; i < 5; ++i) {  // the seat
        const double z = 0.23 - 0.105 * i;
        append(wood, box({-kHalfLength, 0.43, z - 0.046}, {kHalfLength, 0.46, z + 0.046}), kFlat);
    }
    for (int i = 0; i < 4; ++i) {  // the back, leaning
        const double y = 0.56 + 0.105 * i;
        const double z = -0.27 - 0.28 * (y - 0.46);
        append(wood, bar({-kHalfLength, y, z}, {kHalfLength, y, z}, {0, 1, -0.28}, 0.09, 0.03), kFlat);
    }
    for (const double x : {-0.72, 0.72}) {
        append(iron, bar({x, 0, 0.26}, {x, 0.43, 0.22}, {1, 0, 0}, 0.05, 0.05), kFlat);
        append(iron, bar({x, 0, -0.30}, {x, 0.43, -0.24}, {1, 0, 0}, 0.05, 0.05), kFlat);
        append(iron, bar({x, 0.41, 0.28}, {x, 0.41, -0.30}, {1, 0, 0}, 0.05, 0.04), kFlat);
        append(iron, bar({x, 0.40, -0.265}, {x, 0.93, -0.425}, {1, 0, 0}, 0.05, 0.04), kFlat);
        append(iron, bar({x, 0.66, -0.34}, {x, 0.66, 0.26}, {1, 0, 0}, 0.06, 0.03), kFlat);
        append(iron, bar({x, 0.44, 0.24}, {x, 0.66, 0.24}, {1, 0, 0}, 0.04, 0.03), kFlat);
    }
}

}  // namespace

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
