// Where the view frustum is cut and what each map shows of the light: closed forms. [Zhang06], [PSVSM] steps 1, 2a, 2b
#include "techniques/common/splits.h"
#include "scenes/convex.h"
#include "techniques/common/cascade_setup.h"
#include "techniques/common/gaussian.h"
#include "tests/techniques/frames.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

/// 90 degrees each way, from the origin towards -z.
scenes::View straight_camera(float znear, float zfar) {
    return scenes::camera_view({.yfov_rad = 1.57079632679f, .znear = znear, .zfar = zfar}, 1.0f);
}

/// A sun straight above a box of 200 m around the origin: texture space is the ground.
scenes::View sun_above(float half = 100.0f) {
    scenes::Light light{.kind = scenes::LightKind::Directional};
    light.world_from_light = scenes::looking_at({0, 50, 0}, {0, 0, 0});
    return scenes::light_view(light, {.lower = glm::vec3(-half), .upper = glm::vec3(half)});
}

bool holds(const MapWindow& outer, const MapWindow& inner) {
    return outer.low.x <= inner.low.x && outer.low.y <= inner.low.y && outer.high.x >= inner.high.x &&
           outer.high.y >= inner.high.y;
}

}  // namespace

TEST_CASE("practical split scheme in closed form", "[techniques][splits][Zhang06]") {
    // Uniform: equal steps. Logarithmic: equal ratios. In between: in between.
    CHECK(practical_splits(1, 9, 4, 0.0) == std::vector<double>{1, 3, 5, 7, 9});
    const std::vector<double> logarithmic = practical_splits(1, 16, 4, 1.0);
    for (std::size_t i = 0; i < 5; ++i) CHECK(logarithmic[i] == Approx(std::exp2(static_cast<double>(i))).epsilon(1e-14));
    const std::vector<double> half = practical_splits(1, 16, 4, 0.5);
    for (std::size_t i = 0; i < 5; ++i)
        CHECK(half[i] ==
              Approx(0.5 * (std::exp2(static_cast<double>(i)) + 1 + 15 * static_cast<double>(i) / 4)).epsilon(1e-14));
    for (int count = 1; count <= kMaxCascades; ++count)
        for (const double lambda : {0.0, 0.3, 0.5, 0.95, 1.0}) {
            const std::vector<double> splits = practical_splits(0.1, 1000, count, lambda);
            CHECK(splits.size() == static_cast<std::size_t>(count) + 1);
            CHECK(splits.front() == 0.1);
            CHECK(splits.back() == 1000);
            CHECK(std::ranges::adjacent_find(splits, std::greater_equal{}) == splits.end());
        }
}

TEST_CASE("splits by histogram give every part as many pixels", "[techniques][splits][Lauritzen10]") {
    // 4 bins from 1 to 16: an octave each.
    CHECK(histogram_splits(std::array<std::uint32_t, 4>{10, 10, 10, 10}, 1, 16, 4) == std::vector<double>{1, 2, 4, 8, 16});
    const std::vector<double> half = histogram_splits(std::array<std::uint32_t, 4>{0, 30, 10, 0}, 1, 16, 2);
    CHECK(half[0] == 2);
    CHECK(half[1] == Approx(2 * std::exp2(2.0 / 3)));  // 20 of the 30 pixels of the octave from 2 to 4
    CHECK(half[2] == 8);

    // One bin holds all: still ascending. Nothing in view: as without a histogram.
    std::vector<std::uint32_t> one(1024, 0);
    one[500] = 7;
    const std::vector<double> splits = histogram_splits(one, 0.1, 1000, 8);
    CHECK(std::ranges::adjacent_find(splits, std::greater_equal{}) == splits.end());
    CHECK(histogram_splits(std::vector<std::uint32_t>(16, 0), 1, 16, 4) == practical_splits(1, 16, 4, 1.0));
}

