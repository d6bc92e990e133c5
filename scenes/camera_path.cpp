// The table of camera paths: translations in the horizontal plane, turns about vertical axes and about the camera's own x axis.
#include "scenes/camera_path.h"

#include "sim/error.h"
#include "sim/scalar_math.h"

#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gnomon::scenes {

namespace {

constexpr double kWalkShare = 1.0 / 16;  // of the focus distance
constexpr double kStrafeShare = 1.0 / 32;
constexpr double kPanDegrees = 10;
constexpr double kPitchDegrees = 5;
constexpr double kOrbitDegrees = 5;

glm::dvec3 eye_of(const glm::dmat4& camera) { return glm::dvec3(camera[3]); }

/// The unit vector along the view axis without its vertical part; for a camera that looks straight up or down, where the top of
/// its picture points when it is tilted back to the horizon.
glm::dvec3 forward_of(const glm::dmat4& camera) {
    glm::dvec3 forward(-camera[2].x, 0, -camera[2].z);
    if (glm::dot(forward, forward) < 1e-12) {  // closer than 1e-6 rad, as in `looking_at`
        const double sign = camera[2].y > 0 ? 1 : -1;
        forward = sign * glm::dvec3(camera[1].x, 0, camera[1].z);
    }
    return forward / std::sqrt(glm::dot(forward, forward));
}

/// A camera shifted by `offset`.
glm::dmat4 shifted(glm::dmat4 camera, const glm::dvec3& offset) {
    camera[3] += glm::dvec4(offset, 0);
    return camera;
}

/// A camera turned about the vertical axis through `pivot`, counter-clockwise seen from above.
glm::dmat4 yawed(const glm::dmat4& camera, const glm::dvec3& pivot, double degrees) {
    const auto [s, c] = scalar::sincos(scalar::radians(degrees));
    const glm::dmat3 turn({c, 0, -s}, {0, 1, 0}, {s, 0, c});
    glm::dmat4 result(turn * glm::dmat3(camera));
    result[3] = glm::dvec4(pivot + turn * (eye_of(camera) - pivot), 1);
    return result;
}

glm::dmat4 still(const glm::dmat4& start, double /*focus_m*/, double /*time*/) { return start; }

glm::dmat4 walk(const glm::dmat4& start, double focus_m, double time) {
    return shifted(start, kWalkShare * focus_m * time * forward_of(start));
}

glm::dmat4 strafe(const glm::dmat4& start, double focus_m, double time) {
    const glm::dvec3 right = glm::cross(forward_of(start), glm::dvec3(0, 1, 0));
    return shifted(start, kStrafeShare * focus_m * time * right);
}

glm::dmat4 pan(const glm::dmat4& start, double /*focus_m*/, double time) {
    return yawed(start, eye_of(start), kPanDegrees * time);
}

glm::dmat4 pitch(const glm::dmat4& start, double /*focus_m*/, double time) {
    const auto [s, c] = scalar::sincos(scalar::radians(-kPitchDegrees * time));
    glm::dmat4 result = start;
    result[1] = c * start[1] + s * start[2];
    result[2] = c * start[2] - s * start[1];
    return result;
}

glm::dmat4 orbit(const glm::dmat4& start, double focus_m, double time) {
    return yawed(start, eye_of(start) - focus_m * glm::dvec3(start[2]), kOrbitDegrees * time);
}

glm::dmat4 dolly_turn(const glm::dmat4& start, double focus_m, double time) {
    return pan(walk(start, focus_m, time), focus_m, time);
}

}  // namespace

double focus_distance(const Camera& camera, const Bounds& scene) {
    const glm::dvec3 lower(scene.lower);
    const glm::dvec3 upper(scene.upper);
    const glm::dmat4 world_from_camera(camera.world_from_camera);
    const double depth = glm::dot(0.5 * (lower + upper) - eye_of(world_from_camera), -glm::dvec3(world_from_camera[2]));
    const double diagonal = std::sqrt(glm::dot(upper - lower, upper - lower));
    const auto znear = static_cast<double>(camera.znear);
    const auto zfar = static_cast<double>(camera.zfar);
    return std::clamp(std::max(depth, diagonal / 16), znear, zfar);
}

Camera CameraPath::at(const Camera& start, const Bounds& scene, double time) const {
    GNOMON_CHECK_LE(0.0, time);
    GNOMON_CHECK_LT(time, 1.0);
    Camera camera = start;
    if (time == 0) return camera;
    camera.world_from_camera = glm::mat4(moved(glm::dmat4(start.world_from_camera), focus_distance(start, scene), time));
    return camera;
}

std::span<const CameraPath> camera_paths() {
    static constexpr std::array<CameraPath, 7> kPaths = {{
        {"still", "does not move: the control", still},
        {"walk", "forward, level, by 1/16 of the focus distance", walk},
        {"strafe", "to the right, level, by 1/32 of the focus distance", strafe},
        {"pan", "turns to the left by 10 degrees about the vertical axis through the eye", pan},
        {"pitch", "turns down by 5 degrees about the eye", pitch},
        {"orbit", "to the right by 5 degrees around the vertical axis through the focus, which it keeps looking at", orbit},
        {"dolly-turn", "walk and pan at once", dolly_turn},
    }};
    return kPaths;
}

const CameraPath& find_camera_path(std::string_view name) {
    std::vector<std::string_view> names;
    for (const CameraPath& path : camera_paths()) {
        if (path.name == name) return path;
        names.push_back(path.name);
    }
    fail("camera path '{}': not known; expected one of {}", name, fmt::join(names, ", "));
}

}  // namespace gnomon::scenes
