// Same bytes for any number of threads, for every technique and format; relations between techniques; the blur.
#include "scenes/procedural.h"
#include "techniques/common/gaussian.h"
#include "techniques/frame.h"
#include "tests/oracle/texture.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

struct Picture {
    std::vector<std::byte> color, visibility, depth, map;

    bool operator==(const Picture&) const = default;
};

Picture render(std::string_view technique, const TechniqueRequest& request, std::string_view scene_name, int threads,
               const std::string& profile = "d3d11") {
    scenes::Scene scene;
    for (const auto& s : scenes::procedural_scenes())
        if (s.name == scene_name) scene = s.make();
    REQUIRE(!scene.meshes.empty());
    Device device(load_profile(profile), threads);
    const Technique& t = find_technique(technique);
    Frame frame(device, scene, {.width = 320, .height = 240, .technique = t, .settings = resolve_settings(t, request)});
    PassTimer timer(device);
    frame.render(timer);
    return {device.texture(frame.color()).level_bytes(0), device.texture(frame.visibility()).level_bytes(0),
            device.texture(frame.depth()).level_bytes(0), device.texture(frame.maps().front()).level_bytes(0)};
}

bool takes(const Technique& technique, std::string_view parameter) {
    return std::ranges::find(technique.parameters, parameter, &Parameter::name) != technique.parameters.end();
}

/// Shares of visibilities 0, 1 and between.
void require_shadows(const Picture& picture) {
    std::vector<float> values(picture.visibility.size() / 4);
    std::memcpy(values.data(), picture.visibility.data(), picture.visibility.size());
    int dark = 0;
    int lit = 0;
    for (const float v : values) {
        if (v == Frame::kNoSurface) continue;
        REQUIRE((v >= 0.0f && v <= 1.0f));
        dark += v < 0.25f;
        lit += v > 0.75f;
    }
    CHECK(dark > 500);
    CHECK(lit > 5000);
}

}  // namespace

TEST_CASE("every technique and format: same bytes for 1, 2 and 8 threads", "[techniques][order]") {
    for (const Technique& technique : all_techniques())
        for (const Format format : technique.formats) {
            INFO(technique.name << " " << name_of(format));
            TechniqueRequest request{.map_size = 256, .format = format};
            if (takes(technique, "blur")) request.set = {{"blur", "5"}};
            const Picture one = render(technique.name, request, "car", 1);
            CHECK(one == render(technique.name, request, "car", 2));
            CHECK(one == render(technique.name, request, "car", 8));
            require_shadows(one);
        }
}

TEST_CASE("double arithmetic: same bytes for 1 and 8 threads", "[techniques][order]") {
    for (const Technique& technique : all_techniques()) {
        INFO(technique.name);
        const TechniqueRequest request{.map_size = 128};
        const Picture one = render(technique.name, request, "car", 1, "ideal");
        CHECK(one == render(technique.name, request, "car", 8, "ideal"));
        CHECK_FALSE(one == render(technique.name, request, "car", 1, "d3d11"));
        require_shadows(one);
    }
}

TEST_CASE("rendering twice gives the same bytes", "[techniques][order]") {
    scenes::Scene scene = scenes::procedural_scenes()[0].make();
    for (const Technique& technique : all_techniques()) {
        Device device(Profile{}, 2);
        Frame frame(
            device, scene,
            {.width = 64, .height = 48, .technique = technique, .settings = resolve_settings(technique, {.map_size = 64})});
        PassTimer timer(device);
        frame.render(timer);
        const auto first = device.texture(frame.color()).level_bytes(0);
        frame.render(timer);
        CHECK(first == device.texture(frame.color()).level_bytes(0));
    }
}

