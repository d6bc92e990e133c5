// `overlap`: the worst case for variance shadow maps, overlapping shadows with extreme depth ratios. [Lauritzen08] 4.1.4,
// figures 4.3 and 4.4
//
// A floodlight 30 m above a terraced yard shines through a grille, planks, ropes and leaves 4.6 to 7.2 m before it (A). Decks
// of slats, boards, nets and tables (B) stand 0.12 to 0.28 m above their receivers (C): three terraces, a plinth, and boards
// that are each the receiver of the next one's shadow. Along the light's axis Delta x = b - a is 17 to 29 m and Delta y = c - b
// below a B is 0.18 to 0.4 m, so that Delta x / Delta y of eq. 3.4 is 50 to 115 there; where a terrace shadows the one before
// it, about
// 30. The light comes from behind: shadows fall towards the camera, which sees below every B what B hides from the light, and
// the shadow edges of A bleed across it.
#include "scenes/builders.h"
#include "scenes/random.h"
#include "scenes/shapes.h"
#include "scenes/tree.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::scenes {

namespace {

constexpr glm::dvec3 kLight(-6.0, 27.0, -13.0);
constexpr glm::dvec3 kAim(0.0, 0.5, 0.0);

/// The axes of the light in the columns: right, up, back.
glm::dmat3 light_axes() { return {glm::dmat4(looking_at(kLight, kAim))}; }

/// The point at `depth` along the light's axis whose shadow would fall `x` to the right of and `y` above the middle of a plane
/// 30 m before the light: what hangs near the light is small, and its shadow is not.
glm::dvec3 before_light(double x, double y, double depth) {
    constexpr double kPlane = 30.0;
    return kLight + light_axes() * glm::dvec3(x * depth / kPlane, y * depth / kPlane, -depth);
}

/// A bar before the light between two such points, `width` wide in its shadow.
Shape shadow_bar(const glm::dvec3& from, const glm::dvec3& to, double width) {
    const glm::dvec3 a = before_light(from.x, from.y, from.z);
    const glm::dvec3 b = before_light(to.x, to.y, to.z);
    const double size = width * from.z / 30.0;
    return bar(a, b, light_axes() * glm::dvec3(to.y - from.y, from.x - to.x, 0), size, size);
}

/// The grille of the lamp on one side, planks across the middle, ropes everywhere: each at its own depth.
void append_grille(Mesh& iron, Mesh& planks) {
    for (int i = 0; i < 13; ++i) {
        const double at = 0.8 * i;
        append(iron, shadow_bar({-11.0, -8.6 + at, 4.8}, {-2.4, -8.6 + at, 4.8}, 0.16), kFlat);
        append(iron, shadow_bar({-11.2 + at, -9.0, 4.6}, {-11.2 + at, 9.0, 4.6}, 0.16), kFlat);
    }
    for (int i = 0; i < 3; ++i) {
        const double at = 2.6 * i;
        append(planks, shadow_bar({-2.0 + 0.5 * at, -10.0, 6.6}, {-0.6 + 0.5 * at, 10.0, 6.6}, 0.75), kFlat);
    }
    for (int i = 0; i < 9; ++i) {
        const double at = 2.2 * i;
        append(iron, shadow_bar({-11.0, -12.0 + at, 7.2}, {11.0, -8.4 + at, 7.2}, 0.07), kFlat);
    }
}

/// Branches with leaves on the other side, as a tree beside the lamp would reach into its light.
void append_branches(Mesh& bark, Mesh& foliage) {
    Random random(7);
    Shape leaves;
    for (int branch = 0; branch < 11; ++branch) {
        const double y = -10.0 + 2.0 * branch;
        const double depth = random.uniform(5.0, 6.2);
        const double tip_x = random.uniform(1.0, 3.2);
        const double tip_y = y + random.uniform(-1.5, 1.5);
        const glm::dvec3 root = before_light(12.0, y, depth);
        const glm::dvec3 tip = before_light(tip_x, tip_y, depth - 0.2);
        append(bark, tube(root, tip, 0.03, 0.008, 6), kRounded);
        for (int twig = 0; twig < 9; ++twig) {
            const glm::dvec3 from = root + (tip - root) * (0.12 + 0.88 * twig / 8.0);
            const glm::dvec3 turn{random.uniform(-0.25, 0.25), random.uniform(-0.1, 0.1), random.uniform(-0.25, 0.25)};
            append(bark, tube(from, from + turn, 0.007, 0.003, 4), kRounded);
            append_leaves(leaves, {.from = from, .to = from + turn, .leaves = 13, .size = 0.55}, random);
        }
    }
    append(foliage, leaves, kFlat);
}

/// A deck of slats along x with gaps between them, `clearance` above the ground at `foot`: thin occluders in rows.
void append_deck(Mesh& wood, const glm::dvec3& foot, double width, double depth, double clearance) {
    constexpr double kSlat = 0.16;
    constexpr double kPitch = 0.36;
    const int slats = static_cast<int>(depth / kPitch);
    for (int i = 0; i < slats; ++i) {
        const glm::dvec3 corner = foot + glm::dvec3(0, clearance, kPitch * i);
        append(wood, box(corner, corner + glm::dvec3(width, 0.04, kSlat)), kFlat);
    }
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 beam = foot + glm::dvec3(0.5 * i * (width - 0.1), clearance - 0.06, 0);
        append(wood, box(beam, beam + glm::dvec3(0.1, 0.06, depth - kPitch + kSlat)), kFlat);
        append(wood, box(beam - glm::dvec3(0, clearance - 0.06, 0), beam + glm::dvec3(0.1, 0, 0.1)), kFlat);
    }
}

