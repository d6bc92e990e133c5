// Plain images in memory and how textures become them.
#pragma once

#include "texunit/texture.h"

#include <glm/vec4.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::studies {

/// One float per pixel, rows top first.
struct FloatImage {
    int width = 0;
    int height = 0;
    std::vector<float> values;
};

/// Four floats per pixel, rows top first.
struct ColorImage {
    int width = 0;
    int height = 0;
    std::vector<glm::vec4> values;
};

/// 8 bits per channel, rows top first, channels interleaved.
struct ByteImage {
    int width = 0;
    int height = 0;
    int channels = 3;  // 1: grey, 3: red, green, blue
    std::vector<std::uint8_t> values;
};

/// Level 0 of a texture in Format::R32Float or Format::D32Float.
FloatImage float_image(const Texture& texture);

/// Red, green and blue of level 0 of a texture in Format::Rgba8Unorm.
ByteImage color_image(const Texture& texture);

/// 0 to 1 as 0 to 255, to nearest, clamped; NaN is 0.
ByteImage grey_image(const FloatImage& image);

}  // namespace gnomon::studies
