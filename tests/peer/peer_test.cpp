// The harness on every usable Vulkan device here: a plate's shadow lies where it must, for each technique.
// With no device the device tests are left out, and the exit code 4 says so to CTest.
#include "tests/peer/peer.h"
#include "sim/error.h"
#include "tests/peer/frame_tests.h"
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
        {"VSM rg16f anisotropic",
         {.technique = Technique::Vsm,
          .map_size = 256,
          .filter = MapFilter::Trilinear,
          .moment_format = MomentFormat::Rg16f,
          .max_anisotropy = 16,
          .min_variance = 1e-4f}},
        {"EVSM4 rgba32f blur 5x5",
         {.technique = Technique::Evsm4,
          .map_size = 256,
          .filter = MapFilter::Trilinear,
          .moment_format = MomentFormat::Rgba32f,
          .blur_kernel = gaussian_kernel(5)}},
        {"EVSM4 rgba16f anisotropic",
         {.technique = Technique::Evsm4,
          .map_size = 256,
          .filter = MapFilter::Trilinear,
          .moment_format = MomentFormat::Rgba16f,
          .max_anisotropy = 16,
          .min_variance = 1e-4f,
          .positive_exponent = 5.5f}},
    };
}

const std::vector<glm::vec3> kShadowed = {{1, 0, -1}, {0.3f, 0, -0.3f}, {1.7f, 0, -0.3f}, {0.3f, 0, -1.7f}, {1.7f, 0, -1.7f}};
const std::vector<glm::vec3> kLit = {{-1, 0, -1},     {1, 0, 1},     {-1, 0, 1}, {-0.3f, 0, -0.3f},
                                     {0.3f, 0, 0.3f}, {2.3f, 0, -1}, {1, 1, -1}};

// [Donnelly06] section 4, step 1; [Lauritzen08] section 4.2.
std::vector<double> moments_of(double depth) { return {depth, depth * depth}; }
std::vector<double> warped_moments(const TechniqueOptions& technique, double depth) {
    const double x = 2 * depth - 1;
    const double positive = std::exp(static_cast<double>(technique.positive_exponent) * x);
    const double negative = -std::exp(-static_cast<double>(technique.negative_exponent) * x);
    return {positive, positive * positive, negative, negative * negative};
}

// How many moments of a blurred map differ by more than 2e-6 of themselves from the kernel's sums over the sharp one, edge
// texels repeated.
int wrong_moments(const FrameImages& sharp, const std::vector<float>& kernel, const std::vector<float>& blurred) {
    const int size = static_cast<int>(sharp.map_size);
    const int channels = static_cast<int>(sharp.map_channels);
    const int radius = static_cast<int>(kernel.size() / 2);
    const auto index = [&](int x, int y, int channel) {
        return static_cast<std::size_t>(channels * (std::clamp(y, 0, size - 1) * size + std::clamp(x, 0, size - 1)) + channel);
    };
    const auto weight = [&](int i) { return static_cast<double>(kernel[static_cast<std::size_t>(i + radius)]); };
    int wrong = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            for (int channel = 0; channel < channels; ++channel) {
                double sum = 0;
                for (int j = -radius; j <= radius; ++j)
                    for (int i = -radius; i <= radius; ++i)
                        sum += weight(i) * weight(j) * static_cast<double>(sharp.map[index(x + i, y + j, channel)]);
                const auto actual = static_cast<double>(blurred[index(x, y, channel)]);
                if (!(std::abs(actual - sum) <= 2e-6 * std::abs(sum))) ++wrong;
            }
    return wrong;
}

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
                const auto depth = static_cast<double>(linear_depth(p));
                const bool warped = named.technique.technique == Technique::Evsm4;
                const std::vector<double> moments = warped ? warped_moments(named.technique, depth) : moments_of(depth);
                REQUIRE(moments.size() == images.map_channels);
                for (std::size_t channel = 0; channel < moments.size(); ++channel) {
                    const float got = images.map[images.map_channels * place.index + channel];
                    CHECK(got == Approx(moments[channel]).epsilon(2e-3).margin(warped ? 0 : 1e-4));
                }
            }
        }
    });
}

