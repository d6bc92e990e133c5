// Houses of boxes. Faces in one plane never overlap: what stands on a face reaches into it, each kind to its own depth.
#include "scenes/city_buildings.h"

#include "scenes/shapes.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::scenes {

namespace {

constexpr double kGroundFloor = 4.2;
constexpr double kStorey = 3.2;
constexpr double kFooting = -0.3;  // where everything that stands on the ground begins

/// One outer face of a house: `corner` at its foot, unit vectors along it and out of it.
struct Face {
    glm::dvec3 corner{0.0};
    glm::dvec3 along{0.0};
    glm::dvec3 out{0.0};
    double width = 0;
};

struct Range {
    double low = 0;
    double high = 0;
};

/// The box over `along` x `up` of a face that reaches from out.low to out.high before it.
Shape slab(const Face& face, Range along, Range up, Range out) {
    const glm::dvec3 a = face.corner + along.low * face.along + out.low * face.out + glm::dvec3(0, up.low, 0);
    const glm::dvec3 b = face.corner + along.high * face.along + out.high * face.out + glm::dvec3(0, up.high, 0);
    return box(glm::min(a, b), glm::max(a, b));
}

/// The height of the floor of a storey, 0 being the ground floor.
double floor_of(int storey) { return storey == 0 ? 0.0 : kGroundFloor + kStorey * (storey - 1); }

/// Glass behind piers and spandrels: openings 0.25 to 0.3 m deep.
void append_windows(const HouseMeshes& meshes, const Face& whole, int storeys, int bays, bool plain) {
    // Piers at the corners stand 3 cm back from the planes of the other faces.
    Face face = whole;
    face.corner += 0.03 * face.along;
    face.width -= 0.06;
    constexpr double kPier = 0.3;
    constexpr double kSpandrel = 0.25;
    constexpr double kPierWidth = 0.8;
    const double top = house_height(storeys) - 0.2;  // inside the cornice
    append(meshes.glass, slab(face, {0.3, face.width - 0.3}, {0.3, top - 0.1}, {-0.1, 0.05}), kFlat);
    const double pitch = (face.width - kPierWidth) / bays;
    for (int i = 0; i <= bays; ++i) {
        append(meshes.wall, slab(face, {i * pitch, i * pitch + kPierWidth}, {kFooting, top}, {-0.05, kPier}), kFlat);
        if (i == bays || plain) continue;
        const double middle = i * pitch + 0.5 * (pitch + kPierWidth);
        append(meshes.trim, slab(face, {middle - 0.05, middle + 0.05}, {0.35, top - 0.05}, {-0.05, 0.12}), kFlat);
    }
    // A spandrel reaches from the windows of one storey to those of the next; a string course lies on it as their sill.
    const Range inner{0.1, face.width - 0.1};
    append(meshes.wall, slab(face, inner, {kFooting, 0.6}, {-0.05, kSpandrel}), kFlat);
    for (int storey = 1; storey < storeys; ++storey) {
        const double floor = floor_of(storey);
        append(meshes.wall, slab(face, inner, {floor - 0.5, floor + 0.85}, {-0.05, kSpandrel}), kFlat);
        if (plain) continue;
        append(meshes.trim, slab(face, {0.2, face.width - 0.2}, {floor + 0.8, floor + 0.93}, {-0.04, kSpandrel + 0.13}), kFlat);
    }
    append(meshes.wall, slab(face, inner, {top - 0.6, top - 0.02}, {-0.05, kSpandrel}), kFlat);
}

void append_awnings(const HouseMeshes& meshes, const Face& face, int bays) {
    const double pitch = (face.width - 0.8) / bays;
    for (int i = 0; i < bays; ++i) {
        const glm::dvec3 middle = face.corner + (i * pitch + 0.5 * (pitch + 0.8)) * face.along;
        append(meshes.awning,
               bar(middle + 0.2 * face.out + glm::dvec3(0, 3.45, 0), middle + 1.5 * face.out + glm::dvec3(0, 2.8, 0),
                   face.along, pitch - 0.5, 0.05),
               kFlat);
    }
}

/// A slab before every second bay of an upper storey, with a railing of balusters.
void append_balconies(const HouseMeshes& meshes, const Face& face, int storey, int bays) {
    const double pitch = (face.width - 0.8) / bays;
    const double floor = floor_of(storey) + 0.1;
    constexpr double kReach = 1.25;
    for (int i = 0; i < bays; i += 2) {
        const Range width{i * pitch + 0.3, (i + 1) * pitch + 0.5};
        append(meshes.wall, slab(face, width, {floor - 0.15, floor}, {0.1, kReach}), kFlat);
        append(meshes.trim,
               slab(face, {width.low + 0.02, width.high - 0.02}, {floor + 0.95, floor + 1.0}, {kReach - 0.08, kReach - 0.02}),
               kFlat);
        for (const double at : {width.low + 0.03, width.high - 0.09})
            append(meshes.trim, slab(face, {at, at + 0.06}, {floor + 0.94, floor + 0.99}, {0.12, kReach - 0.05}), kFlat);
        constexpr int kBalusters = 6;
        for (int k = 0; k <= kBalusters; ++k) {
            const double at = width.low + 0.05 + (width.high - width.low - 0.1) * k / kBalusters;
            append(meshes.trim,
                   slab(face, {at - 0.015, at + 0.015}, {floor - 0.05, floor + 0.97}, {kReach - 0.065, kReach - 0.035}), kFlat);
        }
    }
}

/// A parapet around a roof at `y`, without corners that overlap.
void append_parapet(Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper) {
    constexpr double kThickness = 0.3;
    for (const double x : {lower.x, upper.x - kThickness})
        append(mesh, box({x, lower.y, lower.z}, {x + kThickness, upper.y, upper.z}), kFlat);
    for (const double z : {lower.z, upper.z - kThickness})
        append(mesh, box({lower.x + kThickness, lower.y, z}, {upper.x - kThickness, upper.y, z + kThickness}), kFlat);
}

/// A stair head, a chimney, a machine, and on some roofs a water tank on legs.
void append_roof_things(const HouseMeshes& meshes, const glm::dvec3& lower, const glm::dvec3& upper, Random& random) {
    const double y = lower.y;
    const double stair_share = random.uniform(0.25, 0.55);
    const glm::dvec3 stair(lower.x + 0.4 * (upper.x - lower.x), y - 0.1, lower.z + stair_share * (upper.z - lower.z));
    append(meshes.wall, box(stair, stair + glm::dvec3(3.0, 2.7, 2.6)), kFlat);
    append(meshes.roof, box(stair + glm::dvec3(-0.25, 2.6, -0.25), stair + glm::dvec3(3.25, 2.8, 2.85)), kFlat);
    const double chimney_share = random.uniform(0.1, 0.8);
    const double chimney_height = random.uniform(1.6, 2.6);
    const glm::dvec3 chimney(lower.x + chimney_share * (upper.x - lower.x), y - 0.1, upper.z - 1.6);
    append(meshes.wall, box(chimney, chimney + glm::dvec3(0.9, chimney_height, 0.6)), kFlat);
    append(meshes.trim,
           box(chimney + glm::dvec3(-0.1, chimney_height - 0.2, -0.1), chimney + glm::dvec3(1.0, chimney_height + 0.05, 0.7)),
           kFlat);
    const double machine_share = random.uniform(0.15, 0.75);
    const glm::dvec3 machine(lower.x + machine_share * (upper.x - lower.x), y - 0.1, lower.z + 0.9);
    append(meshes.trim, box(machine, machine + glm::dvec3(1.4, 1.2, 1.0)), kFlat);
    if (random.uniform(0, 1) < 0.6) return;
    const glm::dvec3 tank(lower.x + 0.72 * (upper.x - lower.x), y, lower.z + 0.3 * (upper.z - lower.z));
    append(meshes.roof, tube(tank + glm::dvec3(0, 1.5, 0), tank + glm::dvec3(0, 3.8, 0), 1.2, 1.2, 14), kSmooth);
    append(meshes.roof, tube(tank + glm::dvec3(0, 3.78, 0), tank + glm::dvec3(0, 4.6, 0), 1.35, 0.1, 14), kSmooth);
    for (const double x : {-0.7, 0.7})
        for (const double z : {-0.7, 0.7})
            append(meshes.trim, box(tank + glm::dvec3(x - 0.08, -0.1, z - 0.08), tank + glm::dvec3(x + 0.08, 1.55, z + 0.08)),
                   kFlat);
}

}  // namespace

