// Camera paths: time 0 is the scene's camera, every path is rigid and goes as far as it says.
#include "scenes/camera_path.h"
#include "scenes/procedural.h"
#include "scenes/view.h"
#include "sim/error.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

using namespace gnomon;
using namespace gnomon::scenes;

namespace {

constexpr double kTimes[] = {1e-3, 0.125, 0.5, 0.97, 0.999999};

// A camera that looks down a little, with the middle of the box 20 m before it along its axis.
const Bounds kBox{{-10, -4, -14}, {10, 8, 18}};
const glm::dvec3 kMiddle(0, 2, 2);
const glm::dvec3 kEye = kMiddle + 20.0 * glm::dvec3(0.48, 0.36, 0.8);
const glm::dvec3 kForward = glm::dvec3(-0.48, 0, -0.8) / std::sqrt(0.48 * 0.48 + 0.8 * 0.8);

Camera test_camera() {
    return {.world_from_camera = looking_at(kEye, kMiddle), .yfov_rad = 0.7f, .znear = 0.5f, .zfar = 90.0f};
}

glm::dvec3 eye(const Camera& camera) { return glm::dvec3(camera.world_from_camera[3]); }
glm::dvec3 axis(const Camera& camera, int i) { return glm::dvec3(camera.world_from_camera[i]); }
double length(const glm::dvec3& v) { return std::sqrt(glm::dot(v, v)); }

Camera moved(const char* path, double time) { return find_camera_path(path).at(test_camera(), kBox, time); }

/// The angle in degrees from a to b about the vertical, counter-clockwise from above.
double yaw_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(a.z * b.x - a.x * b.z, a.x * b.x + a.z * b.z) * 180 / std::acos(-1.0);
}

void check_unturned(const Camera& camera) {
    for (int i = 0; i < 3; ++i) CHECK(camera.world_from_camera[i] == test_camera().world_from_camera[i]);
}

void check_near(const glm::dvec3& a, const glm::dvec3& b, double margin = 4e-6) {
    INFO(fmt::format("({}, {}, {}) and ({}, {}, {})", a.x, a.y, a.z, b.x, b.y, b.z));
    CHECK(length(a - b) < margin);
}

}  // namespace

TEST_CASE("camera paths: at time 0 the camera is the scene's, bit for bit; only its matrix ever changes", "[scenes][paths]") {
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene scene = source.make();
        const Bounds bounds = scene.bounds();
        for (const CameraPath& path : camera_paths()) {
            INFO(source.name << " " << path.name);
            const Camera start = path.at(scene.camera, bounds, 0);
            CHECK(start.world_from_camera == scene.camera.world_from_camera);
            const Camera later = path.at(scene.camera, bounds, 0.5);
            CHECK((later.world_from_camera == scene.camera.world_from_camera) == (path.name == "still"));
            for (const Camera& camera : {start, later}) {
                CHECK(camera.yfov_rad == scene.camera.yfov_rad);
                CHECK(camera.znear == scene.camera.znear);
                CHECK(camera.zfar == scene.camera.zfar);
            }
        }
    }
}

TEST_CASE("camera paths are rigid and continuous in every scene", "[scenes][paths]") {
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene scene = source.make();
        const Bounds bounds = scene.bounds();
        const double focus = focus_distance(scene.camera, bounds);
        for (const CameraPath& path : camera_paths()) {
            INFO(source.name << " " << path.name);
            for (const double time : kTimes) {
                const glm::mat4 matrix = path.at(scene.camera, bounds, time).world_from_camera;
                const glm::dmat3 rotation{glm::dmat4(matrix)};
                const glm::dmat3 gram = glm::transpose(rotation) * rotation;
                for (int i = 0; i < 3; ++i)
                    for (int k = 0; k < 3; ++k) CHECK(gram[i][k] == Approx(i == k ? 1 : 0).margin(1e-6));
                CHECK(glm::dot(glm::cross(rotation[0], rotation[1]), rotation[2]) == Approx(1).margin(1e-6));
                CHECK(matrix[0][3] == 0);
                CHECK(matrix[1][3] == 0);
                CHECK(matrix[2][3] == 0);
                CHECK(matrix[3][3] == 1);
            }
            // A thousandth of the time moves a point at the focus by about a thousandth of what the path does.
            const glm::mat4 first = path.at(scene.camera, bounds, 1e-3).world_from_camera;
            const glm::vec4 seen(0, 0, -static_cast<float>(focus), 1);
            const glm::vec4 step = first * seen - scene.camera.world_from_camera * seen;
            CHECK(length(glm::dvec3(step)) < 4e-4 * focus + 1e-5);
        }
    }
}

TEST_CASE("camera paths: the focus is at the depth of the middle of the scene", "[scenes][paths]") {
    CHECK(focus_distance(test_camera(), kBox) == Approx(20).epsilon(1e-6));
    Camera aside = test_camera();  // along -z, past the middle
    aside.world_from_camera = glm::mat4(1.0f);
    aside.world_from_camera[3] = glm::vec4(7, -3, 12, 1);
    CHECK(focus_distance(aside, kBox) == Approx(10).epsilon(1e-6));

    // In the midst of the scene, turned away from it, and with a far plane before it.
    const double diagonal = length(glm::dvec3(kBox.upper - kBox.lower));
    Camera inside = test_camera();
    inside.world_from_camera = looking_at(kMiddle, kMiddle + glm::dvec3(1, 0, 1));
    CHECK(focus_distance(inside, kBox) == Approx(diagonal / 16).epsilon(1e-6));
    Camera away = test_camera();
    away.world_from_camera = looking_at(kEye, 2.0 * kEye - kMiddle);
    CHECK(focus_distance(away, kBox) == Approx(diagonal / 16).epsilon(1e-6));
    Camera short_sighted = test_camera();
    short_sighted.zfar = 12;
    CHECK(focus_distance(short_sighted, kBox) == 12);
}

