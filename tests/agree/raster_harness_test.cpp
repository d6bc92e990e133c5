// The raster harness on every usable Vulkan device here: what no driver may differ in comes back as it must.
#include "sim/error.h"
#include "tests/agree/rastering.h"
#include "tests/peer/device_tests.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <functional>

namespace gnomon::agree {
namespace {

constexpr ColorFormat kColorFormats[] = {ColorFormat::Rgba8, ColorFormat::Rgba16Unorm, ColorFormat::Rgba16f,
                                         ColorFormat::Rgba32f};

// Runs a check on each device, with the validation layer where it is installed; the layer must have nothing to say.
void on_each_device(const std::function<void(RasterPeer&)>& check_on) {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        INFO("device " << device.name);
        RasterPeer machine(device, {.validate = true});
        check_on(machine);
        for (const std::string& message : machine.validation_messages()) FAIL_CHECK(message);
    }
}

// A vertex at pixels of a viewport of `size` pixels, w 1. Exact for sizes that are powers of two.
ClipVertex at(float x_px, float y_px, int size, float z = 0.5f) {
    const float scale = 2.0f / static_cast<float>(size);
    return {.clip = {x_px * scale - 1, y_px * scale - 1, z, 1}};
}

std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }

// The code of 1.
std::uint32_t one(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return 0xff;
        case ColorFormat::Rgba16Unorm: return 0xffff;
        case ColorFormat::Rgba16f: return 0x3c00;
        case ColorFormat::Rgba32f: return bits(1.0f);
    }
    return 0;
}

TEST_CASE("coverage of halves, quarters and single samples", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        constexpr int kSize = 16;
        const ClipTriangle upper_left{at(0, 0, kSize), at(kSize, 0, kSize), at(0, kSize, kSize)};
        const ClipTriangle turned{upper_left[0], upper_left[2], upper_left[1]};
        const ClipTriangle all{at(0, 0, kSize), at(2 * kSize, 0, kSize), at(0, 2 * kSize, kSize)};
        const ClipTriangle none{at(3, 3, kSize), at(3, 9, kSize), at(3, 5, kSize)};
        // Left of x = 2.5 in rows 4 and 5: of pixel 2 the samples at 3/8 and 1/8.
        const ClipTriangle strip{at(2.5f, 4, kSize), at(2.5f, 6, kSize), at(-400, 5, kSize)};

        for (const int samples : {1, 4}) {
            const std::uint32_t full = samples == 1 ? 1 : 15;
            const CoverageOptions options{.width = kSize, .height = kSize, .samples = samples};
            const auto covered = machine.coverage(options, std::array{upper_left, turned, all, none, strip});
            REQUIRE(covered.size() == 5);
            // The centres of the diagonal lie on the edge and belong to the triangle below.
            std::size_t whole_pixels = 0;
            for (const CoveredPixel& pixel : covered[0].pixels) {
                if (pixel.x + pixel.y < kSize - 1) CHECK(pixel.mask == full);
                CHECK(pixel.x + pixel.y <= kSize - 1);
                if (pixel.mask == full) ++whole_pixels;
            }
            CHECK(whole_pixels == kSize * (kSize - 1) / 2);
            CHECK(covered[1].pixels == covered[0].pixels);
            CHECK(covered[2].pixels.size() == kSize * kSize);
            for (const CoveredPixel& pixel : covered[2].pixels) CHECK(pixel.mask == full);
            CHECK(covered[3].pixels.empty());
            if (samples == 1) continue;
            bool found = false;
            for (const CoveredPixel& pixel : covered[4].pixels) {
                CHECK(pixel.x <= 2);
                if (pixel.x == 2 && pixel.mask == 0b0101) found = true;
                if (pixel.x == 2) CHECK((pixel.mask & 0b1010) == 0);
            }
            CHECK(found);
        }
    });
}

TEST_CASE("each sample is where it is said to be", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        constexpr int kSize = 8;
        constexpr std::array<std::array<float, 2>, 4> kPositions{{{3, 1}, {7, 3}, {1, 5}, {5, 7}}};  // eighths
        std::vector<ClipTriangle> around;
        for (const auto& [x, y] : kPositions) {
            const float cx = 3 + x / 8;
            const float cy = 4 + y / 8;
            around.push_back(
                {at(cx - 0.125f, cy - 0.125f, kSize), at(cx + 0.25f, cy - 0.125f, kSize), at(cx - 0.125f, cy + 0.25f, kSize)});
        }
        const auto covered = machine.coverage({.width = kSize, .height = kSize, .samples = 4}, around);
        for (std::size_t s = 0; s < 4; ++s) CHECK(covered[s].pixels == std::vector<CoveredPixel>{{3, 4, 1u << s}});
    });
}

