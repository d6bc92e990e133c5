// Blend equations as llvmpipe and SwiftShader compute them. D3D11.3 17.5 bounds their precision and leaves the roundings open.
// Mesa 22.3.6 lp_bld_blend.c, lp_bld_blend_aos.c, lp_state_fs.c; SwiftShader PixelRoutine.cpp, PixelProgram.cpp
#pragma once

#include "pipeline/blend.h"

#include <array>

namespace gnomon {

/// What a blend on integers reads, all as codes of the target's width.
struct BlendCodes {
    std::array<Int, 4> src;
    std::array<Int, 4> src1;
    std::array<Int, 4> dst;
    std::array<Int, 4> constant;
};

/// llvmpipe on UNORM targets of 8 or 16 bits: products are rounded to codes, sums saturate.
std::array<Int, 4> blend_codes(const BlendCodes& in, const BlendState& state, int bits);

/// llvmpipe on float targets. Where source and destination factor have one name, in colour and in alpha, their product comes
/// last; factors of one and zero cost no operation. Blends of halves keep denormals.
Vec4<Float> blend_as_llvmpipe(const BlendInput<Float>& in, const BlendState& state, bool flush_denormals);

/// SwiftShader on any target; the caller limits what UNORM targets blend to [0, 1].
Vec4<Float> blend_as_swiftshader(const BlendInput<Float>& in, const BlendState& state);
/// Whether SwiftShader does not touch the target: both equations are what is there.
bool leaves_target(const BlendState& state);

}  // namespace gnomon
