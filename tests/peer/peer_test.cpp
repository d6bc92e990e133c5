// The harness on every usable Vulkan device here: a plate's shadow lies where it must, for each technique.
// With no device the device tests are left out, and the exit code 4 says so to CTest.
#include "tests/peer/peer.h"
#include "sim/error.h"
#include "tests/peer/device_tests.h"
#include "tests/peer/raw_pass.h"
#include "tests/peer/test_scenes.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <set>

namespace gnomon::peer {
namespace {

// Runs a check on each device, with the validation layer where it is installed; the layer must have nothing to say.
void on_each_device(const std::function<void(const Peer&)>& check_on) {
    for (const PeerDevice& device : usable_devices()) {
        INFO("device " << device.name);
        const Peer peer(device, {.validate = true});
        check_on(peer);
        for (const std::string& message : peer.validation_messages()) FAIL_CHECK(message);
    }
}

FrameImages render(const Peer& peer, const scenes::Scene& scene, const TechniqueOptions& technique) {
    Frame frame = scene_frame(scene, 320, 240);
    frame.technique = technique;
    return FrameRenderer(peer, frame).render();
}

// The texel that a world position falls on in an image seen through `view`, y down; and its depth.
struct Place {
    std::size_t index = 0;
    float depth = 0;
};
Place place_of(const glm::vec3& position_ws, const scenes::View& view, std::uint32_t width, std::uint32_t height) {
    const glm::vec4 clip = view.clip_from_world() * glm::vec4(position_ws, 1);
    const float x_px = (clip.x / clip.w + 1) * 0.5f * static_cast<float>(width);
    const float y_px = (1 - clip.y / clip.w) * 0.5f * static_cast<float>(height);
    return {static_cast<std::size_t>(y_px) * width + static_cast<std::size_t>(x_px), clip.z / clip.w};
}

// Each technique with its name.
struct Named {
    const char* name;
    TechniqueOptions technique;
};
std::vector<Named> all_techniques() {
    const float bias = 16;  // d32f steps: the ground is level with the map, so that slope gives none
    return {
        {"shadow map", {.technique = Technique::ShadowMap, .map_size = 256, .depth_bias_constant = bias}},
        {"PCF bilinear",
         {.technique = Technique::Pcf, .map_size = 256, .filter = MapFilter::Bilinear, .depth_bias_constant = bias}},
        {"PCF 3x3", {.technique = Technique::Pcf, .map_size = 256, .depth_bias_constant = bias, .taps = 3}},
        {"VSM rg32f bilinear", {.technique = Technique::Vsm, .map_size = 256, .filter = MapFilter::Bilinear}},
        {"VSM rg32f trilinear", {.technique = Technique::Vsm, .map_size = 256, .filter = MapFilter::Trilinear}},
        {"VSM rg16f trilinear",
         {.technique = Technique::Vsm,
          .map_size = 256,
          .filter = MapFilter::Trilinear,
          .moment_format = MomentFormat::Rg16f,
          .min_variance = 1e-4f}},
        {"VSM rg16unorm bilinear",
         {.technique = Technique::Vsm,
          .map_size = 256,
          .filter = MapFilter::Bilinear,
          .moment_format = MomentFormat::Rg16Unorm,
          .min_variance = 1e-4f}},
        {"VSM blur 3x3",
         {.technique = Technique::Vsm, .map_size = 256, .filter = MapFilter::Trilinear, .blur_kernel = gaussian_kernel(3)}},
        {"VSM anisotropic",
         {.technique = Technique::Vsm, .map_size = 256, .filter = MapFilter::Trilinear, .max_anisotropy = 4}},
    };
}

const std::vector<glm::vec3> kShadowed = {{1, 0, -1}, {0.3f, 0, -0.3f}, {1.7f, 0, -0.3f}, {0.3f, 0, -1.7f}, {1.7f, 0, -1.7f}};
const std::vector<glm::vec3> kLit = {{-1, 0, -1},     {1, 0, 1},     {-1, 0, 1}, {-0.3f, 0, -0.3f},
                                     {0.3f, 0, 0.3f}, {2.3f, 0, -1}, {1, 1, -1}};

std::set<float> distinct(const std::vector<float>& values) { return {values.begin(), values.end()}; }

}  // namespace

TEST_CASE("the plate's shadow lies where it must", "[peer][device]") {
    const scenes::Scene scene = two_planes();
    const scenes::View camera = scene_frame(scene, 320, 240).camera;
    on_each_device([&](const Peer& peer) {
        for (const Named& named : all_techniques()) {
            INFO(named.name);
            const FrameImages images = render(peer, scene, named.technique);
            for (const glm::vec3& p : kShadowed) {
                INFO("shadowed " << p.x << ' ' << p.y << ' ' << p.z);
                const Place place = place_of(p, camera, images.width, images.height);
                CHECK(images.visibility[place.index] < 0.01f);
                CHECK(std::abs(images.color[4 * place.index] - 65) <= 4);  // sqrt(0.8 * 0.08) * 255: ambient alone
                CHECK(images.depth[place.index] == Approx(place.depth).margin(1e-4));
            }
            for (const glm::vec3& p : kLit) {
                INFO("lit " << p.x << ' ' << p.y << ' ' << p.z);
                const Place place = place_of(p, camera, images.width, images.height);
                CHECK(images.visibility[place.index] > 0.99f);
                CHECK(std::abs(images.color[4 * place.index] - 237) <= 2);  // sqrt(0.8 * 1.08) * 255: the light falls straight
                CHECK(images.depth[place.index] == Approx(place.depth).margin(1e-4));
            }
            // The sky is background.
            CHECK(images.visibility[0] == kNoSurface);
            CHECK(images.depth[0] == 1.0f);
        }
    });
}

TEST_CASE("without a technique everything is lit and there is no map", "[peer][device]") {
    on_each_device([](const Peer& peer) {
        const FrameImages images = render(peer, two_planes(), {.technique = Technique::None});
        CHECK(distinct(images.visibility) == std::set<float>{kNoSurface, 1.0f});
        CHECK(distinct(images.depth).size() > 100);
        CHECK(images.map.empty());
    });
}

TEST_CASE("nearest comparisons are 0 or 1, and NxN of them ninths", "[peer][device]") {
    on_each_device([](const Peer& peer) {
        const FrameImages nearest = render(peer, two_planes(), {.technique = Technique::ShadowMap, .depth_bias_constant = 16});
        CHECK(distinct(nearest.visibility) == std::set<float>{kNoSurface, 0.0f, 1.0f});

        const FrameImages ninths =
            render(peer, two_planes(), {.technique = Technique::Pcf, .depth_bias_constant = 16, .taps = 3});
        CHECK(distinct(ninths.visibility).size() > 2);
        for (const float v : distinct(ninths.visibility)) CHECK(v * 9 == Approx(std::round(v * 9)).margin(1e-5));

        const FrameImages linear =
            render(peer, two_planes(),
                   {.technique = Technique::Pcf, .map_size = 64, .filter = MapFilter::Bilinear, .depth_bias_constant = 16});
        CHECK(distinct(linear.visibility).size() > 10);
    });
}

TEST_CASE("the map holds the light's depth, or its moments", "[peer][device]") {
    const scenes::Scene scene = two_planes();
    const scenes::View light = scene_frame(scene, 320, 240).light;
    const auto linear_depth = [&light](const glm::vec3& p) {
        const float z_view = (light.view_from_world * glm::vec4(p, 1)).z;
        return (-z_view - light.znear) / (light.zfar - light.znear);
    };
    on_each_device([&](const Peer& peer) {
        for (const Named& named : all_techniques()) {
            INFO(named.name);
            const FrameImages images = render(peer, scene, named.technique);
            REQUIRE(images.map.size() == std::size_t{images.map_size} * images.map_size * images.map_channels);
            for (const glm::vec3& p : {glm::vec3(1, 1, -1), glm::vec3(-1, 0, -1), glm::vec3(1, 0, 1), glm::vec3(-1, 0, 1)}) {
                const Place place = place_of(p, light, images.map_size, images.map_size);
                if (images.map_channels == 1) {
                    CHECK(images.map[place.index] == Approx(place.depth).margin(1e-5));
                    continue;
                }
                const double depth = static_cast<double>(linear_depth(p));
                CHECK(images.map[2 * place.index] == Approx(depth).epsilon(1e-3).margin(1e-4));
                CHECK(images.map[2 * place.index + 1] == Approx(depth * depth).epsilon(2e-3).margin(1e-4));
            }
        }
    });
}

TEST_CASE("the blur is the separable filter of the map", "[peer][device]") {
    TechniqueOptions sharp{.technique = Technique::Vsm, .map_size = 64, .filter = MapFilter::Bilinear};
    TechniqueOptions blurred = sharp;
    blurred.blur_kernel = {0.1f, 0.2f, 0.4f, 0.2f, 0.1f};
    on_each_device([&](const Peer& peer) {
        const std::vector<float> map = render(peer, boxes(), sharp).map;
        const std::vector<float> actual = render(peer, boxes(), blurred).map;
        REQUIRE(map.size() == actual.size());
        CHECK(distinct(actual).size() > 100);
        const auto at = [&map](int x, int y, int channel) {
            const int column = std::clamp(x, 0, 63);
            const int row = std::clamp(y, 0, 63);
            return static_cast<double>(map[static_cast<std::size_t>(2 * (row * 64 + column) + channel)]);
        };
        double worst = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                for (int channel = 0; channel < 2; ++channel) {
                    double sum = 0;
                    for (int j = -2; j <= 2; ++j)
                        for (int i = -2; i <= 2; ++i)
                            sum += static_cast<double>(blurred.blur_kernel[static_cast<std::size_t>(i + 2)]) *
                                   static_cast<double>(blurred.blur_kernel[static_cast<std::size_t>(j + 2)]) *
                                   at(x + i, y + j, channel);
                    const float got = actual[static_cast<std::size_t>(2 * (y * 64 + x) + channel)];
                    worst = std::max(worst, std::abs(static_cast<double>(got) - sum));
                }
        CHECK(worst < 1e-6);
    });
}

TEST_CASE("mips are the mean of the map", "[peer][device]") {
    // From so far away that one pixel spans the whole map, trilinear filtering reads the smallest levels: the visibility of a
    // half covered map lies strictly between those of its halves, which one level alone would give.
    scenes::Scene scene = two_planes();
    scene.camera.world_from_camera[3] *= glm::vec4(60, 60, 60, 1);
    scene.camera.zfar = 2000;
    on_each_device([&](const Peer& peer) {
        TechniqueOptions technique{.technique = Technique::Vsm, .map_size = 256, .filter = MapFilter::Trilinear};
        std::set<float> filtered = distinct(render(peer, scene, technique).visibility);
        filtered.erase(kNoSurface);
        REQUIRE(!filtered.empty());
        CHECK(std::any_of(filtered.begin(), filtered.end(), [](float v) { return v > 0.02f && v < 0.98f; }));
        CHECK(*filtered.begin() > 0.02f);
    });
}

TEST_CASE("a frame renders the same again, and after timing", "[peer][device]") {
    on_each_device([](const Peer& peer) {
        const scenes::Scene scene = boxes();
        Frame frame = scene_frame(scene, 160, 120);
        frame.technique = {
            .technique = Technique::Vsm, .map_size = 128, .filter = MapFilter::Trilinear, .blur_kernel = gaussian_kernel(5)};
        FrameRenderer renderer(peer, frame);
        const FrameImages first = renderer.render();
        const std::vector<double> times = renderer.time_frames(1, 3);
        const FrameImages second = renderer.render();
        CHECK(first.color == second.color);
        CHECK(first.visibility == second.visibility);
        CHECK(first.depth == second.depth);
        CHECK(first.map == second.map);
        REQUIRE(times.size() == 3);
        CHECK(std::all_of(times.begin(), times.end(), [](double ms) { return ms > 0; }));
    });
}

TEST_CASE("a raw pass draws its half of the target, however it is shaded", "[peer][device]") {
    // The left half, at depth 0.25, with coordinates 0.25 and 0.75 all over.
    RawMesh half;
    for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(0, -1), glm::vec2(-1, 1), glm::vec2(0, 1)})
        half.vertices.push_back({{corner, 0.25f}, {0.25f, 0.75f}});
    half.indices = {0, 1, 2, 1, 3, 2};
    on_each_device([&](const Peer& peer) {
        const auto image = [&](RawShading shading, int samples) {
            RawPassRenderer renderer(peer, {.mesh = half, .shading = shading, .samples = samples, .width = 64, .height = 48});
            CHECK(renderer.time_once() > 0);
            return renderer.render();
        };
        const RawImage depth = image(RawShading::DepthOnly, 1);
        CHECK(depth.covered == 32 * 48);
        CHECK(depth.mean == Approx((0.25 + 1) / 2));
        for (const int samples : {1, 4}) {
            INFO(samples << " samples");
            const RawImage plain = image(RawShading::Plain, samples);
            CHECK(plain.covered == 32 * 48);
            CHECK(plain.mean == Approx((0.25 + 0.75 + 0.5 + 1) / 2).margin(2.0 / 255));
        }
        // Constant coordinates have no footprint: both filters read the finest level.
        const RawImage bilinear = image(RawShading::Bilinear, 1);
        const RawImage trilinear = image(RawShading::Trilinear, 1);
        CHECK(bilinear.covered == 32 * 48);
        CHECK(bilinear.mean > 0.6);
        CHECK(trilinear.mean == Approx(bilinear.mean).margin(2.0 / 255));
        CHECK_THROWS_AS(RawPassRenderer(peer, {.mesh = half, .shading = RawShading::DepthOnly, .samples = 4}), Error);
    });
}

