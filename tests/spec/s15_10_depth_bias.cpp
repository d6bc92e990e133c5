// D3D11.3 15.10: constant and slope-scaled depth bias, its clamp, and the clamp of depth behind it (17.10).
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <catch2/catch.hpp>

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
