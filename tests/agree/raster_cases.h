// Random cases for rasterisers and output mergers, the same everywhere.
#pragma once

#include "tests/agree/rastering.h"
#include "tests/oracle/random.h"

#include <string_view>
#include <vector>

namespace gnomon::agree {

enum class TriangleKind {
    Any,          // corners anywhere in the viewport
    SubPixel,     // within about a pixel
    Sliver,       // one corner next to the opposite edge
    OnSamples,    // corners on pixel centres, sample positions and pixel corners
    Shared,       // two after each other share an edge
    Large,        // corners up to some viewports outside
    Perspective,  // w from 1/8 to 8, some corners outside
    Behind        // some w negative or zero, some depths outside
};
inline constexpr TriangleKind kTriangleKinds[] = {TriangleKind::Any,         TriangleKind::SubPixel, TriangleKind::Sliver,
                                                  TriangleKind::OnSamples,   TriangleKind::Shared,   TriangleKind::Large,
                                                  TriangleKind::Perspective, TriangleKind::Behind};
std::string_view name_of(TriangleKind kind);

std::vector<ClipTriangle> random_triangles(TriangleKind kind, std::size_t count, int width, int height, std::uint64_t seed);

/// Factors, operations and constants.
BlendState random_blend_state(oracle::Random& random, ColorFormat format);
/// Colours that are mostly within [0, 1]; for float formats also large, tiny and, one in a few, not finite.
std::vector<BlendCase> random_blend_cases(oracle::Random& random, ColorFormat format, std::size_t count);
std::vector<SampleCodes> random_samples(oracle::Random& random, ColorFormat format, std::size_t count);

}  // namespace gnomon::agree
