// Scalar calls of the texture unit for tests: lanes are filled from lists and read back.
#pragma once

#include "sim/denormals.h"
#include "tests/oracle/texture.h"
#include "texunit/sample.h"

#include <cstring>
#include <span>
#include <vector>

namespace gnomon::testing {

struct Coordinate {
    float u = 0;
    float v = 0;
    float lod = 0;
    float reference = 0;
};

inline oracle::Address oracle_mode(AddressMode mode) {
    switch (mode) {
        case AddressMode::Wrap: return oracle::Address::Wrap;
        case AddressMode::Mirror: return oracle::Address::Mirror;
        case AddressMode::Clamp: return oracle::Address::Clamp;
        case AddressMode::Border: return oracle::Address::Border;
        case AddressMode::MirrorOnce: return oracle::Address::MirrorOnce;
    }
    return oracle::Address::Wrap;
}

/// Loads one field of up to kLanes coordinates; missing lanes repeat the last.
template <class Real, class Get>
Real load_field(std::span<const Coordinate> wave, const Get& get) {
    std::array<typename Real::Scalar, kLanes> values;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<typename Real::Scalar>(get(wave[std::min(i, wave.size() - 1)]));
    return Real::load(values.data());
}

/// Calls body(wave, first) for every wave of the list.
template <class Body>
void for_waves(std::span<const Coordinate> coordinates, const Body& body) {
    for (std::size_t i = 0; i < coordinates.size(); i += kLanes)
        body(coordinates.subspan(i, std::min<std::size_t>(kLanes, coordinates.size() - i)), i);
}

template <class Real = Float>
std::vector<std::array<typename Real::Scalar, 4>> sample_all(const Texture& texture, const Sampler& sampler,
                                                             const Profile& profile, std::span<const Coordinate> coordinates) {
    const DenormalScope denormals(profile.flush_denormals);
    std::vector<std::array<typename Real::Scalar, 4>> out(coordinates.size());
    for_waves(coordinates, [&](std::span<const Coordinate> wave, std::size_t first) {
        const Vec2<Real> uv{load_field<Real>(wave, [](const Coordinate& c) { return c.u; }),
                            load_field<Real>(wave, [](const Coordinate& c) { return c.v; })};
        const Vec4<Real> color = sample(TextureView(texture), sampler, profile, uv,
                                        LevelOfDetail<Real>(load_field<Real>(wave, [](const Coordinate& c) { return c.lod; })));
        for (std::size_t i = 0; i < wave.size(); ++i) {
            const int l = static_cast<int>(i);
            out[first + i] = {lane(color.x, l), lane(color.y, l), lane(color.z, l), lane(color.w, l)};
        }
    });
    return out;
}

template <class Real = Float>
std::vector<typename Real::Scalar> compare_all(const Texture& texture, const Sampler& sampler, const Profile& profile,
                                               std::span<const Coordinate> coordinates) {
    const DenormalScope denormals(profile.flush_denormals);
    std::vector<typename Real::Scalar> out(coordinates.size());
    for_waves(coordinates, [&](std::span<const Coordinate> wave, std::size_t first) {
        const Vec2<Real> uv{load_field<Real>(wave, [](const Coordinate& c) { return c.u; }),
                            load_field<Real>(wave, [](const Coordinate& c) { return c.v; })};
        const Real result = sample_compare(
            TextureView(texture), sampler, profile, uv, load_field<Real>(wave, [](const Coordinate& c) { return c.reference; }),
            LevelOfDetail<Real>(load_field<Real>(wave, [](const Coordinate& c) { return c.lod; })));
        for (std::size_t i = 0; i < wave.size(); ++i) out[first + i] = lane(result, static_cast<int>(i));
    });
    return out;
}

/// Bits of the code of a component.
inline int code_bits(const FormatInfo& info, int component) {
    switch (info.type) {
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8: return 8;
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Float16: return 16;
        case ComponentType::Float11: return component < 2 ? 11 : 10;
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Depth16:
        case ComponentType::Depth24:
        case ComponentType::Depth32: return 32;
    }
    return 0;
}

/// Where a component starts within the texel.
inline int first_bit(const FormatInfo& info, int component) {
    int bit = 0;
    for (int c = 0; c < component; ++c) bit += code_bits(info, c);
    return bit;
}

/// Component codes of whole texels as the format stores them.
inline std::vector<std::byte> packed(Format format, std::span<const std::uint32_t> codes) {
    const FormatInfo& info = format_info(format);
    const auto components = static_cast<std::size_t>(info.components);
    std::vector<std::byte> bytes(codes.size() / components * static_cast<std::size_t>(info.bytes_per_texel));
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const int c = static_cast<int>(i % components);
        std::byte* texel = bytes.data() + i / components * static_cast<std::size_t>(info.bytes_per_texel);
        for (int b = 0; b < code_bits(info, c); ++b) {
            const int bit = first_bit(info, c) + b;
            if ((codes[i] >> b & 1u) != 0) texel[bit / 8] |= static_cast<std::byte>(1 << (bit % 8));
        }
    }
    return bytes;
}