TEST_CASE("bad frames are refused", "[peer]") {
    const scenes::Scene scene = two_planes();
    const Frame good = scene_frame(scene, 64, 64);
    CHECK_NOTHROW(check_frame(good));
    const auto refused = [&good](const std::function<void(Frame&)>& spoil) {
        Frame bad = good;
        spoil(bad);
        CHECK_THROWS_AS(check_frame(bad), Error);
    };
    refused([](Frame& f) { f.draws.clear(); });
    refused([](Frame& f) { f.draws[0].mesh = nullptr; });
    refused([](Frame& f) { f.width = 0; });
    refused([](Frame& f) { f.height = 5000; });
    refused([](Frame& f) { f.technique.map_size = 0; });
    refused([](Frame& f) { f.technique.taps = 0; });
    refused([](Frame& f) { f.technique.max_anisotropy = std::nanf(""); });
    refused([](Frame& f) { f.technique = {.technique = Technique::Pcf, .filter = MapFilter::Trilinear}; });
    refused([](Frame& f) { f.technique.blur_kernel = {0.5f, 0.5f}; });
    refused([](Frame& f) { f.technique.blur_kernel = {0.5f, 0.25f, 0.25f}; });

    scenes::Mesh broken = scene.meshes[0];
    broken.indices[0] = static_cast<std::uint32_t>(broken.vertices.size());
    refused([&broken](Frame& f) { f.draws[0].mesh = &broken; });
}

