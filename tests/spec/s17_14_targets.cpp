// D3D11.3 17.14 to 17.16, 15.15: several targets, write masks, mips, slices, and primitives that choose their slice.
#include "tests/oracle/output_merger.h"
#include "tests/oracle/random.h"
#include "tests/unit/output_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

std::vector<Format> color_formats() {
    std::vector<Format> formats;
    for (const FormatInfo& info : kFormats)
        if (!info.is_depth) formats.push_back(info.format);
    return formats;
}

}  // namespace

TEST_CASE("eight targets of mixed formats under any write masks", "[17.14][17.15][targets]") {
    // Each takes its own colour in its own format; what the mask leaves out keeps its bits. Some slots are empty.
    const std::vector<Format> formats = color_formats();
    std::vector<int> seen(formats.size());
    for (const int samples : {1, 4}) {
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            Random random(seed);
            Canvas canvas(load_profile("d3d11"), 6, 4, samples, 2);
            const Profile& profile = canvas.device.profile();
            Image colors(canvas.pixels() * 8);
            for (glm::vec4& color : colors)
                for (int c = 0; c < 4; ++c) color[c] = random.in(-1.5f, 2.5f) * (random.chance(8) ? 1e4f : 1.0f);
            Draw draw = canvas.everything(image_program(8), 0.5f, {canvas.image(colors), canvas.image(Image(canvas.pixels()))});
            std::array<std::vector<std::uint32_t>, 8> before;
            std::array<Format, 8> chosen{};
            for (std::size_t t = 0; t < 8; ++t) {
                const std::size_t pick = (seed * 8 + t) % formats.size();
                chosen[t] = formats[pick];
                draw.output.blend[t].write_mask = random.chance(3) ? 15 : random.integer(0, 15);
                if (t != seed % 8 && random.chance(6)) continue;
                ++seen[pick];
                draw.color[t] = canvas.target(chosen[t]);
                const glm::vec4 clear(random.unit(), random.unit(), random.unit(), random.unit());
                canvas.device.execute(ClearColor{draw.color[t], clear});
                for (int c = 0; c < format_info(chosen[t]).components; ++c)
                    before[t].push_back(canvas.code(draw.color[t].texture, 0, c));
            }
            canvas.device.execute(draw);
            for (std::size_t t = 0; t < 8; ++t) {
                if (draw.color[t].texture == TextureId::None) continue;
                for (int s = 0; s < samples; ++s) {
                    for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                        for (int c = 0; c < format_info(chosen[t]).components; ++c) {
                            const auto value = static_cast<double>(colors[t * canvas.pixels() + i][c]);
                            const bool written = (draw.output.blend[t].write_mask >> c & 1) != 0;
                            const std::uint32_t expected = written ? oracle::component_code(chosen[t], profile, value, c)
                                                                   : before[t][static_cast<std::size_t>(c)];
                            const std::uint32_t found = canvas.code(draw.color[t].texture, i, c, 0, s);
                            if (found == expected) continue;
                            FAIL(fmt::format("seed {}, target {} {}, pixel {}, sample {}, component {}: {:#x}, expected {:#x}",
                                             seed, t, format_info(chosen[t]).name, i, s, c, found, expected));
                        }
                    }
                }
            }
        }
    }
    for (const int count : seen) CHECK(count > 5);
}

TEST_CASE("write masks do not limit what blending reads", "[17.15][blend]") {
    Canvas canvas(load_profile("d3d11"), 2, 2);
    const TextureId target = canvas.target(Format::Rgba32Float);
    canvas.device.execute(ClearColor{target, {0.5f, 0.25f, 8.0f, 3.0f}});
    Draw draw = canvas.everything(image_program(1), 0.5f, {canvas.image(Image(4, glm::vec4(1.0f))), canvas.image(Image(4))});
    draw.color[0] = target;
    draw.output.blend[0] = {.enable = true, .src = BlendFactor::DstAlpha, .dst = BlendFactor::One, .write_mask = 1};
    canvas.device.execute(draw);
    CHECK(canvas.value(target, 0, 0) == 3.5f);
    CHECK(canvas.value(target, 0, 1) == 0.25f);
    CHECK(canvas.value(target, 0, 3) == 3.0f);
}

