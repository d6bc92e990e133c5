// Which map a pixel reads and where: parameters of splits one by one, on lanes and in pictures. [PSVSM] steps 2 to 5
#include "techniques/common/cascade_setup.h"
#include "techniques/common/splits.h"
#include "tests/techniques/frames.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace gnomon;
using namespace gnomon::techniques;
using namespace gnomon::testing;

namespace {

/// What cascades ask of a fragment, at chosen distances: every lane is a pixel of its own.
struct LanesAtDistance {
    using Real = Float;

    struct Position {
        Float w;
    };
    struct Inputs {
        Vec4<Float> light{Float(0.0f), Float(0.0f), Float(0.0f), Float(1.0f)};
    };
    Position position;
    Inputs in{};

    template <class Body>
    void branch(Mask mask, const Body& body) const {
        if (mask.bits() != 0) body();
    }
    [[nodiscard]] Mask quad_any(Mask mask) const { return mask; }
    template <int kLane>
    [[nodiscard]] Float quad_read(Float x) const {
        return x;
    }
    [[nodiscard]] Float ddx(Float x) const { return x - x; }
    [[nodiscard]] Float ddy(Float x) const { return x - x; }
    [[nodiscard]] Float rcp(Float x) const { return gnomon::rcp(x); }
    [[nodiscard]] Float exp2(Float x) const { return gnomon::exp2(x); }
    [[nodiscard]] Float log2(Float x) const { return gnomon::log2(x); }
};

TechniqueSettings settings_with(ParameterTexts set, int cascades = 4, std::string_view technique = "pssm", int map_size = 128) {
    return resolve_settings(find_technique(technique), {.map_size = map_size, .cascades = cascades, .set = std::move(set)});
}

/// A scene on a device, and what a frame of it asks for.
struct Stage {
    explicit Stage(std::string_view name)
        : scene(scene_of(name)),
          device(Profile{}, 2),
          draws(upload_scene(device, scene)),
          camera(scenes::camera_view(scene.camera, 4.0f / 3.0f)),
          light(scenes::light_view(scene.light, scene.bounds())) {}

    [[nodiscard]] FrameView frame() const {
        return {.scene = draws, .camera = camera, .light = light, .width = 160, .height = 120};
    }
    CascadeSetup set_up(const TechniqueSettings& settings) {
        CascadeSetup setup(device, settings);
        PassTimer timer(device);
        setup.update(frame(), timer);
        return setup;
    }

    const scenes::Scene& scene;
    Device device;
    std::vector<SceneDraw> draws;
    scenes::View camera;
    scenes::View light;
};

std::vector<double> ends_of(const Cascades& cascades) {
    std::vector<double> ends;
    for (int i = 0; i < cascades.count; ++i) ends.push_back(static_cast<double>(cascades.end[static_cast<std::size_t>(i)]));
    return ends;
}

}  // namespace

TEST_CASE("splits end where the scheme says, up to the reach", "[techniques][splits][Zhang06]") {
    Stage stage("fence");
    const auto n = static_cast<double>(stage.camera.znear);
    const auto f = static_cast<double>(stage.camera.zfar);
    for (const double lambda : {0.0, 0.5, 1.0})
        for (const double reach : {0.0, 25.0}) {
            const Cascades cascades =
                stage.set_up(settings_with({{"lambda", fmt::format("{}", lambda)}, {"reach", fmt::format("{}", reach)}}))
                    .constants();
            const std::vector<double> expected = practical_splits(n, reach > 0 ? reach : f, 4, lambda);
            const std::vector<double> ends = ends_of(cascades);
            for (std::size_t i = 0; i < 4; ++i) CHECK(ends[i] == Approx(expected[i + 1]).epsilon(1e-6));
            if (reach > 0) CHECK(cascades.reach == 25.0f);
        }
}

