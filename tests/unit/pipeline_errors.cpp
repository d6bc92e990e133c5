// What the device refuses: Error, and nothing has changed.
#include "sim/error.h"
#include "tests/unit/pipeline_programs.h"

#include <catch2/catch.hpp>

#include <climits>
#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

struct Bench {
    Device device{Profile{}, 1};
    BufferId vertices;
    BufferId indices;
    TextureId color, wide, depth, small_depth;
    Draw draw;
    std::vector<float> before;

    Bench() {
        const std::vector<TestVertex> v{{-1, 1, 0.5f, 1, 5, 0}, {3, 1, 0.5f, 1, 5, 0}, {-1, -3, 0.5f, 1, 5, 0}};
        vertices = upload(device, v);
        const std::array<std::uint32_t, 4> index{0, 1, 2, 3};
        indices = device.create_buffer("indices", std::as_bytes(std::span(index)));
        color = device.create_texture("color", {.format = Format::R32Float, .width = 8, .height = 4});
        wide = device.create_texture("wide", {.format = Format::R32Float, .width = 9, .height = 4});
        depth = device.create_texture("depth", {.format = Format::D16, .width = 8, .height = 4});
        small_depth = device.create_texture("small", {.format = Format::D16, .width = 4, .height = 4});
        device.execute(ClearColor{color, glm::vec4(2.0f)});
        draw = make_draw(id_program(), vertices, 0, 3);
        draw.color[0] = color;
        draw.depth = depth;
        device.execute(ClearDepth{depth, 1.0f});
        before = floats_of(device.texture(color));
        device.enable_counters(true);
    }

    /// The draw throws, the target keeps its bytes, nothing was counted, and a correct draw still works.
    void refuses(const Draw& bad) {
        CHECK_THROWS_AS(device.execute(bad), Error);
        CHECK(floats_of(device.texture(color)) == before);
        CHECK(device.take_counters() == Counters{});
    }
};

}  // namespace

TEST_CASE("a good draw works on the bench", "[errors]") {
    Bench b;
    b.device.execute(b.draw);
    for (const float id : floats_of(b.device.texture(b.color))) CHECK(id == 5.0f);
    Bench c;
    c.draw.indices = c.indices;
    c.device.execute(c.draw);
    for (const float id : floats_of(c.device.texture(c.color))) CHECK(id == 5.0f);
}

TEST_CASE("draws with bad arguments throw and change nothing", "[errors]") {
    Bench b;
    const auto with = [&](auto change) {
        Draw bad = b.draw;
        change(bad);
        b.refuses(bad);
    };
    with([](Draw& d) { d.program = nullptr; });
    with([](Draw& d) { d.vertex_constants = {}; });
    with([](Draw& d) { d.pixel_constants = {}; });
    with([](Draw& d) { d.vertices = BufferId::None; });
    with([](Draw& d) { d.vertices = static_cast<BufferId>(99); });
    with([](Draw& d) { d.indices = static_cast<BufferId>(99); });
    with([](Draw& d) { d.count = 4; });
    with([](Draw& d) { d.count = 6; });
    with([](Draw& d) { d.first = 1; });
    with([](Draw& d) { d.first = UINT_MAX; });
    with([](Draw& d) { d.count = UINT_MAX; });                   // a multiple of 3
    with([&](Draw& d) { d.indices = b.indices, d.first = 1; });  // index 3 is past the vertices
    with([&](Draw& d) { d.indices = b.indices, d.first = 2; });  // past the indices
    with([](Draw& d) { d.color[0] = TextureId::None, d.depth = TextureId::None; });
    with([](Draw& d) { d.color[0] = static_cast<TextureId>(99); });
    with([&](Draw& d) { d.color[0] = b.depth; });
    with([&](Draw& d) { d.color[0] = b.wide; });
    with([&](Draw& d) { d.depth = b.color; });
    with([&](Draw& d) { d.depth = b.small_depth; });
    with([](Draw& d) { d.depth = static_cast<TextureId>(99); });
    with([](Draw& d) { d.viewport = {4, 0, -2, 4}; });
    with([](Draw& d) { d.viewport = {0, 0, 4, 0}; });
    with([](Draw& d) { d.viewport = {0, 0, 0, 4}; });
    with([](Draw& d) { d.viewport = {1, 0, 0, 0}; });
    with([](Draw& d) { d.viewport = {0, 0, 4, std::numeric_limits<float>::quiet_NaN()}; });
    with([](Draw& d) { d.viewport = {0, 0, 4, 4, 0.5f, 0.25f}; });
    with([](Draw& d) { d.viewport = {0, 0, 4, 4, -0.5f, 1.0f}; });
    with([](Draw& d) { d.viewport = {0, 0, 4, 4, 0.0f, std::numeric_limits<float>::quiet_NaN()}; });
    b.device.execute(b.draw);
    for (const float id : floats_of(b.device.texture(b.color))) CHECK(id == 5.0f);
}

