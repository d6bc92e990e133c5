// `car`: a car of about 10,000 triangles on a large plane, seen at a shallow angle under a spotlight. [Donnelly06] figure 1
//
// The car stands on y = 0, its front towards +x; lengths are metres. Its proportions are those of a four-door saloon.
#include "scenes/builders.h"
#include "scenes/shapes.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace gnomon::scenes {

namespace {

using Ring = std::vector<glm::dvec3>;

constexpr double kFrontAxle = 1.36;
constexpr double kRearAxle = -1.30;
constexpr double kWheelRadius = 0.33;
constexpr double kWheelWidth = 0.21;
constexpr double kTrack = 0.76;        // from the middle plane to the middle of a wheel
constexpr double kArchWidth = 0.40;    // half width of a wheel arch
constexpr double kArchHeight = 0.535;  // height of its top above the sill
constexpr double kSill = 0.19;         // height of the lower edge of the body
constexpr double kHalfWidth = 0.88;

struct Knot {
    double x;
    double y;
};

/// A C1 curve through knots of increasing x: cubic Hermite pieces with central-difference slopes (Catmull and Rom).
template <std::size_t N>
double curve(const std::array<Knot, N>& knots, double x) {
    if (x <= knots.front().x) return knots.front().y;
    if (x >= knots.back().x) return knots.back().y;
    std::size_t i = 0;
    while (x > knots[i + 1].x) ++i;
    const auto slope = [&](std::size_t k) {
        const std::size_t a = k > 0 ? k - 1 : k;
        const std::size_t b = k + 1 < N ? k + 1 : k;
        return (knots[b].y - knots[a].y) / (knots[b].x - knots[a].x);
    };
    const double h = knots[i + 1].x - knots[i].x;
    const double t = (x - knots[i].x) / h;
    const double u = 1 - t;
    return knots[i].y * u * u * (1 + 2 * t) + knots[i + 1].y * t * t * (1 + 2 * u) +
           h * t * u * (slope(i) * u - slope(i + 1) * t);
}

/// Height of the body's upper surface in the middle plane: boot, waist, bonnet.
double body_top(double x) {
    constexpr std::array<Knot, 8> kTop = {{{-2.20, 0.88},
                                           {-1.95, 0.955},
                                           {-1.50, 0.975},
                                           {-0.60, 0.955},
                                           {0.70, 0.945},
                                           {1.10, 0.90},
                                           {1.70, 0.80},
                                           {2.20, 0.66}}};
    return curve(kTop, x);
}

/// Half the width of the body in plan.
double body_half_width(double x) {
    constexpr std::array<Knot, 7> kPlan = {{{-2.20, 0.74},
                                            {-1.80, 0.835},
                                            {-1.20, kHalfWidth},
                                            {0.0, kHalfWidth},
                                            {1.30, kHalfWidth},
                                            {1.85, 0.82},
                                            {2.20, 0.68}}};
    return curve(kPlan, x);
}

/// Height of the body's lower edge: the sill, cut by two half ellipses over the wheels.
double body_bottom(double x) {
    double bottom = kSill;
    for (const double axle : {kFrontAxle, kRearAxle}) {
        const double d = (x - axle) / kArchWidth;
        if (std::fabs(d) < 1) bottom = std::max(bottom, kSill + kArchHeight * std::sqrt(1 - d * d));
    }
    return bottom;
}

/// Half the width at a height between sill (0) and shoulder (1) as a share of the widest: flanks bulge, sides lean in at the
/// top.
double flank(double height) {
    return 1 - 0.16 * (height - 0.45) * (height - 0.45) - (height < 0.15 ? 1.6 * (0.15 - height) * (0.15 - height) : 0);
}

/// One section of the body at x, drawn together towards a point at both ends by `close` in (0, 1].
Ring body_section(double x, double close) {
    const double bottom = body_bottom(x);
    const double top = body_top(x);
    const double half_width = body_half_width(x) * (0.55 + 0.45 * close);
    constexpr double kShoulder = 0.075;  // radius of the edge between side and upper surface
    Ring half;  // from the middle of the underside, up the left side (+z), to the middle of the upper surface
    half.emplace_back(x, bottom, 0.45 * half_width);
    for (int i = 0; i <= 6; ++i) {
        const double y = bottom + (top - kShoulder - bottom) * i / 6;
        const double height = (y - kSill) / (top - kShoulder - kSill);
        half.emplace_back(x, y, half_width * flank(height));
    }
    const double edge = half_width * flank(1);
    for (const double degrees : {30.0, 60.0, 90.0}) {
        const auto [s, c] = scalar::sincos(scalar::radians(degrees));
        half.emplace_back(x, top - kShoulder * (1 - s) - 0.02 * c, edge - kShoulder * (1 - c));
    }
    half.emplace_back(x, top + 0.018, 0.72 * edge);
    half.emplace_back(x, top + 0.028, 0.38 * edge);
    Ring ring = half;
    ring.emplace_back(x, top + 0.032, 0.0);
    for (auto p = half.rbegin(); p != half.rend(); ++p) ring.emplace_back(p->x, p->y, -p->z);
    constexpr double kNoseHeight = 0.52;
    for (glm::dvec3& p : ring) p.y = kNoseHeight + (p.y - kNoseHeight) * close;
    return ring;
}

Shape body() {
    // Sections: rounded at both ends, on the ellipses of the arches so that their outline is smooth, evenly between.
    std::vector<std::pair<double, double>> stations;
    constexpr double kRound = 0.17;
    for (const double degrees : {78.0, 66.0, 52.0, 36.0, 18.0}) {
        const auto [s, c] = scalar::sincos(scalar::radians(degrees));
        stations.emplace_back(2.05 + kRound * s, std::sqrt(c));
        stations.emplace_back(-2.05 - kRound * s, std::sqrt(c));
    }
    for (const double axle : {kFrontAxle, kRearAxle}) {
        for (int i = 0; i <= 12; ++i) stations.emplace_back(axle + kArchWidth * scalar::cos(scalar::kPi * i / 12), 1.0);
    }
    for (const double x : {-2.05, -1.88, -0.74, -0.56, -0.37, -0.18, 0.02, 0.21, 0.40, 0.60, 0.78, 1.90, 2.05}) {
        stations.emplace_back(x, 1.0);
    }
    std::sort(stations.begin(), stations.end());
    std::vector<Ring> rings;
    rings.reserve(stations.size());
    for (const auto& [x, close] : stations) rings.push_back(body_section(x, close));
    return loft(rings);
}

/// The outline of the passenger cell in plan at one height: a rectangle from `rear` to `front` with rounded corners.
Ring cell_outline(double y, double rear, double front, double half_width, double corner) {
    Ring ring;
    const std::array<glm::dvec2, 4> centers = {{{front - corner, half_width - corner},
                                                {rear + corner, half_width - corner},
                                                {rear + corner, -half_width + corner},
                                                {front - corner, -half_width + corner}}};
    for (int quarter = 0; quarter < 4; ++quarter) {
        const glm::dvec2 center = centers[static_cast<std::size_t>(quarter)];
        for (int i = 0; i <= 4; ++i) {
            const auto [s, c] = scalar::sincos(scalar::kPi / 2 * (quarter + i / 4.0));
            ring.emplace_back(center.x + corner * c, y, center.y + corner * s);
        }
    }
    return ring;
}

constexpr double kGlassBottom = 0.90;
constexpr double kGlassTop = 1.30;

/// The outline of the windows at a height: screens slope, sides lean in.
Ring glass_outline(double y, double grow) {
    const double t = (y - kGlassBottom) / (kGlassTop - kGlassBottom);
    return cell_outline(y, -1.72 + 0.66 * t - grow, 1.02 - 0.74 * t + grow, 0.755 - 0.145 * t + grow, 0.16);
}

Shape glass() { return loft({glass_outline(kGlassBottom, 0), glass_outline(1.10, 0.012), glass_outline(kGlassTop, 0)}); }

Shape roof() {
    return loft({glass_outline(kGlassTop - 0.03, 0.012), glass_outline(kGlassTop, 0.014),
                 cell_outline(1.345, -1.00, 0.21, 0.585, 0.16), cell_outline(1.378, -0.88, 0.09, 0.50, 0.16),
                 cell_outline(1.395, -0.66, -0.12, 0.32, 0.14)});
}

/// The pillars between the windows, from the waist to the roof on both sides.
void append_pillars(Mesh& mesh) {
    struct Pillar {
        double low_x, high_x, inset, width;
    };
    for (const Pillar& pillar :
         {Pillar{0.93, 0.20, 0.045, 0.07}, Pillar{-0.30, -0.33, 0.0, 0.10}, Pillar{-1.58, -0.97, 0.04, 0.16}}) {
        for (const double side : {1.0, -1.0}) {
            append(mesh,
                   bar({pillar.low_x, kGlassBottom, side * (0.752 - pillar.inset)},
                       {pillar.high_x, kGlassTop + 0.01, side * (0.606 - pillar.inset)}, {1, 0, 0}, pillar.width, 0.04),
                   kFlat);
        }
    }
}

/// Lamps, grille, bumper strips and mirrors.
void append_trim(Mesh& paint, Mesh& dark, Mesh& lamps) {
    for (const double side : {1.0, -1.0}) {
        append(lamps, ellipsoid({2.10, 0.635, side * 0.52}, {0.09, 0.065, 0.14}, 12, 6), kSmooth);
        append(dark, ellipsoid({-2.14, 0.74, side * 0.53}, {0.07, 0.07, 0.13}, 12, 6), kSmooth);
        append(paint, ellipsoid({0.74, 1.00, side * 0.92}, {0.06, 0.07, 0.10}, 10, 6), kSmooth);
        append(paint, tube({0.74, 0.96, side * 0.70}, {0.74, 0.985, side * 0.88}, 0.025, 0.02, 6), kRounded);
        append(dark, bar({0.12, 0.80, side * 0.868}, {0.32, 0.80, side * 0.868}, {0, 1, 0}, 0.03, 0.03), kFlat);
        append(dark, bar({-0.90, 0.80, side * 0.866}, {-0.70, 0.80, side * 0.866}, {0, 1, 0}, 0.03, 0.03), kFlat);
        append(dark, tube({-2.05, 0.24, side * 0.5}, {-2.26, 0.24, side * 0.5}, 0.035, 0.035, 8), kRounded);
    }
    append(dark, box({2.12, 0.44, -0.34}, {2.222, 0.57, 0.34}), kFlat);
    append(dark, box({2.05, 0.26, -0.60}, {2.17, 0.33, 0.60}), kFlat);
}

/// Tyre and rim, centred on the origin, the outer side towards +z.
Shape tyre() {
    constexpr double kHalf = kWheelWidth / 2;
    const std::vector<glm::dvec2> profile = {
        {0.215, -kHalf + 0.02},       {0.265, -kHalf},       {0.305, -kHalf + 0.01}, {kWheelRadius, -kHalf + 0.05},
        {kWheelRadius, kHalf - 0.05}, {0.305, kHalf - 0.01}, {0.265, kHalf},         {0.215, kHalf - 0.02}};
    return revolution(profile, 36);
}

Mesh rim() {
    Mesh mesh{.name = "rim", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.75f)};
    const std::vector<glm::dvec2> hoop = {{0.195, -0.08}, {0.22, -0.085}, {0.22, 0.085}, {0.195, 0.08}};
    append(mesh, revolution(hoop, 24), kSmooth);
    append(mesh, tube({0, 0, -0.06}, {0, 0, -0.03}, 0.2, 0.2, 24), kSmooth);
    append(mesh, tube({0, 0, -0.03}, {0, 0, 0.085}, 0.055, 0.045, 10), kRounded);
    for (int spoke = 0; spoke < 5; ++spoke) {
        const auto [s, c] = scalar::sincos(2 * scalar::kPi * spoke / 5 + 0.3);
        const glm::dvec3 out(c, s, 0);
        append(mesh, bar(0.03 * out + glm::dvec3(0, 0, 0.055), 0.205 * out + glm::dvec3(0, 0, 0.06), {0, 0, 1}, 0.03, 0.055),
               kFlat);
    }
    return mesh;
}

}  // namespace

