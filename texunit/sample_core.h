// The sample instructions as one template: what to read of a texel (`Tap`) and who watches (`Observer`) are its parameters, so
// that pictures, comparisons and records run through the same lines.
#pragma once

#include "texunit/aniso.h"
#include "texunit/codec.h"
#include "texunit/compare.h"
#include "texunit/ewa.h"
#include "texunit/filter.h"
#include "texunit/lod.h"
#include "texunit/peer_aniso.h"
#include "texunit/sample.h"

namespace gnomon {

/// Watches nothing and costs nothing.
struct Unobserved {
    static constexpr bool kWatches = false;
    template <class Real>
    void begin(const LevelOfDetail<Real>&, const LevelPair<Real>&) {}
    template <class Real>
    void begin_probe(const Vec2<Real>&, const Real&, Mask) {}
    template <class Real>
    void begin_level(Int, const Real&, Mask) {}
    template <class Real, class AnyTexels, class Result>
    void footprint(const Footprint<Real>&, const AnyTexels&, const Result&) {}
    template <class Real, class Texel>
    void ellipse_texel(Int, Mask, const Texel&, const Real&, Mask) {}
    template <class Result, class Real>
    void end_ellipse(const Result&, const Real&) {}
    template <class Result>
    void end_probe(const Result&) {}
};

/// Anisotropy is a line of probes by D3D11, OpenGL or Vulkan: all that a core with an inlined tap can do.
inline bool filters_by_probes(const Profile& profile) {
    return profile.aniso_rule != AnisoRule::Llvmpipe && profile.aniso_rule != AnisoRule::SwiftShader &&
           profile.probe_placement != ProbePlacement::Ewa;
}

/// The case that cores with an inlined tap are compiled for: the specification's filter on one slice of a texture.
inline bool is_standard(const TextureView& view, const Sampler& sampler, const Profile& profile, bool anisotropic) {
    return profile.address_arithmetic == AddressArithmetic::FixedPoint && profile.bilinear_form == BilinearForm::Lerp &&
           profile.unorm_decode == UnormDecode::Divide && profile.unorm_filter == UnormFilter::Float &&
           sampler.reduction == Reduction::Average && view.texture().desc().kind != TextureKind::Cube &&
           (!anisotropic || filters_by_probes(profile));
}

/// The sampler that the hardware makes of the one it is given: formats that it cannot filter are point-sampled.
inline Sampler effective_sampler(const Sampler& sampler, const FormatInfo& format, const Profile& profile) {
    if (filters_format(format, profile)) return sampler;
    Sampler nearest = sampler;
    nearest.min = nearest.mag = TexelFilter::Nearest;
    if (nearest.mip == MipFilter::Linear) nearest.mip = MipFilter::Nearest;
    nearest.max_anisotropy = 1;
    return nearest;
}

/// Colours per texel of `kCount` components, numbers or the results of comparisons.
template <std::size_t kCount, class Value, class Real, class Tap, class Observer>
class SampleCore {
public:
    using Result = std::array<Value, kCount>;

    SampleCore(const Lookup& lookup, const Blend& blend, const Tap& tap, Observer& observer)
        : lookup_(lookup), blend_(blend), tap_(tap), observer_(observer) {}

    /// `coordinate` is normalised, on the face for cubes.
    GNOMON_INLINE Result sample(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, const Real& bias) {
        const Sampler& sampler = lookup_.sampler;
        LevelPair<Real> pair{.magnify = Mask(true), .level = Int(0), .fraction = Real(0.0f), .clamped = Real(0.0f)};
        const bool lod_decides = sampler.mip != MipFilter::Base || sampler.min != sampler.mag;
        if (lod_decides || lod.anisotropic || Observer::kWatches) {
            pair = select_levels(lod.lod, bias, sampler, lookup_.view, lookup_.profile);
            if (blend_.rounds_to_codes) pair.fraction = floor(pair.fraction * Real(256.0f)) * Real(1.0f / 256.0f);
            observer_.begin(lod, pair);
        }
        if constexpr (kIsNumber)
            if (lod.anisotropic) return anisotropic(coordinate, lod, pair);
        observer_.begin_probe(coordinate, Real(1.0f), Mask(true));
        const Result result = filter_levels(coordinate, pair);
        observer_.end_probe(result);
        return result;
    }