TEST_CASE("a plain shadow map is percentage closer filtering with one nearest tap", "[techniques]") {
    for (const Format format : {Format::D32Float, Format::D24, Format::D16}) {
        const TechniqueRequest plain{.map_size = 256, .format = format, .slope_bias = 2.0f};
        TechniqueRequest pcf = plain;
        pcf.set = {{"taps", "1"}};
        CHECK(render("shadow-map", plain, "car", 1) == render("pcf", pcf, "car", 1));
        // And not with the bilinear tap.
        CHECK_FALSE(render("shadow-map", plain, "car", 1) == render("pcf-bilinear", pcf, "car", 1));
        // ... which is what pcf-hw takes.
        CHECK(render("pcf-hw", plain, "car", 1) == render("pcf-bilinear", pcf, "car", 1));
    }
}

TEST_CASE("n x n nearest taps give multiples of 1 / n^2", "[techniques][pcf]") {
    for (const int taps : {2, 3, 4, 5}) {
        const Picture picture = render("pcf", {.map_size = 256, .set = {{"taps", std::to_string(taps)}}}, "car", 1);
        std::vector<float> values(picture.visibility.size() / 4);
        std::memcpy(values.data(), picture.visibility.data(), picture.visibility.size());
        int between = 0;
        for (const float v : values) {
            if (v == Frame::kNoSurface) continue;
            const float count = v * static_cast<float>(taps * taps);
            REQUIRE(std::fabs(count - std::nearbyint(count)) < 1e-5f);
            between += v > 0.0f && v < 1.0f;
        }
        CHECK(between > 200);
    }
}

TEST_CASE("Gaussian weights sum to one, are symmetric and fall", "[techniques][gaussian]") {
    for (int taps = 1; taps <= kMaxBlurTaps; taps += 2) {
        const auto [count, weights] = gaussian_kernel(taps);
        CHECK(count == taps);
        double sum = 0;
        for (const float w : weights) sum += static_cast<double>(w);
        INFO("taps " << taps);
        CHECK(std::fabs(sum - 1.0) <= taps * 0x1p-25);
        const double sigma = taps > 1 ? 0.25 * (taps - 1) : 1.0;
        for (int i = 0; i < kMaxBlurTaps; ++i) {
            const float w = weights[static_cast<std::size_t>(i)];
            if (i >= taps) {
                CHECK(w == 0.0f);
                continue;
            }
            CHECK(w == weights[static_cast<std::size_t>(taps - 1 - i)]);
            if (i > 0 && i <= taps / 2) CHECK(w > weights[static_cast<std::size_t>(i - 1)]);
            // Ratios to the middle are exp(-x^2 / 2 sigma^2).
            const double x = (i - taps / 2) / sigma;
            CHECK(std::fabs(static_cast<double>(w) / static_cast<double>(weights[static_cast<std::size_t>(taps / 2)]) -
                            std::exp(-0.5 * x * x)) < 1e-6);
        }
    }
}

TEST_CASE("a Gaussian of any width: taps as the next odd one, narrower the smaller it is", "[techniques][gaussian]") {
    float before = 1.0f;
    for (const double width : {1.0, 1.25, 2.0, 2.9, 3.0, 3.1, 4.5, 5.0, 61.7, 63.0}) {
        const GaussianKernel kernel = gaussian_kernel(width);
        INFO("width " << width);
        CHECK(kernel.taps % 2 == 1);
        CHECK((kernel.taps >= width && kernel.taps < width + 2));
        const float middle = kernel.weights[static_cast<std::size_t>(kernel.taps / 2)];
        CHECK(middle <= before);
        before = middle;
        double sum = 0;
        for (const float w : kernel.weights) sum += static_cast<double>(w);
        CHECK(std::fabs(sum - 1.0) <= 64 * 0x1p-25);
    }
}

