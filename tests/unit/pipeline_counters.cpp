// Counters on scenes small enough to count by hand.
#include "tests/unit/pipeline_programs.h"

#include <catch2/catch.hpp>

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
    // A triangle in front over everything, then one behind it on the upper half: per block, or per quad where the block is
    // shared.
    std::vector<TestVertex> v{at(0, 0, 0.25f), at(16, 0, 0.25f), at(0, 16, 0.25f),
                              at(0, 0, 0.5f),  at(4, 0, 0.5f),   at(0, 4, 0.5f)};
    const Counters all = count(v, id_program(), true);
    CHECK(all.samples_passed == 64);
    CHECK(all.blocks_rejected == 1);
    CHECK(all.quads_early_killed == 0);
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
