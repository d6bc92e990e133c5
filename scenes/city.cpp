// `city`: a street of 300 m between blocks of houses under the sun, seen from its pavement. [Lefohn07] figure 7
//
// The street runs along -z. On the pavement before the camera stand a rack with bicycles, a bench and a tree; at its end,
// 270 m away, a town hall. The sun stands 48 degrees high over the right side, a little behind the camera: the houses there
// shadow the roadway, those on the left are lit from the side. One map of 1024 texels over all of it has texels of 0.35 by
// 0.22 m, seven times as wide as the tubes of the rack.
#include "scenes/builders.h"
#include "scenes/city_buildings.h"
#include "scenes/random.h"
#include "scenes/shapes.h"
#include "scenes/street_furniture.h"
#include "scenes/tree.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace gnomon::scenes {

namespace {

constexpr double kKerb = 5.5;    // from the middle of the street
constexpr double kFront = 10.5;  // where the houses stand
constexpr double kBack = 24.5;
constexpr double kPavement = 0.14;  // height of its surface
constexpr double kNear = 36;        // the ends of the ground along z
constexpr double kFar = -276;
constexpr double kSide = 88;
constexpr double kTownHall = -258;

/// The blocks along the street, by the z of their kerbs; crossing streets lie between them.
struct Block {
    double low_z;
    double high_z;
};
constexpr std::array<Block, 4> kBlocks = {{{-44, 34}, {-122, -56}, {-198, -134}, {-246, -210}}};

/// The meshes that exist once, in the order of `materials`.
enum Material : std::uint32_t {
    kGround,
    kStone,
    kKerbStone,
    kPaint,
    kBrick,
    kPlaster,
    kSand,
    kConcrete,
    kGlass,
    kTrim,
    kRoof,
    kAwning,
    kSoil,
    kMaterials
};

std::vector<Mesh> materials() {
    const auto mesh = [](const char* name, const glm::vec3& color) {
        return Mesh{.name = name, .vertices = {}, .indices = {}, .base_color = color};
    };
    return {mesh("ground", {0.30f, 0.31f, 0.33f}),    mesh("pavement", {0.64f, 0.61f, 0.56f}),
            mesh("kerb", {0.74f, 0.73f, 0.70f}),      mesh("marking", {0.86f, 0.86f, 0.82f}),
            mesh("brick", {0.58f, 0.27f, 0.19f}),     mesh("plaster", {0.82f, 0.76f, 0.62f}),
            mesh("sandstone", {0.72f, 0.55f, 0.37f}), mesh("concrete", {0.60f, 0.62f, 0.64f}),
            mesh("glass", {0.13f, 0.20f, 0.27f}),     mesh("trim", {0.78f, 0.76f, 0.71f}),
            mesh("roof", {0.33f, 0.37f, 0.36f}),      mesh("awning", {0.66f, 0.15f, 0.13f}),
            mesh("soil", {0.24f, 0.18f, 0.12f})};
}

HouseMeshes house_of(std::vector<Mesh>& meshes, Material wall) {
    return {meshes[wall], meshes[kGlass], meshes[kTrim], meshes[kRoof], meshes[kAwning]};
}

/// The box between two corners whose x is measured to the side on which it stands (-1: left, 1: right).
Shape box_on(double side, const glm::dvec3& lower, const glm::dvec3& upper) {
    return side > 0 ? box(lower, upper) : box({-upper.x, lower.y, lower.z}, {-lower.x, upper.y, upper.z});
}

/// Pavement within kerbs; the kerb stands 1 cm higher, half a kerb under the pavement.
void append_island(std::vector<Mesh>& meshes, double side, double inner_x, double outer_x, Block block) {
    constexpr double kWidth = 0.16;
    constexpr double kLow = -0.4;
    append(meshes[kStone],
           box_on(side, {inner_x + 0.08, kLow, block.low_z + 0.08}, {outer_x - 0.08, kPavement, block.high_z - 0.08}), kFlat);
    for (const double x : {inner_x, outer_x - kWidth})
        append(meshes[kKerbStone], box_on(side, {x, kLow, block.low_z}, {x + kWidth, kPavement + 0.01, block.high_z}), kFlat);
    for (const double z : {block.low_z, block.high_z - kWidth})
        append(meshes[kKerbStone], box_on(side, {inner_x + kWidth, kLow, z}, {outer_x - kWidth, kPavement + 0.01, z + kWidth}),
               kFlat);
}

/// The houses of a block along the street, and behind them a plain one as long as the block.
void append_block(std::vector<Mesh>& meshes, double side, std::size_t index, Random& random) {
    constexpr std::array<Material, 4> kWalls = {kBrick, kPlaster, kSand, kConcrete};
    // Storeys from the far end of each block to its near one. Low ones before the camera leave the left pavement in the sun.
    constexpr std::array<std::array<int, 5>, 4> kRight = {{{4, 5, 3, 4, 4}, {3, 5, 4, 5, 3}, {4, 3, 5, 3, 4}, {5, 3, 4, 0, 0}}};
    constexpr std::array<std::array<int, 5>, 4> kLeft = {{{3, 4, 5, 3, 4}, {4, 3, 5, 3, 4}, {5, 4, 3, 4, 3}, {4, 3, 5, 0, 0}}};
    constexpr std::array<int, 4> kHouses = {5, 5, 4, 3};
    const auto& storeys = (side > 0 ? kRight : kLeft)[index];
    const Block block = kBlocks[index];
    const int houses = kHouses[index];
    const double low = block.low_z + 4;
    const double width = (block.high_z - 4 - low) / houses;
    append_island(meshes, side, kKerb, 46, block);
    for (int i = 0; i < houses; ++i) {
        const std::size_t wall = (static_cast<std::size_t>(i) * 3 + index + (side > 0 ? 1 : 0)) % kWalls.size();
        const HouseMeshes parts = house_of(meshes, kWalls[wall]);
        append_house(parts,
                     {.front_x = side * kFront,
                      .back_x = side * kBack,
                      .low_z = low + width * i,
                      .high_z = low + width * (i + 1),
                      .storeys = storeys[static_cast<std::size_t>(i)],
                      .bays = i % 2 == 0 ? 4 : 5,
                      .high_end = i == houses - 1,
                      .shop = (i + static_cast<int>(index)) % 2 == 0,
                      .balconies = side < 0 && index == 0 && (i == 1 || i == 2)},
                     random);
    }
    append_house(house_of(meshes, kWalls[index]),
                 {.front_x = side * 31,
                  .back_x = side * 42,
                  .low_z = low,
                  .high_z = block.high_z - 4,
                  .storeys = 3 + static_cast<int>(index) % 2,
                  .bays = 0,
                  .high_end = true,
                  .plain = true},
                 random);
}

/// The row beyond the next street, which closes what one sees through the crossings.
void append_outer_row(std::vector<Mesh>& meshes, double side, Random& random) {
    append_island(meshes, side, 56, 86, {-246, 34});
    constexpr std::array<Material, 4> kWalls = {kSand, kConcrete, kPlaster, kBrick};
    for (int i = 0; i < 4; ++i) {
        const HouseMeshes parts = house_of(meshes, kWalls[static_cast<std::size_t>(i)]);
        const double low = -242 + 68.5 * i;
        append_house(parts,
                     {.front_x = side * 60,
                      .back_x = side * 74,
                      .low_z = low,
                      .high_z = low + 64,
                      .storeys = 4 + i % 2,
                      .bays = 14,
                      .high_end = true,
                      .plain = true},
                     random);
    }
}

/// A dashed line along the middle, and stripes to walk on at the crossings: plates of 1 cm.
void append_markings(Mesh& paint) {
    constexpr double kTop = 0.012;
    const auto plate = [&](double x, double z, double width, double length) {
        append(paint, box({x - 0.5 * width, -0.05, z - 0.5 * length}, {x + 0.5 * width, kTop, z + 0.5 * length}), kFlat);
    };
    for (const Block& block : kBlocks) {
        for (double z = block.high_z - 7; z > block.low_z + 7; z -= 6) plate(0, z, 0.14, 2.6);
        for (const double z : {block.high_z - 2.2, block.low_z + 2.2})
            for (int i = 0; i < 9; ++i) plate(-4.4 + 1.1 * i, z, 0.5, 3.0);
    }
}

/// Adds meshes whose placements come later, and returns the index of the first.
std::uint32_t add_meshes(Scene& scene, std::initializer_list<Mesh> meshes) {
    const auto first = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.insert(scene.meshes.end(), meshes);
    return first;
}

/// Places `count` meshes from `first` on at `foot`, turned about the vertical axis from x towards -z.
void place(Scene& scene, std::uint32_t first, std::uint32_t count, const glm::dvec3& foot, double yaw_degrees) {
    const auto [s, c] = scalar::sincos(scalar::radians(yaw_degrees));
    const glm::dmat4 world({c, 0, -s, 0}, {0, 1, 0, 0}, {s, 0, c, 0}, glm::dvec4(foot, 1));
    for (std::uint32_t i = 0; i < count; ++i)
        scene.instances.push_back({.mesh = first + i, .world_from_object = glm::mat4(world)});
}

/// Two trees, placed in turn along both pavements, each turned its own way.
void add_trees(Scene& scene) {
    std::array<std::uint32_t, 2> trees{};
    for (std::size_t i = 0; i < trees.size(); ++i) {
        Mesh bark{.name = "bark", .vertices = {}, .indices = {}, .base_color = {0.30f, 0.22f, 0.16f}};
        Mesh foliage{.name = "foliage", .vertices = {}, .indices = {}, .base_color = {0.24f, 0.46f, 0.14f}};
        append_tree(bark, foliage,
                    {.size = 1.75 - 0.2 * static_cast<double>(i),
                     .seed = 5 + i,
                     .limbs = 8,
                     .twigs = 5,
                     .leaves = 12,
                     .leaf_size = 1.55,
                     .twigs_drawn = false});
        trees[i] = add_meshes(scene, {bark, foliage});
    }
    std::size_t count = 0;
    for (const Block& block : kBlocks) {
        for (const double side : {-1.0, 1.0}) {
            const double middle = 0.5 * (block.low_z + block.high_z);
            for (const double share : {-0.28, 0.09}) {
                const glm::dvec3 foot(side * 6.75, kPavement - 0.05, middle + share * (block.high_z - block.low_z) - side);
                append(scene.meshes[kSoil], box(foot - glm::dvec3(0.7, 0.3, 0.7), foot + glm::dvec3(0.7, 0.06, 0.7)), kFlat);
                place(scene, trees[count % 2], 2, foot, 77.0 * static_cast<double>(count));
                ++count;
            }
        }
    }
}

void add_furniture(Scene& scene) {
    Mesh lamp{.name = "lamp", .vertices = {}, .indices = {}, .base_color = {0.12f, 0.20f, 0.17f}};
    append_street_lamp(lamp);
    Mesh hoop{.name = "rack", .vertices = {}, .indices = {}, .base_color = {0.55f, 0.57f, 0.60f}};
    append_rack_hoop(hoop);
    Mesh wood{.name = "wood", .vertices = {}, .indices = {}, .base_color = {0.62f, 0.40f, 0.20f}};
    Mesh iron{.name = "iron", .vertices = {}, .indices = {}, .base_color = {0.14f, 0.15f, 0.16f}};
    append_bench(wood, iron);
    Mesh frame{.name = "bicycle", .vertices = {}, .indices = {}, .base_color = {0.10f, 0.32f, 0.58f}};
    Mesh rubber{.name = "rubber", .vertices = {}, .indices = {}, .base_color = {0.07f, 0.07f, 0.07f}};
    append_bicycle(frame, rubber);
    Mesh bollard{.name = "bollard", .vertices = {}, .indices = {}, .base_color = {0.75f, 0.66f, 0.22f}};
    append(bollard, tube({0, -0.1, 0}, {0, 0.95, 0}, 0.06, 0.05, 8), kRounded);
    const std::uint32_t lamps = add_meshes(scene, {lamp});
    const std::uint32_t racks = add_meshes(scene, {hoop});
    const std::uint32_t benches = add_meshes(scene, {wood, iron});
    const std::uint32_t bicycles = add_meshes(scene, {frame, rubber});
    const std::uint32_t bollards = add_meshes(scene, {bollard});

    for (const Block& block : kBlocks) {
        const double middle = 0.5 * (block.low_z + block.high_z);
        for (const double share : {-0.4, -0.1}) {
            const double z = middle + share * (block.high_z - block.low_z);
            place(scene, lamps, 1, {-6.0, kPavement, z}, 0);
            place(scene, lamps, 1, {6.0, kPavement, z - 3}, 180);
        }
    }

    // Before the camera: a rack with two bicycles, benches that face the street, bollards; some of it again further on.
    for (const double z : {11.5, -29.0}) {
        for (int i = 0; i < 5; ++i) place(scene, racks, 1, {-7.3, kPavement, z - 0.95 * i}, 0);
        place(scene, bicycles, 2, {-7.25, kPavement, z - 0.95 - 0.12}, 0);
        if (z > 0) place(scene, bicycles, 2, {-7.4, kPavement, z - 2.85 + 0.13}, 180);
    }
    for (int i = 0; i < 6; ++i)
        for (const double side : {-1.0, 1.0}) place(scene, bollards, 1, {side * 6.0, kPavement, 12.1 - 2.4 * i}, 0);
    for (const double z : {3.6, 0.9, -36.0, -92.0}) place(scene, benches, 2, {-9.2, kPavement, z}, 90);
    for (const double z : {-9.0, -70.0}) place(scene, benches, 2, {9.2, kPavement, z}, -90);
}

}  // namespace