TEST_CASE("more triangles than one target holds", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        const CoverageOptions options{.width = 256, .height = 256};
        std::vector<ClipTriangle> triangles;
        for (int i = 0; i < 40; ++i) {
            const auto x = static_cast<float>(i);
            triangles.push_back({at(x, 0, 256), at(x + 1, 0, 256), at(x, 1.5f, 256)});
        }
        const auto covered = machine.coverage(options, triangles);
        REQUIRE(covered.size() == 40);
        for (int i = 0; i < 40; ++i) {
            CHECK(covered[static_cast<std::size_t>(i)].viewport == coverage_viewport(options, static_cast<std::size_t>(i)));
            CHECK(covered[static_cast<std::size_t>(i)].pixels == std::vector<CoveredPixel>{{i, 0, 1}});
        }
        CHECK(machine.coverage(options, {}).empty());
    });
}

TEST_CASE("depth of two squares", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        // The left half at 1/2, and all of it at 1/4, of which the upper half is drawn.
        DepthDraw draw{.width = 16, .height = 16};
        draw.vertices = {at(0, 0, 16, 0.5f),  at(8, 0, 16, 0.5f),   at(8, 16, 16, 0.5f),  at(0, 16, 16, 0.5f),
                         at(0, 0, 16, 0.25f), at(16, 0, 16, 0.25f), at(16, 8, 16, 0.25f), at(0, 8, 16, 0.25f)};
        draw.indices = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
        for (const DepthFormat format : {DepthFormat::D16, DepthFormat::D24, DepthFormat::D32f})
            for (const int samples : {1, 4}) {
                draw.format = format;
                draw.samples = samples;
                if (!machine.supports(format, samples)) {
                    CHECK(format == DepthFormat::D24);
                    CHECK_THROWS_AS(machine.depth(draw), Error);
                    continue;
                }
                const auto codes = machine.depth(draw);
                REQUIRE(codes.size() == static_cast<std::size_t>(256 * samples));
                const double steps = format == DepthFormat::D16 ? 65535 : 16777215;
                for (std::size_t i = 0; i < codes.size(); ++i) {
                    const std::size_t pixel = i / static_cast<std::size_t>(samples);
                    const bool is_near = pixel / 16 < 8;
                    const float z = is_near ? 0.25f : pixel % 16 < 8 ? 0.5f : 1.0f;
                    const bool is_right = format == DepthFormat::D32f
                                              ? codes[i] == bits(z)
                                              : std::abs(static_cast<double>(codes[i]) - static_cast<double>(z) * steps) <= 1;
                    if (!is_right) FAIL_CHECK(fmt::format("sample {}: {:#x}", i, codes[i]));
                }
            }
    });
}

TEST_CASE("depth bias moves depth", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        DepthDraw draw{.width = 8, .height = 8};
        draw.vertices = {at(0, 0, 8, 0.5f), at(16, 0, 8, 0.5f), at(0, 16, 8, 0.5f)};
        draw.indices = {0, 1, 2};
        draw.bias_constant = 4;
        // Exponent of 1/2: steps of 2^-24.
        for (const std::uint32_t code : machine.depth(draw)) CHECK(code == bits(0.5f + 4 * 0x1p-24f));
    });
}

TEST_CASE("attributes", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        ClipTriangle triangle{at(0, 0, 8), at(16, 0, 8), at(0, 16, 8)};
        for (ClipVertex& vertex : triangle) vertex.color = {0.25f, 0.5f, -3, 1};
        triangle[1].color[0] = 0.25f + 16;  // one per pixel
        for (const Interpolation interpolation : {Interpolation::Perspective, Interpolation::Linear}) {
            const auto colors = machine.attributes(triangle, 8, 8, interpolation);
            REQUIRE(colors.size() == 64);
            for (std::size_t i = 0; i < 64; ++i) {
                CHECK(colors[i][0] == Approx(0.75 + static_cast<double>(i % 8)));
                CHECK(colors[i][1] == Approx(0.5));
                CHECK(colors[i][2] == Approx(-3));
            }
        }
    });
}