TEST_CASE("the depths in view, counted on the device, are those of the depth buffer", "[techniques][splits][Lauritzen10]") {
    for (const std::string_view name : {"car", "fence"}) {
        const scenes::Scene& scene = gnomon::testing::scene_of(name);
        Device device(Profile{}, 2);
        const std::vector<SceneDraw> draws = upload_scene(device, scene);
        const scenes::View camera = scenes::camera_view(scene.camera, 4.0f / 3.0f);
        DepthRange range(device);
        const DistanceHistogram seen = range.measure(draws, camera, 172, 129);
        const DistanceHistogram again = range.measure(draws, camera, 172, 129);
        CHECK(seen.bins == again.bins);

        // The same from the pixels of the texture, in double.
        std::vector<std::uint32_t> bins(kDistanceBins, 0);
        double nearest = 1e30;
        double farthest = 0;
        std::uint64_t pixels = 0;
        const TextureId depth{1};
        REQUIRE(device.texture(depth).desc().format == Format::D32Float);
        for (const float d : gnomon::testing::floats_of(device.texture(depth).level_bytes(0))) {
            if (d == 1.0f) continue;
            const auto n = static_cast<double>(camera.znear);
            const auto f = static_cast<double>(camera.zfar);
            const double distance = n * f / (f - static_cast<double>(d) * (f - n));
            nearest = std::min(nearest, distance);
            farthest = std::max(farthest, distance);
            ++bins[static_cast<std::size_t>(std::log2(distance / n) / std::log2(f / n) * kDistanceBins)];
            ++pixels;
        }
        CHECK(std::accumulate(seen.bins.begin(), seen.bins.end(), std::uint64_t{0}) == pixels);
        CHECK(seen.nearest == Approx(nearest).epsilon(1e-4));  // a float's digits of 1 - depth far away
        CHECK(seen.farthest == Approx(farthest).epsilon(1e-3));
        std::uint64_t moved = 0;
        for (std::size_t i = 0; i < bins.size(); ++i)
            moved += static_cast<std::uint64_t>(std::abs(static_cast<std::int64_t>(bins[i]) - seen.bins[i]));
        CHECK(moved < pixels / 50);  // pixels at the edge of a bin
    }
}

TEST_CASE("a slice of the frustum and its bounding rectangle under a sun straight above", "[techniques][splits][PSVSM]") {
    const scenes::View camera = straight_camera(1, 80);
    const scenes::View sun = sun_above();
    // From 10 to 40 m the frustum covers x in [-40, 40] and z in [-40, -10]: the light sees 200 m and its margins, and world -z
    // is up in its map or down.
    const scenes::Hexahedron slice = frustum_slice(camera, 10, 40);
    for (const glm::dvec3& corner : slice) {
        CHECK((std::fabs(corner.z + 10) < 1e-5 || std::fabs(corner.z + 40) < 1e-5));
        CHECK(std::fabs(std::fabs(corner.x) - std::fabs(corner.z)) < 1e-5);
    }
    const MapWindow window = bounding_window(slice, sun);
    const double metres = 2.0 / static_cast<double>(sun.clip_from_view[0][0]);
    CHECK((window.high.x - window.low.x) * metres == Approx(80));
    CHECK((window.high.y - window.low.y) * metres == Approx(30));
    CHECK(0.5 * (window.low.x + window.high.x) == Approx(0.5));
    CHECK(window.zoom().x == Approx(metres / 80));

    // A slice that leaves the light's frustum is cut off there; one outside of it takes all.
    CHECK(bounding_window(frustum_slice(camera, 70, 79), sun_above(75)).low.y >= 0.0);
    CHECK(bounding_window(frustum_slice(camera, 500, 600), sun).is_whole());
}

