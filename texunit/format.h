// The texel formats: one table row each. D3D11.3 19.1
#pragma once

#include "sim/enum_names.h"

#include <cstdint>
#include <span>

namespace gnomon {

/// What the bits of one component mean, and so how they become a number and back.
enum class ComponentType {
    Unorm8,
    Snorm8,
    Srgb8,  // red, green and blue; alpha is UNORM
    Unorm16,
    Snorm16,
    Float16,
    Float32,
    Uint32,
    Float11,  // red and green 11 bits, blue 10, in one word; no sign
    Depth16,  // UNORM; a depth texel of any precision is stored as a 32-bit code whose order is the order of depths
    Depth24,
    Depth32,  // binary32 in [0, 1], as its bits
};

enum class Format {
    R8Unorm,
    Rg8Unorm,
    Rgba8Unorm,
    R8Snorm,
    Rg8Snorm,
    Rgba8Snorm,
    Rgba8Srgb,
    R16Unorm,
    Rg16Unorm,
    Rgba16Unorm,
    R16Snorm,
    Rg16Snorm,
    Rgba16Snorm,
    R16Float,
    Rg16Float,
    Rgba16Float,
    R32Float,
    Rg32Float,
    Rgba32Float,
    R32Uint,
    Rg32Uint,
    Rgba32Uint,
    R11G11B10Float,
    D16,
    D24,
    D32Float,
    D24UnormS8,
    D32FloatS8,
};

struct FormatInfo {
    Format format;
    std::string_view name;
    ComponentType type;
    int components;          // 1 to 4; components a format lacks read as 0, alpha as 1
    int bytes_per_texel;     // as stored here
    int bits_per_component;  // as the format defines it: what a cost model counts; red's where they differ
    bool is_depth;
    bool has_stencil = false;  // 8 bits beside each depth, stored apart from it

    /// Unsigned integers are read as they are and never filtered. D3D11.3 19.1.4
    [[nodiscard]] constexpr bool is_integer() const { return type == ComponentType::Uint32; }
};

inline constexpr std::array kFormats{
    FormatInfo{Format::R8Unorm, "r8unorm", ComponentType::Unorm8, 1, 1, 8, false},
    FormatInfo{Format::Rg8Unorm, "rg8unorm", ComponentType::Unorm8, 2, 2, 8, false},
    FormatInfo{Format::Rgba8Unorm, "rgba8unorm", ComponentType::Unorm8, 4, 4, 8, false},
    FormatInfo{Format::R8Snorm, "r8snorm", ComponentType::Snorm8, 1, 1, 8, false},
    FormatInfo{Format::Rg8Snorm, "rg8snorm", ComponentType::Snorm8, 2, 2, 8, false},
    FormatInfo{Format::Rgba8Snorm, "rgba8snorm", ComponentType::Snorm8, 4, 4, 8, false},
    FormatInfo{Format::Rgba8Srgb, "rgba8srgb", ComponentType::Srgb8, 4, 4, 8, false},
    FormatInfo{Format::R16Unorm, "r16unorm", ComponentType::Unorm16, 1, 2, 16, false},
    FormatInfo{Format::Rg16Unorm, "rg16unorm", ComponentType::Unorm16, 2, 4, 16, false},
    FormatInfo{Format::Rgba16Unorm, "rgba16unorm", ComponentType::Unorm16, 4, 8, 16, false},
    FormatInfo{Format::R16Snorm, "r16snorm", ComponentType::Snorm16, 1, 2, 16, false},
    FormatInfo{Format::Rg16Snorm, "rg16snorm", ComponentType::Snorm16, 2, 4, 16, false},
    FormatInfo{Format::Rgba16Snorm, "rgba16snorm", ComponentType::Snorm16, 4, 8, 16, false},
    FormatInfo{Format::R16Float, "r16f", ComponentType::Float16, 1, 2, 16, false},
    FormatInfo{Format::Rg16Float, "rg16f", ComponentType::Float16, 2, 4, 16, false},
    FormatInfo{Format::Rgba16Float, "rgba16f", ComponentType::Float16, 4, 8, 16, false},
    FormatInfo{Format::R32Float, "r32f", ComponentType::Float32, 1, 4, 32, false},
    FormatInfo{Format::Rg32Float, "rg32f", ComponentType::Float32, 2, 8, 32, false},
    FormatInfo{Format::Rgba32Float, "rgba32f", ComponentType::Float32, 4, 16, 32, false},
    FormatInfo{Format::R32Uint, "r32ui", ComponentType::Uint32, 1, 4, 32, false},
    FormatInfo{Format::Rg32Uint, "rg32ui", ComponentType::Uint32, 2, 8, 32, false},
    FormatInfo{Format::Rgba32Uint, "rgba32ui", ComponentType::Uint32, 4, 16, 32, false},
    FormatInfo{Format::R11G11B10Float, "r11g11b10f", ComponentType::Float11, 3, 4, 11, false},
    FormatInfo{Format::D16, "d16", ComponentType::Depth16, 1, 4, 16, true},
    FormatInfo{Format::D24, "d24", ComponentType::Depth24, 1, 4, 24, true},
    FormatInfo{Format::D32Float, "d32f", ComponentType::Depth32, 1, 4, 32, true},
    FormatInfo{Format::D24UnormS8, "d24s8", ComponentType::Depth24, 1, 4, 24, true, true},
    FormatInfo{Format::D32FloatS8, "d32fs8", ComponentType::Depth32, 1, 4, 32, true, true},
};

/// Bytes of a texel as the format defines it: what a memory model counts. D16 takes two, whatever this machine stores.
constexpr std::uint64_t texel_bytes(const FormatInfo& info) {
    const int bits = info.type == ComponentType::Float11 ? 32 : info.components * info.bits_per_component;
    return static_cast<std::uint64_t>((bits + 7) / 8);
}

constexpr const FormatInfo& format_info(Format format) { return kFormats[static_cast<std::size_t>(format)]; }

template <>
inline constexpr std::array kEnumNames<Format> = [] {
    std::array<EnumName<Format>, kFormats.size()> names{};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = {kFormats[i].format, kFormats[i].name};
    return names;
}();

static_assert([] {
    for (std::size_t i = 0; i < kFormats.size(); ++i)
        if (kFormats[i].format != static_cast<Format>(i)) return false;
    return true;
}());

}  // namespace gnomon