TEST_CASE("blending where nothing rounds", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        for (const ColorFormat format : kColorFormats) {
            REQUIRE(machine.supports(format));
            const std::uint32_t full = one(format);
            const std::vector<BlendCase> cases{
                {{0, 0, 0, 0}, {full, 0, full, 0}},
                {{1, 0, 1, 0}, {0, 0, full, full}},
                {{0, 1, 0, 1}, {full, full, 0, 0}},
            };
            const auto blended = [&](const BlendEquation& equation) {
                return machine.blend(format, {.color = equation, .alpha = equation}, cases);
            };
            using enum BlendFactor;
            using enum BlendOperation;
            const auto written = machine.blend(format, {.enabled = false}, cases);
            CHECK(written == std::vector<Codes>{{0, 0, 0, 0}, {full, 0, full, 0}, {0, full, 0, full}});
            CHECK(blended({One, Zero, Add}) == written);
            CHECK(blended({Zero, One, Add}) == std::vector<Codes>{{full, 0, full, 0}, {0, 0, full, full}, {full, full, 0, 0}});
            CHECK(blended({One, One, Max}) ==
                  std::vector<Codes>{{full, 0, full, 0}, {full, 0, full, full}, {full, full, 0, full}});
            CHECK(blended({One, One, Min}) == std::vector<Codes>{{0, 0, 0, 0}, {0, 0, full, 0}, {0, full, 0, 0}});
            CHECK(blended({DestinationColor, Zero, Add}) == std::vector<Codes>{{0, 0, 0, 0}, {0, 0, full, 0}, {0, full, 0, 0}});
            CHECK(blended({SourceAlpha, InverseSourceAlpha, Add}) ==
                  std::vector<Codes>{{full, 0, full, 0}, {0, 0, full, full}, {0, full, 0, full}});
            const auto by_constant = machine.blend(
                format, {.color = {ConstantColor, Zero}, .alpha = {ConstantAlpha, Zero}, .constant = {1, 1, 0, 1}}, cases);
            CHECK(by_constant == std::vector<Codes>{{0, 0, 0, 0}, {full, 0, 0, 0}, {0, full, 0, full}});
            CHECK(machine.blend(format, {}, {}).empty());
        }
    });
}

TEST_CASE("more blend cases than a row", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        std::vector<BlendCase> cases(1000);
        for (std::size_t i = 0; i < cases.size(); ++i) {
            cases[i].source = {static_cast<float>(i), 0, 0, 0};
            cases[i].destination = {0, bits(static_cast<float>(i)), 0, 0};
        }
        const BlendEquation sum{BlendFactor::One, BlendFactor::One, BlendOperation::Add};
        const auto blended = machine.blend(ColorFormat::Rgba32f, {.color = sum, .alpha = sum}, cases);
        REQUIRE(blended.size() == cases.size());
        for (std::size_t i = 0; i < blended.size(); ++i) {
            const std::uint32_t expected = bits(static_cast<float>(i));
            CHECK(blended[i] == Codes{expected, expected, 0, 0});
        }
    });
}

TEST_CASE("resolve of equal samples, and of one in four", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        for (const ColorFormat format : kColorFormats)
            for (const ResolveBy by : {ResolveBy::Command, ResolveBy::Attachment}) {
                const std::uint32_t full = one(format);
                std::vector<SampleCodes> pixels;
                // Every code of 8 bits comes through as it is; of the others the same small numbers.
                for (std::uint32_t code = 0; code < 256; ++code) {
                    const std::uint32_t stored = format == ColorFormat::Rgba32f ? bits(static_cast<float>(code)) : code << 2;
                    const std::uint32_t fitting = format == ColorFormat::Rgba8 ? code : stored;
                    SampleCodes same;
                    same.fill({fitting, 0, fitting, full});
                    pixels.push_back(same);
                }
                // The sum of the sample masks' parts: 1/4 of one in red, 1/2 in green, 3/4 in blue, all in alpha.
                pixels.push_back({{{full, full, full, full}, {0, full, full, full}, {0, 0, full, full}, {0, 0, 0, full}}});
                const auto resolved = machine.resolve(format, pixels, by);
                REQUIRE(resolved.size() == 257);
                for (std::size_t i = 0; i < 256; ++i) CHECK(resolved[i] == pixels[i][0]);
                const Codes& parts = resolved[256];
                CHECK(parts[3] == full);
                if (format == ColorFormat::Rgba16f) CHECK(parts == Codes{0x3400, 0x3800, 0x3a00, 0x3c00});
                if (format == ColorFormat::Rgba32f) CHECK(parts == Codes{bits(0.25f), bits(0.5f), bits(0.75f), full});
                if (format == ColorFormat::Rgba8 || format == ColorFormat::Rgba16Unorm)
                    for (std::size_t c = 0; c < 3; ++c)
                        CHECK(std::abs(4.0 * parts[c] - static_cast<double>(c + 1) * full) <= 4);
            }
        CHECK(machine.resolve(ColorFormat::Rgba8, {}, ResolveBy::Command).empty());
    });
}

TEST_CASE("impossible requests are refused", "[agree][device]") {
    on_each_device([](RasterPeer& machine) {
        const std::array<ClipTriangle, 1> triangle{};
        CHECK_THROWS_AS(machine.coverage({.width = 0}, triangle), Error);
        CHECK_THROWS_AS(machine.coverage({.height = 5000}, triangle), Error);
        CHECK_THROWS_AS(machine.coverage({.samples = 2}, triangle), Error);
        DepthDraw draw;
        CHECK_THROWS_AS(machine.depth(draw), Error);
        draw.vertices.resize(3);
        draw.indices = {0, 1, 3};
        CHECK_THROWS_AS(machine.depth(draw), Error);
        draw.indices = {0, 1};
        CHECK_THROWS_AS(machine.depth(draw), Error);
        CHECK_THROWS_AS(machine.attributes(triangle[0], 0, 1, Interpolation::Linear), Error);
    });
}

}  // namespace
}  // namespace gnomon::agree