TEST_CASE("camera paths: walk and strafe cover 1/16 and 1/32 of the focus distance, level, without turning",
          "[scenes][paths]") {
    const glm::dvec3 start = eye(test_camera());
    const glm::dvec3 right(0.8 / std::sqrt(0.8704), 0, -0.48 / std::sqrt(0.8704));
    for (const double time : kTimes) {
        INFO(time);
        const Camera walked = moved("walk", time);
        check_near(eye(walked), start + 20.0 / 16 * time * kForward);
        CHECK(walked.world_from_camera[3].y == test_camera().world_from_camera[3].y);
        check_unturned(walked);
        const Camera strafed = moved("strafe", time);
        check_near(eye(strafed), start + 20.0 / 32 * time * right);
        CHECK(strafed.world_from_camera[3].y == test_camera().world_from_camera[3].y);
        check_unturned(strafed);
    }
}

TEST_CASE("camera paths: pan, pitch and orbit turn by 10, 5 and 5 degrees", "[scenes][paths]") {
    const Camera start = test_camera();
    for (const double time : kTimes) {
        INFO(time);
        const Camera panned = moved("pan", time);
        CHECK(panned.world_from_camera[3] == start.world_from_camera[3]);
        for (int i = 0; i < 3; ++i) {
            CHECK(yaw_between(axis(start, i), axis(panned, i)) == Approx(10 * time).margin(3e-5));
            CHECK(axis(panned, i).y == Approx(axis(start, i).y).margin(1e-7));
        }

        const Camera pitched = moved("pitch", time);
        CHECK(pitched.world_from_camera[3] == start.world_from_camera[3]);
        CHECK(pitched.world_from_camera[0] == start.world_from_camera[0]);
        const double tilt = [](const Camera& c) { return std::asin(-axis(c, 2).y) * 180 / std::acos(-1.0); }(pitched);
        CHECK(tilt == Approx(std::asin(-0.36) * 180 / std::acos(-1.0) - 5 * time).margin(3e-5));

        // The orbit stays on its circle, 20 m from what stays in the middle of the picture.
        const Camera orbited = moved("orbit", time);
        CHECK(yaw_between(kEye - kMiddle, eye(orbited) - kMiddle) == Approx(5 * time).margin(3e-5));
        CHECK(eye(orbited).y == Approx(kEye.y).margin(1e-6));
        CHECK(length(eye(orbited) - kMiddle) == Approx(20).epsilon(1e-6));
        check_near(eye(orbited) - 20.0 * axis(orbited, 2), kMiddle, 1e-5);
    }
}

TEST_CASE("camera paths: dolly-turn stands where walk does and looks where pan does", "[scenes][paths]") {
    for (const double time : kTimes) {
        const Camera both = moved("dolly-turn", time);
        CHECK(both.world_from_camera[3] == moved("walk", time).world_from_camera[3]);
        for (int i = 0; i < 3; ++i) CHECK(both.world_from_camera[i] == moved("pan", time).world_from_camera[i]);
    }
}

TEST_CASE("camera paths: one that looks straight down or up walks towards the top or the bottom of its picture",
          "[scenes][paths]") {
    Camera camera = test_camera();
    camera.world_from_camera = looking_at({3, 20, 1}, {3, 0, 1});  // its top is towards -z
    const CameraPath& walk = find_camera_path("walk");
    check_near(eye(walk.at(camera, kBox, 0.5)), {3, 20, 1 - 18.0 / 32});
    camera.world_from_camera = looking_at({3, -20, 1}, {3, 0, 1});  // tilted back from the zenith it looks away from its top
    const glm::dvec3 step = eye(walk.at(camera, kBox, 0.5)) - glm::dvec3(3, -20, 1);
    check_near(step, -22.0 / 32 * axis(camera, 1));
}

TEST_CASE("camera paths have names and one-line summaries; a name that is not there is refused with those that are",
          "[scenes][paths]") {
    std::set<std::string_view> names;
    for (const CameraPath& path : camera_paths()) {
        CHECK(names.insert(path.name).second);
        CHECK(!path.summary.empty());
        CHECK(path.summary.find('\n') == std::string_view::npos);
        CHECK(&find_camera_path(path.name) == &path);
    }
    for (const char* name : {"still", "walk", "strafe", "pan", "orbit"}) CHECK(names.contains(name));
    try {
        (void)find_camera_path("fly");
        FAIL("accepted");
    } catch (const Error& error) {
        const std::string message = error.what();
        CHECK(message.find("'fly'") != std::string::npos);
        CHECK(message.find('\n') == std::string::npos);
        for (const std::string_view name : names) CHECK(message.find(name) != std::string::npos);
    }
}
