// The instructions, for pictures: the formats of shadow maps have the filter inlined around them, the others share one.
#include "texunit/sample.h"

#include "texunit/instruction.h"

namespace gnomon {

namespace {

/// Calls visit(Codec<...>{}) where the format is one that shadow maps use, else other().
template <class Visit, class Other>
auto with_common_codec(Format format, const Visit& visit, const Other& other) {
    using enum ComponentType;
    switch (format) {
        case Format::Rg32Float: return visit(Codec<Float32, 2>{});
        case Format::Rg16Float: return visit(Codec<Float16, 2>{});
        case Format::R32Float: return visit(Codec<Float32, 1>{});
        case Format::Rgba32Float: return visit(Codec<Float32, 4>{});
        case Format::Rgba16Float: return visit(Codec<Float16, 4>{});
        case Format::Rg16Unorm: return visit(Codec<Unorm16, 2>{});
        case Format::Rgba8Unorm: return visit(Codec<Unorm8, 4>{});
        case Format::D32Float: return visit(Codec<Depth32, 1>{});
        default: return other();
    }
}
template <class Visit, class Other>
auto with_depth_codec(Format format, const Visit& visit, const Other& other) {
    using enum ComponentType;
    switch (format) {
        case Format::D16: return visit(Codec<Depth16, 1>{});
        case Format::D24: return visit(Codec<Depth24, 1>{});
        case Format::D32Float: return visit(Codec<Depth32, 1>{});
        default: return other();
    }
}

/// What the loops of shadow techniques ask for: level 0 of a depth texture, compared.
bool is_plain_compare(const TextureView& view, const Sampler& sampler, const SampleOperands<Float>& operands) {
    return view.texture().desc().format == Format::D32Float && view.texture().desc().layers == 1 &&
           sampler.min == sampler.mag && sampler.mip == MipFilter::Base && sampler.address_u == AddressMode::Clamp &&
           sampler.address_v == AddressMode::Clamp && operands.offset == glm::ivec2(0);
}

/// The same filter, with a sampler that the compiler knows.
template <TexelFilter kFilter>
Float plain_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Float>& coordinate,
                    Float reference) {
    using Tap = CompareTap<Codec<ComponentType::Depth32, 1>, Float>;
    Sampler known{.min = kFilter, .mag = kFilter};
    known.compare = sampler.compare;
    const Lookup lookup{view, known, profile, {0, 0}, Int(0)};
    const Blend blend{.carry = profile.texel_carry};
    const Tap tap(lookup, reference);
    Unobserved nobody;
    return SampleCore<1, Float, Float, Tap, Unobserved>(lookup, blend, tap, nobody)
        .sample({coordinate.x, coordinate.y}, LevelOfDetail<Float>(Float(0.0f)), Float(0.0f))[0];
}

}  // namespace

template <class Real>
Vec4<Real> sample(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                  const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) {
    const FormatInfo& format = view.texture().info();
    if (view.empty()) [[unlikely]]
        return out_of_bounds<Real>(format);
    Unobserved nobody;
    const auto any_format = [&] { return sample_observed<0>(view, sampler, profile, coordinate, lod, operands, nobody); };
    if constexpr (std::is_same_v<Real, Float>) {
        if (!filters_format(format, profile) || !is_standard(view, sampler, profile, lod.anisotropic)) return any_format();
        const auto inline_format = [&]<class AnyCodec>(AnyCodec) {
            constexpr std::size_t kCount = AnyCodec::kComponents;
            using Tap = StandardNumberTap<AnyCodec, Real>;
            const LayerPosition<Real> at = locate_slice(view.texture(), coordinate);
            const Lookup lookup{view, sampler, profile, operands.offset, at.layer};
            const Blend blend{.carry = profile.texel_carry};
            const Tap tap(lookup);
            return expand(SampleCore<kCount, Real, Real, Tap, Unobserved>(lookup, blend, tap, nobody)
                              .sample(at.uv, lod, operands.lod_bias));
        };
        return with_common_codec(format.format, inline_format, any_format);
    } else {
        return any_format();
    }
}

template <class Real>
Real sample_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                    const Real& reference, const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands) {
    const FormatInfo& format = view.texture().info();
    Unobserved nobody;
    if (view.empty()) [[unlikely]]
        return compare_out_of_bounds(Lookup{view, sampler, profile, operands.offset, Int(0)}, reference);
    const auto any_format = [&] {
        return compare_observed(view, sampler, profile, coordinate, reference, lod, operands, nobody);
    };
    if constexpr (std::is_same_v<Real, Float>) {
        if (!is_standard(view, sampler, profile, lod.anisotropic)) return any_format();
        if (!lod.anisotropic && is_plain_compare(view, sampler, operands)) {
            if (sampler.min == TexelFilter::Nearest)
                return plain_compare<TexelFilter::Nearest>(view, sampler, profile, coordinate, reference);
            return plain_compare<TexelFilter::Linear>(view, sampler, profile, coordinate, reference);
        }
        const auto inline_format = [&]<class AnyCodec>(AnyCodec) {
            using Tap = CompareTap<AnyCodec, Real>;
            const LayerPosition<Real> at = locate_slice(view.texture(), coordinate);
            const Lookup lookup{view, sampler, profile, operands.offset, at.layer};
            const Blend blend{.carry = profile.texel_carry};
            const Tap tap(lookup, reference);
            return SampleCore<1, Real, Real, Tap, Unobserved>(lookup, blend, tap, nobody)
                .sample(at.uv, lod, operands.lod_bias)[0];
        };
        return with_depth_codec(format.format, inline_format, any_format);
    } else {
        return any_format();
    }
}

template Vec4<Float> sample(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, const LevelOfDetail<Float>&,
                            const SampleOperands<Float>&);
template Vec4<Double> sample(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&,
                             const LevelOfDetail<Double>&, const SampleOperands<Double>&);
template Float sample_compare(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, const Float&,
                              const LevelOfDetail<Float>&, const SampleOperands<Float>&);
template Double sample_compare(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&, const Double&,
                               const LevelOfDetail<Double>&, const SampleOperands<Double>&);

}  // namespace gnomon
