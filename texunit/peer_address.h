// Texel addresses as two software GPUs compute them, operation by operation in binary32: what profiles `llvmpipe` and
// `swiftshader` are made of. Mesa 22.3.6 lp_bld_sample_soa.c and lp_bld_sample_aos.c; SwiftShader SamplerCore.cpp, address()
#pragma once

#include "texunit/address.h"

namespace gnomon {

/// x86 minps and maxps: with a NaN, or equal operands, the second.
inline Float min_second(Float a, Float b) { return select(a < b, a, b); }
inline Float max_second(Float a, Float b) { return select(a > b, a, b); }

/// One axis of a level, as these renderers look at it.
struct PeerAxis {
    Int size;                // of the level, texels
    bool base_power_of_two;  // of the view's finest level
    bool linear;             // two texels, else one
    AddressMode mode;
    int offset;    // of the instruction, texels
    bool gathers;  // no weights: each texel of the footprint is mirrored and clamped on its own
};

/// Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_sample_wrap_nearest and lp_build_sample_wrap_linear.
AxisTexels<Float> llvmpipe_texels(Float coordinate, const PeerAxis& axis);

/// SwiftShader SamplerCore.cpp, address(); `integer` for UNORM formats that are not filtered, whose coordinates have 16 bits.
AxisTexels<Float> swiftshader_texels(Float coordinate, const PeerAxis& axis, bool integer);

/// The 24.8 coordinates of llvmpipe's 8-bit filter, modes wrap and clamp only; the fraction is a multiple of 1/256.
/// Mesa 22.3.6 lp_bld_sample_aos.c, lp_build_sample_image_nearest and lp_build_sample_image_linear
AxisTexels<Float> llvmpipe_fixed_texels(Float coordinate, const PeerAxis& axis);

}  // namespace gnomon
