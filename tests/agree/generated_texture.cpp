// Bits from a Mersenne Twister, whose sequence the C++ standard fixes.
#include "tests/agree/generated_texture.h"

#include "sim/error.h"

#include <glm/gtc/packing.hpp>

#include <cstring>
#include <random>

namespace gnomon::agree {
namespace {

// 32 bits of a level: one float, or two 16-bit components, or four bytes.
std::uint32_t random_word(TexelFormat format, std::mt19937& random) {
    const auto bits = static_cast<std::uint32_t>(random());
    switch (format) {
        case TexelFormat::R32f:
        case TexelFormat::Rg32f:
        case TexelFormat::D32f: {
            const float value = static_cast<float>(bits >> 8) * 0x1p-24f;
            std::uint32_t word = 0;
            std::memcpy(&word, &value, sizeof(word));
            return word;
        }
        case TexelFormat::Rg16f: {
            const std::uint32_t low = glm::packHalf1x16(static_cast<float>(bits & 0x7ffu) * 0x1p-11f);
            const std::uint32_t high = glm::packHalf1x16(static_cast<float>(bits >> 21) * 0x1p-11f);
            return low | high << 16;
        }
        case TexelFormat::Rgba8:
        case TexelFormat::Rg16Unorm: return bits;
    }
    fail("unknown texel format");
}

template <class T>
T component_bits(const std::byte* texel, int component) {
    T bits{};
    std::memcpy(&bits, texel + static_cast<std::size_t>(component) * sizeof(T), sizeof(T));
    return bits;
}

}  // namespace

Levels random_levels(TexelFormat format, int width, int height, int level_count, std::uint64_t seed) {
    if (width < 1 || height < 1) fail("a texture of {}x{} texels; expected at least 1x1", width, height);
    if (level_count < 1 || level_count > full_levels(width, height))
        fail("{} levels of a {}x{} texture; expected 1 to {}", level_count, width, height, full_levels(width, height));
    std::seed_seq seeds{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)};
    std::mt19937 random(seeds);
    Levels texture{.format = format, .width = width, .height = height};
    for (int level = 0; level < level_count; ++level) {
        const auto texels =
            static_cast<std::size_t>(level_size(width, level)) * static_cast<std::size_t>(level_size(height, level));
        std::vector<std::byte>& bytes = texture.levels.emplace_back(texels * texel_bytes(format));
        for (std::size_t i = 0; i < bytes.size(); i += 4) {
            const std::uint32_t word = random_word(format, random);
            std::memcpy(bytes.data() + i, &word, sizeof(word));
        }
    }
    return texture;
}

int component_count(TexelFormat format) {
    switch (format) {
        case TexelFormat::R32f:
        case TexelFormat::D32f: return 1;
        case TexelFormat::Rg32f:
        case TexelFormat::Rg16f:
        case TexelFormat::Rg16Unorm: return 2;
        case TexelFormat::Rgba8: return 4;
    }
    fail("unknown texel format");
}

Sample texel_value(const Levels& texture, int level, int x, int y) {
    const auto index = static_cast<std::size_t>(y * level_size(texture.width, level) + x);
    const std::byte* texel = texture.levels.at(static_cast<std::size_t>(level)).data() + index * texel_bytes(texture.format);
    Sample value{0, 0, 0, 1};
    for (int i = 0; i < component_count(texture.format); ++i) {
        float& component = value[static_cast<std::size_t>(i)];
        switch (texture.format) {
            case TexelFormat::R32f:
            case TexelFormat::Rg32f:
            case TexelFormat::D32f: component = component_bits<float>(texel, i); break;
            case TexelFormat::Rg16f: component = glm::unpackHalf1x16(component_bits<std::uint16_t>(texel, i)); break;
            case TexelFormat::Rgba8: component = static_cast<float>(component_bits<std::uint8_t>(texel, i)) / 255.0f; break;
            case TexelFormat::Rg16Unorm:
                component = static_cast<float>(component_bits<std::uint16_t>(texel, i)) / 65535.0f;
                break;
        }
    }
    return value;
}

}  // namespace gnomon::agree