/// Boards on short feet, each higher by `step` than the one before it and further from the camera: every board is receiver of
/// the next one's shadow.
void append_board_stack(Mesh& board, Mesh& iron, const glm::dvec3& foot, double width, double step) {
    for (int i = 0; i < 4; ++i) {
        const double y = step * (i + 1);
        const glm::dvec3 front = foot + glm::dvec3(0.12 * i, y, -0.75 * i);
        append(board, box(front - glm::dvec3(0, 0.04, 1.6), front + glm::dvec3(width, 0, 0)), kFlat);
        for (const double x : {0.12, width - 0.18}) {
            const glm::dvec3 leg = front + glm::dvec3(x, 0, -0.2);
            append(iron, box(leg - glm::dvec3(0, step, 0.06), leg - glm::dvec3(-0.06, 0.04, 0)), kFlat);
        }
    }
}

/// A net of rods, both diagonals, on posts: thin occluders in all directions.
void append_net(Mesh& iron, const glm::dvec3& foot, double size, double clearance) {
    const glm::dvec3 up(0, clearance, 0);
    constexpr int kRods = 9;
    for (int i = 1; i < 2 * kRods; ++i) {
        const double at = size * i / kRods;
        const double low = at < size ? 0 : at - size;
        const double high = at < size ? at : size;
        append(iron, bar(foot + up + glm::dvec3(low, 0, high), foot + up + glm::dvec3(high, 0, low), up, 0.03, 0.06), kFlat);
        append(
            iron,
            bar(foot + up + glm::dvec3(size - low, 0.03, high), foot + up + glm::dvec3(size - high, 0.03, low), up, 0.03, 0.06),
            kFlat);
    }
    for (const double x : {0.0, size})
        for (const double z : {0.0, size})
            append(iron, box(foot + glm::dvec3(x - 0.05, 0, z - 0.05), foot + glm::dvec3(x + 0.05, clearance + 0.06, z + 0.05)),
                   kFlat);
    for (const double z : {0.0, size}) {
        append(iron, bar(foot + up + glm::dvec3(0, 0, z), foot + up + glm::dvec3(size, 0, z), up, 0.06, 0.06), kFlat);
        append(iron, bar(foot + up + glm::dvec3(z, 0, 0), foot + up + glm::dvec3(z, 0, size), up, 0.06, 0.06), kFlat);
    }
}

