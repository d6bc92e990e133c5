// What the device refuses: Error, and nothing has changed.
#include "sim/error.h"
#include "tests/unit/output_programs.h"

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

namespace {

/// Targets of all kinds beside those of a draw that works, for changes that make it impossible.
struct StateBench {
    Canvas canvas;
    TextureId color, other, integer, single, wide, array, depth, report;
    BufferId vertices, indices, instances;
    Draw draw;
    std::vector<std::byte> before;

    explicit StateBench(const char* profile = "d3d11", int samples = 4, Format format = Format::Rgba8Unorm)
        : canvas(load_profile(profile), 8, 4, samples) {
        Device& device = canvas.device;
        const auto create = [&](Format f, int width, int layers, int count) {
            return device.create_texture("target", {.format = f,
                                                    .width = width,
                                                    .height = 4,
                                                    .kind = layers > 1 ? TextureKind::Array : TextureKind::Flat,
                                                    .layers = layers,
                                                    .samples = count});
        };
        color = create(format, 8, 1, samples);
        other = create(Format::R8Unorm, 8, 1, samples);
        integer = create(Format::R32Uint, 8, 1, samples);
        single = create(Format::R8Unorm, 8, 1, samples == 1 ? 2 : 1);
        wide = create(Format::R8Unorm, 16, 1, samples);
        array = create(Format::R8Unorm, 8, 3, samples);
        depth = create(Format::D24UnormS8, 8, 1, samples);
        report = create(Format::R32Uint, 8, 1, 1);
        const std::array<std::uint32_t, 6> index{0, 1, 2, 3, 4, 5};
        indices = device.create_buffer("indices", std::as_bytes(std::span(index)));
        const std::array<float, 6> instance{};
        instances = device.create_buffer("instances", std::as_bytes(std::span(instance)));
        draw =
            canvas.everything(image_program(8), 0.5f, {canvas.image(Image(32 * 8, glm::vec4(1.0f))), canvas.image(Image(32))});
        vertices = draw.vertices;
        draw.color[0] = color;
        draw.color[1] = other;
        draw.depth = depth;
        device.execute(ClearColor{color, glm::vec4(0.25f)});
        device.execute(ClearDepth{depth, 1.0f});
        before = bytes();
        device.enable_counters(true);
    }
    [[nodiscard]] std::vector<std::byte> bytes() const {
        std::vector<std::byte> all;
        for (const TextureId id : {color, other, depth}) {
            for (int s = 0; s < canvas.samples; ++s) {
                const auto plane = canvas.device.texture(id).level_bytes(0, 0, s);
                all.insert(all.end(), plane.begin(), plane.end());
            }
        }
        return all;
    }

    /// The changed draw is refused with a message that has all of these words, and nothing has happened.
    template <class Change>
    void refuses(const Change& change, std::initializer_list<std::string_view> words) {
        Draw bad = draw;
        bad.label = "shadows";
        change(bad);
        std::string message;
        try {
            canvas.device.execute(bad);
        } catch (const Error& error) {
            message = error.what();
        }
        CHECK(message.find("draw 'shadows'") != std::string::npos);
        for (const std::string_view word : words) {
            INFO("message: " << message);
            CHECK(message.find(word) != std::string::npos);
        }
        CHECK(bytes() == before);
        CHECK(canvas.device.take_counters() == Counters{});
    }
};

}  // namespace

TEST_CASE("impossible targets are refused with the reason", "[errors][17.14]") {
    StateBench b;
    b.refuses([&](Draw& d) { d.color[1] = b.wide; }, {"8x4", "16x4", "expected one size"});
    b.refuses([&](Draw& d) { d.color[2] = b.single; }, {"4 and 1 samples", "expected one count"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 0, 0, 2); }, {"1 and 2 layers", "expected one count"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 0, 2, 2); }, {"colour target 2", "layers 2 to 3", "0 to 2"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 0, -1); }, {"colour target 2", "layers -1"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 0, 0, 0); }, {"colour target 2"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 0, INT_MAX, INT_MAX); }, {"colour target 2"});
    b.refuses([&](Draw& d) { d.color[2] = TargetView(b.array, 1); }, {"colour target 2", "level 1", "0 to 0"});
    b.refuses([&](Draw& d) { d.depth = TargetView(b.depth, -1); }, {"depth target", "level -1"});
    b.refuses([&](Draw& d) { d.color[7] = b.color; }, {"colour target 7", "twice"});
    b.refuses([&](Draw& d) { d.color[3] = d.color[4] = TargetView(b.array, 0, 1); }, {"colour target 4", "twice"});
    b.refuses([&](Draw& d) { d.color[3] = b.depth; }, {"colour target 3", "depth format"});
    b.refuses([&](Draw& d) { d.depth = b.other; }, {"depth target", "r8unorm"});
    b.refuses([&](Draw& d) { d.color = {}, d.depth = {}; }, {"no target at all"});
    b.refuses([&](Draw& d) { d.derivative_report = b.integer; }, {"derivative report", "4 samples", "r32ui"});
    b.refuses([&](Draw& d) { d.derivative_report = b.single; }, {"derivative report", "r8unorm", "expected"});
    const TextureId narrow = b.canvas.device.create_texture("narrow", {.format = Format::R32Uint, .width = 7, .height = 4});
    b.canvas.device.take_counters();
    b.refuses([&](Draw& d) { d.derivative_report = narrow; }, {"derivative report", "7x4", "8x4"});
    StateBench one("d3d11", 1);
    one.refuses([&](Draw& d) { d.color[1] = one.integer, d.derivative_report = one.integer; },
                {"derivative report", "colour target 1"});
    // Two slices of one texture are two targets. D3D11.3 17.14
    b.draw.color[3] = TargetView(b.array, 0, 0);
    b.draw.color[4] = TargetView(b.array, 0, 2);
    b.draw.derivative_report = b.report;
    b.canvas.device.execute(b.draw);
    CHECK(b.bytes() != b.before);
}

