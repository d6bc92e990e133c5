#include "studies/images.h"

#include "sim/error.h"

#include <algorithm>
#include <cstring>

namespace gnomon::studies {

FloatImage float_image(const Texture& texture) {
    GNOMON_CHECK(texture.desc().format == Format::R32Float || texture.desc().format == Format::D32Float);
    const std::vector<std::byte> bytes = texture.level_bytes(0);
    FloatImage image{texture.width(0), texture.height(0), std::vector<float>(bytes.size() / sizeof(float))};
    std::memcpy(image.values.data(), bytes.data(), bytes.size());
    return image;
}

ByteImage color_image(const Texture& texture) {
    GNOMON_CHECK(texture.desc().format == Format::Rgba8Unorm);
    const std::vector<std::byte> bytes = texture.level_bytes(0);
    ByteImage image{.width = texture.width(0), .height = texture.height(0), .channels = 3, .values = {}};
    image.values.reserve(bytes.size() / 4 * 3);
    for (std::size_t texel = 0; texel < bytes.size(); texel += 4)
        for (std::size_t channel = 0; channel < 3; ++channel)
            image.values.push_back(std::to_integer<std::uint8_t>(bytes[texel + channel]));
    return image;
}

ByteImage grey_image(const FloatImage& image) {
    ByteImage grey{.width = image.width, .height = image.height, .channels = 1, .values = {}};
    grey.values.reserve(image.values.size());
    for (const float value : image.values) {
        const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;  // and NaN is 0
        grey.values.push_back(static_cast<std::uint8_t>(clamped * 255.0f + 0.5f));
    }
    return grey;
}

}  // namespace gnomon::studies