/// A component's code in a stored texture.
inline std::uint32_t code_at(const Texture& texture, int level, int x, int y, int component) {
    const FormatInfo& info = texture.info();
    const std::byte* texel = texture.row(level, y) + x * info.bytes_per_texel;
    std::uint32_t code = 0;
    for (int b = 0; b < code_bits(info, component); ++b) {
        const int bit = first_bit(info, component) + b;
        code |= (static_cast<std::uint32_t>(texel[bit / 8]) >> (bit % 8) & 1u) << b;
    }
    return code;
}

/// A texture with one level of raw component codes, `components` per texel.
inline Texture texture_of(Format format, int width, int height, std::span<const std::uint32_t> codes) {
    Texture texture({.format = format, .width = width, .height = height});
    const auto bytes = packed(format, codes);
    texture.set_level_bytes(0, bytes.data(), bytes.size());
    return texture;
}

/// What a component code means, in double. D3D11.3 3.1.5, 3.1.6, 3.2.3. Values that 3.2.3 rounds are rounded to fp32 once.
inline double code_value(Format format, std::uint32_t code, int component = 0) {
    const auto once = [](double exact) { return static_cast<double>(static_cast<float>(exact)); };
    const auto snorm = [&](int value, int largest) { return once(std::max(value, -largest) / static_cast<double>(largest)); };
    switch (format_info(format).type) {
        case ComponentType::Unorm8: return once(code / 255.0);
        case ComponentType::Snorm8: return snorm(static_cast<std::int8_t>(code), 127);
        case ComponentType::Srgb8:
            if (component == 3 || code == 255) return once(code / 255.0);
            return once(code / 255.0 <= 0.04045 ? code / 255.0 / 12.92 : std::pow((code / 255.0 + 0.055) / 1.055, 2.4));
        case ComponentType::Unorm16:
        case ComponentType::Depth16: return once(code / 65535.0);
        case ComponentType::Snorm16: return snorm(static_cast<std::int16_t>(code), 32767);
        case ComponentType::Depth24: return once(code / 16777215.0);
        case ComponentType::Float16: return oracle::half_value(code);
        case ComponentType::Float11:
            return oracle::half_value(component < 2 ? code << 4 : code << 5);  // the same exponent, fewer mantissa bits
        case ComponentType::Uint32: return code;
        case ComponentType::Float32:
        case ComponentType::Depth32: return static_cast<double>(std::bit_cast<float>(code));
    }
    return 0;
}

/// A code with a moderate value: finite, magnitude at most 1 (signed formats may be negative); integers are any.
template <class Random>
std::uint32_t moderate_code(Format format, Random& random, int component = 0) {
    switch (format_info(format).type) {
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8: return random.bits() & 0xffu;
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Depth16: return random.bits() & 0xffffu;
        case ComponentType::Depth24: return random.bits() & 0xffffffu;
        case ComponentType::Float16:
            return (random.bits() & 0x8000u) | static_cast<std::uint32_t>(random.between(0x0400, 0x3c00));
        case ComponentType::Float11:
            return static_cast<std::uint32_t>(component < 2 ? random.between(0x40, 0x3c0) : random.between(0x20, 0x1e0));
        case ComponentType::Uint32: return random.bits();
        case ComponentType::Float32: return std::bit_cast<std::uint32_t>(random.in(-1.0f, 1.0f));
        case ComponentType::Depth32: return std::bit_cast<std::uint32_t>(random.unit());
    }
    return 0;
}

}  // namespace gnomon::testing