Scene make_car() {
    Scene scene;
    scene.name = "car";
    Mesh ground{.name = "ground", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.7f)};
    append(ground, grid({-100, 0, 100}, {200, 0, 0}, {0, 0, -200}, 32, 32), kFlat);
    Mesh paint{.name = "paint", .vertices = {}, .indices = {}, .base_color = {0.70f, 0.06f, 0.05f}};
    Mesh dark{.name = "dark", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.05f)};
    Mesh lamps{.name = "lamps", .vertices = {}, .indices = {}, .base_color = {0.95f, 0.95f, 0.85f}};
    Mesh windows{.name = "windows", .vertices = {}, .indices = {}, .base_color = {0.06f, 0.08f, 0.10f}};
    Mesh tyre_mesh{.name = "tyre", .vertices = {}, .indices = {}, .base_color = glm::vec3(0.03f)};
    append(paint, body(), kSmooth);
    append(paint, roof(), kSmooth);
    append_pillars(paint);
    append_trim(paint, dark, lamps);
    append(windows, glass(), kSmooth);
    append(tyre_mesh, tyre(), kRounded);
    scene.meshes = {ground, paint, dark, lamps, windows, tyre_mesh, rim()};
    for (std::uint32_t mesh = 0; mesh < 5; ++mesh) scene.instances.push_back({.mesh = mesh});

    // Four wheels share two meshes; those on the right side are turned by half a circle around y.
    for (const double axle : {kFrontAxle, kRearAxle}) {
        for (const double side : {1.0, -1.0}) {
            glm::dmat4 world_from_wheel(1.0);
            world_from_wheel[0][0] = side;
            world_from_wheel[2][2] = side;
            world_from_wheel[3] = {axle, kWheelRadius, side * kTrack, 1.0};
            for (const std::uint32_t mesh : {5u, 6u}) scene.instances.push_back({mesh, glm::mat4(world_from_wheel)});
        }
    }

    scene.camera.world_from_camera = looking_at({5.2, 1.35, 5.6}, {0.1, 0.42, -0.25});
    scene.camera.yfov_rad = static_cast<float>(scalar::radians(40));
    scene.camera.znear = 0.25f;
    scene.camera.zfar = 250.0f;
    scene.light.kind = LightKind::Spot;
    scene.light.world_from_light = looking_at({-3.5, 9.0, -4.5}, {0.3, 0.0, 0.4});
    scene.light.outer_cone_rad = static_cast<float>(scalar::radians(30));
    return scene;
}

}  // namespace gnomon::scenes
