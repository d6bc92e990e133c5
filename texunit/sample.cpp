#include "texunit/sample.h"

#include "texunit/codec.h"
#include "texunit/compare.h"
#include "texunit/filter.h"
#include "texunit/lod.h"

namespace gnomon {

namespace {

/// Filters one level with the min filter, the mag filter or, where lanes differ, both.
template <std::size_t kCount, class Real, class Tap>
std::array<Real, kCount> filter_level(const Texture& texture, Int level, Mask magnify, const Vec2<Real>& reduced,
                                      const Sampler& sampler, const Profile& profile, const Tap& tap) {
    const LevelLanes place = locate_level(texture.table(), level);
    const auto filtered = [&](TexelFilter filter) {
        const bool linear = filter == TexelFilter::Linear;
        const int bytes = texture.info().bytes_per_texel;
        return filter_footprint<kCount>(make_footprint(place, reduced, linear, bytes, sampler, profile), profile.bilinear_form,
                                        tap);
    };
    if (sampler.min == sampler.mag || none(magnify)) return filtered(sampler.min);
    if (all(magnify)) return filtered(sampler.mag);
    const auto minified = filtered(sampler.min);
    const auto magnified = filtered(sampler.mag);
    std::array<Real, kCount> result;
    for (std::size_t c = 0; c < kCount; ++c) result[c] = select(magnify, magnified[c], minified[c]);
    return result;
}

/// One sample: range reduction, level choice, one or two filtered levels.
template <std::size_t kCount, class Real, class Tap>
std::array<Real, kCount> sample_taps(const Texture& texture, const Sampler& sampler, const Profile& profile,
                                     const Vec2<Real>& uv, const Real& lod, const Tap& tap) {
    const Vec2<Real> reduced{reduce_range(uv.x, sampler.address_u), reduce_range(uv.y, sampler.address_v)};
    const int levels = texture.desc().levels;
    if (sampler.mip == MipFilter::Base && sampler.min == sampler.mag)  // the level of detail decides nothing
        return filter_level<kCount>(texture, Int(0), Mask(true), reduced, sampler, profile, tap);

    const LevelPair<Real> pair = select_levels(lod, sampler, levels, profile);
    const auto fine = filter_level<kCount>(texture, pair.level, pair.magnify, reduced, sampler, profile, tap);
    if (none(pair.fraction > Real(0.0f))) return fine;
    const Int coarser = min(pair.level + Int(1), Int(levels - 1));
    const auto coarse = filter_level<kCount>(texture, coarser, pair.magnify, reduced, sampler, profile, tap);
    return mix_levels(fine, coarse, pair.fraction);
}

/// The border colour as the filter sees it: clamped to the range of the format, and for comparisons at the precision that the
/// profile gives their reference. D3D11.3 7.18.9.1
template <class AnyCodec, class Real>
auto border_texel(const Sampler& sampler, bool quantised) {
    std::array<Real, AnyCodec::kComponents> border;
    for (std::size_t c = 0; c < border.size(); ++c) {
        border[c] = Real(sampler.border[static_cast<int>(c)]);
        if constexpr (AnyCodec::kIsUnorm || AnyCodec::kIsDepth) border[c] = saturate(border[c]);
        if constexpr (AnyCodec::kIsUnorm) {
            if (quantised) border[c] = AnyCodec::template number<Real>(unorm_from_float(border[c], AnyCodec::kBits));
        }
    }
    return border;
}

bool has_border(const Sampler& sampler) {
    return sampler.address_u == AddressMode::Border || sampler.address_v == AddressMode::Border;
}

}  // namespace

template <class Real>
Vec4<Real> sample(const Texture& texture, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                  const Real& lod) {
    return with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const std::byte* base = texture.data();
        const auto tap = [&](Int offset, Mask outside) {
            auto texel = AnyCodec::template decode<Real>(AnyCodec::load(base, offset));
            if (has_border(sampler)) {
                const auto border = border_texel<AnyCodec, Real>(sampler, false);
                for (std::size_t c = 0; c < texel.size(); ++c) texel[c] = select(outside, border[c], texel[c]);
            }
            return texel;
        };
        return expand(sample_taps<AnyCodec::kComponents>(texture, sampler, profile, uv, lod, tap));
    });
}

template <class Real>
Real sample_compare(const Texture& texture, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                    const Real& reference, const Real& lod) {
    return with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        // The reference takes the range of the format and, if the profile says so, its precision. D3D11.3 22.4.19
        Real limited = reference;
        if constexpr (AnyCodec::kIsUnorm || AnyCodec::kIsDepth) limited = saturate(reference);
        const bool quantised = profile.compare_reference == CompareReference::Quantised;
        if constexpr (AnyCodec::kIsUnorm) {
            if (quantised)
                limited = AnyCodec::template number<Real>(AnyCodec::template code_of<Real>(limited, profile.float_narrowing));
        }
        const std::byte* base = texture.data();
        const auto tap = [&](Int offset, Mask outside) {
            Real texel = AnyCodec::template number<Real>(AnyCodec::code(AnyCodec::load(base, offset), 0));
            if (has_border(sampler)) texel = select(outside, border_texel<AnyCodec, Real>(sampler, quantised)[0], texel);
            return std::array<Real, 1>{select(compare(sampler.compare, limited, texel), Real(1.0f), Real(0.0f))};
        };
        return sample_taps<1>(texture, sampler, profile, uv, lod, tap)[0];
    });
}

template <class Real>
Vec4<Real> load_texel(const Texture& texture, Int x, Int y, int level) {
    const Int width(texture.width(level));
    const Int height(texture.height(level));
    const Mask inside = (x >= Int(0)) & (x < width) & (y >= Int(0)) & (y < height);
    const LevelLanes place = locate_level(texture.table(), Int(level));
    const Int offset = place.offset + select(inside, y * place.pitch + x * Int(texture.info().bytes_per_texel), Int(0));
    return with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const Vec4<Real> color = expand(AnyCodec::template decode<Real>(AnyCodec::load(texture.data(), offset)));
        const Real zero(0.0f);
        return Vec4<Real>{select(inside, color.x, zero), select(inside, color.y, zero), select(inside, color.z, zero),
                          select(inside, color.w, zero)};
    });
}

template <class Real>
int texels_per_lane(const Sampler& sampler, const Real& lod, const Texture& texture, const Profile& profile, int which) {
    const LevelPair<Real> pair = select_levels(lod, sampler, texture.desc().levels, profile);
    const bool magnify = (pair.magnify.bits() >> which & 1u) != 0;
    const int per_level = (magnify ? sampler.mag : sampler.min) == TexelFilter::Linear ? 4 : 1;
    return per_level * (lane(pair.fraction, which) > 0 ? 2 : 1);
}

template Vec4<Float> sample(const Texture&, const Sampler&, const Profile&, const Vec2<Float>&, const Float&);
template Vec4<Double> sample(const Texture&, const Sampler&, const Profile&, const Vec2<Double>&, const Double&);
template Float sample_compare(const Texture&, const Sampler&, const Profile&, const Vec2<Float>&, const Float&, const Float&);
template Double sample_compare(const Texture&, const Sampler&, const Profile&, const Vec2<Double>&, const Double&,
                               const Double&);
template Vec4<Float> load_texel(const Texture&, Int, Int, int);
template Vec4<Double> load_texel(const Texture&, Int, Int, int);
template int texels_per_lane(const Sampler&, const Float&, const Texture&, const Profile&, int);
template int texels_per_lane(const Sampler&, const Double&, const Texture&, const Profile&, int);

}  // namespace gnomon
