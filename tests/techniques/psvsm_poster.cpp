// The poster's four pictures against the truth, with as many texels: each step takes error away. [PSVSM]
#include "scenes/reference.h"
#include "tests/techniques/frames.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 150;

/// Root of the mean squared error over the pixels whose truth is known.
double error_of(std::string_view technique, TechniqueRequest request, std::string_view scene,
                const scenes::ReferenceImage& truth) {
    if (technique == "vsm" || technique == "psvsm") {
        request.anisotropy = 16;
        request.set.emplace_back("min-variance", "1e-7");
    }
    const std::vector<float> visibility =
        gnomon::testing::shoot(technique, request, {.scene = scene, .width = kWidth, .height = kHeight}).visibility;
    double squares = 0;
    int pixels = 0;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        if (visibility[i] == Frame::kNoSurface || truth.weight[i] < 0.999f) continue;
        const double error = static_cast<double>(visibility[i]) - static_cast<double>(truth.visibility[i]);
        squares += error * error;
        ++pixels;
    }
    REQUIRE(pixels > 5000);
    return std::sqrt(squares / pixels);
}

}  // namespace

TEST_CASE("one map, a filtered one, four maps, four filtered ones: the last errs least", "[techniques][PSVSM]") {
    for (const std::string_view name : {"city", "fence"}) {
        const scenes::Scene& scene = gnomon::testing::scene_of(name);
        const float aspect = static_cast<float>(kWidth) / static_cast<float>(kHeight);
        const scenes::ReferenceImage truth = scenes::trace_reference(scene, scenes::camera_view(scene.camera, aspect),
                                                                     scenes::light_view(scene.light, scene.bounds()), kWidth,
                                                                     kHeight, {.mode = scenes::ReferenceMode::Area});
        const TechniqueRequest one{.map_size = 512};
        const TechniqueRequest four{.map_size = 256, .set = {{"lambda", "0.8"}, {"cure", "quad-broadcast"}}};
        const double shadow_map = error_of("shadow-map", one, name, truth);
        const double vsm = error_of("vsm", one, name, truth);
        const double pssm = error_of("pssm", four, name, truth);
        const double psvsm = error_of("psvsm", four, name, truth);
        INFO(name << ": " << shadow_map << ", " << vsm << ", " << pssm << ", " << psvsm);
        CHECK(vsm < shadow_map);
        CHECK(pssm < shadow_map);
        CHECK(psvsm < 0.9 * pssm);
        CHECK(psvsm < 0.9 * vsm);
    }
}

TEST_CASE("what stands between the light and a split casts into it, though the camera does not see it", "[techniques][PSVSM]") {
    // The camera looks along the ground under the plane of `planes` that throws the shadow: neither split holds the occluder.
    const scenes::Scene& planes = gnomon::testing::scene_of("planes");
    scenes::Scene scene = planes;
    const scenes::View light = scenes::light_view(scene.light, scene.bounds());
    const scenes::Bounds bounds = scene.bounds();
    const float ground = bounds.lower.y;
    scene.camera.world_from_camera =
        scenes::looking_at({0.0, static_cast<double>(ground) + 0.2, 1.5}, {0.0, static_cast<double>(ground), -1.0});
    scene.camera.znear = 0.05f;
    const float aspect = static_cast<float>(kWidth) / static_cast<float>(kHeight);
    const scenes::ReferenceImage truth =
        scenes::trace_reference(scene, scenes::camera_view(scene.camera, aspect), light, kWidth, kHeight, {});

    Device device(Profile{}, 2);
    const Technique& technique = find_technique("pssm");
    Frame frame(device, scene,
                {.width = kWidth,
                 .height = kHeight,
                 .technique = technique,
                 .settings = resolve_settings(technique, {.map_size = 512, .cascades = 3, .set = {{"lambda", "0.9"}}})});
    PassTimer timer(device);
    frame.render(timer);
    const std::vector<float> visibility = gnomon::testing::floats_of(device.texture(frame.visibility()).level_bytes(0));
    int shadowed = 0;
    int lit = 0;
    int wrong = 0;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        if (visibility[i] == Frame::kNoSurface || truth.weight[i] < 0.999f) continue;
        shadowed += truth.visibility[i] == 0.0f;
        lit += truth.visibility[i] == 1.0f;
        wrong += visibility[i] != truth.visibility[i];
    }
    INFO(shadowed << " shadowed, " << lit << " lit, " << wrong << " wrong");
    CHECK(shadowed > 1000);
    CHECK(lit > 1000);
    CHECK(wrong * 50 < shadowed + lit);
}