TEST_CASE("minmax begins and ends with what is in view; a histogram shares out the pixels",
          "[techniques][splits][Lauritzen10]") {
    Stage stage("fence");
    DepthRange range(stage.device);
    const DistanceHistogram seen = range.measure(stage.draws, stage.camera, 160, 120);

    // Uniform steps, so that the first one tells where they begin.
    const std::vector<double> minmax =
        ends_of(stage.set_up(settings_with({{"splits", "minmax"}, {"lambda", "0"}})).constants());
    CHECK(minmax[3] == Approx(seen.farthest).epsilon(0.01));
    CHECK(minmax[0] - (minmax[1] - minmax[0]) == Approx(seen.nearest).epsilon(0.05));

    const std::vector<double> shared = ends_of(stage.set_up(settings_with({{"splits", "histogram"}})).constants());
    const auto n = static_cast<double>(stage.camera.znear);
    const auto f = static_cast<double>(stage.camera.zfar);
    std::array<double, 4> pixels{};
    for (std::size_t bin = 0; bin < seen.bins.size(); ++bin) {
        const double distance = n * std::pow(f / n, (static_cast<double>(bin) + 0.5) / kDistanceBins);
        const auto split = static_cast<std::size_t>(std::ranges::count_if(shared, [&](double end) { return end <= distance; }));
        pixels[std::min<std::size_t>(split, 3)] += seen.bins[bin];
    }
    const double all = std::accumulate(pixels.begin(), pixels.end(), 0.0);
    for (const double share : pixels) CHECK(share / all == Approx(0.25).margin(0.03));
}

TEST_CASE("the farthest surface is in the last split even where the near plane leaves depth few bits",
          "[techniques][splits][Lauritzen10]") {
    for (const float znear : {1e-2f, 1e-3f, 1e-4f, 1e-5f}) {
        Stage stage("city");
        scenes::Camera camera = stage.scene.camera;
        const DistanceHistogram exact = DepthRange(stage.device).measure(stage.draws, stage.camera, 160, 120);
        camera.znear = znear;
        stage.camera = scenes::camera_view(camera, 4.0f / 3.0f);
        INFO("near plane " << znear);
        for (const char* splits : {"minmax", "histogram"})
            CHECK(ends_of(stage.set_up(settings_with({{"splits", splits}})).constants())[3] >= exact.farthest * 0.999);
    }
}

TEST_CASE("windows hold their split, the fade before it, and what filters reach", "[techniques][splits][PSVSM]") {
    Stage stage("city");
    const auto window_with = [&](ParameterTexts set, std::string_view technique = "psvsm") {
        return stage.set_up(settings_with(std::move(set), 4, technique, 512)).window(2);
    };
    const std::vector<double> ends = ends_of(stage.set_up(settings_with({})).constants());
    const auto tight = [&](double before) {
        return bounding_window(frustum_slice(stage.camera, ends[1] - before, ends[2]), stage.light);
    };
    const auto check_equal = [](const MapWindow& a, const MapWindow& b) {
        for (int axis = 0; axis < 2; ++axis) {
            CHECK(a.low[axis] == Approx(b.low[axis]).margin(1e-6));
            CHECK(a.high[axis] == Approx(b.high[axis]).margin(1e-6));
        }
    };
    check_equal(window_with({}), with_margin(tight(0), 2, 512));
    check_equal(window_with({{"fade", "0.5"}}), with_margin(tight(0.5 * (ends[1] - ends[0])), 2, 512));
    const glm::dvec2 zoom = tight(0).zoom();
    check_equal(window_with({{"blur", "3"}}), with_margin(tight(0), 2 + std::max(zoom.x, zoom.y), 512));
    check_equal(window_with({{"taps", "9"}}, "pcf"), with_margin(tight(0), 2 + 4, 512));
    check_equal(window_with({}, "savsm"), with_margin(tight(0), 2 + 7.5, 512));  // 16 : 1
}

TEST_CASE("a blur is as wide in the scene whatever the zoom and the size of a map", "[techniques][splits][PSVSM]") {
    Stage stage("city");
    for (const char* ratio : {"1", "0.5"}) {
        const TechniqueSettings settings =
            settings_with({{"size-ratio", ratio}, {"blur", "3"}, {"lambda", "0.2"}}, 3, "psvsm", 512);
        const CascadeSetup setup = stage.set_up(settings);
        const std::vector<int> sizes = map_sizes(settings);
        for (std::size_t i = 0; i < 3; ++i) {
            // The width in texels over the texels of the whole light.
            const MapView view = setup.view(i, stage.light);
            const glm::dvec2 whole = view.window.zoom() * static_cast<double>(sizes[i]);
            CHECK(view.texel_zoom().x / whole.x == Approx(1.0 / 512));
            CHECK(view.texel_zoom().y / whole.y == Approx(1.0 / 512));
        }
    }
}

