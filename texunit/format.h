// The texel formats: one table row each. D3D11.3 19.1
#pragma once

#include "sim/enum_names.h"

#include <span>

namespace gnomon {

/// What the bits of one component mean, and so how they become a number and back.
enum class ComponentType {
    Unorm8,
    Unorm16,
    Float16,
    Float32,
    Depth16,  // UNORM; a depth texel of any precision is stored as a 32-bit code whose order is the order of depths
    Depth24,
    Depth32,  // binary32 in [0, 1], as its bits
};

enum class Format {
    R8Unorm,
    Rg8Unorm,
    Rgba8Unorm,
    R16Unorm,
    Rg16Unorm,
    Rgba16Unorm,
    R16Float,
    Rg16Float,
    Rgba16Float,
    R32Float,
    Rg32Float,
    Rgba32Float,
    D16,
    D24,
    D32Float,
};

struct FormatInfo {
    Format format;
    std::string_view name;
    ComponentType type;
    int components;          // 1, 2 or 4; components a format lacks read as 0, alpha as 1
    int bytes_per_texel;     // as stored here
    int bits_per_component;  // as the format defines it: what a cost model counts
    bool is_depth;
};

template <>
inline constexpr std::array kEnumNames<Format>{EnumName{Format::R8Unorm, "r8unorm"},
                                               EnumName{Format::Rg8Unorm, "rg8unorm"},
                                               EnumName{Format::Rgba8Unorm, "rgba8unorm"},
                                               EnumName{Format::R16Unorm, "r16unorm"},
                                               EnumName{Format::Rg16Unorm, "rg16unorm"},
                                               EnumName{Format::Rgba16Unorm, "rgba16unorm"},
                                               EnumName{Format::R16Float, "r16f"},
                                               EnumName{Format::Rg16Float, "rg16f"},
                                               EnumName{Format::Rgba16Float, "rgba16f"},
                                               EnumName{Format::R32Float, "r32f"},
                                               EnumName{Format::Rg32Float, "rg32f"},
                                               EnumName{Format::Rgba32Float, "rgba32f"},
                                               EnumName{Format::D16, "d16"},
                                               EnumName{Format::D24, "d24"},
                                               EnumName{Format::D32Float, "d32f"}};

inline constexpr std::array kFormats{
    FormatInfo{Format::R8Unorm, "r8unorm", ComponentType::Unorm8, 1, 1, 8, false},
    FormatInfo{Format::Rg8Unorm, "rg8unorm", ComponentType::Unorm8, 2, 2, 8, false},
    FormatInfo{Format::Rgba8Unorm, "rgba8unorm", ComponentType::Unorm8, 4, 4, 8, false},
    FormatInfo{Format::R16Unorm, "r16unorm", ComponentType::Unorm16, 1, 2, 16, false},
    FormatInfo{Format::Rg16Unorm, "rg16unorm", ComponentType::Unorm16, 2, 4, 16, false},
    FormatInfo{Format::Rgba16Unorm, "rgba16unorm", ComponentType::Unorm16, 4, 8, 16, false},
    FormatInfo{Format::R16Float, "r16f", ComponentType::Float16, 1, 2, 16, false},
    FormatInfo{Format::Rg16Float, "rg16f", ComponentType::Float16, 2, 4, 16, false},
    FormatInfo{Format::Rgba16Float, "rgba16f", ComponentType::Float16, 4, 8, 16, false},
    FormatInfo{Format::R32Float, "r32f", ComponentType::Float32, 1, 4, 32, false},
    FormatInfo{Format::Rg32Float, "rg32f", ComponentType::Float32, 2, 8, 32, false},
    FormatInfo{Format::Rgba32Float, "rgba32f", ComponentType::Float32, 4, 16, 32, false},
    FormatInfo{Format::D16, "d16", ComponentType::Depth16, 1, 4, 16, true},
    FormatInfo{Format::D24, "d24", ComponentType::Depth24, 1, 4, 24, true},
    FormatInfo{Format::D32Float, "d32f", ComponentType::Depth32, 1, 4, 32, true},
};

constexpr const FormatInfo& format_info(Format format) { return kFormats[static_cast<std::size_t>(format)]; }

static_assert([] {
    for (std::size_t i = 0; i < kFormats.size(); ++i)
        if (kFormats[i].format != static_cast<Format>(i)) return false;
    return true;
}());

}  // namespace gnomon