TEST_CASE("impossible blending is refused with the reason", "[errors][17.6][17.5]") {
    StateBench b;
    b.refuses([&](Draw& d) { d.color[1] = b.integer, d.output.blend[1].enable = true; }, {"target 1", "r32ui", "integers"});
    b.refuses([](Draw& d) { d.output.blend[1].write_mask = 16; }, {"write mask 16", "target 1", "0 to 15"});
    b.refuses([](Draw& d) { d.output.blend[0].write_mask = -1; }, {"write mask -1", "target 0"});
    const BlendState dual{.enable = true, .src = BlendFactor::Src1Alpha};
    b.refuses([&](Draw& d) { d.output.blend[0] = dual; }, {"target 0", "second colour", "target 0 alone"});
    b.refuses([&](Draw& d) { d.output.blend[1] = dual; }, {"target 1", "second colour"});
    b.refuses([&](Draw& d) { d.color[1] = {}, d.output.blend[0] = dual, d.output.blend[0].op = BlendOp::Min; },
              {"second colour", "add, subtract"});
    b.refuses([&](Draw& d) { d.color[1] = {}, d.output.blend[0] = dual, d.output.blend[0].op_alpha = BlendOp::Max; },
              {"second colour", "add, subtract"});
    b.refuses([&](Draw& d) { d.program = &image_program(1), d.color[1] = {}, d.output.blend[0] = dual; },
              {"second colour", "writes two colours"});
    // A state that is off, or of a target that is not there, says nothing.
    b.draw.color[1] = {};
    b.draw.output.blend[0] = dual;
    b.draw.output.blend[1] = {.enable = true, .dst = BlendFactor::InvSrc1Color, .op = BlendOp::Max};
    b.canvas.device.execute(b.draw);
    CHECK(b.bytes() != b.before);
}

TEST_CASE("a profile refuses what its hardware could not do", "[errors]") {
    StateBench half("nv40", 1, Format::Rgba16Float);
    half.draw.program = &image_program(2);
    half.draw.color[1] = TextureId::None;
    half.refuses([](Draw& d) { d.program = &image_program(8); }, {"8 targets", "nv40", "has 4"});
    half.draw.output.blend[0].enable = true;  // halves it blends
    half.canvas.device.execute(half.draw);
    StateBench full("nv40", 1, Format::Rgba32Float);
    full.draw.program = &image_program(2);
    full.draw.color[1] = TextureId::None;
    full.refuses([](Draw& d) { d.output.blend[0].enable = true; }, {"target 0", "nv40", "rgba32f"});
    full.canvas.device.execute(full.draw);
    const auto refuses = [](const TextureDesc& desc, std::initializer_list<std::string_view> words) {
        Device device(load_profile("nv40"), 1);
        std::string message;
        try {
            (void)device.create_texture("bad", desc);
        } catch (const Error& error) {
            message = error.what();
        }
        for (const std::string_view word : words) {
            INFO("message: " << message);
            CHECK(message.find(word) != std::string::npos);
        }
        CHECK(device.create_texture("good", {}) == static_cast<TextureId>(1));
    };
    refuses({.samples = 8}, {"8 samples", "nv40", "at most 4"});
    refuses({.format = Format::R16Float, .samples = 4}, {"4 samples", "r16f", "nv40"});
    refuses({.format = Format::R11G11B10Float, .samples = 2}, {"r11g11b10f", "nv40"});
    // Three samples there are nowhere, several samples with mips or faces neither. D3D11.3 19.2
    Device device(load_profile("d3d11"), 1);
    CHECK_THROWS_AS(device.create_texture("bad", {.samples = 3}), Error);
    CHECK_THROWS_AS(device.create_texture("bad", {.samples = 0}), Error);
    CHECK_THROWS_AS(device.create_texture("bad", {.samples = 32}), Error);
    CHECK_THROWS_AS(device.create_texture("bad", {.width = 4, .height = 4, .levels = 2, .samples = 4}), Error);
    CHECK_THROWS_AS(device.create_texture("bad", {.kind = TextureKind::Cube, .layers = 6, .samples = 4}), Error);
}

