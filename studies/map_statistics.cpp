// Saturated, infinite and undefined texels, told by their bits.
#include "studies/map_statistics.h"

#include <algorithm>
#include <cstring>

namespace gnomon::studies {

namespace {

/// Counts the components of texels by their bits; `largest` is the largest finite number, the next code infinity.
template <class Code>
void count(MapStatistics& statistics, const std::vector<std::byte>& bytes, std::size_t components, Code largest) {
    const Code magnitude_bits = static_cast<Code>(static_cast<Code>(~Code{0}) >> 1);
    for (std::size_t texel = 0; texel < bytes.size() / (components * sizeof(Code)); ++texel) {
        bool saturated = false;
        bool infinite = false;
        bool nan = false;
        for (std::size_t c = 0; c < components; ++c) {
            Code code{};
            std::memcpy(&code, bytes.data() + (texel * components + c) * sizeof(Code), sizeof(Code));
            const auto magnitude = static_cast<Code>(code & magnitude_bits);
            saturated = saturated || magnitude == largest;
            infinite = infinite || magnitude == largest + 1;
            nan = nan || magnitude > largest + 1;
        }
        statistics.saturated += saturated;
        statistics.infinite += infinite;
        statistics.nan += nan;
    }
}

}  // namespace

MapStatistics& MapStatistics::operator+=(const MapStatistics& other) {
    texels += other.texels;
    saturated += other.saturated;
    infinite += other.infinite;
    nan += other.nan;
    return *this;
}

MapStatistics map_statistics(const Texture& texture) {
    MapStatistics statistics;
    const FormatInfo& format = texture.info();
    const auto components = static_cast<std::size_t>(format.components);
    for (int slice = 0; slice < texture.desc().layers; ++slice) {
        statistics.texels += static_cast<std::uint64_t>(texture.width(0)) * static_cast<std::uint64_t>(texture.height(0));
        if (format.type == ComponentType::Float16)
            count<std::uint16_t>(statistics, texture.level_bytes(0, slice), components, 0x7bff);
        if (format.type == ComponentType::Float32)
            count<std::uint32_t>(statistics, texture.level_bytes(0, slice), components, 0x7f7fffff);
    }
    return statistics;
}

MapStatistics map_statistics(const Device& device, std::span<const TextureId> maps) {
    MapStatistics statistics;
    for (const TextureId id : maps) statistics += map_statistics(device.texture(id));
    return statistics;
}

MapStatistics worse(const MapStatistics& a, const MapStatistics& b) {
    return {.texels = std::max(a.texels, b.texels),
            .saturated = std::max(a.saturated, b.saturated),
            .infinite = std::max(a.infinite, b.infinite),
            .nan = std::max(a.nan, b.nan)};
}

}  // namespace gnomon::studies
