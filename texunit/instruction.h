// What every sample instruction does before and after its filter: where on the texture it looks, how the format's numbers are
// made, which path filters them.
#pragma once

#include "texunit/sample_core.h"
#include "texunit/taps.h"

namespace gnomon {

/// Position on one 2D layer.
template <class Real>
struct LayerPosition {
    Vec2<Real> uv;
    Int layer;
};

/// Slices of an array round to nearest even and clamp. D3D11.3 22.4.15
template <class Real>
GNOMON_INLINE LayerPosition<Real> locate_slice(const Texture& texture, const Vec3<Real>& coordinate) {
    Int slice(0);
    if (texture.desc().kind == TextureKind::Array) {
        const Real limit(static_cast<float>(kMaxLayers));
        const Real number = select(is_nan(coordinate.z), Real(0.0f), clamp(coordinate.z, -limit, limit));
        slice = clamp(bounded_round_to_int(number), Int(0), Int(texture.desc().layers - 1));
    }
    return {{coordinate.x, coordinate.y}, slice};
}
/// And directions leave a cube through a face. D3D11.3 7.18.7
template <class Real>
GNOMON_INLINE LayerPosition<Real> locate_layer(const Texture& texture, const Vec3<Real>& coordinate) {
    if (texture.desc().kind != TextureKind::Cube) return locate_slice(texture, coordinate);
    const CubeDirection<Real> on = face_of(coordinate);
    return {face_coordinate(on), on.face};
}

/// How one instruction on one texture computes.
struct Instruction {
    NumberRule numbers;
    Blend blend;
    bool integer_coordinates = false;
    bool fixed_coordinates = false;
};

/// By format, sampler and profile. Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_sample_soa_code (when 8-bit integers filter);
/// SwiftShader SamplerCore.cpp, sampleTexture128 (when 16-bit integers are read)
GNOMON_INLINE Instruction decide_instruction(const FormatInfo& format, const Sampler& sampler, const Profile& profile,
                                             bool compares, bool gathers) {
    Instruction result{.numbers = {.decode = profile.unorm_decode},
                       .blend = {.form = profile.bilinear_form, .carry = profile.texel_carry}};
    const bool unorm8 = format.type == ComponentType::Unorm8;
    const bool unorm16 = format.type == ComponentType::Unorm16;
    const bool nearest =
        sampler.min == TexelFilter::Nearest && sampler.mag == TexelFilter::Nearest && sampler.max_anisotropy <= 1;
    if (profile.unorm_decode == UnormDecode::Late) {
        result.numbers.decode = UnormDecode::Divide;  // of the formats that are not decoded late
        if (!compares && (unorm8 || unorm16)) {
            result.numbers.code_scale = unorm8 ? 256.0f : 1.0f;
            result.numbers.largest = unorm8 ? 65280.0f : 65535.0f;
        }
    }
    result.integer_coordinates = profile.address_arithmetic == AddressArithmetic::SwiftShader && (unorm8 || unorm16) &&
                                 nearest && !compares && !gathers && !has_border(sampler);
    const auto simple = [](AddressMode mode) { return mode == AddressMode::Wrap || mode == AddressMode::Clamp; };
    if (profile.unorm_filter == UnormFilter::Llvmpipe && unorm8 && !compares && !gathers && sampler.max_anisotropy <= 1 &&
        sampler.min == sampler.mag && simple(sampler.address_u) && simple(sampler.address_v)) {
        result.numbers.code_scale = 1.0f;
        result.numbers.largest = 255.0f;
        result.blend.rounds_to_codes = true;
        result.fixed_coordinates = profile.address_arithmetic == AddressArithmetic::Llvmpipe;
    }
    return result;
}

/// A tap of any format behind one call, widened to `kCount` components with the defaults 0, 0, 0, 1: what rare formats, records
/// and double arithmetic run through.
template <std::size_t kCount, class RealType, bool kCompare>
class AnyTap {
public:
    static constexpr bool kCompares = kCompare;
    static constexpr bool kStandard = false;
    static constexpr bool kIsFinite = false;
    using Real = RealType;

