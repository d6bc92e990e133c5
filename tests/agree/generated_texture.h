// Textures of random texels.
#pragma once

#include "tests/agree/sampling.h"

#include <cstdint>

namespace gnomon::agree {

/// `level_count` levels of texels that have nothing to do with one another: floats in [0, 1), multiples of 2^-24 (2^-11 in
/// halfs), unorms of any bits. The same seed gives the same bytes everywhere. Throws Error where the size has not so many
/// levels.
Levels random_levels(TexelFormat format, int width, int height, int level_count, std::uint64_t seed);

/// Components stored by a format: 1, 2 or 4.
int component_count(TexelFormat format);

/// Texel (x, y) of `level` as D3D11.3 3.2.3 and IEEE widen it; the components that the format lacks are 0, 0, 1.
Sample texel_value(const Levels& texture, int level, int x, int y);

}  // namespace gnomon::agree
