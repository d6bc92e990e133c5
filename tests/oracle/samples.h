// Standard sample patterns and where the samples of a pixel lie on the snapped grid. D3D11.3 19.2.4, Vulkan "Standard Sample
// Locations"
#pragma once

#include "tests/oracle/raster.h"

#include <array>
#include <cstdint>
#include <utility>

namespace oracle {

/// Sample positions of one pixel in 1/16 pixel from its top left corner, in index order.
struct SamplePattern {
    int count = 1;
    std::array<std::pair<int, int>, 16> positions{{{8, 8}}};

    /// Where sample i of pixel (x, y) lies, 1/256 pixel.
    [[nodiscard]] Point at(int x, int y, int i) const {
        const auto [dx, dy] = positions[static_cast<std::size_t>(i)];
        return {std::int64_t{x} * 256 + dx * 16, std::int64_t{y} * 256 + dy * 16};
    }
    [[nodiscard]] std::uint32_t all() const { return (1u << count) - 1u; }
};

inline constexpr std::array<int, 5> kSampleCounts{1, 2, 4, 8, 16};

/// The standard pattern of 1, 2, 4, 8 or 16 samples. No two samples of one share a row or a column.
constexpr SamplePattern standard_pattern(int count) {
    switch (count) {
        case 2: return {2, {{{12, 12}, {4, 4}}}};
        case 4: return {4, {{{6, 2}, {14, 6}, {2, 10}, {10, 14}}}};
        case 8: return {8, {{{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}}}};
        case 16:
            return {16,
                    {{{9, 9},
                      {7, 5},
                      {5, 10},
                      {12, 7},
                      {3, 6},
                      {10, 13},
                      {13, 11},
                      {11, 3},
                      {6, 14},
                      {8, 1},
                      {4, 2},
                      {2, 12},
                      {0, 8},
                      {15, 4},
                      {14, 15},
                      {1, 0}}}};
        default: return {};
    }
}

/// The sibling with every sample at the centre. D3D11.3 19.2.4
constexpr SamplePattern center_pattern(int count) {
    SamplePattern pattern;
    pattern.count = count;
    for (int i = 0; i < count; ++i) pattern.positions[static_cast<std::size_t>(i)] = {8, 8};
    return pattern;
}

}  // namespace oracle