TEST_CASE("a device that is not there is refused", "[peer][device]") {
    PeerDevice elsewhere = usable_devices().at(0);
    elsewhere.name += " of yesterday";
    CHECK_THROWS_AS(Peer(elsewhere), Error);
    elsewhere = usable_devices().at(0);
    elsewhere.index = 1000;
    CHECK_THROWS_AS(Peer(elsewhere), Error);
}

TEST_CASE("Gaussian kernels", "[peer]") {
    CHECK(gaussian_kernel(1) == std::vector<float>{1.0f});
    for (int taps = 3; taps <= 31; taps += 2) {
        // Neighbouring weights fall off as the density of the normal distribution does.
        const std::vector<float> w = gaussian_kernel(taps);
        const std::size_t middle = w.size() / 2;
        const double sigma = 0.25 * (taps - 1);
        CHECK(static_cast<double>(w[middle + 1] / w[middle]) == Approx(std::exp(-0.5 / (sigma * sigma))));
        CHECK(std::equal(w.begin(), w.end(), w.rbegin()));
    }
    CHECK_THROWS_AS(gaussian_kernel(2), Error);
    CHECK_THROWS_AS(gaussian_kernel(33), Error);
}

TEST_CASE("time summaries", "[peer]") {
    CHECK(summarize({3, 1, 2}).median_ms == 2);
    CHECK(summarize({4, 1, 2, 3}).median_ms == 2.5);
    CHECK(summarize({3, 1, 2}).min_ms == 1);
    CHECK_THROWS_AS(summarize({}), Error);
}

TEST_CASE("driver manifests exist", "[peer]") {
    for (const std::string& manifest : driver_manifests()) CHECK(std::filesystem::exists(manifest));
}

}  // namespace gnomon::peer
