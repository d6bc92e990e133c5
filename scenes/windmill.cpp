// `windmill`: sails of lattice before a tower with a gallery, trees and a fence around it: many overlapping shadows.
// [Lauritzen08] figure 4.8
//
// The light comes over the sails. A ray to the ground behind the mill can meet the bars of a sail, the rail of the gallery, the
// planks of its deck and the struts below; the shadow of a tree lies over the ladder and its shadow.
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/tree.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace gnomon::scenes {

namespace {

constexpr double kDeckHeight = 2.9;  // top of the gallery's planks
constexpr double kEaves = 6.9;       // where the tower ends and the cap begins
constexpr double kGalleryRadius = 3.6;
constexpr double kHillRadius = 11.0;
constexpr glm::dvec3 kHub(0.0, 7.75, 2.35);
constexpr glm::dvec3 kShaft(0.0, 0.12, 1.0);  // the windshaft rises towards the sails

/// The point at `radius` from the tower's axis in the direction of corner `k` of its octagon; a whole side faces +z. Between
/// corners `k` goes through the circle.
glm::dvec3 corner(double k, double radius, double y) {
    const auto [s, c] = scalar::sincos(scalar::kPi / 4 * (k + 0.5));
    return {radius * s, y, radius * c};
}

/// A point on the side of the octagon from corner `k` to the next, at `share` of the way.
glm::dvec3 on_side(int k, double share, double radius, double y) {
    return corner(k, radius, y) * (1 - share) + corner(k + 1, radius, y) * share;
}

/// An upright eight-sided prism around the axis, tapered.
Shape octagon(double low_y, double low_radius, double high_y, double high_radius) {
    std::vector<std::vector<glm::dvec3>> rings(2);
    for (int k = 0; k < 8; ++k) {
        rings[0].push_back(corner(k, low_radius, low_y));
        rings[1].push_back(corner(k, high_radius, high_y));
    }
    return loft(rings);
}

/// A brick base, a body of boards that overlap like scales, and openings.
void append_tower(Mesh& brick, Mesh& boards, Mesh& trim) {
    append(brick, octagon(-0.3, 2.45, kDeckHeight - 0.3, 2.2), kFlat);
    append(trim, octagon(kDeckHeight - 0.3, 2.3, kDeckHeight - 0.1, 2.3), kFlat);
    constexpr int kBoards = 16;
    const auto radius = [](double y) { return 2.1 - 0.75 * (y - kDeckHeight) / (kEaves - kDeckHeight); };
    for (int i = 0; i < kBoards; ++i) {
        const double low = kDeckHeight - 0.1 + (kEaves - kDeckHeight + 0.1) * i / kBoards;
        const double high = kDeckHeight - 0.1 + (kEaves - kDeckHeight + 0.1) * (i + 1) / kBoards;
        append(boards, octagon(low, radius(low) + 0.05, high, radius(high)), kFlat);
    }

    // Doors in front and in the side towards the camera, windows with sills above them.
    append(trim, box({-0.5, 0, 2.0}, {0.5, 1.75, 2.28}), kFlat);
    append(trim, box({-0.35, kDeckHeight, 1.8}, {0.35, kDeckHeight + 1.4, 2.02}), kFlat);
    append(trim, box({2.0, 0.9, -0.35}, {2.26, 1.7, 0.35}), kFlat);
    append(trim, box({1.3, 5.0, -0.25}, {1.66, 5.6, 0.25}), kFlat);
    append(trim, box({1.3, 4.95, -0.35}, {1.78, 5.0, 0.35}), kFlat);
}

/// The cap, its curb, the windshaft, and behind it the tail pole by which the miller turns the sails into the wind.
void append_cap(Mesh& thatch, Mesh& trim) {
    append(trim, octagon(kEaves, 1.55, kEaves + 0.16, 1.55), kFlat);
    append(thatch, ellipsoid({0, kEaves + 0.16, -0.05}, {1.5, 1.55, 1.9}, 32, 16), kSmooth);
    append(trim, tube(kHub - 1.2 * kShaft, kHub + 0.28 * kShaft, 0.2, 0.17, 12), kRounded);
    const glm::dvec3 foot(0, kDeckHeight + 0.5, -3.9);
    append(trim, bar({0, kEaves + 1.2, -1.3}, foot, {1, 0, 0}, 0.14, 0.14), kFlat);
    for (const double side : {-1.0, 1.0}) {
        append(trim, bar({side * 1.75, kEaves + 0.5, 0.3}, foot, {1, 0, 0}, 0.09, 0.09), kFlat);
        append(trim, bar({side * 1.2, kEaves + 0.4, -1.0}, foot, {1, 0, 0}, 0.09, 0.09), kFlat);
    }
    append(trim, bar({-1.9, kEaves + 0.5, 0.3}, {1.9, kEaves + 0.5, 0.3}, {0, 1, 0}, 0.14, 0.14), kFlat);
}

/// One sail along the unit vector `along`: the stock, and beside it a lattice of bars and laths, set at an angle to the wind.
void append_sail(Mesh& lattice, const glm::dvec3& along, const glm::dvec3& side) {
    constexpr double kLength = 4.1;
    constexpr double kRoot = 0.75;  // where the lattice begins
    const auto [s, c] = scalar::sincos(scalar::radians(14));
    const glm::dvec3 across = c * side + s * kShaft;
    append(lattice, bar(kHub, kHub + kLength * along, across, 0.16, 0.13), kFlat);
    constexpr int kBars = 20;
    for (int i = 0; i < kBars; ++i) {
        const glm::dvec3 middle = kHub + (kRoot + (kLength - 0.05 - kRoot) * i / (kBars - 1)) * along;
        append(lattice, bar(middle - 0.32 * across, middle + 0.92 * across, along, 0.05, 0.045), kFlat);
    }
    for (const double offset : {-0.3, 0.3, 0.6, 0.9}) {
        const glm::dvec3 shift = offset * across - 0.03 * kShaft;
        append(lattice, bar(kHub + kRoot * along + shift, kHub + kLength * along + shift, across, 0.055, 0.04), kFlat);
    }
}

void append_sails(Mesh& lattice) {
    const double length = std::sqrt(glm::dot(kShaft, kShaft));
    const glm::dvec3 right(1, 0, 0);
    const glm::dvec3 up = glm::cross(kShaft, right) / length;
    for (int sail = 0; sail < 4; ++sail) {
        const auto [s, c] = scalar::sincos(scalar::radians(90.0 * sail + 33.0));
        append_sail(lattice, c * right + s * up, -s * right + c * up);
    }
}

/// One of the eight sides of the gallery: planks with gaps, joists and struts below, a railing with balusters.
void append_gallery_side(Mesh& wood, Mesh& rail, int k) {
    for (int plank = 0; plank < 8; ++plank) {
        const double radius = 2.25 + 0.19 * plank;
        append(wood,
               bar(corner(k, radius, kDeckHeight - 0.03), corner(k + 1, radius, kDeckHeight - 0.03), {0, 1, 0}, 0.06, 0.125),
               kFlat);
    }
    for (const double share : {0.0, 0.5}) {
        append(wood,
               bar(on_side(k, share, 2.1, kDeckHeight - 0.13), on_side(k, share, kGalleryRadius, kDeckHeight - 0.13), {0, 1, 0},
                   0.14, 0.1),
               kFlat);
        append(wood, bar(on_side(k, share, 2.25, 1.4), on_side(k, share, 3.4, kDeckHeight - 0.2), {0, 1, 0}, 0.1, 0.1), kFlat);
        append(rail,
               bar(on_side(k, share, kGalleryRadius, kDeckHeight - 0.2), on_side(k, share, kGalleryRadius, kDeckHeight + 1.0),
                   corner(k, 1, 0), 0.1, 0.1),
               kFlat);
    }
    for (const double height : {0.12, 0.55, 0.95}) {
        append(rail,
               bar(corner(k, kGalleryRadius, kDeckHeight + height), corner(k + 1, kGalleryRadius, kDeckHeight + height),
                   {0, 1, 0}, 0.07, 0.08),
               kFlat);
    }
    constexpr int kBalusters = 16;
    for (int i = 0; i < kBalusters; ++i) {
        const double share = (i + 0.5) / kBalusters;
        append(rail,
               bar(on_side(k, share, kGalleryRadius, kDeckHeight + 0.12), on_side(k, share, kGalleryRadius, kDeckHeight + 0.95),
                   corner(k, 1, 0), 0.05, 0.05),
               kFlat);
    }
}

/// A low round hill whose edge falls off.
Shape hill() {
    std::vector<std::vector<glm::dvec3>> rings;
    for (const auto& [radius, y] :
         {std::pair(kHillRadius - 0.4, -1.0), std::pair(kHillRadius, -0.35), std::pair(kHillRadius - 0.3, -0.1),
          std::pair(kHillRadius - 1.0, 0.0), std::pair(0.5 * kHillRadius, 0.0)}) {
        std::vector<glm::dvec3>& ring = rings.emplace_back();
        for (int i = 0; i < 64; ++i) ring.push_back(corner(i / 8.0, radius, y));
    }
    return loft(rings);
}

/// One section of the fence from the post at `from`: the post, two rails, pickets.
void append_fence_section(Mesh& wood, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    append(wood, bar(from, from + glm::dvec3(0, 1.25, 0), along, 0.12, 0.12), kFlat);
    for (const double y : {0.35, 0.85})
        append(wood, bar(from + glm::dvec3(0, y, 0), to + glm::dvec3(0, y, 0), {0, 1, 0}, 0.08, 0.05), kFlat);
    constexpr int kPickets = 6;
    for (int i = 0; i < kPickets; ++i) {
        const glm::dvec3 foot = from + along * ((i + 1.0) / (kPickets + 1));
        append(wood, bar(foot + glm::dvec3(0, 0.1, 0), foot + glm::dvec3(0, 1.1, 0), along, 0.09, 0.03), kFlat);
    }
}

/// A ladder against the gallery on the lit side, and a millstone that leans on the tower.
void append_props(Mesh& wood, Mesh& stone) {
    const glm::dvec3 foot(-1.6, 0, 5.3);
    const glm::dvec3 top(-1.6, kDeckHeight + 0.6, 3.5);
    for (const double x : {-0.25, 0.25})
        append(wood, bar(foot + glm::dvec3(x, 0, 0), top + glm::dvec3(x, 0, 0), {1, 0, 0}, 0.06, 0.09), kFlat);
    for (int rung = 1; rung < 12; ++rung) {
        const glm::dvec3 middle = foot + (top - foot) * (rung / 12.0);
        append(wood, bar(middle - glm::dvec3(0.25, 0, 0), middle + glm::dvec3(0.25, 0, 0), {0, 1, 0}, 0.05, 0.05), kFlat);
    }
    append(stone, tube({1.15, 0.55, 2.38}, {1.16, 0.61, 2.56}, 0.55, 0.55, 32), kSmooth);
}

}  // namespace

Scene make_windmill() {
    Scene scene;
    scene.name = "windmill";
    Mesh ground{.name = "ground", .vertices = {}, .indices = {}, .base_color = {0.50f, 0.56f, 0.34f}};
    Mesh brick{.name = "brick", .vertices = {}, .indices = {}, .base_color = {0.62f, 0.30f, 0.20f}};
    Mesh boards{.name = "boards", .vertices = {}, .indices = {}, .base_color = {0.70f, 0.66f, 0.56f}};
    Mesh thatch{.name = "thatch", .vertices = {}, .indices = {}, .base_color = {0.45f, 0.36f, 0.24f}};
    Mesh trim{.name = "trim", .vertices = {}, .indices = {}, .base_color = {0.10f, 0.25f, 0.20f}};
    Mesh wood{.name = "wood", .vertices = {}, .indices = {}, .base_color = {0.50f, 0.37f, 0.24f}};
    Mesh rail{.name = "rail", .vertices = {}, .indices = {}, .base_color = {0.82f, 0.82f, 0.78f}};
    Mesh lattice{.name = "lattice", .vertices = {}, .indices = {}, .base_color = {0.72f, 0.22f, 0.14f}};
    Mesh stone{.name = "stone", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.42f)};
    Mesh bark{.name = "bark", .vertices = {}, .indices = {}, .base_color = {0.30f, 0.22f, 0.16f}};
    Mesh foliage{.name = "foliage", .vertices = {}, .indices = {}, .base_color = {0.22f, 0.48f, 0.14f}};

    append(ground, hill(), kSmooth);
    append_tower(brick, boards, trim);
    append_cap(thatch, trim);
    append_sails(lattice);
    for (int k = 0; k < 8; ++k) append_gallery_side(wood, rail, k);
    for (int i = 6; i < 27; ++i) append_fence_section(wood, corner(0.25 * i, 9.6, 0), corner(0.25 * (i + 1), 9.6, 0));
    append_props(wood, stone);
    append_tree(bark, foliage, {.foot = {-5.4, 0, 3.9}, .size = 1.1, .seed = 2});
    append_tree(bark, foliage, {.foot = {5.2, 0, -5.6}, .size = 1.25, .seed = 3});

    scene.meshes = {ground, brick, boards, thatch, trim, wood, rail, lattice, stone, bark, foliage};
    for (std::uint32_t mesh = 0; mesh < 11; ++mesh) scene.instances.push_back({.mesh = mesh});

    // From the side to which the shadows fall, high enough to see the deck of the gallery and the ground behind the tower.
    scene.camera.world_from_camera = looking_at({11.8, 10.2, 20.8}, {0.5, 4.35, 0.0});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(36));
    scene.camera.znear = 0.5f;
    scene.camera.zfar = 80.0f;
    scene.light.kind = LightKind::Spot;
    scene.light.world_from_light = looking_at({-17.0, 38.0, 25.0}, {0.5, 2.0, -0.8});
    scene.light.outer_cone_rad = static_cast<float>(scalar::radians(16));
    return scene;
}

}  // namespace gnomon::scenes