    /// The codes or numbers of the four texels under a bilinear filter of the view's finest level, no arithmetic.
    Texels<kCount, Value> gather(const Vec2<Real>& coordinate) {
        const LevelLanes place = locate_level(lookup_.view.texture().table(), Int(lookup_.view.base()));
        return read_texels<kCount, Value>(footprint_of(place, prepared(coordinate), true), lookup_.profile.cube_corner, tap_);
    }

private:
    static constexpr bool kIsNumber = !std::is_same_v<Value, Int>;

    [[gnu::noinline]] Result anisotropic(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod,
                                         const LevelPair<Real>& pair) {
        if constexpr (!Tap::kStandard) {
            switch (lookup_.profile.aniso_rule) {
                case AnisoRule::Llvmpipe: return llvmpipe_ellipse(coordinate, lod, pair);
                case AnisoRule::SwiftShader: return swiftshader_probes(coordinate, lod, pair);
                case AnisoRule::D3d11:
                case AnisoRule::OpenGl:
                case AnisoRule::Vulkan: break;
            }
            if (lookup_.profile.probe_placement == ProbePlacement::Ewa) return elliptical(coordinate, lod, pair);
        }
        return probes(coordinate, lod, pair);
    }

    /// One isotropic sample of several.
    [[gnu::noinline]] Result probe(const Vec2<Real>& coordinate, const Real& weight, Mask active, const LevelPair<Real>& pair) {
        observer_.begin_probe(coordinate, weight, active);
        const Result result = filter_levels(coordinate, pair);
        observer_.end_probe(result);
        return result;
    }

    GNOMON_INLINE Result filter_levels(const Vec2<Real>& coordinate, const LevelPair<Real>& pair) {
        const Sampler& sampler = lookup_.sampler;
        const Vec2<Real> reduced = prepared(coordinate);
        if constexpr (kIsNumber) {
            const Real rest = Real(1.0f) - pair.fraction;
            const Result fine = filter_level(pair.level, rest, pair.magnify, reduced);
            const Mask mixed = pair.fraction > Real(0.0f);
            if (none(mixed)) return fine;
            const Int coarser = min(pair.level + Int(1), Int(lookup_.view.levels() - 1));
            const Result coarse = filter_level(coarser, pair.fraction, pair.magnify, reduced);
            return mix_levels<Tap>(fine, coarse, pair.fraction, sampler.reduction, blend_);
        } else {
            return filter_level(pair.level, Real(1.0f), pair.magnify, reduced);
        }
    }

    /// One level with the min filter, the mag filter or, where lanes differ, both.
    GNOMON_INLINE Result filter_level(Int level, const Real& weight, Mask magnify, const Vec2<Real>& reduced) {
        const Sampler& sampler = lookup_.sampler;
        const Int stored = level + Int(lookup_.view.base());
        const LevelLanes place = locate_level(lookup_.view.texture().table(), stored);
        TexelFilter filter = sampler.min;
        if (sampler.min != sampler.mag) {
            if (all(magnify)) {
                filter = sampler.mag;
            } else if (any(magnify)) {
                const Result minified = filter_lanes(stored, place, weight, !magnify, reduced, sampler.min);
                const Result magnified = filter_lanes(stored, place, weight, magnify, reduced, sampler.mag);
                Result result;
                for (std::size_t c = 0; c < kCount; ++c) result[c] = select(magnify, magnified[c], minified[c]);
                return result;
            }
        }
        observer_.begin_level(stored, weight, weight > Real(0.0f));
        return filter_texels(place, reduced, filter == TexelFilter::Linear);
    }
    [[gnu::noinline]] Result filter_lanes(Int stored, const LevelLanes& place, const Real& weight, Mask lanes,
                                          const Vec2<Real>& reduced, TexelFilter filter) {
        observer_.begin_level(stored, weight, lanes & (weight > Real(0.0f)));
        return filter_texels(place, reduced, filter == TexelFilter::Linear);
    }

