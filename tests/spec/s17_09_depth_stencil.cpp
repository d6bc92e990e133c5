// D3D11.3 17.9 to 17.13: depth and stencil tests of one sample, every comparison and operation.
#include "tests/oracle/output_merger.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texel.h"
#include "tests/unit/output_programs.h"

#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr std::array kCompares{CompareOp::Never,   CompareOp::Less,     CompareOp::Equal,        CompareOp::LessEqual,
                               CompareOp::Greater, CompareOp::NotEqual, CompareOp::GreaterEqual, CompareOp::Always};
constexpr int kSize = 16;

/// A 16x16 stencil buffer with every value once: value i at pixel i.
void write_ramp(Canvas& canvas, TextureId target) {
    canvas.device.execute(ClearStencil{target, 0});
    for (int bit = 0; bit < 8; ++bit) {
        std::vector<TestVertex> vertices;
        for (int run = 1 << bit % 4; run < kSize; run += 2 << bit % 4) {
            const auto low = static_cast<float>(run);
            const auto high = static_cast<float>(run + (1 << bit % 4));
            const Box box = bit < 4 ? Box{low, 0, high, kSize} : Box{0, low, kSize, high};
            const auto corners = canvas.corners(box, 0.5f);
            vertices.insert(vertices.end(), corners.begin(), corners.end());
        }
        Draw draw =
            make_draw(depth_only_program(), upload(canvas.device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
        draw.depth = target;
        draw.depth_state.test = false;
        draw.stencil = {.test = true, .reference = 255, .write_mask = 1 << bit};
        draw.stencil.front.pass = draw.stencil.back.pass = StencilOp::Replace;
        canvas.device.execute(draw);
    }
}

}  // namespace

TEST_CASE("every depth comparison, with and without writes", "[17.9][17.11][depth]") {
    // Three codes beside each other, stored and incoming: all nine pairs.
    for (const Format format : {Format::D16, Format::D24UnormS8, Format::D32Float}) {
        const float step = format == Format::D16 ? 1.0f / 65535.0f : format == Format::D32Float ? 0x1p-25f : 1.0f / 16777215.0f;
        for (const CompareOp compare : kCompares) {
            for (const bool write : {true, false}) {
                for (const bool by_shader : {true, false}) {
                    Canvas canvas(load_profile("d3d11"), 3, 3);
                    const TextureId depth = canvas.target(format);
                    const TextureId color = canvas.target(Format::R32Float);
                    const auto value = [&](std::size_t i) { return 0.25f + (static_cast<float>(i) - 1.0f) * step; };
                    for (std::size_t column = 0; column < 3; ++column) {
                        const auto x = static_cast<float>(column);
                        Draw prepare = canvas.rectangle(depth_only_program(), {x, 0, x + 1, 3}, value(column));
                        prepare.depth = depth;
                        prepare.depth_state.compare = CompareOp::Always;
                        canvas.device.execute(prepare);
                    }
                    std::array<std::uint32_t, 9> before;
                    for (std::size_t i = 0; i < 9; ++i) before[i] = canvas.code(depth, i);
                    CHECK((before[0] < before[1] && before[1] < before[2]));

                    Image control;
                    for (std::size_t i = 0; i < 9; ++i) control.emplace_back(0.0f, value(i / 3), 0.0f, 0.0f);
                    const ImageConstants images{canvas.image(Image(9, glm::vec4(1.0f))), canvas.image(control)};
                    for (std::size_t row = 0; row < 3; ++row) {
                        const auto y = static_cast<float>(row);
                        Draw draw = canvas.rectangle(image_program(1, by_shader ? unsigned{kDepth} : 0u), {0, y, 3, y + 1},
                                                     by_shader ? 0.75f : value(row), images);
                        draw.color[0] = color;
                        draw.depth = depth;
                        draw.depth_state = {.write = write, .compare = compare};
                        canvas.device.execute(draw);
                    }
                    for (std::size_t i = 0; i < 9; ++i) {
                        const std::size_t incoming = i / 3;
                        const std::size_t stored = i % 3;
                        const bool passes = oracle::passes(compare, static_cast<double>(incoming), static_cast<double>(stored));
                        INFO(name_of(compare) << " " << format_info(format).name << " pixel " << i << " shader " << by_shader);
                        CHECK(canvas.value(color, i) == (passes ? 1.0f : 0.0f));
                        CHECK(canvas.code(depth, i) == before[passes && write ? incoming : stored]);
                    }
                }
            }
        }
    }
}

TEST_CASE("reversed z keeps the nearest surface under the opposite comparison", "[17.11][depth]") {
    // The same triangles in random order, once with z and once with 1 - z: who wins each pixel is the same.
    Random random(5);
    for (const Format format : {Format::D16, Format::D24, Format::D32Float}) {
        std::array<std::vector<float>, 2> winners;
        std::vector<Box> boxes;
        for (int i = 0; i < 40; ++i) {
            const float x = random.in(0, 24);
            const float y = random.in(0, 24);
            boxes.push_back({x, y, x + random.in(1, 12), y + random.in(1, 12)});
        }
        for (const bool reversed : {false, true}) {
            Canvas canvas(load_profile("d3d11"), 32, 32);
            const TextureId color = canvas.target(Format::R32Float);
            const TextureId depth = canvas.target(format);
            canvas.device.execute(ClearDepth{depth, reversed ? 0.0f : 1.0f});
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                const float z = static_cast<float>(i * 37 % 64) / 64.0f;
                const auto id = static_cast<float>(i + 1);
                Draw draw =
                    make_draw(id_program(), upload(canvas.device, canvas.corners(boxes[i], reversed ? 1.0f - z : z, id)), 0, 6);
                draw.color[0] = color;
                draw.depth = depth;
                draw.depth_state.compare = reversed ? CompareOp::Greater : CompareOp::Less;
                canvas.device.execute(draw);
            }
            winners[reversed ? 1 : 0] = floats_of(canvas.device.texture(color));
        }
        CHECK(winners[0] == winners[1]);
        CHECK(std::count(winners[0].begin(), winners[0].end(), 0.0f) < 900);
    }
}

