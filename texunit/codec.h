// Texels to numbers and back, on lanes: one codec per format. D3D11.3 3.1.5, 3.1.6, 3.2.2, 3.2.3
#pragma once

#include "sim/fixed.h"
#include "sim/half.h"
#include "sim/profile.h"
#include "sim/vec.h"
#include "texunit/format.h"
#include "texunit/srgb.h"

#include <array>
#include <limits>
#include <utility>

namespace gnomon {

/// Stored bits of one component of a type; a depth texel takes a whole word, the parts of Float11 share one.
constexpr int stored_bits(ComponentType type) {
    switch (type) {
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8: return 8;
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Float16: return 16;
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth16:
        case ComponentType::Depth24:
        case ComponentType::Depth32: return 32;
    }
    __builtin_unreachable();
}

/// code / (2^n - 1), correctly rounded for every code (tests/spec/s03_02_03_integer.cpp asks each). For up to 16 bits as the
/// exact code * 2^-n plus the rounded rest, which costs a fraction of a division.
template <class Real, int kBits>
Real normalised(Int code) {
    if constexpr (kBits <= 16 && std::is_same_v<Real, Float>) {
        constexpr double kLeading = 1.0 / static_cast<double>(1 << kBits);
        constexpr double kRest = 1.0 / static_cast<double>((1 << kBits) - 1) - kLeading;
        const Real number(code);
        const Real rest = number * Real(static_cast<float>(kRest));
        // The leading product is exact, so fused or not is the same.
        if constexpr (HWY_NATIVE_FMA) return fused_multiply_add(number, Real(static_cast<float>(kLeading)), rest);
        return number * Real(static_cast<float>(kLeading)) + rest;
    } else {
        return Real(code) / Real(static_cast<float>((1 << kBits) - 1));
    }
}

/// How texels of one format are read and written. `kType` and `kComponents` fix everything at compile time.
template <ComponentType kType, std::size_t kCount>
struct Codec {
    static constexpr std::size_t kComponents = kCount;
    static constexpr bool kIsDepth =
        kType == ComponentType::Depth16 || kType == ComponentType::Depth24 || kType == ComponentType::Depth32;
    static constexpr bool kIsInteger = kType == ComponentType::Uint32;
    static constexpr bool kIsUnsignedFloat = kType == ComponentType::Float11;
    static constexpr bool kIsSnorm = kType == ComponentType::Snorm8 || kType == ComponentType::Snorm16;
    /// Bits of the code of a normalised integer, 0 where it is none.
    static constexpr int kUnormBits = kType == ComponentType::Unorm8 || kType == ComponentType::Srgb8      ? 8
                                      : kType == ComponentType::Unorm16 || kType == ComponentType::Depth16 ? 16
                                      : kType == ComponentType::Depth24                                    ? 24
                                                                                                           : 0;
    static constexpr bool kIsUnorm = kUnormBits > 0;
    static constexpr std::size_t kStoredBits = static_cast<std::size_t>(stored_bits(kType));
    static constexpr int kBytes = kType == ComponentType::Float11 ? 4 : static_cast<int>(kStoredBits * kCount / 8);
    static constexpr std::size_t kWords = kBytes <= 4 ? 1 : kBytes / 4;  // 32-bit words that hold one texel

    template <class Real>
    using Texel = std::array<Real, kCount>;
    using Words = std::array<Int, kWords>;

    /// The words of the texel at `base + byte_offset`. Formats below 32 bits leave what follows in the upper bits.
    static Words load(const std::byte* base, Int byte_offset) {
        Words words;
        if constexpr (kWords == 1) {
            words[0] = gather_bits(base, byte_offset);
        } else {
            for (std::size_t w = 0; w < kWords; w += 2) {
                const IntPair pair = gather_pairs(base + 4 * w, byte_offset);
                words[w] = pair.first;
                words[w + 1] = pair.second;
            }
        }
        return words;
    }