TEST_CASE("a view is one level and some slices, and the rest of the texture stays", "[17.14][5.2][targets]") {
    for (int level = 0; level < 4; ++level) {
        for (int first = 0; first < 3; ++first) {
            Device device(load_profile("d3d11"), 2);
            const TextureDesc desc{.width = 13, .height = 9, .levels = 4, .kind = TextureKind::Array, .layers = 4};
            TextureDesc color_desc = desc;
            color_desc.format = Format::R32Float;
            TextureDesc depth_desc = desc;
            depth_desc.format = Format::D32FloatS8;
            const TextureId color = device.create_texture("color", color_desc);
            const TextureId depth = device.create_texture("depth", depth_desc);
            for (int l = 0; l < 4; ++l) {
                device.execute(ClearColor{TargetView(color, l, 0, 4), glm::vec4(-1.0f)});
                device.execute(ClearDepth{TargetView(depth, l, 0, 4), 1.0f});
                device.execute(ClearStencil{TargetView(depth, l, 0, 4), 7});
            }
            // Two slices; the triangle of slice n has the value n in it. Slices 5 and -1 are out of range: 0.
            std::vector<TestVertex> v;
            for (const float slice : {1.0f, 0.0f})
                for (const auto& [x, y] : {std::pair{-1.0f, 1.0f}, {3.0f, 1.0f}, {-1.0f, -3.0f}})
                    v.push_back({x, y, 0.5f, 1, slice, 0});
            Draw draw = make_draw(layered_program(), upload(device, v), 0, 6);
            draw.pixel_constants = pixel_constants(id_program());  // neither has constants
            draw.color[0] = TargetView(color, level, first, 2);
            draw.depth = TargetView(depth, level, first, 2);
            draw.stencil.test = true;
            draw.stencil.front.pass = draw.stencil.back.pass = StencilOp::Increment;
            device.execute(draw);
            for (int l = 0; l < 4; ++l) {
                for (int layer = 0; layer < 4; ++layer) {
                    const bool drawn = l == level && (layer == first || layer == first + 1);
                    const auto bytes = device.texture(color).level_bytes(l, layer);
                    const auto depths = device.texture(depth).level_bytes(l, layer);
                    for (std::size_t i = 0; i < bytes.size(); i += 4) {
                        float value = 0;
                        float z = 0;
                        std::memcpy(&value, &bytes[i], 4);
                        std::memcpy(&z, &depths[i], 4);
                        REQUIRE(value == (drawn ? static_cast<float>(layer - first) : -1.0f));
                        REQUIRE(z == (drawn ? 0.5f : 1.0f));
                    }
                    for (const std::uint8_t stencil : device.texture(depth).stencil_bytes(l, layer))
                        REQUIRE(stencil == (drawn ? 8 : 7));
                }
            }
        }
    }
}