    GNOMON_INLINE Result filter_texels(const LevelLanes& place, const Vec2<Real>& reduced, bool linear) {
        const Footprint<Real> footprint = footprint_of(place, reduced, linear);
        const Texels<kCount, Value> texels = read_texels<kCount, Value>(footprint, lookup_.profile.cube_corner, tap_);
        const Result result = combine(footprint, texels);
        observer_.footprint(footprint, texels, result);
        return result;
    }

    GNOMON_INLINE Footprint<Real> footprint_of(const LevelLanes& place, const Vec2<Real>& reduced, bool linear) const {
        if constexpr (!Tap::kStandard) {
            if (lookup_.view.texture().desc().kind == TextureKind::Cube)
                return make_cube_footprint(lookup_, place, reduced, linear);
        }
        return make_footprint<Tap::kStandard>(lookup_, place, reduced, linear);
    }

    GNOMON_INLINE Result combine(const Footprint<Real>& footprint, const Texels<kCount, Value>& texels) const {
        if constexpr (kIsNumber) {
            if (!footprint.linear) return texels[0];
            const Real& u = footprint.fraction_u;
            const Real& v = footprint.fraction_v;
            if constexpr (!Tap::kStandard)
                if (lookup_.sampler.reduction != Reduction::Average) return extreme(texels, u, v, lookup_.sampler.reduction);
            if constexpr (Tap::kCompares && !Tap::kStandard) {
                if (blend_.form == BilinearForm::FusedLerp) return llvmpipe_compared(texels, u, v);
            }
            return bilinear<Tap>(texels, u, v, blend_);
        } else {
            return texels[0];
        }
    }

    /// Comparison results along u as sums of weights. Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_masklerp2d
    static Result llvmpipe_compared(const Texels<kCount, Value>& t, const Real& u, const Real& v) {
        const Real rest = Real(1.0f) - u;
        const Real upper = t[1][0] * u + t[0][0] * rest;
        const Real lower = t[3][0] * u + t[2][0] * rest;
        return {fused_multiply_add(v, lower - upper, upper)};
    }

    /// Probes of equal weight along the line of anisotropy. D3D11.3 7.18.6, 7.18.11
    Result probes(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, const LevelPair<Real>& pair) {
        ProbeMean<kCount, Real> mean(lookup_.sampler.reduction);
        const Real weight = Real(1.0f) / Real(lod.probes);
        Mask active(true);
        for (int k = 0; any(active); active = Int(++k) < lod.probes) {
            const Real t = probe_position<Real>(k, lod.probes, lookup_.profile.probe_placement);
            const Vec2<Real> at{coordinate.x + lod.major.x * t, coordinate.y + lod.major.y * t};
            mean.add(probe(at, weight, active, pair), weight, active);
        }
        return mean.mean();
    }

    /// A Gaussian over the ellipse on each of the two levels; a magnified pixel gets its mag filter. [Heckbert89] 3.5.8
    Result elliptical(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, const LevelPair<Real>& pair) {
        const Mask round = (lod.probes <= Int(1)) & pair.magnify;
        if (all(round)) return probe(coordinate, Real(1.0f), Mask(true), pair);
        observer_.begin_probe(coordinate, Real(1.0f), !round);
        Result result = ellipse_level(coordinate, lod, pair.level, Real(1.0f) - pair.fraction, !round);
        if (any(pair.fraction > Real(0.0f))) {
            const Int coarser = min(pair.level + Int(1), Int(lookup_.view.levels() - 1));
            const Result coarse = ellipse_level(coordinate, lod, coarser, pair.fraction, !round);
            result = mix_levels<Tap>(result, coarse, pair.fraction, lookup_.sampler.reduction, blend_);
        }
        observer_.end_probe(result);
        if (none(round)) return result;
        const Result magnified = probe(coordinate, Real(1.0f), round, pair);
        for (std::size_t c = 0; c < kCount; ++c) result[c] = select(round, magnified[c], result[c]);
        return result;
    }

