// Normalised and fixed-point integers. D3D11.3 3.2.3, 3.2.4
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"

#include <cstdint>

namespace gnomon {

/// Code of x as an n-bit UNORM, 1 <= n <= 24: NaN gives 0, clamp to [0, 1], scale by 2^n - 1, add 1/2, truncate.
/// D3D11.3 3.2.3.6 Computed without any intermediate rounding that could change the code: the product has at most 48 bits and
/// double holds 53.
inline std::uint32_t unorm_from_float(float x, int bits) {
    const double limited = x > 0.0f ? (x < 1.0f ? static_cast<double>(x) : 1.0) : 0.0;
    return static_cast<std::uint32_t>(limited * static_cast<double>((1 << bits) - 1) + 0.5);
}

/// code / (2^n - 1), correctly rounded. D3D11.3 3.2.3.5
inline float float_from_unorm(std::uint32_t code, int bits) {
    return static_cast<float>(code) / static_cast<float>((1 << bits) - 1);
}

/// The same on lanes.
inline Int unorm_from_float(Float x, int bits) {
#if HWY_NATIVE_FMA
    // One rounding to nearest even. As 2^n - 1 is odd, only 1/2 lies between two codes, and the upper one, 2^(n-1), is even.
    if (bits <= 16) {
        constexpr float kAlign = 8388608.0f;  // 2^23: the sum's mantissa is the code
        const Float scale(static_cast<float>((1 << bits) - 1));
#if HWY_ARCH_X86
        // The first operand where it is larger (smaller), else the second: NaN gives 0. A denormal has code 0 whether it is
        // flushed here or not.
        const Float limited(hn::Min(hn::Max(x.v, Float(0.0f).v), Float(1.0f).v));
#else
        const Float limited = saturate(x);
#endif
        return bits_of(fused_multiply_add(limited, scale, Float(kAlign))) & Int(0x7fffff);
    }
#endif
    const hn::RepartitionToWide<detail::FloatTag> wide;
    const hn::Half<detail::FloatTag> half;
    const hn::Half<detail::IntTag> half_int;
    const auto limited = saturate(x).v;
    const auto scale = hn::Set(wide, static_cast<double>((1 << bits) - 1));
    const auto rounder = hn::Set(wide, 0.5);
    const auto lower = hn::Add(hn::Mul(hn::PromoteTo(wide, hn::LowerHalf(half, limited)), scale), rounder);
    const auto upper = hn::Add(hn::Mul(hn::PromoteTo(wide, hn::UpperHalf(half, limited)), scale), rounder);
    return Int(hn::Combine(detail::IntTag{}, hn::DemoteTo(half_int, upper), hn::DemoteTo(half_int, lower)));
}
inline Int unorm_from_float(const Double& x, int bits) {
    const Double limited = saturate(x);
    return truncate_to_int(limited * Double((1 << bits) - 1) + Double(0.5));
}

/// Code of x as an n-bit SNORM, in two's complement: NaN gives 0, clamp to [-1, 1], scale by 2^(n-1) - 1, add 1/2 away from
/// zero, truncate. D3D11.3 3.2.3.4
inline Int snorm_from_float(Float x, int bits) {
    const Int magnitude = unorm_from_float(abs(x), bits - 1);
    return select(x < Float(0.0f), Int(0) - magnitude, magnitude);
}
inline Int snorm_from_float(const Double& x, int bits) {
    const Int magnitude = unorm_from_float(abs(x), bits - 1);
    return select(x < Double(0.0), Int(0) - magnitude, magnitude);
}

inline Float float_from_unorm(Int code, int bits) { return Float(code) / Float(static_cast<float>((1 << bits) - 1)); }

/// Nearest-even fixed point with `fraction_bits` below the point, as an integer count of 2^-fraction_bits; NaN gives 0,
/// out of range saturates to 31 bits. D3D11.3 3.2.4.1
inline std::int32_t fixed_from_float(double x, int fraction_bits) {
    const double scaled = std::nearbyint(x * static_cast<double>(1 << fraction_bits));
    if (scaled != scaled) return 0;
    return static_cast<std::int32_t>(scaled < -2147483647.0 ? -2147483647.0 : scaled > 2147483647.0 ? 2147483647.0 : scaled);
}

}  // namespace gnomon