TEST_CASE("the blur is the separable filter of the map", "[peer][device]") {
    const std::vector<float> kernel{0.1f, 0.2f, 0.4f, 0.2f, 0.1f};
    const TechniqueOptions two{.technique = Technique::Vsm, .map_size = 64, .filter = MapFilter::Bilinear};
    TechniqueOptions four = two;
    four.technique = Technique::Evsm4;
    four.moment_format = MomentFormat::Rgba32f;
    for (TechniqueOptions technique : {two, four}) {
        on_each_device([&](const Peer& peer) {
            technique.blur_kernel = {};
            const FrameImages sharp = render(peer, boxes(), technique);
            technique.blur_kernel = kernel;
            const std::vector<float> actual = render(peer, boxes(), technique).map;
            REQUIRE(sharp.map.size() == actual.size());
            CHECK(distinct(actual).size() > 100);
            CHECK(wrong_moments(sharp, kernel, actual) == 0);
        });
    }
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
    refused([](Frame& f) { f.technique = {.technique = Technique::Pcf, .max_anisotropy = 16}; });
    refused([](Frame& f) { f.technique = {.technique = Technique::Vsm, .moment_format = MomentFormat::Rgba32f}; });
    refused([](Frame& f) { f.technique = {.technique = Technique::Vsm, .min_variance = -1e-5f}; });
    refused([](Frame& f) { f.technique = {.technique = Technique::Vsm, .blur_kernel = {0.5f, 0.5f}}; });
    refused([](Frame& f) { f.technique = {.technique = Technique::Vsm, .blur_kernel = {0.5f, 0.25f, 0.25f}}; });
    refused([](Frame& f) { f.technique = {.technique = Technique::Evsm4, .moment_format = MomentFormat::Rg32f}; });

    scenes::Mesh broken = scene.meshes[0];
    broken.indices[0] = static_cast<std::uint32_t>(broken.vertices.size());
    refused([&broken](Frame& f) { f.draws[0].mesh = &broken; });
}

TEST_CASE("a warp's square fits in the map", "[peer]") {
    // [Lauritzen08] section 4.2 with the largest exponents: half the logarithms of 65504 and of what floats can add up.
    CHECK(largest_exponent(Encoding::Float16) == Approx(5.545).margin(1e-3));
    CHECK(std::exp(2 * static_cast<double>(largest_exponent(Encoding::Float16))) < 65504 * (1 + 0x1p-12));  // rounds to 65504
    CHECK(largest_exponent(Encoding::Float32) == Approx(42.975).margin(1e-3));
    CHECK_THROWS_AS(largest_exponent(Encoding::Unorm16), Error);

    const scenes::Scene scene = two_planes();
    Frame frame = scene_frame(scene, 64, 64);
    const auto check_exponents = [&frame](MomentFormat format, float positive, float negative) {
        frame.technique = {.technique = Technique::Evsm4,
                           .moment_format = format,
                           .positive_exponent = positive,
                           .negative_exponent = negative};
        check_frame(frame);
    };
    CHECK_NOTHROW(check_exponents(MomentFormat::Rgba32f, 42, 42));
    CHECK_NOTHROW(check_exponents(MomentFormat::Rgba16f, 5.54f, 5.54f));
    CHECK_THROWS_AS(check_exponents(MomentFormat::Rgba32f, 43, 5), Error);
    CHECK_THROWS_AS(check_exponents(MomentFormat::Rgba16f, 5.54f, 5.55f), Error);
    CHECK_THROWS_AS(check_exponents(MomentFormat::Rgba16f, 0, 5), Error);
    CHECK_THROWS_AS(check_exponents(MomentFormat::Rgba16f, 5, std::nanf("")), Error);
}

TEST_CASE("anisotropy beyond the device's is refused", "[peer]") {
    PeerDevice device;
    device.name = "some device";
    CHECK_NOTHROW(check_anisotropy(device, 1));
    CHECK_THROWS_WITH(check_anisotropy(device, 2), Catch::Contains("no anisotropic filtering"));
    device.limits.max_anisotropy = 8;
    CHECK_NOTHROW(check_anisotropy(device, 8));
    CHECK_THROWS_WITH(check_anisotropy(device, 16), Catch::Contains("up to 8"));
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