double house_height(int storeys) { return kGroundFloor + kStorey * (storeys - 1) + 0.7; }

void append_house(const HouseMeshes& meshes, const House& house, Random& random) {
    const double height = house_height(house.storeys);
    const double side = house.front_x < 0 ? -1 : 1;
    const glm::dvec3 lower(std::min(house.front_x, house.back_x), kFooting, house.low_z);
    const glm::dvec3 upper(std::max(house.front_x, house.back_x), height, house.high_z);
    append(meshes.wall, box(lower, upper), kFlat);

    const double depth = upper.x - lower.x;
    const Face front{.corner = {house.front_x, 0, house.low_z},
                     .along = {0, 0, 1},
                     .out = {-side, 0, 0},
                     .width = house.high_z - house.low_z};
    if (house.bays > 0) append_windows(meshes, front, house.storeys, house.bays, house.plain);
    const int end_bays = static_cast<int>(depth / 3.4);
    if (house.high_end)
        append_windows(meshes, {.corner = {lower.x, 0, upper.z}, .along = {1, 0, 0}, .out = {0, 0, 1}, .width = depth},
                       house.storeys, end_bays, house.plain);
    if (house.shop) append_awnings(meshes, front, house.bays);
    if (house.balconies)
        for (int storey = 1; storey < std::min(house.storeys, 3); ++storey) append_balconies(meshes, front, storey, house.bays);

    // The cornice is the roof as well. It ends 2 cm before a neighbour's wall, so that it lies in no plane of it.
    glm::dvec3 eaves_low(lower.x, height - 0.45, lower.z + 0.02);
    glm::dvec3 eaves_high(upper.x, height + 0.12, upper.z + (house.high_end ? 0.55 : -0.02));
    (side < 0 ? eaves_high : eaves_low).x -= side * 0.55;
    (side < 0 ? eaves_low : eaves_high).x += side * 0.1;
    append(meshes.trim, box(eaves_low, eaves_high), kFlat);
    const double roof = height + 0.12;
    const glm::dvec3 parapet_low(lower.x + 0.05, roof - 0.1, lower.z + 0.05);
    const glm::dvec3 parapet_high(upper.x - 0.05, roof + 0.9, upper.z - 0.05);
    append_parapet(meshes.wall, parapet_low, parapet_high);
    append_roof_things(meshes, {lower.x + 1, roof, lower.z + 0.5}, {upper.x - 1, roof, upper.z - 0.5}, random);
}