TEST_CASE("stencil values, viewports and scissors out of range are refused", "[errors][15.7][15.8.1][17.12]") {
    StateBench b;
    for (const int value : {-1, 256, INT_MAX, INT_MIN}) {
        b.refuses([&](Draw& d) { d.stencil.reference = value; }, {"stencil", "0 to 255"});
        b.refuses([&](Draw& d) { d.stencil.read_mask = value; }, {"stencil", "0 to 255"});
        b.refuses([&](Draw& d) { d.stencil.write_mask = value; }, {"stencil", "0 to 255"});
    }
    const std::vector<Viewport> many(17, Viewport{0, 0, 8, 4});
    const std::vector<ScissorRect> scissors(17, ScissorRect{0, 0, 8, 4});
    b.refuses([&](Draw& d) { d.viewports = many; }, {"17 viewports", "1 to 16"});
    b.refuses([&](Draw& d) { d.viewports = std::span(many).first(3), d.scissors = std::span(scissors).first(2); },
              {"2 scissor", "3 viewports", "one each"});
    b.refuses([&](Draw& d) { d.scissors = std::span(scissors).first(2); }, {"2 scissor", "1 viewports"});
    std::vector<Viewport> bad(16, Viewport{0, 0, 8, 4});
    bad[15].max_depth = 1.5f;
    b.refuses([&](Draw& d) { d.viewports = bad; }, {"depth range", "1.5", "viewport 15"});
    bad[15] = {0, 0, -8, 4};
    b.refuses([&](Draw& d) { d.viewports = bad; }, {"viewport", "-8"});
    // Scissors may be empty, turned inside out or larger than everything.
    const std::array odd{ScissorRect{5, 5, 5, 5}, ScissorRect{7, 3, 1, 0}, ScissorRect{INT_MIN, INT_MIN, INT_MIN, INT_MAX}};
    for (const ScissorRect& rect : odd) {
        b.draw.scissors = std::span(&rect, 1);
        b.canvas.device.execute(b.draw);
        CHECK(b.bytes() == b.before);
    }
    const ScissorRect all{INT_MIN, INT_MIN, INT_MAX, INT_MAX};
    b.draw.scissors = std::span(&all, 1);
    b.canvas.device.execute(b.draw);
    CHECK(b.bytes() != b.before);
}

TEST_CASE("attributes that are missing are refused", "[errors]") {
    StateBench b;
    b.refuses([&](Draw& d) { d.instances = b.instances; }, {"buffer of instances", "reads none"});
    b.refuses([](Draw& d) { d.base_vertex = 1; }, {"base vertex 1", "without indices"});
    b.refuses([&](Draw& d) { d.indices = b.indices, d.base_vertex = 1, d.count = 6; }, {"vertex 6", "6 of 6 floats"});
    b.refuses([&](Draw& d) { d.indices = b.indices, d.base_vertex = -1; }, {"vertex -1"});
    b.refuses([&](Draw& d) { d.indices = b.indices, d.base_vertex = INT_MIN; }, {"vertex -2147483648"});
    b.refuses([&](Draw& d) { d.indices = b.indices, d.index_type = IndexType::Uint16, d.count = 13; },
              {"indices 0 to 12", "12"});
    b.refuses([](Draw& d) { d.count = 7; }, {"vertex 6"});
    b.refuses([](Draw& d) { d.pixel_constants = {}; }, {"0 bytes", "expects"});
}

