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
        const Vec4<Real> color =
            sample(texture, sampler, profile, uv, load_field<Real>(wave, [](const Coordinate& c) { return c.lod; }));
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
        const Real result = sample_compare(texture, sampler, profile, uv,
                                           load_field<Real>(wave, [](const Coordinate& c) { return c.reference; }),
                                           load_field<Real>(wave, [](const Coordinate& c) { return c.lod; }));
        for (std::size_t i = 0; i < wave.size(); ++i) out[first + i] = lane(result, static_cast<int>(i));
    });
    return out;
}

/// A texture with one level of raw component codes, `components` per texel.
inline Texture texture_of(Format format, int width, int height, std::span<const std::uint32_t> codes) {
    Texture texture({.format = format, .width = width, .height = height});
    const FormatInfo& info = texture.info();
    const std::size_t size = static_cast<std::size_t>(info.bytes_per_texel / info.components);
    std::vector<std::byte> bytes(codes.size() * size);
    for (std::size_t i = 0; i < codes.size(); ++i) std::memcpy(bytes.data() + i * size, &codes[i], size);
    texture.set_level_bytes(0, bytes.data(), bytes.size());
    return texture;
}

/// What a component code means, in double. D3D11.3 3.1.5, 3.2.3.5. UNORM values are rounded to fp32 once, as 3.2.3.5 asks.
inline double code_value(Format format, std::uint32_t code) {
    const FormatInfo& info = format_info(format);
    switch (info.type) {
        case ComponentType::Unorm8: return static_cast<double>(static_cast<float>(static_cast<double>(code) / 255.0));
        case ComponentType::Unorm16:
        case ComponentType::Depth16: return static_cast<double>(static_cast<float>(static_cast<double>(code) / 65535.0));
        case ComponentType::Depth24: return static_cast<double>(static_cast<float>(static_cast<double>(code) / 16777215.0));
        case ComponentType::Float16: return oracle::half_value(code);
        case ComponentType::Float32:
        case ComponentType::Depth32: return static_cast<double>(std::bit_cast<float>(code));
    }
    return 0;
}

/// A code with a moderate value: finite, magnitude at most 1 (floats may be negative).
template <class Random>
std::uint32_t moderate_code(Format format, Random& random) {
    switch (format_info(format).type) {
        case ComponentType::Unorm8: return random.bits() & 0xffu;
        case ComponentType::Unorm16:
        case ComponentType::Depth16: return random.bits() & 0xffffu;
        case ComponentType::Depth24: return random.bits() & 0xffffffu;
        case ComponentType::Float16:
            return (random.bits() & 0x8000u) | static_cast<std::uint32_t>(random.between(0x0400, 0x3c00));
        case ComponentType::Float32: return std::bit_cast<std::uint32_t>(random.in(-1.0f, 1.0f));
        case ComponentType::Depth32: return std::bit_cast<std::uint32_t>(random.unit());
    }
    return 0;
}

}  // namespace gnomon::testing
