// Texels as bytes, as stored codes and as the floats that the codes stand for.
#pragma once

#include "tests/agree/rastering.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gnomon::agree {

/// Little endian, red first.
std::vector<std::byte> texels_from_codes(ColorFormat format, std::span<const Codes> codes);
std::vector<Codes> codes_from_texels(ColorFormat format, std::span<const std::byte> texels);

/// Halves and floats exactly; a unorm code rounds to the nearest float.
Color color_from_codes(ColorFormat format, const Codes& codes);

}  // namespace gnomon::agree