    Result ellipse_level(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, Int level, const Real& weight,
                         Mask lanes) {
        const Int stored = level + Int(lookup_.view.base());
        observer_.begin_level(stored, weight, lanes & (weight > Real(0.0f)));
        const LevelLanes place = locate_level(lookup_.view.texture().table(), stored);
        const Real w(place.width);
        const Real h(place.height);
        const Real half(0.5f);
        const Sampler& sampler = lookup_.sampler;
        const Vec2<Real> center{reduce_range(coordinate.x, sampler.address_u) * w - half,
                                reduce_range(coordinate.y, sampler.address_v) * h - half};
        const Ellipse<Real> ellipse =
            make_ellipse(center, Vec2<Real>{lod.major.x * w, lod.major.y * h}, Vec2<Real>{lod.minor.x * w, lod.minor.y * h});
        WeightedMean<kCount, Real> mean;
        for_ellipse(ellipse, [&](Int u, Int v, const Real& r2, Mask inside) {
            Mask border;
            const Int offset = texel_offset(place, u, v, border);
            const auto texel = tap_(offset, border);
            const Real texel_weight = ewa_weight(r2);
            mean.add(texel, texel_weight, inside);
            observer_.ellipse_texel(offset, border, texel, texel_weight, inside);
        });
        const Result result = mean.mean(sampler.reduction);
        observer_.end_ellipse(result, mean.total_weight());
        return result;
    }

    /// Byte offset of any texel of a level, address modes applied.
    Int texel_offset(const LevelLanes& place, Int u, Int v, Mask& border) const {
        const Sampler& sampler = lookup_.sampler;
        const Int x = u + Int(lookup_.offset.x);
        const Int y = v + Int(lookup_.offset.y);
        border = outside(x, place.width, sampler.address_u) | outside(y, place.height, sampler.address_v);
        const Texture& texture = lookup_.view.texture();
        return place.offset + lookup_.layer * Int(texture.layer_stride()) +
               apply_address_mode(y, place.height, sampler.address_v, true) * place.pitch +
               apply_address_mode(x, place.width, sampler.address_u, true) * Int(texture.info().bytes_per_texel);
    }

    /// Weighted sums of probes, each level walked on its own. SwiftShader SamplerCore.cpp, sampleAniso()
    Result swiftshader_probes(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, const LevelPair<Real>& pair) {
        const Reduction reduction = lookup_.sampler.reduction;
        const auto walk = [&](Int level, const Real& level_weight, Mask lanes) {
            const LevelPair<Real> alone{
                .magnify = pair.magnify, .level = level, .fraction = Real(0.0f), .clamped = pair.clamped};
            const Real share = Real(1.0f) / Real(lod.probes);
            const Real start = -(Real(lod.probes - Int(1)) / Real(lod.probes + lod.probes));
            const Vec2<Real> step{lod.major.x * share, lod.major.y * share};
            Vec2<Real> at{coordinate.x + start * lod.major.x, coordinate.y + start * lod.major.y};
            Result sum{};
            Mask active(true);
            for (int k = 0; any(active); active = Int(++k) < lod.probes) {
                const Result one = probe(at, share * level_weight, active & lanes, alone);
                for (std::size_t c = 0; c < kCount; ++c) {
                    const Real next = reduction == Reduction::Average   ? sum[c] + one[c] * share
                                      : k == 0                          ? one[c]
                                      : reduction == Reduction::Minimum ? min(sum[c], one[c])
                                                                        : max(sum[c], one[c]);
                    sum[c] = select(active, next, sum[c]);
                }
                at = at + step;
            }
            return sum;
        };
        const Result fine = walk(pair.level, Real(1.0f) - pair.fraction, Mask(true));
        const Mask mixed = pair.fraction > Real(0.0f);
        if (none(mixed)) return fine;
        const Result coarse = walk(min(pair.level + Int(1), Int(lookup_.view.levels() - 1)), pair.fraction, mixed);
        return mix_levels<Tap>(fine, coarse, pair.fraction, lookup_.sampler.reduction, blend_);
    }

