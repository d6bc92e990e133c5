// D3D11.3 15.10: constant and slope-scaled depth bias, its clamp, and the clamp of depth behind it (17.10).
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

std::uint32_t depth_code_of(Format format, float z) {
    if (format == Format::D16) return oracle::unorm_code(z, 16);
    if (format == Format::D24) return oracle::unorm_code(z, 24);
    const float limited = z > 0.0f ? (z < 1.0f ? z : 1.0f) : 0.0f;
    // Operands below the normal range count as 0 under the d3d11 profile. D3D11.3 3.1.3.2
    return limited < 0x1p-126f ? 0u : std::bit_cast<std::uint32_t>(limited);
}

/// Depth codes and shader depth of one triangle with a slope, with and without bias.
std::vector<std::uint32_t> biased(Format format, const std::array<float, 3>& z, const RasterState& raster) {
    Device device(Profile{}, 1);
    const TextureId target = device.create_texture("depth", {.format = format, .width = 16, .height = 16});
    const std::vector<TestVertex> v{{-1, 1, z[0], 1, 0, 0}, {3, 1, z[1], 1, 0, 0}, {-1, -3, z[2], 1, 0, 0}};
    device.execute(ClearDepth{target, 1.0f});
    Draw draw = make_draw(depth_only_program(), upload(device, v), 0, 3);
    draw.depth = target;
    draw.raster = raster;
    draw.depth_state.compare = CompareOp::Always;
    device.execute(draw);
    return codes_of(device.texture(target));
}

}  // namespace

TEST_CASE("constant depth bias counts steps of the format", "[depth][15.10]") {
    for (const int steps : {1, -1, 7, 100, -3000}) {
        const RasterState raster{.depth_bias = steps};
        // 0.25 * 65535 is a quarter of a step away from where the code changes.
        const auto d16 = biased(Format::D16, {0.25f, 0.25f, 0.25f}, {});
        const auto d16_biased = biased(Format::D16, {0.25f, 0.25f, 0.25f}, raster);
        for (std::size_t i = 0; i < d16.size(); ++i)
            REQUIRE(static_cast<int>(d16_biased[i]) - static_cast<int>(d16[i]) == steps);
        // 0.25 leaves fp32 two bits below a D24 step.
        const auto d24 = biased(Format::D24, {0.25f, 0.25f, 0.25f}, {});
        const auto d24_biased = biased(Format::D24, {0.25f, 0.25f, 0.25f}, raster);
        for (std::size_t i = 0; i < d24.size(); ++i)
            REQUIRE(static_cast<int>(d24_biased[i]) - static_cast<int>(d24[i]) == steps);
        // Float: 2^(exponent of the largest z - 23), one unit in the last place of 0.5 at the largest vertex.
        const auto d32_biased = biased(Format::D32Float, {0.5f, 0.5f, 0.5f}, raster);
        for (const std::uint32_t code : d32_biased)
            REQUIRE(std::bit_cast<float>(code) == 0.5f + static_cast<float>(steps) * 0x1p-24f);
        // The step follows the largest depth of the primitive: here 0.75 in [1/2, 1) although depth at vertex 0 is 1/8.
        const std::array<float, 3> slope{0.125f, 0.75f, 0.125f};
        const auto plain = biased(Format::D32Float, slope, {});
        const auto moved = biased(Format::D32Float, slope, raster);
        for (std::size_t i = 0; i < plain.size(); ++i) {
            const float a = std::bit_cast<float>(plain[i]);
            const float b = std::bit_cast<float>(moved[i]);
            REQUIRE(std::fabs((b - a) - static_cast<float>(steps) * 0x1p-24f) <= 0x1p-25f);
        }
    }
}

TEST_CASE("slope-scaled bias and its clamp", "[depth][15.10]") {
    // z = 1/8 + x/32 * 1/2 over 32 pixels: dz/dx = 1/64, dz/dy = -1/256 per pixel; 3 times the larger magnitude.
    const std::array<float, 3> z{0.25f, 0.75f, 0.125f};
    const auto plain = biased(Format::D32Float, z, {});
    const auto shift = [&](const RasterState& raster, std::size_t i) {
        return std::bit_cast<float>(biased(Format::D32Float, z, raster)[i]) - std::bit_cast<float>(plain[i]);
    };
    for (const std::size_t i : {0u, 17u, 255u}) {
        CHECK(shift({.slope_scaled_depth_bias = 3.0f}, i) == 3.0f / 64.0f);
        CHECK(shift({.slope_scaled_depth_bias = -1.0f}, i) == -1.0f / 64.0f);
        CHECK(shift({.slope_scaled_depth_bias = 3.0f, .depth_bias_clamp = 0.03125f}, i) == 0.03125f);
        CHECK(shift({.slope_scaled_depth_bias = -3.0f, .depth_bias_clamp = -0.03125f}, i) == -0.03125f);
        CHECK(shift({.slope_scaled_depth_bias = -1.0f, .depth_bias_clamp = 0.03125f}, i) == -1.0f / 64.0f);
        CHECK(shift({.depth_bias = 4, .slope_scaled_depth_bias = 2.0f}, i) == 2.0f / 64.0f + 0x1p-22f);
    }
}

