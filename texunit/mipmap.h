// Mip generation on the device, level by level, rounded to the texture's format at every level.
#pragma once

#include "sim/parallel.h"
#include "sim/profile.h"
#include "texunit/texture.h"

namespace gnomon {

/// Fills levels 1 and up of every layer from level 0 by the profile's filter. MipGeneration::Bilinear: one bilinear sample at
/// the coarser texel's centre. MipGeneration::Box: each texel is the mean of the area it covers in the level above: 2 texels
/// per axis where the side above is even, 3 with weights (n-x, n, x+1) / (2n+1) for texel x of n where it is odd (the polyphase
/// box filter), 1 where it is 1. Columns first, then rows, in the profile's arithmetic; constants stay constant. Throws Error
/// for formats of integers. D3D11.3 5.9.3.3.1 leaves the filter open.
void generate_mips(Texture& texture, const Profile& profile, Workers& workers);

}  // namespace gnomon