Scene make_city() {
    Scene scene;
    scene.name = "city";
    scene.meshes = materials();
    append(scene.meshes[kGround], grid({-kSide, 0, kNear}, {2 * kSide, 0, 0}, {0, 0, kFar - kNear}, 6, 12), kFlat);
    append_markings(scene.meshes[kPaint]);
    Random random(58);
    for (std::size_t i = 0; i < kBlocks.size(); ++i)
        for (const double side : {-1.0, 1.0}) append_block(scene.meshes, side, i, random);
    for (const double side : {-1.0, 1.0}) append_outer_row(scene.meshes, side, random);
    append_town_hall(
        {scene.meshes[kSand], scene.meshes[kGlass], scene.meshes[kTrim], scene.meshes[kRoof], scene.meshes[kAwning]},
        kTownHall);
    for (std::uint32_t mesh = 0; mesh < kMaterials; ++mesh) scene.instances.push_back({.mesh = mesh});
    add_trees(scene);
    add_furniture(scene);

    scene.camera.world_from_camera = looking_at({-5.0, 2.2, 14.2}, {-5.85, 0.95, 5.0});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(50));
    scene.camera.znear = 0.5f;
    scene.camera.zfar = 300.0f;
    scene.light.kind = LightKind::Directional;
    const auto [high, flat] = scalar::sincos(scalar::radians(48));
    const auto [behind, across] = scalar::sincos(scalar::radians(20));
    scene.light.world_from_light = looking_at({100 * flat * across, 100 * high, 100 * flat * behind}, {0, 0, 0});
    return scene;
}

}  // namespace gnomon::scenes
