// The enumerations of sampling.h by the names that gnomon_agree_sample and messages use.
#pragma once

#include "sim/enum_names.h"
#include "tests/agree/sampling.h"

namespace gnomon {

template <>
inline constexpr std::array kEnumNames<agree::TexelFormat> = std::to_array<EnumName<agree::TexelFormat>>({
    {agree::TexelFormat::R32f, "r32f"},
    {agree::TexelFormat::Rg32f, "rg32f"},
    {agree::TexelFormat::Rg16f, "rg16f"},
    {agree::TexelFormat::Rgba8, "rgba8"},
    {agree::TexelFormat::Rg16Unorm, "rg16unorm"},
    {agree::TexelFormat::D32f, "d32f"},
});

template <>
inline constexpr std::array kEnumNames<agree::Filter> = std::to_array<EnumName<agree::Filter>>({
    {agree::Filter::Nearest, "nearest"},
    {agree::Filter::Linear, "linear"},
});

template <>
inline constexpr std::array kEnumNames<agree::Mip> = std::to_array<EnumName<agree::Mip>>({
    {agree::Mip::Base, "base"},
    {agree::Mip::Nearest, "nearest"},
    {agree::Mip::Linear, "linear"},
});

template <>
inline constexpr std::array kEnumNames<agree::Address> = std::to_array<EnumName<agree::Address>>({
    {agree::Address::Wrap, "wrap"},
    {agree::Address::Mirror, "mirror"},
    {agree::Address::Clamp, "clamp"},
    {agree::Address::Border, "border"},
    {agree::Address::MirrorOnce, "mirror-once"},
});

template <>
inline constexpr std::array kEnumNames<agree::Compare> = std::to_array<EnumName<agree::Compare>>({
    {agree::Compare::None, "none"},
    {agree::Compare::Never, "never"},
    {agree::Compare::Less, "less"},
    {agree::Compare::Equal, "equal"},
    {agree::Compare::LessEqual, "less-equal"},
    {agree::Compare::Greater, "greater"},
    {agree::Compare::NotEqual, "not-equal"},
    {agree::Compare::GreaterEqual, "greater-equal"},
    {agree::Compare::Always, "always"},
});

template <>
inline constexpr std::array kEnumNames<agree::Instruction> = std::to_array<EnumName<agree::Instruction>>({
    {agree::Instruction::Gradient, "gradient"},
    {agree::Instruction::Lod, "lod"},
    {agree::Instruction::Gather, "gather"},
});

}  // namespace gnomon
