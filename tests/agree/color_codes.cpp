// Bytes, codes, floats.
#include "tests/agree/color_codes.h"

#include "sim/half.h"

#include <bit>
#include <cstring>

namespace gnomon::agree {
namespace {

std::size_t channel_bytes(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return 1;
        case ColorFormat::Rgba16Unorm:
        case ColorFormat::Rgba16f: return 2;
        case ColorFormat::Rgba32f: return 4;
    }
    return 4;
}

float value_of(ColorFormat format, std::uint32_t code) {
    switch (format) {
        case ColorFormat::Rgba8: return static_cast<float>(code) / 255.0f;
        case ColorFormat::Rgba16Unorm: return static_cast<float>(code) / 65535.0f;
        case ColorFormat::Rgba16f: return float_from_half({static_cast<std::uint16_t>(code)});
        case ColorFormat::Rgba32f: return std::bit_cast<float>(code);
    }
    return 0;
}

}  // namespace

static_assert(std::endian::native == std::endian::little);

std::vector<std::byte> texels_from_codes(ColorFormat format, std::span<const Codes> codes) {
    const std::size_t bytes = channel_bytes(format);
    std::vector<std::byte> texels(codes.size() * 4 * bytes);
    for (std::size_t i = 0; i < codes.size() * 4; ++i) std::memcpy(&texels[i * bytes], &codes[i / 4][i % 4], bytes);
    return texels;
}

std::vector<Codes> codes_from_texels(ColorFormat format, std::span<const std::byte> texels) {
    const std::size_t bytes = channel_bytes(format);
    std::vector<Codes> codes(texels.size() / (4 * bytes));
    for (std::size_t i = 0; i < codes.size() * 4; ++i) std::memcpy(&codes[i / 4][i % 4], &texels[i * bytes], bytes);
    return codes;
}

Color color_from_codes(ColorFormat format, const Codes& codes) {
    Color color{};
    for (std::size_t i = 0; i < 4; ++i) color[i] = value_of(format, codes[i]);
    return color;
}

}  // namespace gnomon::agree
