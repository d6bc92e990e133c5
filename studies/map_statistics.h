// What became of numbers that the format of a shadow map cannot hold.
#pragma once

#include "pipeline/device.h"
#include "sim/fields.h"

#include <cstdint>
#include <span>

namespace gnomon::studies {

/// Texels of level 0, of all slices; one with several such components counts once in each row.
struct MapStatistics {
    std::uint64_t texels = 0;
    std::uint64_t saturated = 0;  // a component is the largest finite number of the format, of either sign
    std::uint64_t infinite = 0;
    std::uint64_t nan = 0;

    static constexpr auto fields() {
        using M = MapStatistics;
        return std::tuple{Field{"texels", &M::texels}, Field{"saturated", &M::saturated}, Field{"infinite", &M::infinite},
                          Field{"nan", &M::nan}};
    }
    MapStatistics& operator+=(const MapStatistics& other);
    bool operator==(const MapStatistics&) const = default;
};

/// Only formats of 16- and 32-bit floats can hold anything but plain numbers; of others just the texels are counted.
MapStatistics map_statistics(const Texture& texture);
/// Of all maps of a technique.
MapStatistics map_statistics(const Device& device, std::span<const TextureId> maps);

/// The larger of each count.
MapStatistics worse(const MapStatistics& a, const MapStatistics& b);

}  // namespace gnomon::studies
