// Benches, bicycle racks, bicycles, street lamps: thin things that throw thin shadows.
#include "scenes/street_furniture.h"

#include "scenes/shapes.h"
#include "sim/scalar_math.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace gnomon::scenes {

namespace {

/// A tyre with a rim and crossed spokes around `hub`, in the plane z = 0.
void append_wheel(Mesh& rubber, Mesh& paint, const glm::dvec3& hub) {
    constexpr double kOuter = 0.345;
    constexpr double kInner = 0.312;
    Shape tyre = revolution({{kOuter, -0.014}, {kOuter, 0.014}, {kInner, 0.018}, {kInner, -0.018}}, 28);
    for (glm::vec3& p : tyre.positions) p += glm::vec3(hub);
    append(rubber, tyre, kSmooth);

    // Each pair of spokes lies a little beside the one before, so that no two faces lie in one plane.
    constexpr int kPairs = 5;
    for (int i = 0; i < kPairs; ++i) {
        const auto [s, c] = scalar::sincos(scalar::kPi * (i + 0.3) / kPairs);
        const glm::dvec3 reach = 0.5 * (kOuter + kInner) * glm::dvec3(c, s, 0);
        const glm::dvec3 beside(0, 0, 0.005 * (i - 2));
        append(paint, bar(hub + beside - reach, hub + beside + reach, {0, 0, 1}, 0.007, 0.007), kFlat);
    }
    append(paint, tube(hub - glm::dvec3(0, 0, 0.05), hub + glm::dvec3(0, 0, 0.05), 0.025, 0.025, 8), kRounded);
}

}  // namespace

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

void append_rack_hoop(Mesh& steel) {
    constexpr double kHalfWidth = 0.38;
    constexpr double kShoulder = 0.5;  // height at which the legs end and the half circle begins
    constexpr double kTube = 0.024;
    constexpr int kSides = 8;
    constexpr int kArc = 10;
    std::vector<std::vector<glm::dvec3>> rings;
    const auto add_ring = [&](const glm::dvec3& middle, const glm::dvec3& outwards) {
        std::vector<glm::dvec3>& ring = rings.emplace_back();
        for (int i = 0; i < kSides; ++i) {
            const auto [s, c] = scalar::sincos(2 * scalar::kPi * i / kSides);
            ring.push_back(middle + kTube * (c * outwards + glm::dvec3(0, 0, s)));
        }
    };
    add_ring({-kHalfWidth, -0.1, 0}, {-1, 0, 0});
    for (int i = 0; i <= kArc; ++i) {
        const auto [s, c] = scalar::sincos(scalar::kPi * i / kArc);
        const glm::dvec3 outwards(-c, s, 0);
        add_ring(glm::dvec3(0, kShoulder, 0) + kHalfWidth * outwards, outwards);
    }
    add_ring({kHalfWidth, -0.1, 0}, {1, 0, 0});
    append(steel, loft(rings), kSmooth);
}

void append_bicycle(Mesh& paint, Mesh& rubber) {
    const glm::dvec3 rear(-0.52, 0.345, 0);
    const glm::dvec3 front(0.52, 0.345, 0);
    const glm::dvec3 crank(-0.06, 0.29, 0);
    const glm::dvec3 seat(-0.22, 0.86, 0);
    const glm::dvec3 head_low(0.42, 0.64, 0);
    const glm::dvec3 head_high(0.36, 0.86, 0);
    const glm::dvec3 grip(0.30, 0.98, 0);
    append_wheel(rubber, paint, rear);
    append_wheel(rubber, paint, front);

    // The frame: three main tubes and the head, stays and fork on both sides of the wheels.
    const auto add = [&](Mesh& mesh, const glm::dvec3& from, const glm::dvec3& to, double radius) {
        append(mesh, tube(from, to, radius, radius, 6), kRounded);
    };
    add(paint, crank, seat, 0.016);
    add(paint, seat - glm::dvec3(-0.025, 0.1, 0), head_high - glm::dvec3(-0.01, 0.06, 0), 0.016);
    add(paint, crank, head_low, 0.019);
    add(paint, head_low, head_high, 0.02);
    for (const double side : {-0.04, 0.04}) {
        const glm::dvec3 z(0, 0, side);
        add(paint, rear + z, crank + 0.5 * z, 0.009);
        add(paint, rear + z, seat - glm::dvec3(-0.03, 0.12, 0) + 0.3 * z, 0.008);
        add(paint, front + z, head_low + z, 0.012);
    }
    add(paint, head_low - glm::dvec3(0, 0, 0.052), head_low + glm::dvec3(0, 0, 0.052), 0.014);

    // What the rider touches.
    add(paint, head_high, grip, 0.014);
    add(rubber, grip - glm::dvec3(0, 0, 0.28), grip + glm::dvec3(0, 0, 0.28), 0.014);
    append(rubber, ellipsoid(seat + glm::dvec3(0.02, 0.02, 0), {0.13, 0.035, 0.07}, 8, 4), kSmooth);
    append(paint, tube(crank - glm::dvec3(0, 0, 0.055), crank - glm::dvec3(0, 0, 0.045), 0.09, 0.09, 14), kSmooth);
    add(rubber, crank + glm::dvec3(0.1, -0.14, 0.04), crank + glm::dvec3(0.1, -0.14, 0.14), 0.02);
    add(paint, crank, crank + glm::dvec3(0.1, -0.14, 0.04), 0.012);
}

void append_street_lamp(Mesh& steel) {
    append(steel, tube({0, -0.1, 0}, {0, 0.7, 0}, 0.13, 0.11, 10), kRounded);
    append(steel, tube({0, 0.65, 0}, {0, 6.2, 0}, 0.075, 0.05, 10), kRounded);
    append(steel, tube({0, 6.15, 0}, {1.4, 6.55, 0}, 0.045, 0.035, 8), kRounded);
    append(steel, bar({1.3, 6.54, 0}, {2.1, 6.6, 0}, {0, 0, 1}, 0.28, 0.12), kFlat);
}

}  // namespace gnomon::scenes
