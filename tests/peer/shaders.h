// The shaders of tests/peer/shaders, as compiled by glslangValidator at build time.
#pragma once

#include "tests/peer/frame.h"
#include "tests/peer/owned.h"

#include <cstdint>
#include <span>

namespace gnomon::peer {

/// SPIR-V words; empty where a stage is not needed (a depth map has no caster fragments).
struct ShaderPair {
    std::span<const std::uint32_t> vertex;
    std::span<const std::uint32_t> fragment;
};

ShaderPair caster_shaders(MapKind map);
/// Specialisation constant 0 of the fragments is `taps` for a depth map and must be set where no shader has that many taps
/// written out; for moments, warped or not, it is 1 with anisotropic filtering and 0 without.
ShaderPair receiver_shaders(MapKind map, int taps);
/// For a map of moments, warped or not. Specialisation constant 0 of the fragments is taps / 2.
ShaderPair blur_shaders(MapKind map, int taps);

/// Of raw_pass.h: without fragments, or with plain or textured ones.
enum class RawFragments { None, Plain, Textured };
ShaderPair raw_shaders(RawFragments fragments);

OwnedShader make_shader(VkDevice device, std::span<const std::uint32_t> spirv);

}  // namespace gnomon::peer
