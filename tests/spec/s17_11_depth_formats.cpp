// D3D11.3 17.10, 17.11: depth is clamped, converted to the format and stored; every code is exact.
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

std::uint32_t depth_code_of(Format format, float z) {
    if (format == Format::D16) return oracle::unorm_code(z, 16);
    if (format == Format::D24) return oracle::unorm_code(z, 24);
    const float limited = z > 0.0f ? (z < 1.0f ? z : 1.0f) : 0.0f;
    // Operands below the normal range count as 0 under the d3d11 profile. D3D11.3 3.1.3.2
    return limited < 0x1p-126f ? 0u : std::bit_cast<std::uint32_t>(limited);
}

}  // namespace

TEST_CASE("depth codes of every format are exact", "[depth][17.11][3.2.3.6]") {
    for (const Format format : {Format::D16, Format::D24, Format::D32Float}) {
        const int bits = format == Format::D16 ? 16 : 24;
        const std::uint32_t last = (1u << bits) - 1u;
        Random random(5);
        std::vector<float> depths{0.0f, -0.0f, 1.0f, 0x1p-126f, 0x1p-30f, 0x1.fffffep-1f, 0.5f, 0x1.000002p-1f};
        for (int k = 0; k < 400; ++k) {
            // Around the boundary between two codes: (n + 1/2) / last.
            const auto n = static_cast<std::uint32_t>(random.between(0, last - 1));
            float boundary = static_cast<float>((static_cast<double>(n) + 0.5) / last);
            for (const float z : {boundary, std::nextafter(boundary, 0.0f), std::nextafter(boundary, 1.0f), random.unit()})
                depths.push_back(z);
        }
        Device device(Profile{}, 1);
        const TextureId target = device.create_texture("depth", {.format = format, .width = 2, .height = 2});
        std::vector<TestVertex> vertices;
        for (const float z : depths)
            for (const auto& [x, y] : {std::pair{-1.0f, 1.0f}, std::pair{3.0f, 1.0f}, std::pair{-1.0f, -3.0f}})
                vertices.push_back({x, y, z, 1, 0, 0});
        Draw draw = make_draw(depth_only_program(), upload(device, vertices), 0, 3);
        draw.depth = target;
        draw.depth_state.compare = CompareOp::Always;
        for (std::size_t k = 0; k < depths.size(); ++k) {
            draw.first = static_cast<std::uint32_t>(3 * k);
            device.execute(draw);
            for (const std::uint32_t code : codes_of(device.texture(target)))
                if (code != depth_code_of(format, depths[k]))
                    FAIL(fmt::format("{} z {:a}: code {:#x}, expected {:#x}", name_of(format), depths[k], code,
                                     depth_code_of(format, depths[k])));
            // A clear to the same depth stores the same code.
            device.execute(ClearDepth{target, depths[k]});
            CHECK(codes_of(device.texture(target))[0] == depth_code_of(format, depths[k]));
        }
    }
}