TEST_CASE("without the depth test nothing is compared or written, and stencil sees a pass", "[17.9][stencil]") {
    for (const bool test : {true, false}) {
        Canvas canvas(load_profile("d3d11"), 4, 4);
        const TextureId depth = canvas.target(Format::D24UnormS8);
        canvas.device.execute(ClearDepth{depth, 0.25f});
        canvas.device.execute(ClearStencil{depth, 9});
        const std::uint32_t before = canvas.code(depth, 5);
        Draw draw = canvas.everything(depth_only_program(), 0.5f);
        draw.depth = depth;
        draw.depth_state.test = test;
        draw.stencil.test = true;
        draw.stencil.front = draw.stencil.back = {.depth_fail = StencilOp::Zero, .pass = StencilOp::Increment};
        canvas.device.execute(draw);
        CHECK(canvas.code(depth, 5) == before);
        CHECK(canvas.stencil(depth, 5) == (test ? 0 : 10));
        // And without the stencil test its buffer stays, whatever the operations.
        draw.stencil.test = false;
        canvas.device.execute(draw);
        CHECK(canvas.stencil(depth, 5) == (test ? 0 : 10));
    }
}

TEST_CASE("a target without stencil passes the stencil test", "[17.12][stencil]") {
    Canvas canvas(load_profile("d3d11"), 4, 4);
    const TextureId color = canvas.target(Format::R32Float);
    const TextureId depth = canvas.target(Format::D32Float);
    canvas.device.execute(ClearDepth{depth, 1.0f});
    Draw draw = canvas.everything(image_program(1), 0.5f, {canvas.image(Image(16, glm::vec4(3.0f))), canvas.image(Image(16))});
    draw.color[0] = color;
    draw.depth = depth;
    draw.stencil.test = true;
    draw.stencil.front.compare = draw.stencil.back.compare = CompareOp::Never;
    canvas.device.execute(draw);
    for (std::size_t i = 0; i < 16; ++i) CHECK(canvas.value(color, i) == 3.0f);
    draw.depth = TextureId::None;
    canvas.device.execute(ClearColor{color, glm::vec4(0.0f)});
    canvas.device.execute(draw);
    for (std::size_t i = 0; i < 16; ++i) CHECK(canvas.value(color, i) == 3.0f);
}