TEST_CASE("primitives choose slice and viewport by their leading vertex; out of range counts as 0",
          "[15.15][15.8.1][targets]") {
    struct Case {
        float slice, viewport;
        std::size_t expected_slice, expected_viewport;
    };
    const std::array cases{Case{0, 0, 0, 0},
                           Case{1, 2, 1, 2},
                           Case{5, 1, 5, 1},
                           Case{6, 1, 0, 1},
                           Case{-1, 1, 0, 1},
                           Case{2, 3, 2, 0},
                           Case{3, -1, 3, 0},
                           Case{2147483520.0f, 2, 0, 2},
                           Case{4, 2147483520.0f, 4, 0},
                           Case{65536, 1, 0, 1},
                           Case{65537, 1, 0, 1},
                           Case{1048577, 1048577, 0, 0}};
    const std::array viewports{Viewport{0, 0, 4, 4}, Viewport{4, 0, 4, 4, 0.0f, 0.5f}, Viewport{0, 4, 8, 4}};
    const std::array<PixelRect, 3> areas{PixelRect{0, 0, 4, 4}, PixelRect{4, 0, 8, 4}, PixelRect{0, 4, 8, 8}};
    for (const bool last : {false, true}) {
        for (const int samples : {1, 2}) {
            for (const Case& c : cases) {
                Canvas canvas(load_profile("d3d11"), 8, 8, samples, 2);
                const TextureId color = canvas.target(Format::Rgba32Float, 6);
                const TextureId depth = canvas.target(Format::D32Float, 6);
                canvas.device.execute(ClearColor{TargetView(color, 0, 0, 6), glm::vec4(-1.0f)});
                canvas.device.execute(ClearDepth{TargetView(depth, 0, 0, 6), 1.0f});
                std::vector<TestVertex> v{{-1, 1, 0.5f, 1, 3, 1}, {3, 1, 0.5f, 1, 3, 1}, {-1, -3, 0.5f, 1, 3, 1}};
                TestVertex& leading = v[last ? 2 : 0];
                leading.a = c.slice;
                leading.b = c.viewport;
                Draw draw = make_draw(layered_program(), upload(canvas.device, v), 0, 3);
                draw.pixel_constants = pixel_constants(id_program());
                draw.raster.provoking = last ? ProvokingVertex::Last : ProvokingVertex::First;
                draw.viewports = viewports;
                draw.color[0] = TargetView(color, 0, 0, 6);
                draw.depth = TargetView(depth, 0, 0, 6);
                canvas.device.execute(draw);
                const PixelRect& area = areas[c.expected_viewport];
                for (int layer = 0; layer < 6; ++layer) {
                    for (std::size_t i = 0; i < 64; ++i) {
                        const int x = static_cast<int>(i % 8);
                        const int y = static_cast<int>(i / 8);
                        const bool drawn = static_cast<std::size_t>(layer) == c.expected_slice && x >= area.x0 && x < area.x1 &&
                                           y >= area.y0 && y < area.y1;
                        INFO("slice " << c.slice << ", viewport " << c.viewport << ", layer " << layer << ", pixel " << i);
                        REQUIRE(canvas.value(color, i, 2, layer, samples - 1) ==
                                (drawn ? static_cast<float>(c.expected_slice) : -1.0f));
                        REQUIRE(canvas.value(depth, i, 0, layer, samples - 1) ==
                                (drawn ? (c.expected_viewport == 1 ? 0.25f : 0.5f) : 1.0f));
                    }
                }
            }
        }
    }
}

TEST_CASE("layered depth-only drawing into the faces of a cube", "[15.15][targets]") {
    Device device(load_profile("d3d11"), 2);
    const TextureId cube = device.create_texture(
        "cube", {.format = Format::D16, .width = 9, .height = 9, .kind = TextureKind::Cube, .layers = kCubeFaces});
    device.execute(ClearDepth{TargetView(cube, 0, 0, kCubeFaces), 1.0f});
    std::vector<TestVertex> v;
    for (int face = kCubeFaces - 1; face >= 0; --face)
        for (const auto& [x, y] : {std::pair{-1.0f, 1.0f}, {3.0f, 1.0f}, {-1.0f, -3.0f}})
            v.push_back({x, y, static_cast<float>(face) / 15.0f, 1, static_cast<float>(face), 0});
    Draw draw = make_draw(layered_depth_program(), upload(device, v), 0, static_cast<std::uint32_t>(v.size()));
    draw.depth = TargetView(cube, 0, 0, kCubeFaces);
    device.execute(draw);
    for (int face = 0; face < kCubeFaces; ++face) {
        const auto bytes = device.texture(cube).level_bytes(0, face);
        for (std::size_t i = 0; i < bytes.size(); i += 4) {
            std::uint32_t code = 0;
            std::memcpy(&code, &bytes[i], 4);
            REQUIRE(code == static_cast<std::uint32_t>(face) * 4369u);
        }
    }
}
