// Counters on scenes small enough to count by hand.
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Pixels to clip space of an 8x8 target.
TestVertex at(float x, float y, float z = 0.5f) { return {x / 4.0f - 1.0f, 1.0f - y / 4.0f, z, 1.0f, 1.0f, 0.0f}; }

Counters count(const std::vector<TestVertex>& vertices, const Program& program, bool with_depth, RasterState raster = {}) {
    Device device(Profile{}, 1);
    Draw draw = make_draw(program, upload(device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
    for (std::size_t i = 0; i < static_cast<std::size_t>(program.targets()); ++i)
        draw.color[i] = device.create_texture("c", {.format = Format::Rgba32Float, .width = 8, .height = 8});
    if (with_depth) {
        draw.depth = device.create_texture("d", {.format = Format::D32Float, .width = 8, .height = 8});
        device.execute(ClearDepth{draw.depth, 1.0f});
    }
    draw.raster = raster;
    device.enable_counters(true);
    device.execute(draw);
    return device.take_counters();
}

}  // namespace

TEST_CASE("counters of a 2x1 rectangle half a quad off the grid", "[counters]") {
    // Pixels (1,1) and (2,1): the rectangle [1,3) x [1,2). Two quads, one covered lane each. Two triangles share the diagonal.
    const std::vector<TestVertex> v{at(1, 1), at(3, 1), at(1, 2), at(3, 1), at(3, 2), at(1, 2)};
    const Counters c = count(v, inspect_program(), false);
    CHECK(c.vertices == 6);
    CHECK(c.primitives_in == 2);
    CHECK(c.primitives_clipped == 0);
    CHECK(c.primitives_culled == 0);
    CHECK(c.primitives_drawn == 2);
    CHECK(c.samples_covered == 2);
    CHECK(c.samples_passed == 2);
    CHECK(c.lanes_shaded == 2);
    // The diagonal from (3,1) to (1,2) passes (1.5,1.75) and (2.5,1.25): centre (1.5,1.5) is above it, (2.5,1.5) below.
    CHECK(c.quads_shaded == 2);
    CHECK(c.lanes_helper == 6);
    // 4 derivatives per covered lane, all next to helpers.
    CHECK(c.invalid_derivatives == 8);
    CHECK(c.tiles == 2);
    CHECK(c.texture_instructions == 0);
}

TEST_CASE("counters of a full target", "[counters]") {
    const std::vector<TestVertex> v{at(0, 0), at(16, 0), at(0, 16)};
    const Counters c = count(v, inspect_program(), true);
    CHECK(c.samples_covered == 64);
    CHECK(c.samples_passed == 64);
    CHECK(c.quads_shaded == 16);
    CHECK(c.lanes_shaded == 64);
    CHECK(c.lanes_helper == 0);
    CHECK(c.invalid_derivatives == 0);
    CHECK(c.blocks_rejected == 0);
    CHECK(c.quads_early_killed == 0);
    CHECK(c.tiles == 1);
}

TEST_CASE("counters of triangles that are culled", "[counters][15.11]") {
    // Six centres are inside; the four on the slanted edge belong to the other side.
    const std::vector<TestVertex> clockwise{at(0, 0), at(4, 0), at(0, 4)};
    const std::vector<TestVertex> counter{at(0, 0), at(0, 4), at(4, 0)};
    // front_counter_clockwise: clockwise is back.
    CHECK(count(clockwise, id_program(), false, {.cull = CullMode::Back}).samples_covered == 0);
    CHECK(count(clockwise, id_program(), false, {.cull = CullMode::Back}).primitives_culled == 1);
    CHECK(count(clockwise, id_program(), false, {.cull = CullMode::Front}).samples_covered == 6);
    CHECK(count(counter, id_program(), false, {.cull = CullMode::Back}).samples_covered == 6);
    CHECK(count(counter, id_program(), false, {.cull = CullMode::Front}).primitives_culled == 1);
    CHECK(count(counter, id_program(), false, {.cull = CullMode::Front, .front_counter_clockwise = false}).samples_covered ==
          6);
    CHECK(
        count(clockwise, id_program(), false, {.cull = CullMode::Front, .front_counter_clockwise = false}).primitives_culled ==
        1);
    // No area, outside, behind.
    CHECK(count({at(0, 0), at(4, 4), at(8, 8)}, id_program(), false).primitives_culled == 1);
    CHECK(count({at(-9, 0), at(-5, 0), at(-9, 4)}, id_program(), false).primitives_culled == 1);
    CHECK(count({at(0, 0, -1), at(4, 0, -1), at(0, 4, -1)}, id_program(), false).primitives_culled == 1);
    // Cut by the near plane: one triangle in, counted once, and what is left is drawn.
    const Counters cut = count({at(0, 0, -1), at(8, 0, 1), at(0, 8, -1)}, id_program(), false);
    CHECK(cut.primitives_in == 1);
    CHECK(cut.primitives_clipped == 1);
    CHECK(cut.primitives_culled == 0);
    CHECK(cut.primitives_drawn == 1);
}

TEST_CASE("early depth kills quads and counts them", "[counters][depth]") {
    // A triangle in front over everything, then one behind it in the corner. Hierarchical depth drops its block, which the
    // other counters do not show.
    std::vector<TestVertex> v{at(0, 0, 0.25f), at(16, 0, 0.25f), at(0, 16, 0.25f),
                              at(0, 0, 0.5f),  at(4, 0, 0.5f),   at(0, 4, 0.5f)};
    const Counters all = count(v, id_program(), true);
    CHECK(all.blocks_rejected == 1);
    CHECK(all.samples_covered == 64 + 6);
    CHECK(all.samples_depth_tested == 64 + 6);
    CHECK(all.samples_passed == 64);
    CHECK(all.quads_early_killed == 3);
    // With Less and a hole in the front triangle (it covers x < 4 only) the block cannot be rejected, but its quads can.
    v = {at(0, 0, 0.25f), at(4, 0, 0.25f), at(0, 8, 0.25f), at(4, 0, 0.25f), at(4, 8, 0.25f),
         at(0, 8, 0.25f), at(0, 0, 0.5f),  at(4, 0, 0.5f),  at(0, 4, 0.5f)};
    const Counters some = count(v, id_program(), true);
    CHECK(some.blocks_rejected == 0);
    CHECK(some.samples_covered == 32 + 6);
    CHECK(some.samples_passed == 32);
    CHECK(some.quads_early_killed == 3);
}

TEST_CASE("counters stay zero while off and add up while on", "[counters]") {
    Device device(Profile{}, 2);
    const std::vector<TestVertex> v{at(0, 0), at(16, 0), at(0, 16)};
    Draw draw = make_draw(id_program(), upload(device, v), 0, 3);
    draw.color[0] = device.create_texture("c", {.format = Format::R32Float, .width = 8, .height = 8});
    device.execute(draw);
    CHECK(device.take_counters() == Counters{});
    device.enable_counters(true);
    device.execute(draw);
    device.execute(draw);
    CHECK(device.take_counters().samples_covered == 128);
    CHECK(device.take_counters() == Counters{});
}

namespace {

/// A canvas of 8x8 with a colour and a depth target, cleared, and counting from then on.
struct CountingBench {
    Canvas canvas;
    TextureId color, depth, colors, control;

    CountingBench(int samples, Format color_format, Format depth_format, int threads = 1)
        : canvas(load_profile("d3d11"), 8, 8, samples, threads) {
        color = canvas.target(color_format);
        depth = canvas.target(depth_format);
        colors = canvas.image(Image(64));
        control = canvas.image(Image(64));
        canvas.device.execute(ClearDepth{depth, 1.0f});
        canvas.device.enable_counters(true);
    }
    Draw draw(const Box& box, float z, unsigned features = 0) {
        Draw draw = canvas.rectangle(image_program(1, features), box, z, {colors, control});
        draw.color[0] = color;
        return draw;
    }
    Tally run(const Draw& draw) {
        canvas.device.execute(draw);
        return canvas.device.take_tally();
    }
};

// Rectangles whose diagonals pass no pixel of the canvas, so that one of their triangles covers all: [0, w) x [0, h).
constexpr Box columns(float end) { return {-4096, -4096, end, 256}; }

}  // namespace

TEST_CASE("counters and traffic of a multisampled pass", "[counters][msaa]") {
    for (const int threads : {1, 3}) {
        CountingBench bench(4, Format::Rgba8Unorm, Format::D24UnormS8, threads);
        // Left six columns: three quads wide, four high. D24 takes 3 bytes a sample, stencil 1.
        Draw draw = bench.draw(columns(6), 0.5f);
        draw.depth = bench.depth;
        const Tally tally = bench.run(draw);
        const Counters& c = tally.counters;
        CHECK(c.vertices == 6);
        CHECK(c.primitives_in == 2);
        CHECK(c.primitives_drawn + c.primitives_culled == 2);
        CHECK(c.samples_covered == 48 * 4);
        CHECK(c.quads_covered == 12);
        CHECK(c.samples_depth_tested == 48 * 4);
        CHECK(c.samples_stencil_tested == 0);
        CHECK(c.samples_passed == 48 * 4);
        CHECK(c.quads_shaded == 12);
        CHECK(c.values_interpolated == 24);
        CHECK(c.lanes_shaded == 48);
        CHECK(c.lanes_helper == 0);
        CHECK(c.samples_written == 48 * 4);
        CHECK(c.samples_blended == 0);
        CHECK(c.texture_instructions == 48);
        CHECK(c.texels_fetched == 48);
        CHECK(c.texture_probes == 0);
        CHECK(tally.of(bench.color) == Bytes{.read = 0, .written = 48 * 4 * 4});
        CHECK(tally.of(bench.depth) == Bytes{.read = 48 * 4 * 3, .written = 48 * 4 * 3});
        CHECK(tally.of(bench.colors) == Bytes{.read = 48 * 16, .written = 0});
        CHECK(tally.of(bench.control) == Bytes{});
        CHECK(tally.of(draw.vertices) == Bytes{.read = 6 * 24, .written = 0});
        CHECK(c.bytes_read == 48 * 4 * 3 + 48 * 16 + 6 * 24);
        CHECK(c.bytes_written == 48 * 4 * 4 + 48 * 4 * 3);
    }
}

TEST_CASE("a sample mask, sample frequency and partial coverage are counted as they are", "[counters][msaa]") {
    CountingBench bench(4, Format::R32Float, Format::D16);
    // The rectangle ends at x = 5.5: samples 0 and 2 of column 5 (at 6/16 and 2/16) are inside, 1 and 3 are not.
    Draw draw = bench.draw(columns(5.5f), 0.5f);
    Tally tally = bench.run(draw);
    CHECK(tally.counters.samples_covered == 5 * 8 * 4 + 8 * 2);
    CHECK(tally.counters.lanes_shaded == 48);
    CHECK(tally.counters.samples_written == 5 * 8 * 4 + 8 * 2);
    // Without samples 0 and 2 column 5 has nothing left; its pixels are helpers of column 4.
    draw.output.sample_mask = 0b1010;
    tally = bench.run(draw);
    CHECK(tally.counters.samples_covered == 5 * 8 * 2);
    CHECK(tally.counters.lanes_shaded == 40);
    CHECK(tally.counters.lanes_helper == 8);
    // Per sample: 40 pixels with four runs, 8 with two, in 12 quads; in a run for sample 1 or 3 column 5 helps.
    draw.output.sample_mask = ~0u;
    draw.program = &image_program(1, kPerSample);
    tally = bench.run(draw);
    CHECK(tally.counters.quads_shaded == 12 * 4);
    CHECK(tally.counters.lanes_shaded == 40 * 4 + 8 * 2);
    CHECK(tally.counters.lanes_helper == 8 * 2);
    CHECK(tally.counters.values_interpolated == 12 * 4 * 2);
    CHECK(tally.counters.samples_written == 5 * 8 * 4 + 8 * 2);
}

TEST_CASE("blending, write masks and several targets are counted per target", "[counters][blend]") {
    CountingBench bench(1, Format::Rgba16Float, Format::D16);
    Draw draw = bench.draw(columns(8), 0.5f);
    draw.program = &image_program(8);
    draw.color[3] = bench.canvas.target(Format::R8Unorm);
    draw.color[5] = bench.canvas.target(Format::Rgba32Float);
    draw.output.blend[0].enable = true;
    draw.output.blend[5].enable = true;
    draw.output.blend[5].write_mask = 0;  // not written at all, so not read
    draw.output.blend[3].write_mask = 1;
    bench.canvas.device.take_tally();
    const Tally tally = bench.run(draw);
    CHECK(tally.counters.samples_written == 128);
    CHECK(tally.counters.samples_blended == 64);
    CHECK(tally.counters.samples_passed == 64);
    CHECK(tally.of(draw.color[0].texture) == Bytes{.read = 64 * 8, .written = 64 * 8});
    CHECK(tally.of(draw.color[3].texture) == Bytes{.read = 0, .written = 64});
    CHECK(tally.of(draw.color[5].texture) == Bytes{});
}

TEST_CASE("stencil, late depth and discards are counted exactly", "[counters][stencil]") {
    CountingBench bench(1, Format::R8Unorm, Format::D32FloatS8);
    // Left half of the stencil buffer is 1; depth passes there and in the right half only in front.
    Draw mark = bench.draw(columns(4), 0.25f);
    mark.program = &depth_only_program();
    mark.pixel_constants = {};
    mark.color[0] = TextureId::None;
    mark.depth = bench.depth;
    mark.stencil = {.test = true, .reference = 1};
    mark.stencil.front.pass = mark.stencil.back.pass = StencilOp::Replace;
    Tally tally = bench.run(mark);
    CHECK(tally.counters.samples_stencil_tested == 32);
    CHECK(tally.counters.samples_depth_tested == 32);
    CHECK(tally.counters.samples_passed == 32);
    CHECK(tally.counters.quads_shaded == 0);
    CHECK(tally.of(bench.depth) == Bytes{.read = 32 + 32 * 4, .written = 32 + 32 * 4});

    // Everywhere at 0.5: stencil passes in the right half, where 24 of the 32 pixels stay and depth passes.
    Image control(64);
    for (std::size_t i = 0; i < 64; ++i) control[i].x = i % 8 == 7 ? 1.0f : 0.0f;
    bench.canvas.device.execute(WriteTexture{bench.control, 0, std::as_bytes(std::span(control))});
    bench.canvas.device.take_tally();
    Draw draw = bench.draw(columns(8), 0.5f, kDiscards);
    draw.depth = bench.depth;
    draw.stencil = {.test = true, .reference = 0};
    draw.stencil.front = draw.stencil.back = {.compare = CompareOp::Equal, .fail = StencilOp::Zero, .pass = StencilOp::Keep};
    tally = bench.run(draw);
    CHECK(tally.counters.lanes_shaded == 64);
    CHECK(tally.counters.lanes_discarded == 8);
    CHECK(tally.counters.samples_stencil_tested == 56);
    CHECK(tally.counters.samples_depth_tested == 24);
    CHECK(tally.counters.samples_passed == 24);
    CHECK(tally.counters.samples_written == 24);
    CHECK(tally.counters.texels_fetched == 128);
    CHECK(tally.of(bench.depth) == Bytes{.read = 56 + 24 * 4, .written = 32 + 24 * 4});
    // Operations that the write mask keeps from every bit write nothing.
    draw.stencil.write_mask = 0;
    draw.stencil.front.compare = draw.stencil.back.compare = CompareOp::Never;
    tally = bench.run(draw);
    CHECK(tally.of(bench.depth) == Bytes{.read = 56, .written = 0});
}

TEST_CASE("clears, resolves and mips count their bytes", "[counters][resolve]") {
    CountingBench bench(4, Format::Rgba16Float, Format::D24UnormS8);
    Device& device = bench.canvas.device;
    const TextureId mean = device.create_texture("mean", {.format = Format::Rgba16Float, .width = 8, .height = 8, .levels = 4});
    device.take_tally();
    device.execute(ClearColor{bench.color, glm::vec4(1.0f)});
    device.execute(ClearDepth{bench.depth, 1.0f});
    device.execute(ClearStencil{bench.depth, 1});
    Tally tally = device.take_tally();
    CHECK(tally.of(bench.color) == Bytes{.read = 0, .written = 256 * 8});
    CHECK(tally.of(bench.depth) == Bytes{.read = 0, .written = 256 * 3 + 256});
    device.execute(Resolve{bench.color, mean});
    tally = device.take_tally();
    CHECK(tally.counters.samples_resolved == 256);
    CHECK(tally.of(bench.color) == Bytes{.read = 256 * 8, .written = 0});
    CHECK(tally.of(mean) == Bytes{.read = 0, .written = 64 * 8});
    device.execute(GenerateMips{mean});
    tally = device.take_tally();
    CHECK(tally.of(mean) == Bytes{.read = (64 + 16 + 4) * 8, .written = (16 + 4 + 1) * 8});
    CHECK(tally.counters.bytes_read == (64 + 16 + 4) * 8);
    // Reports name what was touched, textures first.
    const auto traffic = device.traffic(tally);
    REQUIRE(traffic.size() == 1);
    CHECK(traffic[0].label == "mean");
}

TEST_CASE("indices and instances count what is fetched", "[counters]") {
    CountingBench bench(1, Format::R8Unorm, Format::D16);
    const std::array<std::uint16_t, 6> indices{0, 1, 2, 2, 1, 0};
    Draw draw = bench.draw(columns(8), 0.5f);
    draw.indices = bench.canvas.device.create_buffer("indices", std::as_bytes(std::span(indices)));
    draw.index_type = IndexType::Uint16;
    draw.instance_count = 3;
    bench.canvas.device.take_tally();
    const Tally tally = bench.run(draw);
    CHECK(tally.counters.vertices == 3 * 3);
    CHECK(tally.counters.primitives_in == 3 * 2);
    CHECK(tally.of(draw.indices) == Bytes{.read = 3 * 6 * 2, .written = 0});
    CHECK(tally.of(draw.vertices) == Bytes{.read = 9 * 24, .written = 0});
}

namespace {

/// What a draw of these indices over `vertices` vertices counts.
Tally count_indexed(const std::vector<std::uint32_t>& indices, std::size_t vertices, Topology topology, bool restart = false) {
    Device device(Profile{}, 2);
    Draw draw = make_draw(depth_only_program(), upload(device, std::vector<TestVertex>(vertices, at(0, 0))), 0,
                          static_cast<std::uint32_t>(indices.size()));
    draw.indices = device.create_buffer("indices", std::as_bytes(std::span(indices)));
    draw.topology = topology;
    draw.primitive_restart = restart;
    draw.instance_count = 2;
    draw.depth = device.create_texture("d", {.format = Format::D16, .width = 8, .height = 8});
    device.execute(ClearDepth{draw.depth, 1.0f});
    device.take_tally();
    device.enable_counters(true);
    device.execute(draw);
    const Tally tally = device.take_tally();
    CHECK(tally.of(draw.vertices) == Bytes{.read = tally.counters.vertices * 24, .written = 0});
    CHECK(tally.of(draw.indices) == Bytes{.read = 2 * 4 * indices.size(), .written = 0});
    return tally;
}

}  // namespace

TEST_CASE("vertices are those that primitives refer to, whatever windows they are shaded in", "[counters]") {
    // Far apart; more than once; left over behind the last primitive; in runs too short for one.
    CHECK(count_indexed({0, 1000, 2}, 1001, Topology::TriangleList).counters.vertices == 2 * 3);
    CHECK(count_indexed({5, 6, 7, 7, 6, 8}, 1001, Topology::TriangleList).counters.vertices == 2 * 4);
    CHECK(count_indexed({0, 1, 2, 500, 501}, 1001, Topology::TriangleList).counters.vertices == 2 * 3);
    CHECK(count_indexed({9, ~0u, 0, 1, 2, ~0u, 3, 4}, 1001, Topology::TriangleStrip, true).counters.vertices == 2 * 3);
    CHECK(count_indexed({0, 900000, 2}, 1000000, Topology::TriangleList).counters.vertices == 2 * 3);

    // A ring that goes round 300,000 vertices twice: no window holds them all, and every one comes up in several.
    constexpr std::uint32_t kMany = 300'000;
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < 2 * kMany; ++i)
        for (const std::uint32_t ahead : {0u, 1u, 2u}) ring.push_back((i + ahead) % kMany);
    CHECK(count_indexed(ring, kMany, Topology::TriangleList).counters.vertices == 2 * std::uint64_t{kMany});
    // Strewn, so that corners are shaded one by one.
    for (std::uint32_t i = 0; i < ring.size(); ++i) ring[i] = i * 2654435761u % kMany / 3 * 3;
    const std::set<std::uint32_t> strewn(ring.begin(), ring.end());
    CHECK(count_indexed(ring, kMany, Topology::TriangleList).counters.vertices == 2 * strewn.size());
    // Without indices: what is left over is not shaded.
    Device device(Profile{}, 1);
    Draw draw = make_draw(depth_only_program(), upload(device, std::vector<TestVertex>(11, at(0, 0))), 0, 11);
    draw.depth = device.create_texture("d", {.format = Format::D16, .width = 8, .height = 8});
    device.enable_counters(true);
    device.execute(draw);
    CHECK(device.take_counters().vertices == 9);
}