namespace {

/// 15.10 operation by operation in float32.
float d3d_bias(Format format, const RasterState& raster, const std::array<float, 3>& z, float max_slope) {
    float r = 0;
    if (format == Format::D32Float) {
        int exponent = 0;
        std::frexp(std::max({std::fabs(z[0]), std::fabs(z[1]), std::fabs(z[2])}), &exponent);  // mantissa in [1/2, 1)
        r = std::ldexp(1.0f, exponent - 1 - 23);
    } else {
        r = static_cast<float>(1.0 / (format == Format::D16 ? 65535.0 : 16777215.0));
    }
    const float constant = static_cast<float>(raster.depth_bias) * r;
    float bias = constant;
    if (raster.slope_scaled_depth_bias != 0.0f) {
        const float sloped = raster.slope_scaled_depth_bias * max_slope;
        bias = constant + sloped;
    }
    if (raster.depth_bias_clamp > 0.0f) bias = std::min(raster.depth_bias_clamp, bias);
    if (raster.depth_bias_clamp < 0.0f) bias = std::max(raster.depth_bias_clamp, bias);
    return bias;
}

/// Draws triangles whose first corner is the centre of a pixel, where depth is that of the vertex, to the bit.
class CornerCanvas {
public:
    explicit CornerCanvas(Format format)
        : format_(format), target_(device_.create_texture("depth", {.format = format, .width = 4, .height = 4})) {}

    std::uint32_t code(const std::array<float, 3>& z, const RasterState& raster) {
        // Sides of 4 pixels from (1/2, 1/2): half a pixel is a quarter of the clip space's half.
        const std::vector<TestVertex> v{
            {-0.75f, 0.75f, z[0], 1, 0, 0}, {1.25f, 0.75f, z[1], 1, 0, 0}, {-0.75f, -1.25f, z[2], 1, 0, 0}};
        Draw draw = make_draw(depth_only_program(), upload(device_, v), 0, 3);
        draw.depth = target_;
        draw.raster = raster;
        draw.depth_state.compare = CompareOp::Always;
        device_.execute(draw);
        return codes_of(device_.texture(target_))[0];
    }
    void check(const std::array<float, 3>& z, const RasterState& raster) {
        const float max_slope = std::max(std::fabs(z[1] - z[0]), std::fabs(z[2] - z[0])) / 4.0f;
        const float bias = d3d_bias(format_, raster, z, max_slope);
        const std::uint32_t expected = depth_code_of(format_, z[0] + bias);
        const std::uint32_t got = code(z, raster);
        if (got != expected)
            FAIL(fmt::format(
                "{}: z {:a} {:a} {:a}, bias {}, slope-scaled {:a}, clamp {:a}: code {:#x}, expected {:#x} (bias {:a})",
                name_of(format_), z[0], z[1], z[2], raster.depth_bias, raster.slope_scaled_depth_bias, raster.depth_bias_clamp,
                got, expected, bias));
    }

private:
    Device device_{Profile{}, 1};
    Format format_;
    TextureId target_;
};

}  // namespace

TEST_CASE("depth bias is computed and added in float32", "[depth][15.10]") {
    for (const Format format : {Format::D16, Format::D24, Format::D32Float}) {
        CornerCanvas canvas(format);
        const double codes = format == Format::D16 ? 65535.0 : 16777215.0;
        oracle::Random random(static_cast<std::uint64_t>(format));
        for (int steps = 1; steps <= 300; ++steps) {
            const int bias = steps % 2 == 0 ? steps : -steps;
            // Halfway between two codes the last bit of the bias shows; small depths keep more of it.
            const auto tie = static_cast<float>((random.integer(400, 60000) + 0.5) / codes);
            for (const float z0 : {tie, random.unit() * 0x1p-12f + 0x1p-10f, random.unit()}) {
                canvas.check({z0, z0, z0}, {.depth_bias = bias});
                const std::array<float, 3> slope{z0, z0 * random.unit(), z0 * random.unit()};
                const float scale = random.in(-3.0f, 3.0f);
                const float limit = z0 * random.unit() * 0.25f;
                for (const float clamp : {0.0f, limit, -limit})
                    canvas.check(slope, {.depth_bias = bias, .slope_scaled_depth_bias = scale, .depth_bias_clamp = clamp});
            }
        }
    }
}

TEST_CASE("depth beyond the range after bias is clamped per pixel", "[depth][17.10]") {
    for (const Format format : {Format::D16, Format::D24, Format::D32Float}) {
        for (const std::uint32_t code :
             biased(format, {0.999f, 0.999f, 0.999f}, {.slope_scaled_depth_bias = 0.0f, .depth_bias_clamp = 0.0f}))
            REQUIRE(code == depth_code_of(format, 0.999f));
        const int many = format == Format::D16 ? 70000 : 200000000;
        for (const std::uint32_t code : biased(format, {0.5f, 0.5f, 0.5f}, {.depth_bias = many}))
            REQUIRE(code == depth_code_of(format, 1.0f));
        for (const std::uint32_t code : biased(format, {0.5f, 0.5f, 0.5f}, {.depth_bias = -many})) REQUIRE(code == 0u);
    }
}
