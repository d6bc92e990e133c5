#include "sim/half.h"

#include <bit>

namespace gnomon {

Half half_from_float(float x, Narrowing narrowing) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t sign = bits >> 16 & 0x8000u;
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    const auto signed_half = [&](std::uint32_t half) { return Half{static_cast<std::uint16_t>(sign | half)}; };

    if (magnitude > 0x7f800000u) return signed_half(0x7e00u | (magnitude >> 13 & 0x3ffu));
    if (magnitude == 0x7f800000u) return signed_half(0x7c00u);

    // The value as mantissa * 2^-(24 + dropped) in units of the result's last place.
    const std::uint32_t exponent = magnitude >> 23;
    const bool denormal = exponent < 113;
    if (exponent < 102) return signed_half(0);  // below half of 2^-24
    const std::uint32_t dropped = denormal ? 126 - exponent : 13;
    const std::uint32_t value = denormal ? (magnitude & 0x7fffffu) | 0x800000u : magnitude - (112u << 23);
    std::uint32_t half = value >> dropped;

    if (narrowing == Narrowing::TowardZero) return signed_half(half < 0x7c00u ? half : 0x7bffu);

    const std::uint32_t rest = value & ((1u << dropped) - 1u);
    const std::uint32_t tie = 1u << (dropped - 1u);
    if (rest > tie || (rest == tie && (half & 1u) != 0)) ++half;
    return signed_half(half < 0x7c00u ? half : 0x7c00u);
}

float float_from_half(Half x) {
    const std::uint32_t sign = (x.bits & 0x8000u) << 16;
    const std::uint32_t exponent = x.bits >> 10 & 0x1fu;
    const std::uint32_t mantissa = x.bits & 0x3ffu;
    if (exponent == 31) {
        const std::uint32_t quiet = mantissa != 0 ? 0x400000u : 0u;
        return std::bit_cast<float>(sign | 0x7f800000u | mantissa << 13 | quiet);
    }
    if (exponent == 0) {
        const float magnitude = static_cast<float>(mantissa) * 0x1p-24f;
        return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(magnitude));
    }
    return std::bit_cast<float>(sign | (exponent + 112u) << 23 | mantissa << 13);
}

}  // namespace gnomon