TEST_CASE("every point of a split that the light sees lies in its window, under spots too", "[techniques][splits][PSVSM]") {
    for (const std::string_view name : {"car", "fence", "windmill", "overlap"}) {
        const scenes::Scene& scene = gnomon::testing::scene_of(name);
        const scenes::View camera = scenes::camera_view(scene.camera, 4.0f / 3.0f);
        const scenes::View light = scenes::light_view(scene.light, scene.bounds());
        const glm::dmat4 clip_from_world(light.clip_from_world());
        const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(camera.view_from_world));
        const std::vector<double> splits =
            practical_splits(static_cast<double>(camera.znear), static_cast<double>(camera.zfar), 4, 0.5);
        int seen = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const MapWindow window = bounding_window(frustum_slice(camera, splits[i], splits[i + 1]), light);
            glm::dvec2 low(1.0);
            glm::dvec2 high(0.0);
            for (int k = 0; k < 20 * 20 * 20; ++k) {
                const glm::dvec3 share(k % 20 / 19.0, k / 20 % 20 / 19.0, k / 400 / 19.0);
                const double z = splits[i] + (splits[i + 1] - splits[i]) * share.z;
                const glm::dvec4 view((2 * share.x - 1) * z / static_cast<double>(camera.clip_from_view[0][0]),
                                      (2 * share.y - 1) * z / static_cast<double>(camera.clip_from_view[1][1]), -z, 1.0);
                const glm::dvec4 clip = clip_from_world * (world_from_view * view);
                if (clip.w <= 0 || clip.z < 0 || clip.z > clip.w) continue;
                const glm::dvec2 uv(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
                if (uv.x < 0 || uv.x > 1 || uv.y < 0 || uv.y > 1) continue;
                ++seen;
                low = glm::min(low, uv);
                high = glm::max(high, uv);
                const bool inside = uv.x >= window.low.x - 1e-9 && uv.x <= window.high.x + 1e-9 &&
                                    uv.y >= window.low.y - 1e-9 && uv.y <= window.high.y + 1e-9;
                if (!inside) FAIL_CHECK(fmt::format("{}, split {}: ({}, {}) outside", name, i, uv.x, uv.y));
            }
            // The window is no larger than it must be: a grid this fine comes close to its sides.
            if (low.x < high.x && !window.is_whole())
                CHECK((high.x - low.x) * (high.y - low.y) >
                      0.55 * (window.high.x - window.low.x) * (window.high.y - window.low.y));
        }
        CHECK(seen > 1000);
    }
}

TEST_CASE("the zoomed projection puts the window's corners on the map's", "[techniques][splits][PSVSM]") {
    for (const std::string_view name : {"car", "planes"}) {
        const scenes::Scene& scene = gnomon::testing::scene_of(name);
        const scenes::View light = scenes::light_view(scene.light, scene.bounds());
        const MapView zoomed{.light = light, .window = {.low = {0.25, 0.5}, .high = {0.375, 0.875}}};
        const glm::dmat4 whole(light.clip_from_world());
        const glm::dmat4 part(zoomed.clip_from_world());
        for (int k = 0; k < 64; ++k) {
            const glm::dvec4 point(k % 4 - 1.5, k / 4 % 4 - 1.0, k / 16 - 1.5, 1.0);
            const glm::dvec4 a = whole * point;
            const glm::dvec4 b = part * point;
            const glm::dvec2 uv(0.5 + 0.5 * a.x / a.w, 0.5 - 0.5 * a.y / a.w);
            CHECK(0.5 + 0.5 * b.x / b.w == Approx((uv.x - 0.25) * 8).margin(1e-4));
            CHECK(0.5 - 0.5 * b.y / b.w == Approx((uv.y - 0.5) / 0.375).margin(1e-4));
            CHECK(b.z / b.w == Approx(a.z / a.w).margin(1e-6));  // depths stay those of the light
        }
    }
}

TEST_CASE("margins leave room, and blur kernels grow with the zoom", "[techniques][splits][PSVSM]") {
    const MapWindow window{.low = {0.25, 0.25}, .high = {0.75, 0.5}};
    const MapWindow wider = with_margin(window, 16, 512);
    CHECK(holds(wider, window));
    // 16 of 512 texels on each side of what is left.
    CHECK((window.low.x - wider.low.x) / (wider.high.x - wider.low.x) == Approx(16.0 / 512));
    CHECK((wider.high.y - window.high.y) / (wider.high.y - wider.low.y) == Approx(16.0 / 512));

    const BlurKernels kernels = zoomed_kernels(3, {4.0, 1.0});
    CHECK(kernels.columns.weights == gaussian_kernel(3).weights);
    CHECK(kernels.rows.taps == 9);
    CHECK(kernels.rows.weights == gaussian_kernel(9).weights);  // 1 + 2 * 4
    CHECK(zoomed_kernels(9, {100.0, 1.0}).rows.taps == kMaxBlurTaps);
}