void append_town_hall(const HouseMeshes& meshes, double front_z) {
    constexpr double kHalf = 17;
    constexpr double kTop = 13;
    const glm::dvec3 lower(-kHalf, kFooting, front_z - 12);
    const glm::dvec3 upper(kHalf, kTop, front_z);
    append(meshes.wall, box(lower, upper), kFlat);
    append_windows(meshes, {.corner = {-kHalf, 0, front_z}, .along = {1, 0, 0}, .out = {0, 0, 1}, .width = 2 * kHalf}, 3, 11,
                   false);

    // A portico on steps, its gable, and the tower with a lantern and a spire.
    for (int i = 0; i < 4; ++i)
        append(meshes.trim,
               box({-9.0 - 0.4 * i, -0.2, front_z - 0.1}, {9.0 + 0.4 * i, 0.8 - 0.17 * i, front_z + 4.4 + 0.4 * i}), kFlat);
    for (int i = 0; i < 6; ++i) {
        const double x = -7.5 + 3.0 * i;
        append(meshes.trim, tube({x, 0.7, front_z + 3.4}, {x, 10.2, front_z + 3.4}, 0.55, 0.45, 12), kRounded);
    }
    append(meshes.trim, box({-8.8, 10.1, front_z - 0.1}, {8.8, 11.4, front_z + 4.3}), kFlat);
    const auto gable = [&](double z) { return std::vector<glm::dvec3>{{-8.9, 11.35, z}, {8.9, 11.35, z}, {0.0, 14.4, z}}; };
    append(meshes.roof, loft({gable(front_z - 2), gable(front_z + 4.5)}), kFlat);
    append(meshes.trim, box({-kHalf - 0.5, kTop - 0.4, front_z - 12.5}, {kHalf + 0.5, kTop + 0.3, front_z + 0.5}), kFlat);
    append(meshes.wall, box({-3.5, kTop, front_z - 9}, {3.5, 24, front_z - 2.5}), kFlat);
    append(meshes.trim, box({-4, 23.5, front_z - 9.5}, {4, 24.3, front_z - 2}), kFlat);
    append(meshes.wall, box({-2.5, 24, front_z - 8.25}, {2.5, 28, front_z - 3.25}), kFlat);
    append(meshes.roof, tube({0, 27.9, front_z - 5.75}, {0, 37, front_z - 5.75}, 3.6, 0.1, 8), kFlat);
}

}  // namespace gnomon::scenes