    /// Nearest texels of one level under an ellipse. Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_sample_aniso
    Result llvmpipe_ellipse(const Vec2<Real>& coordinate, const LevelOfDetail<Real>& lod, const LevelPair<Real>& pair) {
        const TextureView& view = lookup_.view;
        const Int level = clamp(truncate_to_int(pair.clamped), Int(0), Int(view.levels() - 1));
        const Int stored = level + Int(view.base());
        const LevelLanes place = locate_level(view.texture().table(), stored);
        observer_.begin_probe(coordinate, Real(1.0f), Mask(true));
        observer_.begin_level(stored, Real(1.0f), Mask(true));

        const LlvmpipeEllipse ellipse({to_float(coordinate.x), to_float(coordinate.y)},
                                      {to_float(lod.major.x), to_float(lod.major.y)},
                                      {to_float(lod.minor.x), to_float(lod.minor.y)}, view.width(), view.height(), level);
        const Reduction reduction = lookup_.sampler.reduction;
        Result sum{};
        Real total(0.0f);
        ellipse.for_each([&](Int u, Int v, Float weight) {
            const Mask counts = weight != Float(0.0f);
            const Vec2<Real> at{Real(Float(u) / Float(place.width)), Real(Float(v) / Float(place.height))};
            const Footprint<Real> footprint = make_footprint<Tap::kStandard>(lookup_, place, prepared(at), false);
            const auto texel = tap_(footprint.offset[0], footprint.outside[0]);
            const Mask first = counts & (total == Real(0.0f));
            for (std::size_t c = 0; c < kCount; ++c) {
                const Real next = reduction == Reduction::Average   ? sum[c] + texel[c] * Real(weight)
                                  : reduction == Reduction::Minimum ? select(first, texel[c], min(sum[c], texel[c]))
                                                                    : select(first, texel[c], max(sum[c], texel[c]));
                sum[c] = select(counts, next, sum[c]);
            }
            total = total + Real(weight);
            observer_.ellipse_texel(footprint.offset[0], footprint.outside[0], texel, Real(weight), counts);
        });
        Result result;
        for (std::size_t c = 0; c < kCount; ++c) result[c] = reduction == Reduction::Average ? sum[c] / total : sum[c];

        // An ellipse without texels: bilinear.
        const Mask found = (total < Real(0.0f)) | (total > Real(0.0f));
        observer_.end_ellipse(result, total);
        if (!all(found)) {
            const Result bilinear = filter_lanes(stored, place, Real(1.0f), !found, prepared(coordinate), TexelFilter::Linear);
            for (std::size_t c = 0; c < kCount; ++c) result[c] = select(found, result[c], bilinear[c]);
        }
        observer_.end_probe(result);
        return result;
    }

    /// Range reduction, where the profile's addresses begin with it.
    GNOMON_INLINE Vec2<Real> prepared(const Vec2<Real>& coordinate) const {
        if (lookup_.profile.address_arithmetic != AddressArithmetic::FixedPoint) return coordinate;
        if (lookup_.view.texture().desc().kind == TextureKind::Cube) return coordinate;  // D3D11.3 7.18.5: not for cubes
        return {reduce_range(coordinate.x, lookup_.sampler.address_u), reduce_range(coordinate.y, lookup_.sampler.address_v)};
    }

    const Lookup& lookup_;
    const Blend& blend_;
    const Tap& tap_;
    Observer& observer_;
};

}  // namespace gnomon
