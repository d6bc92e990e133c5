// Texels to numbers and back, on lanes: one codec per format. D3D11.3 3.2.2, 3.2.3
#pragma once

#include "sim/fixed.h"
#include "sim/half.h"
#include "sim/profile.h"
#include "sim/vec.h"
#include "texunit/format.h"

#include <array>

namespace gnomon {

/// How texels of one format are read and written. `kType` and `kComponents` fix everything at compile time.
template <ComponentType kType, std::size_t kCount>
struct Codec {
    static constexpr std::size_t kComponents = kCount;
    static constexpr bool kIsDepth =
        kType == ComponentType::Depth16 || kType == ComponentType::Depth24 || kType == ComponentType::Depth32;
    static constexpr int kBits =
        kType == ComponentType::Unorm8                                                                          ? 8
        : kType == ComponentType::Unorm16 || kType == ComponentType::Float16 || kType == ComponentType::Depth16 ? 16
        : kType == ComponentType::Depth24                                                                       ? 24
                                                                                                                : 32;
    static constexpr bool kIsUnorm = kType == ComponentType::Unorm8 || kType == ComponentType::Unorm16 ||
                                     kType == ComponentType::Depth16 || kType == ComponentType::Depth24;
    static constexpr std::size_t kStoredBits = kIsDepth ? 32u : static_cast<unsigned>(kBits);
    static constexpr int kBytes = static_cast<int>(kStoredBits) * static_cast<int>(kCount) / 8;
    static constexpr std::size_t kWords = kBytes <= 4 ? 1 : kBytes / 4;  // 32-bit words that hold one texel

    template <class Real>
    using Texel = std::array<Real, kCount>;
    using Words = std::array<Int, kWords>;

    /// The words of the texel at `base + byte_offset`. Formats below 32 bits leave what follows in the upper bits.
    static Words load(const std::byte* base, Int byte_offset) {
        Words words;
        for (std::size_t w = 0; w < kWords; ++w) words[w] = gather_bits(base + 4 * w, byte_offset);
        return words;
    }

    template <class Real>
    static Texel<Real> decode(const Words& words) {
        Texel<Real> texel;
        for (std::size_t c = 0; c < kCount; ++c) texel[c] = number<Real>(code(words, c));
        return texel;
    }

    template <class Real>
    static Words encode(const Texel<Real>& texel, Narrowing narrowing) {
        Words words;
        for (std::size_t c = 0; c < kCount; ++c) {
            const std::size_t bit = c * kStoredBits;
            const Int code = code_of(texel[c], narrowing);
            Int& word = words[bit / 32];
            switch (bit % 32) {
                case 0: word = code; break;
                case 8: word = word | shift_left<8>(code); break;
                case 16: word = word | shift_left<16>(code); break;
                default: word = word | shift_left<24>(code); break;
            }
        }
        return words;
    }

    /// The stored code of one component, in the lower kStoredBits.
    static Int code(const Words& words, std::size_t component) {
        const std::size_t bit = component * kStoredBits;
        const Int word = words[bit / 32];
        if constexpr (kStoredBits == 32) {
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

    template <class Real>
    static Real number(Int code) {
        if constexpr (kIsUnorm) {
            return Real(code) / Real(static_cast<float>((1 << kBits) - 1));
        } else if constexpr (kType == ComponentType::Float16) {
            return Real(float_from_half_bits(code));
        } else {
            return Real(float_of_bits(code));
        }
    }

    /// DEVIATION(D3D11.3 19.1.2): a NaN is stored as the one quiet NaN without sign: which payload and sign arithmetic gives it
    /// differs between processors and with the order a compiler puts operands in. D3D11.3 3.2.2 asks only that NaN stays NaN.
    template <class Real>
    static Int code_of(const Real& x, Narrowing narrowing) {
        if constexpr (kIsUnorm) {
            return unorm_from_float(x, kBits);
        } else if constexpr (kType == ComponentType::Float16) {
            const Float value = to_float(x);
            return select(is_nan(value), Int(0x7e00), half_bits_from_float(value, narrowing));
        } else if constexpr (kType == ComponentType::Depth32) {
            return bits_of(to_float(x) + Float(0.0f));  // -0 becomes +0, so that the codes order as the depths do
        } else {
            const Float value = to_float(x);
            return select(is_nan(value), Int(0x7fc00000), bits_of(value));
        }
    }
};

/// Calls visit(Codec<...>{}) with the codec of `format`.
template <class Visit>
decltype(auto) with_codec(Format format, const Visit& visit) {
    using enum ComponentType;
    switch (format) {
        case Format::R8Unorm: return visit(Codec<Unorm8, 1>{});
        case Format::Rg8Unorm: return visit(Codec<Unorm8, 2>{});
        case Format::Rgba8Unorm: return visit(Codec<Unorm8, 4>{});
        case Format::R16Unorm: return visit(Codec<Unorm16, 1>{});
        case Format::Rg16Unorm: return visit(Codec<Unorm16, 2>{});
        case Format::Rgba16Unorm: return visit(Codec<Unorm16, 4>{});
        case Format::R16Float: return visit(Codec<Float16, 1>{});
        case Format::Rg16Float: return visit(Codec<Float16, 2>{});
        case Format::Rgba16Float: return visit(Codec<Float16, 4>{});
        case Format::R32Float: return visit(Codec<Float32, 1>{});
        case Format::Rg32Float: return visit(Codec<Float32, 2>{});
        case Format::Rgba32Float: return visit(Codec<Float32, 4>{});
        case Format::D16: return visit(Codec<Depth16, 1>{});
        case Format::D24: return visit(Codec<Depth24, 1>{});
        case Format::D32Float: return visit(Codec<Depth32, 1>{});
    }
    __builtin_unreachable();
}

/// One value per component, missing ones as 0 and alpha as 1. D3D11.3 19.1.3.3 (defaults for missing components)
template <class Real, std::size_t kCount>
Vec4<Real> expand(const std::array<Real, kCount>& texel) {
    Vec4<Real> color{texel[0], Real(0.0f), Real(0.0f), Real(1.0f)};
    if constexpr (kCount >= 2) color.y = texel[1];
    if constexpr (kCount == 4) {
        color.z = texel[2];
        color.w = texel[3];
    }
    return color;
}

/// The first components of a colour.
template <std::size_t kCount, class Real>
std::array<Real, kCount> truncate(const Vec4<Real>& color) {
    if constexpr (kCount == 1) return {color.x};
    if constexpr (kCount == 2) return {color.x, color.y};
    if constexpr (kCount == 4) return {color.x, color.y, color.z, color.w};
}

}  // namespace gnomon
