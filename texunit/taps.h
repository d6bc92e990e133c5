// What a filter sees of a texel: its numbers, the result of a comparison, or its codes. D3D11.3 7.18.9.1, 22.4.19
#pragma once

#include "texunit/codec.h"
#include "texunit/compare.h"
#include "texunit/footprint.h"

namespace gnomon {

/// How the numbers of a format are made, for one instruction.
struct NumberRule {
    UnormDecode decode = UnormDecode::Divide;
    float code_scale = 0.0f;  // not 0: the filter sees codes times this, and its result is
    float largest = 1.0f;     // multiplied by the reciprocal of that
};

inline bool has_border(const Sampler& sampler) {
    return sampler.address_u == AddressMode::Border || sampler.address_v == AddressMode::Border;
}

/// The border colour as the filter sees it: at the precision it is kept in and clamped to the range of the format.
/// D3D11.3 7.18.9.1
template <class AnyCodec, class Real>
auto border_texel(const Sampler& sampler, const Profile& profile) {
    std::array<Real, AnyCodec::kComponents> border;
    for (std::size_t c = 0; c < border.size(); ++c) {
        border[c] = Real(sampler.border[static_cast<int>(c)]);
        if (profile.border_precision == BorderPrecision::Unorm8)
            border[c] = Real(unorm_from_float(border[c], 8)) / Real(255.0f);
        if constexpr (AnyCodec::kIsUnorm || AnyCodec::kIsDepth) border[c] = saturate(border[c]);
        if constexpr (AnyCodec::kIsSnorm) border[c] = clamp(border[c], Real(-1.0f), Real(1.0f));
        if constexpr (AnyCodec::kIsUnsignedFloat || AnyCodec::kIsInteger) border[c] = max(border[c], Real(0.0f));
    }
    return border;
}

// A tap says what a core may rely on when it is compiled:
//   kCompares: what it gives are results of comparisons;
//   kStandard: it runs only where is_standard() (sample_core.h);
//   kIsFinite: and gives neither infinities nor NaN.

/// The numbers of a texel.
template <class AnyCodec, class RealType>
class NumberTap {
public:
    static constexpr bool kCompares = false;
    static constexpr bool kStandard = false;
    static constexpr bool kIsFinite = false;
    using Real = RealType;
    using Texel = std::array<Real, AnyCodec::kComponents>;

    NumberTap(const Lookup& lookup, const NumberRule& rule)
        : base_(lookup.view.texture().data()), rule_(rule), has_border_(has_border(lookup.sampler)) {
        if (!has_border_) return;
        border_ = border_texel<AnyCodec, Real>(lookup.sampler, lookup.profile);
        if (rule.code_scale != 0.0f)
            for (Real& component : border_) component = component * Real(rule.largest);
    }
    GNOMON_INLINE Texel operator()(Int offset, Mask outside) const {
        Texel texel = numbers(AnyCodec::load(base_, offset));
        if (has_border_)
            for (std::size_t c = 0; c < texel.size(); ++c) texel[c] = select(outside, border_[c], texel[c]);
        return texel;
    }

private:
    GNOMON_INLINE Texel numbers(const typename AnyCodec::Words& words) const {
        if constexpr (AnyCodec::kIsUnorm) {
            if (rule_.code_scale != 0.0f) {
                Texel texel;
                for (std::size_t c = 0; c < texel.size(); ++c)
                    texel[c] = Real(AnyCodec::code(words, c)) * Real(rule_.code_scale);
                return texel;
            }
        }
        return AnyCodec::template decode<Real>(words, rule_.decode);
    }

    const std::byte* base_;
    const NumberRule& rule_;
    bool has_border_;
    Texel border_;
};

/// The same as the specification has them.
template <class AnyCodec, class RealType>
class StandardNumberTap {
public:
    static constexpr bool kCompares = false;
    static constexpr bool kStandard = true;
    static constexpr bool kIsFinite = AnyCodec::kIsUnorm;
    using Real = RealType;
    using Texel = std::array<Real, AnyCodec::kComponents>;

