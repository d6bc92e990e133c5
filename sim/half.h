// IEEE binary16 and its conversions with named rounding. D3D11.3 3.1.5, 3.2.2
#pragma once

#include "sim/lanes.h"

#include <cstdint>

namespace gnomon {

/// How a float becomes a narrower float.
enum class Narrowing {
    TowardZero,   // what does not fit becomes the largest finite number, infinity stays infinity. D3D11.3 3.2.2
    NearestEven,  // what does not fit becomes infinity; what most devices do
};

/// A half as stored: 1 sign, 5 exponent, 10 mantissa bits. Denormals, infinities and NaN are values like any other.
struct Half {
    std::uint16_t bits = 0;

    bool operator==(const Half&) const = default;
};

/// NaN keeps its sign and its upper payload bits and becomes quiet.
Half half_from_float(float x, Narrowing narrowing);
/// Exact. A signalling NaN becomes quiet.
float float_from_half(Half x);

/// Floats with 5 exponent bits on lanes: a half has 10 mantissa bits, the parts of r11g11b10f have 6 and 5.
/// D3D11.3 3.1.5, 3.1.6
///
/// The magnitude of x in exponent and mantissa; the sign is not looked at. NaN keeps its upper payload bits and becomes quiet.
template <int kMantissa>
Int small_float_from_magnitude(Float x, Narrowing narrowing) {
    constexpr int kDropped = 23 - kMantissa;
    constexpr int kInfinity = 31 << kMantissa;
    const Int magnitude = bits_of(x) & Int(0x7fffffff);

    // Normal results: rebias the exponent from 127 to 15 and drop the lower bits.
    const Int rebased = magnitude - Int(112 << 23);
    // Denormal results: the mantissa with its leading one, shifted right until the exponent is that of the smallest number.
    const Int exponent = shift_right_logical<23>(magnitude);
    const Int shift = clamp(Int(113 + kDropped) - exponent, Int(0), Int(31));
    const Int mantissa = (magnitude & Int(0x007fffff)) | Int(0x00800000);
    const Mask denormal = magnitude < Int(113 << 23);

    Int result;
    if (narrowing == Narrowing::TowardZero) {
        result = select(denormal, shift_right_logical(mantissa, shift), shift_right_logical<kDropped>(rebased));
        result = min(result, Int(kInfinity - 1));
    } else {
        // Add just under half a unit, and the unit's own lowest bit, so that ties go to even.
        const Int odd_normal = shift_right_logical<kDropped>(rebased) & Int(1);
        const Int normal = shift_right_logical<kDropped>(rebased + Int((1 << (kDropped - 1)) - 1) + odd_normal);
        const Int odd = shift_right_logical(mantissa, shift) & Int(1);
        const Int below_half = shift_left(Int(1), max(shift - Int(1), Int(0))) - Int(1);
        const Int tiny = shift_right_logical(mantissa + below_half + odd, shift);
        result = select(denormal, tiny, normal);
        result = min(result, Int(kInfinity));
    }

    constexpr int kPayload = (1 << kMantissa) - 1;
    const Int quiet = Int(kInfinity | 1 << (kMantissa - 1)) | (shift_right_logical<kDropped>(magnitude) & Int(kPayload));
    const Int special = select(magnitude == Int(0x7f800000), Int(kInfinity), quiet);
    return select(magnitude >= Int(0x7f800000), special, result);
}

/// Exact, without sign. A signalling NaN becomes quiet.
template <int kMantissa>
Int magnitude_from_small_float(Int code) {
    constexpr int kRaised = 23 - kMantissa;
    constexpr float kSmallest = 1.0f / static_cast<float>(1 << (14 + kMantissa));
    const Int normal = shift_left<kRaised>(code) + Int(112 << 23);
    const Int denormal = bits_of(Float(code) * Float(kSmallest));
    const Int special = shift_left<kRaised>(code) | Int(0x7f800000);
    const Int quiet = select(code > Int(31 << kMantissa), Int(0x00400000), Int(0));
    const Int finite = select(code < Int(1 << kMantissa), denormal, normal);
    return select(code >= Int(31 << kMantissa), special | quiet, finite);
}

/// The half is in the lower 16 bits, the upper ones are 0.
inline Int half_bits_from_float(Float x, Narrowing narrowing) {
    const Int sign = shift_right_logical<16>(bits_of(x)) & Int(0x8000);
    return sign | small_float_from_magnitude<10>(x, narrowing);
}
inline Float float_from_half_bits(Int half) {
    const Int sign = shift_left<16>(half & Int(0x8000));
    return float_of_bits(sign | magnitude_from_small_float<10>(half & Int(0x7fff)));
}

/// An unsigned small float: what is below zero becomes 0, minus infinity included; NaN stays NaN. D3D11.3 3.1.6, 3.2.2
template <int kMantissa>
Int unsigned_float_bits_from_float(Float x, Narrowing narrowing) {
    return select(x < Float(0.0f), Int(0), small_float_from_magnitude<kMantissa>(x, narrowing));
}

}  // namespace gnomon
