// D3D11.3 17.10: depth is clamped to the viewport's range behind the pixel functor, which sees it unclamped (15.4, 16.9.2.1).
#include "tests/oracle/output_merger.h"
#include "tests/oracle/raster.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t code_of(Format format, float z) {
    if (format == Format::D16) return oracle::unorm_code(z, 16);
    if (format == Format::D24UnormS8) return oracle::unorm_code(z, 24);
    return std::bit_cast<std::uint32_t>(z);
}

}  // namespace

TEST_CASE("interpolated depth beyond the range is clamped to it and the functor sees it as it is", "[17.10][depth]") {
    for (const Format format : {Format::D16, Format::D24UnormS8, Format::D32Float}) {
        for (const auto& [low, high] : {std::pair{0.0f, 1.0f}, {0.25f, 0.75f}, {0.5f, 0.5f}}) {
            for (const bool pixel_functor : {false, true}) {
                Canvas canvas(load_profile("d3d11"), 16, 2);
                const TextureId depth = canvas.target(format);
                // From -1 at the left side to 3 at the right one, in the viewport's range.
                std::vector<TestVertex> v = canvas.corners({0, 0, 16, 2}, 0.0f);
                for (TestVertex& vertex : v) vertex.z = vertex.x < 0 ? -1.0f : 3.0f;
                Draw draw = make_draw(pixel_functor ? inspect_program() : depth_only_program(), upload(canvas.device, v), 0, 6);
                if (pixel_functor)
                    for (std::size_t i = 0; i < 3; ++i) draw.color[i] = canvas.target(Format::Rgba32Float);
                draw.depth = depth;
                draw.depth_state.compare = CompareOp::Always;
                draw.raster.depth_clip = false;
                draw.viewport = {0, 0, 16, 2, low, high};
                canvas.device.execute(draw);
                int below = 0;
                int above = 0;
                for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                    const float t = (static_cast<float>(i % 16) + 0.5f) / 16.0f;  // exact
                    const float z = low + (4.0f * t - 1.0f) * (high - low);
                    below += z < low ? 1 : 0;
                    above += z > high ? 1 : 0;
                    const float limited = z < low ? low : z > high ? high : z;
                    CHECK(canvas.code(depth, i) == code_of(format, limited));
                    if (pixel_functor) CHECK(canvas.value(draw.color[0].texture, i, 2) == z);
                }
                if (low < high) CHECK((below > 4 && above > 4));
            }
        }
    }
}

TEST_CASE("a shader's depth is clamped, NaN to the lower end", "[17.10][16.9.2][depth]") {
    const std::array values{0.5f, 0.0f, -0.0f, 1.0f, -1.0f, 2.0f, kInfinity, -kInfinity, kNan, 1e30f, 0.3f, 0.7f};
    for (const Format format : {Format::D16, Format::D24UnormS8, Format::D32Float}) {
        for (const auto& [low, high] : {std::pair{0.0f, 1.0f}, {0.25f, 0.625f}}) {
            Canvas canvas(load_profile("d3d11"), static_cast<int>(values.size()), 1);
            const TextureId depth = canvas.target(format);
            Image control;
            for (const float z : values) control.emplace_back(0.0f, z, 0.0f, 0.0f);
            Draw draw =
                canvas.everything(image_program(1, kDepth), 0.5f, {canvas.image(Image(values.size())), canvas.image(control)});
            draw.color[0] = canvas.target(Format::R8Unorm);
            draw.depth = depth;
            draw.depth_state.compare = CompareOp::Always;
            draw.viewport = {0, 0, static_cast<float>(values.size()), 1, low, high};
            canvas.device.execute(draw);
            for (std::size_t i = 0; i < values.size(); ++i) {
                // min(most, max(least, z)): NaN leaves the other operand.
                const float z = values[i] > low ? (values[i] < high ? values[i] : high) : low;
                INFO(format_info(format).name << " z " << values[i]);
                CHECK(canvas.code(depth, i) == code_of(format, z));
            }
        }
    }
}
