// Programs that show what the rasteriser handed to them, for the tests of chapters 3, 8 and 15.
#pragma once

#include "pipeline/program.h"

#include <array>

namespace gnomon::testing {

/// What all of them fetch: clip-space position, two attributes, and the array slice and viewport of what the vertex provokes.
struct RasterVertex {
    std::array<float, 4> clip{};
    float a = 0, b = 0;
    float layer = 0, viewport = 0;
};
static_assert(sizeof(RasterVertex) == 8 * sizeof(float));

/// One target: {flat a, 0, 0, 1}.
const Program& mark_program();

/// Two targets: {flat a, flat vertex id, flat instance id, primitive id}, {front facing, coverage, layer, viewport}.
const Program& identify_program();

/// The same from two floats more per instance, which are added to x and y.
const Program& instanced_program();

/// Five targets, one run per pixel: position, {a, linear a, flat a, coverage}, {b, linear b, flat b, front facing},
/// {centroid a, linear centroid a, centroid b, linear centroid b}, {ddx a, ddy a, 0, 0}.
const Program& interpolation_program();

/// The same outputs and one more, {sample a, linear sample a, sample b, sample index}: one run per sample.
const Program& sample_program();

/// No pixel functor.
const Program& depth_program();

/// The constants of any of them; none has any to set.
std::span<const std::byte> raster_vertex_constants(const Program& program);
std::span<const std::byte> raster_pixel_constants(const Program& program);

}  // namespace gnomon::testing
