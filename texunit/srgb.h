// The sRGB transfer functions of 8-bit codes. D3D11.3 3.2.3.7, 3.2.3.8
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"

#include <array>

namespace gnomon {

/// Linear value of every code, correctly rounded, and for every code k but 0 the smallest linear value that becomes k.
struct SrgbTables {
    std::array<double, 256> linear;
    std::array<double, 256> threshold;
    alignas(64) std::array<std::int32_t, 256> linear_bits;     // the same as the bits of floats
    alignas(64) std::array<std::int32_t, 256> threshold_bits;  // of the smallest float not below it
};
const SrgbTables& srgb_tables();

template <class Real>
Real linear_from_srgb(Int code) {
    const SrgbTables& tables = srgb_tables();
    if constexpr (std::is_same_v<Real, Float>) {
        return float_of_bits(gather(tables.linear_bits.data(), code));
    } else {
        const auto codes = code.lanes();
        return Real::map([&](std::size_t i) { return tables.linear[static_cast<std::size_t>(codes[i])]; });
    }
}

/// The number of thresholds at or below x: NaN and what is below 0 give 0, what is above 1 gives 255.
inline Int srgb_from_linear(Float x) {
    const std::int32_t* table = srgb_tables().threshold_bits.data();
    Int code(0);
    for (int step = 128; step > 0; step /= 2) {
        const Int candidate = code + Int(step);
        code = select(x >= float_of_bits(gather(table, candidate)), candidate, code);
    }
    return code;
}
inline Int srgb_from_linear(const Double& x) {
    const SrgbTables& tables = srgb_tables();
    std::array<std::int32_t, kLanes> codes{};
    for (std::size_t i = 0; i < codes.size(); ++i)
        for (std::int32_t step = 128; step > 0; step /= 2)
            if (x.v[i] >= tables.threshold[static_cast<std::size_t>(codes[i] + step)]) codes[i] += step;
    return Int::load(codes.data());
}

}  // namespace gnomon