/// A wide round table on one leg.
void append_table(Mesh& board, Mesh& iron, const glm::dvec3& foot, double radius, double clearance) {
    append(board, tube(foot + glm::dvec3(0, clearance, 0), foot + glm::dvec3(0, clearance + 0.05, 0), radius, radius, 40),
           kSmooth);
    append(iron, tube(foot, foot + glm::dvec3(0, clearance, 0), 0.14, 0.09, 12), kRounded);
}

/// Three terraces that rise away from the camera, the middle one with a plinth.
void append_terraces(Mesh& stone) {
    append(stone, box({-9.5, -0.6, -2.4}, {9.5, 0.0, 8.5}), kFlat);
    append(stone, box({-9.5, -0.6, -6.2}, {9.5, 0.7, -2.4}), kFlat);
    append(stone, box({-9.5, -0.6, -10.0}, {9.5, 1.4, -6.2}), kFlat);
    append(stone, box({-1.9, 0.0, 0.2}, {1.9, 0.35, 3.6}), kFlat);
}

}  // namespace

Scene make_overlap() {
    Scene scene;
    scene.name = "overlap";
    Mesh stone{.name = "stone", .vertices = {}, .indices = {}, .base_color = {0.74f, 0.72f, 0.66f}};
    Mesh wood{.name = "wood", .vertices = {}, .indices = {}, .base_color = {0.62f, 0.42f, 0.24f}};
    Mesh board{.name = "board", .vertices = {}, .indices = {}, .base_color = {0.30f, 0.46f, 0.58f}};
    Mesh iron{.name = "iron", .vertices = {}, .indices = {}, .base_color = {0.45f, 0.16f, 0.12f}};
    Mesh planks{.name = "planks", .vertices = {}, .indices = {}, .base_color = {0.55f, 0.40f, 0.25f}};
    Mesh bark{.name = "bark", .vertices = {}, .indices = {}, .base_color = {0.30f, 0.22f, 0.16f}};
    Mesh foliage{.name = "foliage", .vertices = {}, .indices = {}, .base_color = {0.22f, 0.48f, 0.14f}};

    append_terraces(stone);
    append_deck(wood, {-6.2, 0, 0.6}, 4.3, 4.6, 0.28);
    append_deck(wood, {-4.2, 0, 6.2}, 5.2, 1.9, 0.12);
    append_deck(wood, {2.6, 0.7, -5.7}, 5.2, 2.9, 0.25);
    append_board_stack(board, iron, {2.3, 0, 4.6}, 3.9, 0.25);
    append_board_stack(board, iron, {-7.4, 0.7, -2.9}, 3.8, 0.18);
    append_net(iron, {-1.5, 0.35, 0.4}, 3.0, 0.25);
    append_table(board, iron, {-0.6, 0.7, -4.3}, 1.5, 0.28);
    append_deck(wood, {-6.5, 1.4, -9.6}, 5.0, 3.0, 0.3);
    append_table(board, iron, {1.6, 1.4, -8.1}, 1.4, 0.28);
    append_net(iron, {4.6, 1.4, -9.4}, 2.8, 0.25);
    append_grille(iron, planks);
    append_branches(bark, foliage);
    scene.meshes = {stone, wood, board, iron, planks, bark, foliage};
    for (std::uint32_t mesh = 0; mesh < 7; ++mesh) scene.instances.push_back({.mesh = mesh});

    // Low enough to look under the boards, against the light.
    scene.camera.world_from_camera = looking_at({0.4, 7.6, 17.6}, {0.1, 0.1, -0.1});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(36.5));
    scene.camera.znear = 0.5f;
    scene.camera.zfar = 80.0f;
    scene.light.kind = LightKind::Spot;
    scene.light.world_from_light = looking_at(kLight, kAim);
    scene.light.outer_cone_rad = static_cast<float>(scalar::radians(26));
    return scene;
}

}  // namespace gnomon::scenes