TEST_CASE("lanes read the split of their distance, fade into the next one, and are lit beyond the reach",
          "[techniques][splits]") {
    Cascades cascades{.count = 3, .fades = 1, .reach = 50.0f};
    cascades.end = {10.0f, 20.0f, 60.0f};
    cascades.fade = {1.0f / 4.0f, 1.0f / 5.0f, 1.0f / 10.0f};
    const auto visibility_at = [&](float distance) {
        const LanesAtDistance f{{Float(distance)}};
        const MapPosition<Float> at{{Float(0.5f), Float(0.5f)}, Float(0.5f), Mask(true)};
        const Float v =
            cascades.visibility(f, at, [](int split, const auto&) { return Float(0.25f * static_cast<float>(split)); });
        return static_cast<double>(lane(v, 0));
    };
    // Map i shows 0.25 i. Distances, and what comes out in closed form.
    for (float z = 0.5f; z < 49.9f; z += 0.25f) {
        const int split = z < 10 ? 0 : z < 20 ? 1 : 2;
        const double length = split == 0 ? 4 : 5;
        const double end = split == 0 ? 10 : 20;
        const double share = split == 2 ? 0.0 : std::clamp(1.0 - (end - static_cast<double>(z)) / length, 0.0, 1.0);
        INFO("distance " << z);
        CHECK(visibility_at(z) == Approx(0.25 * (split + share)).margin(1e-6));
    }
    CHECK(visibility_at(50.0f) == 1.0);
    CHECK(visibility_at(55.0f) == 1.0);
    cascades.fades = 0;
    CHECK(visibility_at(9.99f) == 0.0);
    CHECK(visibility_at(10.0f) == 0.25);
}

TEST_CASE("in a picture everything beyond the reach is lit, and shadows before it stay", "[techniques][splits]") {
    const scenes::Scene& scene = scene_of("fence");
    const auto render = [&](const char* reach) {
        Device device(Profile{}, 2);
        Frame frame(device, scene,
                    {.width = 160,
                     .height = 120,
                     .technique = find_technique("pssm"),
                     .settings = settings_with({{"reach", reach}, {"lambda", "0.8"}}, 4, "pssm", 512)});
        PassTimer timer(device);
        frame.render(timer);
        return std::pair{floats_of(device.texture(frame.visibility()).level_bytes(0)),
                         floats_of(device.texture(frame.depth()).level_bytes(0))};
    };
    const auto [visibility, depth] = render("12");
    const auto [whole, same_depth] = render("0");
    const double n = static_cast<double>(scene.camera.znear);
    const double f = static_cast<double>(scene.camera.zfar);
    int dark_before = 0;
    int dark_beyond = 0;
    int once_dark_beyond = 0;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        if (visibility[i] == Frame::kNoSurface) continue;
        const double distance = n * f / (f - static_cast<double>(depth[i]) * (f - n));
        dark_before += distance < 11.9 && visibility[i] < 0.5f;
        dark_beyond += distance > 12.1 && visibility[i] < 1.0f;
        once_dark_beyond += distance > 12.1 && whole[i] < 0.5f;
    }
    CHECK(dark_before > 100);
    CHECK(dark_beyond == 0);
    CHECK(once_dark_beyond > 100);
}

TEST_CASE("what does not go together is refused", "[techniques][splits]") {
    using Catch::Matchers::Contains;
    CHECK_THROWS_WITH(settings_with({{"snap", "on"}, {"splits", "minmax"}}), Contains("snap") && Contains("practical"));
    CHECK_THROWS_WITH(settings_with({{"snap", "on"}, {"splits", "histogram"}}), Contains("snap") && Contains("practical"));
    CHECK_NOTHROW(settings_with({{"snap", "on"}}));
}