TEST_CASE("snapped windows keep their size and move by whole texels while the camera does", "[techniques][splits]") {
    constexpr int kMap = 256;
    for (const bool directional : {true, false}) {
        const scenes::Scene& scene = gnomon::testing::scene_of("windmill");
        scenes::Light light = scene.light;
        light.kind = directional ? scenes::LightKind::Directional : scenes::LightKind::Spot;
        const scenes::View view = scenes::light_view(light, scene.bounds());
        std::optional<MapWindow> first;
        int moved = 0;
        int resized = 0;
        for (int step = 0; step < 200; ++step) {
            scenes::Camera camera = scene.camera;
            const double angle = 0.002 * step;
            camera.world_from_camera =
                scenes::looking_at({11.8 + 0.013 * step, 10.2, 20.8}, {0.5 + 10 * angle, 4.35, 0.007 * step});
            const scenes::View from = scenes::camera_view(camera, 4.0f / 3.0f);
            const scenes::Hexahedron slice = frustum_slice(from, 5, 15);
            const MapWindow tight = bounding_window(slice, view);
            const std::optional<glm::dvec2> around = sphere_diameter(from, view, 5, 15);
            CHECK(around.has_value() == directional);
            const MapWindow window = snapped_window(tight, around, kMap);
            CHECK(holds(window, tight));
            if (!first) first = window;
            for (int axis = 0; axis < 2; ++axis) {
                const double side = window.high[axis] - window.low[axis];
                const double texel = side / kMap;
                CHECK(std::fabs(window.low[axis] / texel - std::round(window.low[axis] / texel)) < 1e-6);
                resized += std::fabs(side - (first->high[axis] - first->low[axis])) > 1e-9;
                moved += window.low[axis] != first->low[axis];
            }
        }
        CHECK(moved > 20);
        if (directional) CHECK(resized == 0);
        CHECK(resized < 200);  // a spot's rectangle may change by a quarter octave now and then
    }
}

TEST_CASE("a setup with snapping gives windows of one size, whatever the blur", "[techniques][splits]") {
    const scenes::Scene& scene = gnomon::testing::scene_of("city");
    const scenes::View light = scenes::light_view(scene.light, scene.bounds());
    Device device(Profile{}, 1);
    for (const char* blur : {"1", "3"}) {
        for (const char* snap : {"on", "off"}) {
            const Technique& technique = find_technique("psvsm");
            const TechniqueRequest request{.map_size = 256, .set = {{"blur", blur}, {"snap", snap}, {"fade", "0.1"}}};
            CascadeSetup setup(device, resolve_settings(technique, request));
            PassTimer timer(device);
            std::vector<glm::dvec2> first;
            double largest_change = 0;
            for (int step = 0; step < 40; ++step) {
                scenes::Camera camera = scene.camera;
                camera.world_from_camera =
                    scenes::looking_at({0.3 * step, 2.5, 3.0 - 0.1 * step}, {20.0 - step, 1.0 + 0.1 * step, -40.0});
                const scenes::View from = scenes::camera_view(camera, 4.0f / 3.0f);
                setup.update({.scene = {}, .camera = from, .light = light, .width = 64, .height = 48}, timer);
                for (std::size_t i = 0; i < 4; ++i) {
                    const glm::dvec2 side = setup.window(i).high - setup.window(i).low;
                    if (step == 0) first.push_back(side);
                    const glm::dvec2 change = glm::abs(side - first[i]) / first[i];
                    largest_change = std::max({largest_change, change.x, change.y});
                }
            }
            INFO("blur " << blur << ", snap " << snap);
            if (snap == std::string_view("on")) {
                CHECK(largest_change < 1e-12);
            } else {
                CHECK(largest_change > 0.1);
            }
        }
    }
}