TEST_CASE("a texture that a draw writes cannot be read by it", "[errors][17.13]") {
    StateBench b("d3d11", 1);
    const auto reads = [&](TextureId id) {
        b.canvas.constants.push_back({id, b.canvas.constants.front().control});
        return constants_of(b.canvas.constants.back());
    };
    b.refuses([&](Draw& d) { d.pixel_constants = reads(b.color); }, {"colors", "sampled and written"});
    b.refuses([&](Draw& d) { d.pixel_constants = reads(b.other); }, {"colors", "sampled and written"});
    b.refuses([&](Draw& d) { d.pixel_constants = reads(b.depth); }, {"colors", "sampled and written"});
    b.refuses([&](Draw& d) { d.pixel_constants = reads(b.report), d.derivative_report = b.report; }, {"sampled and written"});
    b.refuses(
        [&](Draw& d) {
            d.pixel_constants = reads(b.depth), d.depth_state.write = false;
            d.stencil.test = true, d.stencil.back.fail = StencilOp::Zero;
        },
        {"sampled and written"});
    const auto none = static_cast<TextureId>(4711);
    Draw bad = b.draw;
    bad.pixel_constants = reads(none);
    CHECK_THROWS_AS(b.canvas.device.execute(bad), Error);
    CHECK(b.bytes() == b.before);
}

TEST_CASE("resolves, clears and writes that cannot be are refused", "[errors][5.6.6]") {
    Device device(load_profile("d3d11"), 1);
    const auto create = [&](Format format, int samples, int width = 8, int layers = 1) {
        return device.create_texture("t", {.format = format,
                                           .width = width,
                                           .height = 4,
                                           .kind = layers > 1 ? TextureKind::Array : TextureKind::Flat,
                                           .layers = layers,
                                           .samples = samples});
    };
    const TextureId four = create(Format::R8Unorm, 4);
    const TextureId one = create(Format::R8Unorm, 1);
    const auto refuses = [&](const Command& command, std::string_view words) {
        std::string message;
        try {
            device.execute(command);
        } catch (const Error& error) {
            message = error.what();
        }
        INFO("message: " << message << ", expected in it: " << words);
        CHECK(message.find(words) != std::string::npos);
    };
    refuses(Resolve{one, one}, "one sample, expected several");
    refuses(Resolve{four, create(Format::R8Unorm, 2)}, "2 samples, expected one");
    refuses(Resolve{four, create(Format::R16Unorm, 1)}, "r8unorm to r16unorm");
    refuses(Resolve{four, create(Format::R8Unorm, 1, 9)}, "8x4 to 9x4");
    refuses(Resolve{create(Format::D16, 4), create(Format::D16, 1)}, "d16 has no mean");
    refuses(Resolve{create(Format::R32Uint, 4), create(Format::R32Uint, 1)}, "r32ui has no mean");
    refuses(Resolve{four, TargetView(create(Format::R8Unorm, 1, 8, 2), 0, 0, 2)}, "one at a time");
    refuses(Resolve{four, TargetView(one, 1)}, "level 1");
    refuses(ClearColor{TargetView(one, 0, 1)}, "layers 1 to 1");
    refuses(ClearDepth{create(Format::D16, 1), 1.5f}, "expected 0 to 1");
    refuses(ClearDepth{create(Format::D16, 1), std::numeric_limits<float>::quiet_NaN()}, "expected 0 to 1");
    refuses(ClearStencil{create(Format::D24UnormS8, 1), 256}, "stencil 256");
    refuses(ClearStencil{create(Format::D24, 1), 1}, "d24");
    refuses(ClearStencil{one, 1}, "r8unorm");
    const std::vector<std::byte> bytes(32);
    refuses(WriteTexture{four, 0, bytes, 0, 4}, "sample 4");
    refuses(WriteTexture{four, 0, bytes, 1, 0}, "layer 1");
    device.execute(Resolve{four, one});
}

TEST_CASE("a program with instance inputs needs its instances", "[errors]") {
    Device device(load_profile("d3d11"), 1);
    const TextureId depth = device.create_texture("depth", {.format = Format::D16, .width = 8, .height = 4});
    const std::vector<TestVertex> v{{-1, 1, 0.5f, 1, 5, 0}, {3, 1, 0.5f, 1, 5, 0}, {-1, -3, 0.5f, 1, 5, 0}};
    const std::vector<float> offsets(5);  // two instances of two floats, and half of one
    Draw draw = make_draw(per_instance_program(), upload(device, v), 0, 3);
    draw.depth = depth;
    CHECK_THROWS_AS(device.execute(draw), Error);
    draw.instances = device.create_buffer("instances", std::as_bytes(std::span(offsets)));
    draw.instance_count = 2;
    device.execute(draw);
    const auto before = codes_of(device.texture(depth));
    for (const auto& [first, count] : {std::pair{0u, 3u}, {1u, 2u}, {2u, 1u}, {UINT_MAX, UINT_MAX}, {0u, UINT_MAX}}) {
        draw.first_instance = first;
        draw.instance_count = count;
        CHECK_THROWS_WITH(device.execute(draw), Catch::Contains("instances up to") && Catch::Contains("holds 2 of 2 floats"));
    }
    CHECK(codes_of(device.texture(depth)) == before);
}
