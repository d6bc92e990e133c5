// Ground truth: where the shadow of an edge must fall, threads, and the two modes against each other.
#include "scenes/procedural.h"
#include "scenes/reference.h"
#include "sim/error.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <vector>

using namespace gnomon;
using namespace gnomon::scenes;

namespace {

/// A receiver in the plane y = 0 and a plate above it whose shadow under a vertical light is the square |x|, |z| <= 1.
Scene plate_scene() {
    const auto square = [](std::string name, float y, float half) {
        return Mesh{.name = std::move(name),
                    .vertices = {{{-half, y, half}, {0, 1, 0}},
                                 {{half, y, half}, {0, 1, 0}},
                                 {{half, y, -half}, {0, 1, 0}},
                                 {{-half, y, -half}, {0, 1, 0}}},
                    .indices = {0, 1, 2, 0, 2, 3},
                    .base_color = {1, 1, 1}};
    };
    Scene scene;
    scene.meshes = {square("receiver", 0, 4), square("plate", 2, 1)};
    scene.instances = {{0, glm::mat4(1.0f)}, {1, glm::mat4(1.0f)}};
    scene.camera = {.world_from_camera = looking_at({0, 1, 0}, {0, 0, 0}), .yfov_rad = 1.4f, .znear = 0.1f, .zfar = 10.0f};
    scene.light = {.kind = LightKind::Directional, .world_from_light = looking_at({0, 5, 0}, {0, 0, 0}), .color = {1, 1, 1}};
    return scene;
}

}  // namespace

TEST_CASE("the traced shadow of a plate is the square it must be", "[scenes][reference]") {
    const Scene scene = plate_scene();
    constexpr int kSize = 128;
    const View camera = camera_view(scene.camera, 1.0f);
    const View light = light_view(scene.light, scene.bounds());
    const ReferenceImage image =
        trace_reference(scene, camera, light, kSize, kSize, {.mode = ReferenceMode::Center, .threads = 2});
    int shadowed = 0;
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            // The camera looks straight down from y = 1 with world -z up in the image.
            const double reach = std::tan(0.7);
            const double px = ((x + 0.5) / kSize * 2 - 1) * reach;
            const double pz = ((y + 0.5) / kSize * 2 - 1) * reach;
            const double edge = std::max(std::fabs(px), std::fabs(pz)) - 1.0;
            if (std::fabs(edge) < 1e-3) continue;
            const auto i = static_cast<std::size_t>(y * kSize + x);
            if (!(image.weight[i] == 1.0f && image.visibility[i] == (edge < 0 ? 0.0f : 1.0f)))
                FAIL_CHECK("pixel " << x << ", " << y << ": visibility " << image.visibility[i] << " weight " << image.weight[i]
                                    << ", distance to the edge " << edge);
            shadowed += edge < 0;
        }
    }
    CHECK(shadowed > 1000);
}

TEST_CASE("points of surfaces lie under the centres of their pixels", "[scenes][reference]") {
    const Scene scene = plate_scene();
    constexpr int kSize = 128;
    const std::vector<glm::ivec2> pixels{{0, 0}, {64, 63}, {127, 5}, {20, 100}};
    const auto points = trace_points(scene, camera_view(scene.camera, 1.0f), kSize, kSize, pixels);
    REQUIRE(points.size() == pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        REQUIRE(points[i]);
        const double reach = std::tan(0.7);
        CHECK(points[i]->position_ws.x == Approx(((pixels[i].x + 0.5) / kSize * 2 - 1) * reach).epsilon(1e-6));
        CHECK(points[i]->position_ws.y == Approx(0.0).margin(1e-6));
        CHECK(points[i]->position_ws.z == Approx(((pixels[i].y + 0.5) / kSize * 2 - 1) * reach).epsilon(1e-6));
        CHECK(std::fabs(points[i]->normal_ws.y) == Approx(1.0).epsilon(1e-6));
    }

    // Nothing under a ray is nothing: a camera beside, that looks out over the edge of the receiver.
    Camera aside = scene.camera;
    aside.world_from_camera = looking_at({4.5, 1, 0}, {4.5, 0, 0});
    const std::vector<glm::ivec2> across{{0, 64}, {127, 64}};
    const auto seen = trace_points(scene, camera_view(aside, 1.0f), kSize, kSize, across);
    CHECK(seen[0]);
    CHECK(!seen[1]);
}

TEST_CASE("the reference does not depend on threads, and its two modes agree away from edges", "[scenes][reference]") {
    const Scene scene = procedural_scenes()[1].make();
    const View camera = camera_view(scene.camera, 4.0f / 3.0f);
    const View light = light_view(scene.light, scene.bounds());
    const auto trace = [&](ReferenceMode mode, int threads, std::uint64_t seed) {
        return trace_reference(scene, camera, light, 96, 72,
                               {.mode = mode, .area_samples = 64, .seed = seed, .threads = threads});
    };
    const ReferenceImage area = trace(ReferenceMode::Area, 1, 1);
    for (const int threads : {2, 8}) {
        const ReferenceImage other = trace(ReferenceMode::Area, threads, 1);
        CHECK(other.visibility == area.visibility);
        CHECK(other.weight == area.weight);
    }
    CHECK(trace(ReferenceMode::Area, 2, 2).visibility != area.visibility);  // the seed moves the samples

    const ReferenceImage center = trace(ReferenceMode::Center, 2, 1);
    int agree = 0;
    int partial = 0;
    for (std::size_t i = 0; i < center.visibility.size(); ++i) {
        if (center.weight[i] < 1 || area.weight[i] < 1) continue;
        const bool whole = area.visibility[i] == 0.0f || area.visibility[i] == 1.0f;
        partial += !whole;
        if (whole && center.visibility[i] != area.visibility[i]) FAIL_CHECK("pixel " << i);
        agree += whole;
    }
    CHECK(agree > 2000);
    CHECK(partial > 20);
}

TEST_CASE("the reference refuses what it cannot trace", "[scenes][reference][errors]") {
    const Scene scene = plate_scene();
    const View view = camera_view(scene.camera, 1.0f);
    CHECK_THROWS_AS(trace_reference(scene, view, view, 0, 8, {}), Error);
    CHECK_THROWS_AS(trace_reference(scene, view, view, 8, 8, {.mode = ReferenceMode::Area, .area_samples = 63}), Error);
    std::atomic<bool> stop{true};
    CHECK_THROWS_AS(trace_reference(scene, view, view, 8, 8, {}, {.report = {}, .stop = &stop}), Stopped);
}
