// Tiny programs and a canvas for the tests of the rasteriser.
#pragma once

#include "pipeline/device.h"

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gnomon::testing {

/// What both programs fetch: clip-space position and two attributes.
struct TestVertex {
    float x, y, z, w;
    float a, b;
};
static_assert(sizeof(TestVertex) == 6 * sizeof(float));

/// Writes attribute a to its one target. Attributes that are equal at three vertices identify the triangle.
const Program& id_program();

/// Writes three targets: {position}, {a, b, ddx(a), ddy(a)}, {ddx_fine(a), ddy_fine(a), 0, 1}.
const Program& inspect_program();

/// No pixel functor.
const Program& depth_only_program();

/// Constants of either program.
std::span<const std::byte> vertex_constants();
std::span<const std::byte> pixel_constants(const Program& program);

/// A Draw of `program` over the whole buffer with everything else at its default.
Draw make_draw(const Program& program, BufferId vertices, std::uint32_t first, std::uint32_t count);

BufferId upload(Device& device, const std::vector<TestVertex>& vertices);

std::vector<float> floats_of(const Texture& texture);         // level 0, row by row, all components
std::vector<std::uint32_t> codes_of(const Texture& texture);  // the same for textures of 32-bit texels

}  // namespace gnomon::testing