    template <class Tap>
    explicit AnyTap(const Tap& tap)
        : tap_(&tap), read_([](const void* object, Int offset, Mask outside) {
              const auto texel = (*static_cast<const Tap*>(object))(offset, outside);
              std::array<Real, kCount> wide;
              for (std::size_t c = 0; c < kCount; ++c) wide[c] = c < texel.size() ? texel[c] : Real(c == 3 ? 1.0f : 0.0f);
              return wide;
          }) {}
    std::array<Real, kCount> operator()(Int offset, Mask outside) const { return read_(tap_, offset, outside); }

private:
    const void* tap_;
    std::array<Real, kCount> (*read_)(const void*, Int, Mask);
};

/// What an instruction on a view without levels returns: 0, and the defaults of missing components. D3D11.3 5.8.5
template <class Real>
Vec4<Real> out_of_bounds(const FormatInfo& format) {
    const Real zero(0.0f);
    return {zero, zero, zero, Real(format.components == 4 ? 0.0f : 1.0f)};
}

/// The filter core over any format through AnyTap.
template <std::size_t kCount, class Real, class Observer>
[[gnu::noinline]] std::array<Real, kCount> run_core(const Lookup& lookup, const Blend& blend,
                                                    const AnyTap<kCount, Real, false>& tap, const Vec2<Real>& uv,
                                                    const LevelOfDetail<Real>& lod, const Real& bias, Observer& observer) {
    return SampleCore<kCount, Real, Real, AnyTap<kCount, Real, false>, Observer>(lookup, blend, tap, observer)
        .sample(uv, lod, bias);
}

/// An instruction over every format, with `kWidth` components or, where that is 0, about as many as the format has.
template <std::size_t kWidth, class Real, class Observer>
Vec4<Real> sample_observed(const TextureView& view, const Sampler& given, const Profile& profile, const Vec3<Real>& coordinate,
                           const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands, Observer& observer) {
    const FormatInfo& format = view.texture().info();
    const Sampler sampler = effective_sampler(given, format, profile);
    const Instruction how = decide_instruction(format, sampler, profile, false, false);
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, sampler, profile, operands.offset, at.layer, how.integer_coordinates, how.fixed_coordinates};
    return with_codec(format.format, [&]<class AnyCodec>(AnyCodec) {
        constexpr std::size_t kCount = AnyCodec::kComponents;
        constexpr std::size_t kWide = kWidth != 0 ? kWidth : kCount == 3 ? 4 : kCount;
        const NumberTap<AnyCodec, Real> concrete(lookup, how.numbers);
        const AnyTap<kWide, Real, false> tap(concrete);
        const auto wide = run_core(lookup, how.blend, tap, at.uv, lod, operands.lod_bias, observer);
        std::array<Real, kCount> result;
        for (std::size_t c = 0; c < kCount; ++c)
            result[c] = how.numbers.code_scale != 0.0f ? wide[c] * Real(1.0f / how.numbers.largest) : wide[c];
        return expand(result);
    });
}

template <class Real, class Observer>
Real compare_observed(const TextureView& view, const Sampler& given, const Profile& profile, const Vec3<Real>& coordinate,
                      const Real& reference, const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands,
                      Observer& observer) {
    const FormatInfo& format = view.texture().info();
    const Sampler sampler = effective_sampler(given, format, profile);
    const Instruction how = decide_instruction(format, sampler, profile, true, false);
    const LayerPosition<Real> at = locate_layer(view.texture(), coordinate);
    const Lookup lookup{view, sampler, profile, operands.offset, at.layer};
    using Tap = AnyTap<1, Real, true>;
    const auto run = [&](const Tap& tap) {
        return SampleCore<1, Real, Real, Tap, Observer>(lookup, how.blend, tap, observer)
            .sample(at.uv, lod, operands.lod_bias)[0];
    };
    return with_codec(format.format, [&]<class AnyCodec>(AnyCodec) {
        const CompareTap<AnyCodec, Real> concrete(lookup, reference);
        return run(Tap(concrete));
    });
}

/// Instantiated in sample_any.cpp.
extern template Vec4<Float> sample_observed<0>(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&,
                                               const LevelOfDetail<Float>&, const SampleOperands<Float>&, Unobserved&);
extern template Vec4<Double> sample_observed<0>(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&,
                                                const LevelOfDetail<Double>&, const SampleOperands<Double>&, Unobserved&);
extern template Float compare_observed(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, const Float&,
                                       const LevelOfDetail<Float>&, const SampleOperands<Float>&, Unobserved&);
extern template Double compare_observed(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&, const Double&,
                                        const LevelOfDetail<Double>&, const SampleOperands<Double>&, Unobserved&);

}  // namespace gnomon
