// Colours to the codes of a target and back, with the roundings of the profile: the specification's, llvmpipe's (Mesa 22.3.6
// lp_bld_conv.c) or SwiftShader's (PixelRoutine.cpp). D3D11.3 3.2
#pragma once

#include "sim/profile.h"
#include "texunit/codec.h"

namespace gnomon {

/// Of the formats that profiles round in their own ways: bits of linear UNORM, and floats of which a component is not a part of
/// a word.
template <class AnyCodec>
inline constexpr int kPlainUnormBits = 0;
template <std::size_t kCount>
inline constexpr int kPlainUnormBits<Codec<ComponentType::Unorm8, kCount>> = 8;
template <std::size_t kCount>
inline constexpr int kPlainUnormBits<Codec<ComponentType::Unorm16, kCount>> = 16;
template <class AnyCodec>
inline constexpr bool kIsHalf = false;
template <std::size_t kCount>
inline constexpr bool kIsHalf<Codec<ComponentType::Float16, kCount>> = true;
template <class AnyCodec>
inline constexpr bool kIsFloat = kIsHalf<AnyCodec>;
template <std::size_t kCount>
inline constexpr bool kIsFloat<Codec<ComponentType::Float32, kCount>> = true;

/// Codes of 8, 16 or 32 bits to words.
template <class AnyCodec>
typename AnyCodec::Words packed(const std::array<Int, AnyCodec::kComponents>& codes) {
    typename AnyCodec::Words words;
    for (std::size_t c = 0; c < AnyCodec::kComponents; ++c) {
        const std::size_t bit = c * AnyCodec::kStoredBits;
        Int& word = words[bit / 32];
        switch (bit % 32) {
            case 0: word = codes[c]; break;
            case 8: word = word | shift_left<8>(codes[c]); break;
            case 16: word = word | shift_left<16>(codes[c]); break;
            default: word = word | shift_left<24>(codes[c]); break;
        }
    }
    return words;
}

/// An UNORM code in binary32; NaN gives 0. `rounding` is not HalfUp.
template <class Real>
Int driver_unorm_code(const Real& x, int bits, UnormRounding rounding) {
    const Float limited = saturate(to_float(x));
    // Scaled to 2^16 less one part, then rounded by the addition that aligns the code with the mantissa.
    if (rounding == UnormRounding::Llvmpipe && bits == 16)
        return bits_of(limited * Float(65535.0f / 65536.0f) + Float(128.0f)) & Int(0xffff);
    return bounded_round_to_int(limited * Float(static_cast<float>((1 << bits) - 1)));
}

/// A half without infinities: what is above 65519.99 becomes 0x7fff. Of denormals only the bits above a 23-bit mantissa's end
/// take part in the rounding.
/// NaN has no sign here, as in all targets (texunit/codec.h).
inline Int swiftshader_half(Float x) {
    const Int bits = bits_of(x);
    const Int magnitude = bits & Int(0x7fffffff);
    const Int shift = clamp(Int(113) - shift_right_logical<23>(magnitude), Int(0), Int(31));
    const Int denormal = shift_right_logical((magnitude & Int(0x7fffff)) | Int(0x800000), shift);
    const Int tiny = select(shift < Int(24), denormal, Int(0));
    const Int aligned = select(magnitude < Int(0x38800000), tiny, magnitude - Int(0x38000000));
    const Int odd = shift_right_logical<13>(aligned) & Int(1);
    const Int rounded = shift_right_logical<13>(aligned + Int(0xfff) + odd);
    const Int sign = select(is_nan(x), Int(0), shift_right_logical<16>(bits) & Int(0x8000));
    return sign | select(magnitude > Int(0x47ffefff), Int(0x7fff), rounded);
}
/// Exponent 31 goes on where 30 ends.
inline Float swiftshader_half_value(Int code) {
    const Int sign = shift_left<16>(code & Int(0x8000));
    const Int magnitude = code & Int(0x7fff);
    const Float above = float_of_bits(sign | (shift_left<13>(magnitude) + Int(112 << 23)));
    return select(magnitude >= Int(0x7c00), above, float_from_half_bits(code));
}

/// What a target stores of a colour.
template <class AnyCodec, class Real>
typename AnyCodec::Words encode_target(const std::array<Real, AnyCodec::kComponents>& texel, const Profile& profile) {
    std::array<Int, AnyCodec::kComponents> codes;
    if constexpr (kPlainUnormBits<AnyCodec> > 0) {
        if (profile.unorm_rounding != UnormRounding::HalfUp) {
            for (std::size_t c = 0; c < codes.size(); ++c)
                codes[c] = driver_unorm_code(texel[c], kPlainUnormBits<AnyCodec>, profile.unorm_rounding);
            return packed<AnyCodec>(codes);
        }
    }
    if constexpr (kIsHalf<AnyCodec>) {
        switch (profile.half_targets) {
            case HalfTargets::Narrowed: break;
            case HalfTargets::TowardZero: return AnyCodec::encode(texel, Narrowing::TowardZero);
            case HalfTargets::SwiftShader:
                for (std::size_t c = 0; c < codes.size(); ++c) codes[c] = swiftshader_half(to_float_for_narrowing(texel[c]));
                return packed<AnyCodec>(codes);
        }
    }
    return AnyCodec::encode(texel, profile.float_narrowing);
}

/// What SwiftShader's output merger and resolve read: UNORM by the reciprocal of 65535, halves without infinities.
template <class AnyCodec>
std::array<Float, AnyCodec::kComponents> decode_as_swiftshader(const typename AnyCodec::Words& words) {
    std::array<Float, AnyCodec::kComponents> texel;
    for (std::size_t c = 0; c < texel.size(); ++c) {
        const Int code = AnyCodec::code(words, c);
        if constexpr (kPlainUnormBits<AnyCodec> > 0) {
            texel[c] = Float(kPlainUnormBits<AnyCodec> == 8 ? code * Int(257) : code) * Float(1.0f / 65535.0f);
        } else if constexpr (kIsHalf<AnyCodec>) {
            texel[c] = swiftshader_half_value(code);
        } else {
            texel[c] = AnyCodec::template number<Float>(code, c);
        }
    }
    return texel;
}

}  // namespace gnomon
