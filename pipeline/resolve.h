// Samples to pixels: the mean. D3D11.3 19.2.4, 5.6.6
#pragma once

#include "sim/parallel.h"
#include "sim/profile.h"
#include "texunit/texture.h"

namespace gnomon {

/// Where a resolve reads and writes.
struct ResolvePlace {
    int source_layer = 0;
    int level = 0;  // of the destination
    int layer = 0;
};

/// Sums the samples of each pixel in index order in the profile's arithmetic, multiplies by 1 / N and rounds to the format;
/// sRGB as linear light. The textures have one format; the destination level has the source's size.
void resolve_samples(const Texture& source, Texture& destination, const ResolvePlace& place, const Profile& profile,
                     Workers& workers);

}  // namespace gnomon