TEST_CASE("hostile viewports do not overflow", "[errors]") {
    Bench b;
    constexpr float kHuge = 3e38f;
    for (const Viewport& v : {Viewport{kHuge, 0, 1, 1}, Viewport{0, kHuge, 1, kHuge}, Viewport{-kHuge, 0, kHuge, 4},
                              Viewport{1, 0, kHuge, 4}, Viewport{32000, 0, 1000, 4}, Viewport{-32769, 0, 8, 4}}) {
        Draw bad = b.draw;
        bad.viewport = v;
        b.refuses(bad);
    }
}

TEST_CASE("resources with bad arguments throw and change nothing", "[errors]") {
    Device device(Profile{}, 1);
    const TextureId color = device.create_texture("c", {.format = Format::Rgba8Unorm, .width = 4, .height = 4, .levels = 2});
    const TextureId depth = device.create_texture("d", {.format = Format::D24, .width = 4, .height = 4});
    for (const TextureDesc& desc :
         {TextureDesc{Format::R8Unorm, 0, 4, 1}, TextureDesc{Format::R8Unorm, 4, 0, 1}, TextureDesc{Format::R8Unorm, -1, 4, 1},
          TextureDesc{Format::R8Unorm, 16385, 4, 1}, TextureDesc{Format::R8Unorm, 4, 4, 0},
          TextureDesc{Format::R8Unorm, 4, 4, 4}, TextureDesc{Format::Rgba32Float, 16384, 16384, 1}})
        CHECK_THROWS_AS(device.create_texture("bad", desc), Error);
    CHECK_THROWS_AS(device.texture(static_cast<TextureId>(3)), Error);
    CHECK_THROWS_AS(device.texture(TextureId::None), Error);
    CHECK_THROWS_AS(device.buffer(BufferId::None), Error);
    CHECK_THROWS_AS(device.buffer(static_cast<BufferId>(1)), Error);
    CHECK_THROWS_AS(device.execute(CreateTexture{static_cast<TextureId>(7), "gap", {}}), Error);
    CHECK_THROWS_AS(device.execute(CreateTexture{color, "again", {}}), Error);
    CHECK_THROWS_AS(device.execute(CreateBuffer{static_cast<BufferId>(2), "gap", {}}), Error);
    CHECK(device.create_texture("next", {}) == static_cast<TextureId>(3));

    const std::vector<std::byte> bytes(4 * 4 * 4, std::byte{0x5a});
    CHECK_NOTHROW(device.execute(WriteTexture{color, 0, bytes}));
    CHECK(device.texture(color).level_bytes(0) == bytes);
    CHECK_THROWS_AS(device.execute(WriteTexture{color, 1, bytes}), Error);
    CHECK_THROWS_AS(device.execute(WriteTexture{color, 2, bytes}), Error);
    CHECK_THROWS_AS(device.execute(WriteTexture{color, -1, bytes}), Error);
    CHECK_THROWS_AS(device.execute(WriteTexture{color, 0, std::span(bytes).first(63)}), Error);
    CHECK_THROWS_AS(device.execute(WriteTexture{static_cast<TextureId>(44), 0, bytes}), Error);
    CHECK_THROWS_AS(device.execute(ClearColor{depth, {}}), Error);
    CHECK_THROWS_AS(device.execute(ClearDepth{color, 1.0f}), Error);
    CHECK_THROWS_AS(device.execute(GenerateMips{static_cast<TextureId>(44)}), Error);
    CHECK(device.texture(color).level_bytes(0) == bytes);
}

TEST_CASE("a target may not be two targets at once", "[errors]") {
    // Two colour targets of one draw that are the same texture would be written in an order that nobody defines.
    Device device(Profile{}, 1);
    const std::vector<TestVertex> v{{-1, 1, 0.5f, 1, 5, 0}, {3, 1, 0.5f, 1, 5, 0}, {-1, -3, 0.5f, 1, 5, 0}};
    Draw draw = make_draw(inspect_program(), upload(device, v), 0, 3);
    draw.color[0] = device.create_texture("a", {.format = Format::Rgba32Float, .width = 4, .height = 4});
    draw.color[1] = draw.color[0];
    draw.color[2] = device.create_texture("b", {.format = Format::Rgba32Float, .width = 4, .height = 4});
    CHECK_THROWS_AS(device.execute(draw), Error);
}