    explicit StandardNumberTap(const Lookup& lookup)
        : base_(lookup.view.texture().data()), has_border_(has_border(lookup.sampler)) {
        if (has_border_) border_ = border_texel<AnyCodec, Real>(lookup.sampler, lookup.profile);
    }
    GNOMON_INLINE Texel operator()(Int offset, Mask outside) const {
        Texel texel = AnyCodec::template decode<Real>(AnyCodec::load(base_, offset));
        if (has_border_)
            for (std::size_t c = 0; c < texel.size(); ++c) texel[c] = select(outside, border_[c], texel[c]);
        return texel;
    }

private:
    const std::byte* base_;
    bool has_border_;
    Texel border_;
};

/// 1 where the reference passes against red, else 0. D3D11.3 22.4.19
template <class AnyCodec, class RealType>
class CompareTap {
public:
    static constexpr bool kCompares = true;
    static constexpr bool kStandard = true;
    static constexpr bool kIsFinite = true;
    using Real = RealType;

    CompareTap(const Lookup& lookup, const Real& reference)
        : base_(lookup.view.texture().data()),
          decode_(lookup.profile.unorm_decode),
          op_(lookup.sampler.compare),
          has_border_(has_border(lookup.sampler)),
          reference_(limited(reference)) {
        const bool quantised = lookup.profile.compare_reference == CompareReference::Quantised;
        if (quantised) reference_ = at_precision(reference_, lookup.profile);
        if (!has_border_) return;
        border_ = border_texel<AnyCodec, Real>(lookup.sampler, lookup.profile)[0];
        if (quantised) border_ = at_precision(border_, lookup.profile);
    }
    GNOMON_INLINE std::array<Real, 1> operator()(Int offset, Mask outside) const {
        Real red = AnyCodec::template number<Real>(AnyCodec::code(AnyCodec::load(base_, offset), 0), 0, decode_);
        if (has_border_) red = select(outside, border_, red);
        return {against(red)};
    }

    /// The comparison with one value instead of a texel.
    [[nodiscard]] Real against(const Real& red) const { return select(compare(op_, reference_, red), Real(1.0f), Real(0.0f)); }

private:
    /// In the range of the format.
    static Real limited(const Real& x) {
        if constexpr (AnyCodec::kIsUnorm || AnyCodec::kIsDepth) {
            return saturate(x);
        } else if constexpr (AnyCodec::kIsSnorm) {
            return select(is_nan(x), Real(0.0f), clamp(x, Real(-1.0f), Real(1.0f)));
        } else {
            return x;
        }
    }
    /// As the format would store it: D3D11.3 22.4.19. Floats keep their bits.
    Real at_precision(const Real& x, const Profile& profile) const {
        if constexpr (AnyCodec::kIsUnorm || AnyCodec::kIsSnorm) {
            const Int code = AnyCodec::template code_of<Real>(x, 0, profile.float_narrowing);
            return AnyCodec::template number<Real>(code, 0, decode_);
        } else {
            return x;
        }
    }

    const std::byte* base_;
    UnormDecode decode_;
    CompareOp op_;
    bool has_border_;
    Real reference_;
    Real border_{};
};

/// What a comparison returns where the view has no level to read: the out-of-bounds value 0 meets the reference. D3D11.3 5.8.6
template <class Real>
Real compare_out_of_bounds(const Lookup& lookup, const Real& reference) {
    return with_codec(lookup.view.texture().desc().format, [&]<class AnyCodec>(AnyCodec) {
        return CompareTap<AnyCodec, Real>(lookup, reference).against(Real(0.0f));
    });
}

/// The stored codes, missing components as 0 and alpha as 1. D3D11.3 19.1.3.3
template <class AnyCodec>
class CodeTap {
public:
    static constexpr bool kCompares = false;
    static constexpr bool kStandard = false;
    static constexpr bool kIsFinite = false;

    explicit CodeTap(const Lookup& lookup) : base_(lookup.view.texture().data()), border_(lookup.sampler) {}
    std::array<Int, 4> operator()(Int offset, Mask outside) const {
        const auto words = AnyCodec::load(base_, offset);
        std::array<Int, 4> codes{Int(0), Int(0), Int(0), Int(1)};
        for (std::size_t c = 0; c < AnyCodec::kComponents; ++c) codes[c] = select(outside, border(c), AnyCodec::code(words, c));
        return codes;
    }

private:
    Int border(std::size_t c) const {
        return AnyCodec::template code_of<Float>(Float(border_.border[static_cast<int>(c)]), c, Narrowing::NearestEven);
    }

    const std::byte* base_;
    const Sampler& border_;
};

}  // namespace gnomon