TEST_CASE("splits from the depths in view stay within reach", "[techniques][splits][Lauritzen10]") {
    const scenes::Scene& scene = gnomon::testing::scene_of("fence");
    Device device(Profile{}, 2);
    const std::vector<SceneDraw> draws = upload_scene(device, scene);
    const scenes::View camera = scenes::camera_view(scene.camera, 4.0f / 3.0f);
    const scenes::View light = scenes::light_view(scene.light, scene.bounds());
    for (const char* splits : {"practical", "minmax", "histogram"})
        for (const char* reach : {"0", "0.001", "1", "5", "30", "1e6"}) {
            INFO(splits << ", reach " << reach);
            const TechniqueRequest request{.map_size = 64, .cascades = 8, .set = {{"splits", splits}, {"reach", reach}}};
            CascadeSetup setup(device, resolve_settings(find_technique("pssm"), request));
            PassTimer timer(device);
            setup.update({.scene = draws, .camera = camera, .light = light, .width = 96, .height = 72}, timer);
            const Cascades& cascades = setup.constants();
            CHECK(std::is_sorted(cascades.end.begin(), cascades.end.end()));
            CHECK(cascades.end[0] > camera.znear);
            CHECK(cascades.end[7] <= camera.zfar * 1.01f);
            const double wanted = std::stod(reach);
            if (wanted >= 5 && wanted < 100) CHECK(cascades.end[7] <= static_cast<float>(wanted) * 1.02f);
        }
}

TEST_CASE("the sphere around a slice holds its corners and is no larger than it must be", "[techniques][splits]") {
    const scenes::View sun = sun_above();
    for (const auto& [nearest, farthest] : {std::pair(1.0, 2.0), std::pair(1.0, 50.0), std::pair(30.0, 31.0)}) {
        const scenes::View camera = straight_camera(1, 80);
        const double radius =
            0.5 * sphere_diameter(camera, sun, nearest, farthest)->x * 2.0 / static_cast<double>(sun.clip_from_view[0][0]);
        double best = 1e30;  // over centres on the axis
        for (int k = 0; k <= 4000; ++k) {
            const double centre = nearest + (farthest - nearest) * 1.5 * k / 4000;
            double needed = 0;
            for (const glm::dvec3& corner : frustum_slice(camera, nearest, farthest))
                needed = std::max(needed, glm::length(corner - glm::dvec3(0, 0, -centre)));
            best = std::min(best, needed);
        }
        CHECK(radius == Approx(best).epsilon(1e-3));
    }
}

TEST_CASE("map sizes by ratio, and what settings refuse", "[techniques][splits]") {
    const Technique& technique = find_technique("psvsm");
    const auto sizes = [&](int cascades, const char* ratio) {
        return map_sizes(resolve_settings(technique, {.map_size = 512, .cascades = cascades, .set = {{"size-ratio", ratio}}}));
    };
    CHECK(sizes(4, "1") == std::vector<int>{512, 512, 512, 512});
    CHECK(sizes(4, "0.5") == std::vector<int>{512, 256, 128, 64});
    CHECK(sizes(3, "2") == std::vector<int>{512, 1024, 2048});
    CHECK(map_sizes(resolve_settings(technique, {.map_size = 300, .cascades = 0})) == std::vector<int>{300});

    using Catch::Matchers::Contains;
    CHECK_THROWS_WITH(resolve_settings(technique, {.cascades = 9}), Contains("--cascades 9") && Contains("0 to 8"));
    CHECK_THROWS_WITH(resolve_settings(find_technique("vsm"), {.set = {{"lambda", "0.5"}}}),
                      Contains("lambda") && Contains("--cascades"));
    CHECK_THROWS_WITH(resolve_settings(technique, {.set = {{"cure", "aspirin"}}}), Contains("cure") && Contains("quad-min"));
}

TEST_CASE("one split that holds everything shows what one map shows", "[techniques][splits]") {
    // psvsm with one split and a map of its own against vsm: coarser where the frustum is larger than the light's cone, so only
    // close. A window of the whole light is vsm to the bit: what cascades add is then a scale of 1 and an offset of 0.
    for (const std::string_view name : {"planes", "car"}) {
        const auto visibility = [&](std::string_view technique, int cascades) {
            return gnomon::testing::shoot(technique, {.map_size = 512, .cascades = cascades}, {.scene = name}).visibility;
        };
        const std::vector<float> one = visibility("vsm", 0);
        const std::vector<float> split = visibility("vsm", 1);
        CHECK(visibility("psvsm", 0) == one);
        REQUIRE(one.size() == split.size());
        double difference = 0;
        for (std::size_t i = 0; i < one.size(); ++i) difference += std::fabs(static_cast<double>(one[i] - split[i]));
        INFO(name);
        CHECK(difference / static_cast<double>(one.size()) < 0.02);
        CHECK(difference > 0);
    }
}
