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

/// The same on lanes; the half is in the lower 16 bits, the upper ones are 0.
inline Int half_bits_from_float(Float x, Narrowing narrowing) {
    const Int bits = bits_of(x);
    const Int sign = shift_right_logical<16>(bits) & Int(0x8000);
    const Int magnitude = bits & Int(0x7fffffff);

    // Normal results: rebias the exponent from 127 to 15 and drop 13 bits.
    const Int rebased = magnitude - Int(112 << 23);
    // Denormal results: the mantissa with its leading one, shifted right until the exponent is that of 2^-24.
    const Int exponent = shift_right_logical<23>(magnitude);
    const Int shift = clamp(Int(126) - exponent, Int(0), Int(31));
    const Int mantissa = (magnitude & Int(0x007fffff)) | Int(0x00800000);
    const Mask denormal = magnitude < Int(113 << 23);

    Int result;
    if (narrowing == Narrowing::TowardZero) {
        result = select(denormal, shift_right_logical(mantissa, shift), shift_right_logical<13>(rebased));
        result = min(result, Int(0x7bff));
    } else {
        // Add just under half a unit, and the unit's own lowest bit, so that ties go to even.
        const Int odd_normal = shift_right_logical<13>(rebased) & Int(1);
        const Int normal = shift_right_logical<13>(rebased + Int(0x0fff) + odd_normal);
        const Int odd = shift_right_logical(mantissa, shift) & Int(1);
        const Int below_half = shift_left(Int(1), max(shift - Int(1), Int(0))) - Int(1);
        const Int tiny = shift_right_logical(mantissa + below_half + odd, shift);
        result = select(denormal, tiny, normal);
        result = min(result, Int(0x7c00));
    }

    const Int special =
        select(magnitude == Int(0x7f800000), Int(0x7c00), Int(0x7e00) | (shift_right_logical<13>(magnitude) & Int(0x03ff)));
    return sign | select(magnitude >= Int(0x7f800000), special, result);
}

inline Float float_from_half_bits(Int half) {
    const Int sign = shift_left<16>(half & Int(0x8000));
    const Int magnitude = half & Int(0x7fff);
    const Int normal = shift_left<13>(magnitude) + Int(112 << 23);
    const Int denormal = bits_of(Float(magnitude) * Float(0x1p-24f));
    const Int special = shift_left<13>(magnitude) | Int(0x7f800000);
    const Int quiet = select(magnitude > Int(0x7c00), Int(0x00400000), Int(0));
    const Int finite = select(magnitude < Int(0x0400), denormal, normal);
    return float_of_bits(sign | select(magnitude >= Int(0x7c00), special | quiet, finite));
}

}  // namespace gnomon