    template <class Real>
    static Texel<Real> decode(const Words& words, UnormDecode how = UnormDecode::Divide) {
        Texel<Real> texel;
#pragma GCC unroll 4
        for (std::size_t c = 0; c < kCount; ++c) texel[c] = number<Real>(code(words, c), c, how);
        return texel;
    }

    template <class Real>
    static Words encode(const Texel<Real>& texel, Narrowing narrowing) {
        Words words;
        for (std::size_t c = 0; c < kCount; ++c) {
            const std::size_t bit = first_bit(c);
            const Int code = code_of(texel[c], c, narrowing);
            Int& word = words[bit / 32];
            switch (bit % 32) {
                case 0: word = code; break;
                case 8: word = word | shift_left<8>(code); break;
                case 11: word = word | shift_left<11>(code); break;
                case 16: word = word | shift_left<16>(code); break;
                case 22: word = word | shift_left<22>(code); break;
                default: word = word | shift_left<24>(code); break;
            }
        }
        return words;
    }

    /// The stored code of one component, in the lower bits.
    static Int code(const Words& words, std::size_t component) {
        const std::size_t bit = first_bit(component);
        const Int word = words[bit / 32];
        if constexpr (kType == ComponentType::Float11) {
            switch (component) {
                case 0: return word & Int(0x7ff);
                case 1: return shift_right_logical<11>(word) & Int(0x7ff);
                default: return shift_right_logical<22>(word);
            }
        } else if constexpr (kStoredBits == 32) {
            return word;
        } else {
            const Int mask((1 << kStoredBits) - 1);
            switch (bit % 32) {
                case 0: return word & mask;
                case 8: return shift_right_logical<8>(word) & mask;
                case 16: return shift_right_logical<16>(word) & mask;
                default: return shift_right_logical<24>(word) & mask;
            }
        }
    }

    /// Adds the bits of one component to masks of the words.
    static constexpr void add_component_bits(std::array<std::uint32_t, kWords>& bits, std::size_t component) {
        const std::size_t bit = first_bit(component);
        const std::size_t width = kType == ComponentType::Float11 ? (component < 2 ? 11 : 10) : kStoredBits;
        bits[bit / 32] |= (width == 32 ? 0xffffffffu : (1u << width) - 1u) << (bit % 32);
    }

    /// What a code means. D3D11.3 3.1.5, 3.1.6, 3.2.3.3, 3.2.3.5, 3.2.3.7
    template <class Real>
    static Real number(Int code, std::size_t component, UnormDecode how = UnormDecode::Divide) {
        if constexpr (kIsUnorm) {
            if constexpr (kType == ComponentType::Srgb8)
                if (component < 3) return linear_from_srgb<Real>(code);
            if (how == UnormDecode::Reciprocal) return Real(code) * Real(1.0f / static_cast<float>((1 << kUnormBits) - 1));
            return normalised<Real, kUnormBits>(code);
        } else if constexpr (kIsSnorm) {
            constexpr int kBits = static_cast<int>(kStoredBits);
            const Int extended = shift_right<32 - kBits>(shift_left<32 - kBits>(code));
            const Int limited = max(extended, Int(1 - (1 << (kBits - 1))));  // both lowest codes are -1
            return normalised<Real, kBits - 1>(limited);
        } else if constexpr (kType == ComponentType::Float16) {
            return Real(float_from_half_bits(code));
        } else if constexpr (kType == ComponentType::Float11) {
            return Real(
                float_of_bits(component < 2 ? magnitude_from_small_float<6>(code) : magnitude_from_small_float<5>(code)));
        } else if constexpr (kIsInteger) {
            if constexpr (std::is_same_v<Real, Double>) {
                return select(code < Int(0), Real(code) + Real(0x1p32), Real(code));
            } else {
                // Above 2^31 half of it, with the last bit kept where it decides the one rounding.
                const Int halved = shift_right_logical<1>(code) | (code & Int(1));
                return select(code < Int(0), Real(halved) * Real(2.0f), Real(code));
            }
        } else {
            return Real(float_of_bits(code));
        }
    }