TEST_CASE("the blur of a constant is that constant within the format", "[techniques][gaussian]") {
    // Weights sum to 1 within taps * 2^-25; each of `taps` products and sums rounds once in fp32; each pass stores once.
    for (const auto& [format, storage] : {std::pair{Format::Rg32Float, 0x1p-24}, std::pair{Format::Rg16Float, 0x1p-10},
                                          std::pair{Format::Rg16Unorm, 0.5 / 65535}})
        for (const int taps : {1, 3, 9, 31}) {
            Device device(Profile{}, 2);
            const TextureDesc desc{.format = format, .width = 37, .height = 21};
            const TextureId texture = device.create_texture("map", desc);
            const TextureId scratch = device.create_texture("scratch", desc);
            device.execute(ClearColor{texture, {0.3f, 0.09f, 0.0f, 1.0f}});
            const auto before = device.texture(texture).level_bytes(0);
            blur(FullScreen(device), {gaussian_kernel(taps), gaussian_kernel(taps)}, texture, scratch);
            const auto after = device.texture(texture).level_bytes(0);
            const FormatInfo& info = format_info(format);
            const auto value = [&](const std::vector<std::byte>& bytes, std::size_t i) {
                const std::size_t size = static_cast<std::size_t>(info.bits_per_component) / 8;
                std::uint32_t code = 0;
                std::memcpy(&code, bytes.data() + i * size, size);
                if (info.type == ComponentType::Float16) return oracle::half_value(code);
                if (info.type == ComponentType::Unorm16) return code / 65535.0;
                return static_cast<double>(std::bit_cast<float>(code));
            };
            const std::size_t count = before.size() / (static_cast<std::size_t>(info.bits_per_component) / 8);
            for (std::size_t i = 0; i < count; ++i) {
                const double error = std::fabs(value(after, i) - value(before, i));
                const double bound = 2 * (storage + 3 * taps * 0x1p-24) * (info.type == ComponentType::Unorm16 ? 1.0 : 0.3);
                if (!(error <= bound))
                    FAIL(fmt::format("{} taps {} texel {} channel {}: {:a} from {:a}", name_of(format), taps, i / 2, i % 2,
                                     value(after, i), value(before, i)));
            }
        }
}

TEST_CASE("the blur of one texel is the outer product of the weights", "[techniques][gaussian]") {
    for (const int taps : {3, 7, 15}) {
        Device device(Profile{}, 1);
        const TextureDesc desc{.format = Format::R32Float, .width = 33, .height = 29};
        const TextureId texture = device.create_texture("map", desc);
        const TextureId scratch = device.create_texture("scratch", desc);
        std::vector<float> values(33 * 29, 0.0f);
        values[14 * 33 + 16] = 1.0f;
        device.execute(WriteTexture{texture, 0, std::as_bytes(std::span(values))});
        const GaussianKernel kernel = gaussian_kernel(taps);
        blur(FullScreen(device), {kernel, kernel}, texture, scratch);
        const auto bytes = device.texture(texture).level_bytes(0);
        std::memcpy(values.data(), bytes.data(), bytes.size());
        const auto& weights = kernel.weights;
        for (int y = 0; y < 29; ++y)
            for (int x = 0; x < 33; ++x) {
                const int i = x - 16 + taps / 2;
                const int j = y - 14 + taps / 2;
                const bool inside = i >= 0 && j >= 0 && i < taps && j < taps;
                const float expected =
                    inside ? weights[static_cast<std::size_t>(i)] * weights[static_cast<std::size_t>(j)] : 0.0f;
                if (values[static_cast<std::size_t>(y * 33 + x)] != expected)
                    FAIL(fmt::format("taps {} pixel ({}, {}): {:a}, expected {:a}", taps, x, y,
                                     values[static_cast<std::size_t>(y * 33 + x)], expected));
            }
    }
}

TEST_CASE("a pass may not read the texture it writes", "[techniques][errors]") {
    // Tiles run in parallel: what they would read depends on which of them ran first.
    Device device(Profile{}, 2);
    const TextureId texture = device.create_texture("map", {.format = Format::R32Float, .width = 128, .height = 128});
    device.execute(ClearColor{texture, glm::vec4(0.5f)});
    const auto before = device.texture(texture).level_bytes(0);
    const FullScreen full_screen(device);
    CHECK_THROWS_AS(blur(full_screen, {gaussian_kernel(3), gaussian_kernel(3)}, texture, texture), Error);
    CHECK(device.texture(texture).level_bytes(0) == before);
}
