// Where the samples of a pixel lie. D3D11.3 19.2.4; Vulkan 1.3 26.4 (Standard Sample Locations)
#pragma once

#include "pipeline/primitive.h"
#include "sim/profile.h"
#include "texunit/texture.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace gnomon {

inline constexpr SamplePosition kPixelCentre{8, 8};

/// The samples of a pixel by index.
struct SamplePattern {
    int count = 1;
    std::array<SamplePosition, kMaxSamples> at{kPixelCentre};

    [[nodiscard]] std::uint32_t all() const { return (1u << count) - 1u; }
};

/// The profile's positions for `count` samples.
inline SamplePattern sample_pattern(const Profile& profile, int count) {
    SamplePattern pattern{.count = count};
    const auto take = [&](const auto& positions) { std::copy(positions.begin(), positions.end(), pattern.at.begin()); };
    switch (count) {
        case 2: take(profile.sample_positions_2); break;
        case 4: take(profile.sample_positions_4); break;
        case 8: take(profile.sample_positions_8); break;
        case 16: take(profile.sample_positions_16); break;
        default: break;
    }
    return pattern;
}

/// The mirror images of samples in the middle column of their pixel.
inline SamplePattern mirrored(SamplePattern pattern) {
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s) pattern.at[s].x = 16 - pattern.at[s].x;
    return pattern;
}

/// The least and the largest position of a sample, in 1/256 pixel; both ends inclusive.
inline PixelRect sample_extent(const SamplePattern& pattern) {
    PixelRect extent{kSubpixels, kSubpixels, 0, 0};
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s) {
        const int x = pattern.at[s].x * kSampleGrid;
        const int y = pattern.at[s].y * kSampleGrid;
        extent = {std::min(extent.x0, x), std::min(extent.y0, y), std::max(extent.x1, x), std::max(extent.y1, y)};
    }
    return extent;
}

}  // namespace gnomon
