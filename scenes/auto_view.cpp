#include "scenes/auto_view.h"

#include "scenes/shapes.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace gnomon::scenes {

namespace {

struct Sphere {
    glm::dvec3 center;
    double radius;
};

Sphere bounding_sphere(const Bounds& box) {
    const glm::dvec3 lower(box.lower);
    const glm::dvec3 upper(box.upper);
    const glm::dvec3 half = 0.5 * (upper - lower);
    const double radius = std::sqrt(glm::dot(half, half));
    return {lower + half, radius > 0 ? radius : 1.0};
}

glm::dvec3 unit(const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); }

}  // namespace

Camera automatic_camera(const Bounds& model) {
    const Sphere sphere = bounding_sphere(model);
    constexpr double kYfov = 0.7;
    const double distance = 1.2 * sphere.radius / scalar::sin(0.5 * kYfov);
    const glm::dvec3 direction = unit({0.45, 0.5, 1.0});
    // A little below the centre, where the shadow is.
    const glm::dvec3 target = sphere.center - glm::dvec3(0, 0.12 * sphere.radius, 0);
    return {.world_from_camera = looking_at(target + distance * direction, target),
            .yfov_rad = static_cast<float>(kYfov),
            .znear = static_cast<float>(0.05 * distance),
            .zfar = static_cast<float>(distance + 12.0 * sphere.radius)};
}

Light automatic_light(const Bounds& model) {
    const Sphere sphere = bounding_sphere(model);
    const double tilt = scalar::radians(40.0);
    const double azimuth = scalar::radians(-50.0);
    const glm::dvec3 towards{scalar::sin(tilt) * scalar::sin(azimuth), scalar::cos(tilt),
                             scalar::sin(tilt) * scalar::cos(azimuth)};
    // Far enough to be nearly parallel; wide enough for the shadow of a model on its ground.
    return spot_at(sphere.center + 4.5 * sphere.radius * towards, model);
}

Light spot_at(const glm::dvec3& position_ws, const Bounds& model) {
    const Sphere sphere = bounding_sphere(model);
    const glm::dvec3 away = position_ws - sphere.center;
    const double distance = std::sqrt(glm::dot(away, away));
    constexpr double kReach = 1.7;  // bounding radii
    const double sine = distance > 0 ? kReach * sphere.radius / distance : 1.0;
    const double widest = scalar::radians(80.0);
    const double half_angle = sine < scalar::sin(widest) ? scalar::atan(sine / std::sqrt(1.0 - sine * sine)) : widest;
    const glm::dvec3 target = distance > 0 ? sphere.center : sphere.center - glm::dvec3(0, 1, 0);
    return {.kind = LightKind::Spot,
            .world_from_light = looking_at(position_ws, target),
            .outer_cone_rad = static_cast<float>(half_angle),
            .color = glm::vec3(1.0f)};
}

Mesh ground_plane(const Bounds& model) {
    const Sphere sphere = bounding_sphere(model);
    const double reach = 6.0 * sphere.radius;
    const double y = static_cast<double>(model.lower.y);
    Mesh mesh{.name = "ground", .vertices = {}, .indices = {}, .base_color = {0.62f, 0.62f, 0.6f}};
    append(mesh, grid({sphere.center.x - reach, y, sphere.center.z + reach}, {2 * reach, 0, 0}, {0, 0, -2 * reach}, 16, 16),
           kFlat);
    return mesh;
}

}  // namespace gnomon::scenes
