// Encoded texels to memory.
#pragma once

#include "sim/lanes.h"

#include <array>
#include <cstddef>
#include <cstring>

namespace gnomon {

/// The texel words of a wave, spilled so that single lanes can be stored.
template <class AnyCodec>
struct SpilledTexels {
    std::array<std::array<std::int32_t, kLanes>, AnyCodec::kWords> words;

    explicit SpilledTexels(const typename AnyCodec::Words& encoded) {
        for (std::size_t w = 0; w < words.size(); ++w) encoded[w].store(words[w].data());
    }
    void store_lane(std::byte* to, std::size_t lane) const {
        if constexpr (AnyCodec::kBytes < 4) {
            std::memcpy(to, &words[0][lane], AnyCodec::kBytes);
        } else {
            for (std::size_t w = 0; w < words.size(); ++w) std::memcpy(to + 4 * w, &words[w][lane], 4);
        }
    }
};

/// Lanes 0 to count - 1 to consecutive texels of a row.
template <class AnyCodec>
void store_row(std::byte* to, const typename AnyCodec::Words& encoded, int count) {
    const SpilledTexels<AnyCodec> spilled(encoded);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) spilled.store_lane(to + i * AnyCodec::kBytes, i);
}

}  // namespace gnomon