TEST_CASE("every stencil operation on every stored value, on both faces", "[17.12][17.8][stencil]") {
    // All triples of operations, the comparison and the masks by the case's number; every case asks all 256 stored values, a
    // part of them behind the stored depth.
    constexpr int kOps = 8;
    std::array<int, 3> taken{};  // fail, depth fail, pass
    for (const Format format : {Format::D24UnormS8, Format::D32FloatS8}) {
        Canvas canvas(load_profile("d3d11"), kSize, kSize);
        const TextureId depth = canvas.target(format);
        canvas.device.execute(ClearDepth{depth, 1.0f});
        Draw nearer = canvas.rectangle(depth_only_program(), {0, 0, 7, kSize}, 0.25f);
        nearer.depth = depth;
        canvas.device.execute(nearer);
        const auto corners = canvas.corners({0, 0, kSize, kSize}, 0.5f);
        const BufferId vertices = upload(canvas.device, corners);
        std::array<int, 256> expected;
        for (int n = 0; n < kOps * kOps * kOps; ++n) {
            if (n % 8 == 0) {
                write_ramp(canvas, depth);
                for (int i = 0; i < 256; ++i) {
                    expected[static_cast<std::size_t>(i)] = i;
                    REQUIRE(canvas.stencil(depth, static_cast<std::size_t>(i)) == i);
                }
            }
            Random random(static_cast<std::uint64_t>(n));
            const bool front = n % 2 == 0;
            const StencilFace used{.compare = kCompares[static_cast<std::size_t>(random.integer(0, 7))],
                                   .fail = static_cast<StencilOp>(n % kOps),
                                   .depth_fail = static_cast<StencilOp>(n / kOps % kOps),
                                   .pass = static_cast<StencilOp>(n / kOps / kOps)};
            const StencilFace other{.compare = CompareOp::Never, .fail = StencilOp::Invert};
            StencilState state{.test = true,
                               .reference = random.integer(0, 255),
                               .read_mask = random.chance(2) ? 255 : random.integer(0, 255),
                               .write_mask = random.chance(2) ? 255 : random.integer(0, 255)};
            state.front = front ? used : other;
            state.back = front ? other : used;
            Draw draw = make_draw(depth_only_program(), vertices, 0, 6);
            draw.depth = depth;
            draw.depth_state.write = false;
            draw.raster.front_counter_clockwise = !front;  // the rectangle is clockwise
            draw.stencil = state;
            canvas.device.execute(draw);
            for (std::size_t i = 0; i < 256; ++i) {
                const bool depth_passes = i % 16 >= 7;
                const auto outcome = oracle::stencil(state, front, depth_passes, expected[i]);
                ++taken[outcome.passes ? 2u : depth_passes ? 0u : 1u];
                INFO("case " << n << ", pixel " << i << ", stored " << expected[i]);
                expected[i] = outcome.stored;
                if (canvas.stencil(depth, i) != expected[i]) REQUIRE(canvas.stencil(depth, i) == expected[i]);
            }
        }
    }
    for (const int count : taken) CHECK(count > 10000);
}

TEST_CASE("stencil masks colours and depth of each sample by itself", "[17.12][stencil][msaa]") {
    // Stencil 1 in the samples of a slanted triangle; then a full rectangle passes there only.
    for (const int samples : {1, 4, 8}) {
        Canvas canvas(load_profile("d3d11"), 20, 20, samples);
        const TextureId depth = canvas.target(Format::D32FloatS8);
        const TextureId color = canvas.target(Format::R32Float);
        const TextureId direct = canvas.target(Format::R32Float);
        canvas.device.execute(ClearDepth{depth, 1.0f});
        const std::vector<TestVertex> slanted{
            {-0.9f, 0.7f, 0.5f, 1, 1, 0}, {0.8f, 0.2f, 0.5f, 1, 1, 0}, {-0.3f, -0.95f, 0.5f, 1, 1, 0}};
        const BufferId triangle = upload(canvas.device, slanted);
        Draw mark = make_draw(depth_only_program(), triangle, 0, 3);
        mark.depth = depth;
        mark.depth_state.write = false;
        mark.stencil = {.test = true, .reference = 1};
        mark.stencil.front.pass = mark.stencil.back.pass = StencilOp::Replace;
        canvas.device.execute(mark);
        Draw fill = canvas.everything(id_program(), 0.75f);
        fill.vertices = upload(canvas.device, canvas.corners({0, 0, 20, 20}, 0.75f, 1.0f));
        fill.pixel_constants = pixel_constants(id_program());
        fill.color[0] = color;
        fill.depth = depth;
        fill.stencil = {.test = true, .reference = 1};
        fill.stencil.front.compare = fill.stencil.back.compare = CompareOp::Equal;
        canvas.device.execute(fill);
        Draw straight = make_draw(id_program(), triangle, 0, 3);
        straight.color[0] = direct;
        canvas.device.execute(straight);
        std::size_t inside = 0;
        for (int s = 0; s < samples; ++s) {
            for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                REQUIRE(canvas.value(color, i, 0, 0, s) == canvas.value(direct, i, 0, 0, s));
                const bool is_inside = canvas.value(direct, i, 0, 0, s) == 1.0f;
                REQUIRE(canvas.value(depth, i, 0, 0, s) == (is_inside ? 0.75f : 1.0f));
                inside += is_inside ? 1u : 0u;
            }
        }
        CHECK(inside > 80 * static_cast<std::size_t>(samples));
    }
}

TEST_CASE("a depth target that is only tested may be read", "[17.13][depth]") {
    Canvas canvas(load_profile("d3d11"), 4, 4);
    const TextureId depth = canvas.target(Format::D32Float);
    const TextureId color = canvas.target(Format::R32Float);
    canvas.device.execute(ClearDepth{depth, 0.625f});
    Draw draw = canvas.everything(image_program(1), 0.5f, {depth, canvas.image(Image(16))});
    draw.color[0] = color;
    draw.depth = depth;
    CHECK_THROWS_AS(canvas.device.execute(draw), Error);
    draw.depth_state.write = false;
    canvas.device.execute(draw);
    CHECK(canvas.value(color, 7) == 0.625f);
}