    /// DEVIATION(D3D11.3 19.1.2): a NaN is stored as the one quiet NaN without sign: which payload and sign arithmetic gives it
    /// differs between processors and with the order a compiler puts operands in. D3D11.3 3.2.2 asks only that NaN stays NaN.
    template <class Real>
    static Int code_of(const Real& x, std::size_t component, Narrowing narrowing) {
        if constexpr (kIsUnorm) {
            if constexpr (kType == ComponentType::Srgb8)
                if (component < 3) return srgb_from_linear(x);
            return unorm_from_float(x, kUnormBits);
        } else if constexpr (kIsSnorm) {
            return snorm_from_float(x, static_cast<int>(kStoredBits)) & Int((1 << kStoredBits) - 1);
        } else if constexpr (kType == ComponentType::Float16) {
            return select(is_nan(x), Int(0x7e00), half_bits_from_float(to_float_for_narrowing(x), narrowing));
        } else if constexpr (kType == ComponentType::Float11) {
            const Float value = to_float_for_narrowing(x);
            if (component < 2) return select(is_nan(x), Int(0x7e0), unsigned_float_bits_from_float<6>(value, narrowing));
            return select(is_nan(x), Int(0x3f0), unsigned_float_bits_from_float<5>(value, narrowing));
        } else if constexpr (kIsInteger) {
            return uint_from_float(x);
        } else if constexpr (kType == ComponentType::Depth32) {
            return bits_of(to_float(x) + Float(0.0f));  // -0 becomes +0, so that the codes order as the depths do
        } else {
            const Float value = to_float(x);
            return select(is_nan(value), Int(0x7fc00000), bits_of(value));
        }
    }

private:
    static constexpr std::size_t first_bit(std::size_t component) {
        return component * (kType == ComponentType::Float11 ? 11 : kStoredBits);
    }

    /// Toward zero, limited to [0, 2^32 - 1]; NaN gives 0. D3D11.3 22.13.4 (ftou)
    template <class Real>
    static Int uint_from_float(const Real& x) {
        const Real limited = max(x, Real(0.0f));
        const Real half_range(0x1p31f);
        const Int low = truncate_to_int(select(limited >= half_range, limited - half_range, limited));
        const Int code = select(limited >= half_range, low + Int(std::numeric_limits<std::int32_t>::min()), low);
        return select(limited >= Real(0x1p32f), Int(-1), code);
    }
};

/// Calls visit(Codec<...>{}) with the codec of `format`.
template <class Visit>
decltype(auto) with_codec(Format format, const Visit& visit) {
    using Result = decltype(visit(Codec<ComponentType::Unorm8, 1>{}));
    using Call = Result (*)(const Visit&);
    static constexpr auto calls = []<std::size_t... kRow>(std::index_sequence<kRow...>) {
        return std::array<Call, sizeof...(kRow)>{[](const Visit& v) -> Result {
            return v(Codec<kFormats[kRow].type, static_cast<std::size_t>(kFormats[kRow].components)>{});
        }...};
    }(std::make_index_sequence<kFormats.size()>());
    return calls[static_cast<std::size_t>(format)](visit);
}

/// One value per component, missing ones as 0 and alpha as 1. D3D11.3 19.1.3.3 (defaults for missing components)
template <class Real, std::size_t kCount>
Vec4<Real> expand(const std::array<Real, kCount>& texel) {
    Vec4<Real> color{texel[0], Real(0.0f), Real(0.0f), Real(1.0f)};
    if constexpr (kCount >= 2) color.y = texel[1];
    if constexpr (kCount >= 3) color.z = texel[2];
    if constexpr (kCount >= 4) color.w = texel[3];
    return color;
}

/// The first components of a colour.
template <std::size_t kCount, class Real>
std::array<Real, kCount> truncate(const Vec4<Real>& color) {
    if constexpr (kCount == 1) return {color.x};
    if constexpr (kCount == 2) return {color.x, color.y};
    if constexpr (kCount == 3) return {color.x, color.y, color.z};
    if constexpr (kCount == 4) return {color.x, color.y, color.z, color.w};
}

}  // namespace gnomon
