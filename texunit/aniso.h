// Anisotropic filtering: ratio, line and number of probes, and where on the line they lie. D3D11.3 7.18.11,
// EXT_texture_filter_anisotropic, Vulkan 1.3 (Scale Factor Operation; Texel Anisotropic Filtering)
#pragma once

#include "texunit/lod.h"
#include "texunit/peer_aniso.h"

namespace gnomon {

/// Whether the hardware filters a format at all. The instructions here point-sample others whatever the sampler says; draws and
/// `gnomon sample` refuse them together with a sampler that filters.
inline bool filters_format(const FormatInfo& format, const Profile& profile) {
    return !format.is_integer() && (profile.filters_float32 || format.type != ComponentType::Float32);
}

/// The limit of anisotropy that the hardware makes of the sampler's.
inline int effective_anisotropy(int wanted, AnisoLimits limits) {
    if (limits == AnisoLimits::Any) return wanted;
    for (const int step : {16, 12, 10, 8, 6, 4, 2})
        if (wanted >= step) return step;
    return 1;
}

/// Number of probes for a ratio in [1, 16].
template <class Real>
GNOMON_INLINE Int probe_count(const Real& ratio, ProbeCount rule) {
    switch (rule) {
        case ProbeCount::Ceil: return Int(0) - bounded_truncate_to_int(floor(-ratio));
        case ProbeCount::Round: return bounded_truncate_to_int(ratio + Real(0.5f));
        case ProbeCount::Steps: {
            Int count(16);
            for (const int step : {12, 10, 8, 6, 4, 2, 1})
                count = select(ratio <= Real(static_cast<float>(step)), Int(step), count);
            return count;
        }
    }
    __builtin_unreachable();
}

/// Position of probe k (0 to count - 1) on the line of anisotropy, from -1/2 to 1/2.
template <class Real>
GNOMON_INLINE Real probe_position(int k, Int count, ProbePlacement placement) {
    switch (placement) {
        case ProbePlacement::Interior: return Real(static_cast<float>(k + 1)) / Real(count + Int(1)) - Real(0.5f);
        case ProbePlacement::Centred:
        case ProbePlacement::Ewa: return (Real(static_cast<float>(k)) + Real(0.5f)) / Real(count) - Real(0.5f);
    }
    __builtin_unreachable();
}

/// The two derivative vectors, or what takes their place.
template <class Real>
struct Axes {
    Vec2<Real> x;
    Vec2<Real> y;
};

/// The orthogonal axes of the ellipse that the derivatives span; lanes without one (a vector of zero length, parallel,
/// perpendicular or unbounded ones) keep the derivatives. D3D11.3 7.18.11
///
/// The longer axis squared, 2 F / (q - t) in the specification, is written (q + t) / 2, and whichever of t + p and t - p
/// cancels as B^2 over the other: the same numbers, as q^2 - t^2 = 4 F and t^2 - p^2 = B^2, without the differences that lose
/// all digits where the ellipse is thin.
template <class Real>
GNOMON_INLINE Axes<Real> ellipse_axes(const Axes<Real>& d) {
    const Real zero(0.0f);
    const Real half(0.5f);
    const Real a = d.x.y * d.x.y + d.y.y * d.y.y;
    const Real b = Real(-2.0f) * (d.x.x * d.x.y + d.y.x * d.y.y);
    const Real c = d.x.x * d.x.x + d.y.x * d.y.x;
    const Real determinant = d.x.x * d.y.y - d.y.x * d.x.y;
    const Real p = a - c;
    const Real q = a + c;
    const Real t = sqrt(p * p + b * b);

    const Real larger = t + abs(p);
    const Real smaller = b * b / larger;
    const Real plus = select(p >= zero, larger, smaller);   // t + p
    const Real minus = select(p >= zero, smaller, larger);  // t - p
    const Real short_scale = abs(determinant) / sqrt(half * (t * (q + t)));
    const Real long_scale = sqrt(half * ((q + t) / t));
    const Real sign = select(b < zero, Real(-1.0f), Real(1.0f));
    const Real root_plus = sqrt(half * plus);
    const Real root_minus = sqrt(half * minus);
    const Axes<Real> axes{{short_scale * root_plus, short_scale * root_minus * sign},
                          {-(long_scale * root_minus * sign), long_scale * root_plus}};

    // A sum that is not finite betrays any member that is not.
    const Real sum = (axes.x.x + axes.x.y) + (axes.y.x + axes.y.y);
    const Mask usable = (abs(determinant) > zero) & (dot(d.x, d.y) != zero) & (sum - sum == zero);
    const auto pick = [&](const Real& yes, const Real& no) { return select(usable, yes, no); };
    return {{pick(axes.x.x, d.x.x), pick(axes.x.y, d.x.y)}, {pick(axes.y.x, d.y.x), pick(axes.y.y, d.y.y)}};
}

/// Level of detail, ratio and line of the probes; `gradients` in normalised coordinates, sides in texels of the view's finest
/// level. Lanes whose derivatives are both zero, or where anything is not finite, are isotropic: taken literally, 0/0 would
/// send them to the coarsest level (DEVIATION(D3D11.3 7.18.11), tests/spec/s07_18_11_anisotropic.cpp).
template <class Real>
GNOMON_INLINE LevelOfDetail<Real> anisotropic_lod(const Gradients<Real>& gradients, int width, int height,
                                                  const Sampler& sampler, const Profile& profile) {
    const Real zero(0.0f);
    const Real one(1.0f);
    const Real w(static_cast<float>(width));
    const Real h(static_cast<float>(height));
    const Axes<Real> derivatives{{gradients.dx.x * w, gradients.dx.y * h}, {gradients.dy.x * w, gradients.dy.y * h}};
    const Axes<Real> axes = profile.ellipse_transform ? ellipse_axes(derivatives) : derivatives;

    // The longer and the shorter vector.
    const Real squared_x = dot(axes.x, axes.x);
    const Real squared_y = dot(axes.y, axes.y);
    const Mask major_is_x = squared_x > squared_y;
    const auto pick = [&](const Real& x, const Real& y) { return select(major_is_x, x, y); };
    const Vec2<Real> major{pick(axes.x.x, axes.y.x), pick(axes.x.y, axes.y.y)};
    const Real squared_major = pick(squared_x, squared_y);
    const Real length_major = sqrt(squared_major);

    // Ratio of anisotropy and length of the minor axis, by the profile's rule.
    const Real limit(static_cast<float>(effective_anisotropy(sampler.max_anisotropy, profile.aniso_limits)));
    Real ratio;
    Real length_minor;
    if (profile.aniso_rule == AnisoRule::D3d11) {
        const Real determinant = abs(axes.x.x * axes.y.y - axes.x.y * axes.y.x);
        const Real unlimited = squared_major / determinant;
        const Mask limited = unlimited > limit;
        ratio = select(limited, limit, unlimited);
        length_minor = select(limited, length_major / limit, determinant / length_major);
    } else {
        const Real squared_minor = pick(squared_y, squared_x);
        ratio = min(length_major / sqrt(squared_minor), limit);
        if (profile.aniso_rule == AnisoRule::OpenGl) ratio = Real(probe_count(max(ratio, one), profile.probe_count));
        ratio = min(ratio, limit);
        length_minor = length_major / ratio;
    }

    ratio = max(one, ratio);  // rounding may leave a circle a little below 1

    // Clamp to the top level: a magnified minor axis needs fewer probes.
    const Mask magnified = length_minor < one;
    if (profile.aniso_rule == AnisoRule::D3d11) ratio = select(magnified, max(one, ratio * length_minor), ratio);
    const Real counted = profile.aniso_clamps_to_top ? select(magnified, one, length_minor) : length_minor;

    // Isotropic where there is no ellipse.
    const auto is_finite = [&](const Real& x) { return x - x == zero; };
    const Mask finite =
        (ratio <= limit) & is_finite(squared_x) & is_finite(squared_y) & is_finite(length_minor) & (length_minor > zero);
    const Real isotropic = isotropic_lod(derivatives.x, derivatives.y, profile);
    LevelOfDetail<Real> result(select(finite, lod_of_square(counted * counted, profile.log2_model), isotropic));
    result.anisotropic = true;
    result.ratio = select(finite, ratio, one);
    result.major = {select(finite, major.x / w, zero), select(finite, major.y / h, zero)};
    result.probes = min(probe_count(result.ratio, profile.probe_count), Int(sampler.max_anisotropy));

    // The other axis, as long as the limit leaves it: perpendicular where axes are, else along the shorter derivative.
    const Vec2<Real> minor{pick(axes.y.x, axes.x.x), pick(axes.y.y, axes.x.y)};
    const Real stretch = length_minor / sqrt(dot(minor, minor));
    const Mask stretched = finite & is_finite(stretch);
    const Vec2<Real> across{-major.y * (length_minor / length_major), major.x * (length_minor / length_major)};
    result.minor = {select(finite, select(stretched, minor.x * stretch, across.x) / w, zero),
                    select(finite, select(stretched, minor.y * stretch, across.y) / h, zero)};
    return result;
}

/// A level of detail that was computed in binary32.
template <class Real>
LevelOfDetail<Real> widened(const LevelOfDetail<Float>& lod) {
    LevelOfDetail<Real> result(Real(lod.lod));
    result.anisotropic = lod.anisotropic;
    result.ratio = Real(lod.ratio);
    result.major = {Real(lod.major.x), Real(lod.major.y)};
    result.minor = {Real(lod.minor.x), Real(lod.minor.y)};
    result.probes = lod.probes;
    return result;
}

/// What a sampler makes of the derivatives: anisotropic where it asks for it, but isotropic on cubes and for formats that are
/// not filtered. D3D11.3 7.18.11, 7.18.13
template <class Real>
GNOMON_INLINE LevelOfDetail<Real> level_of_detail(const Gradients<Real>& gradients, const TextureView& view,
                                                  const Sampler& sampler, const Profile& profile) {
    const int width = view.width();
    const int height = view.height();
    const bool filtered = filters_format(view.texture().info(), profile);
    if (sampler.max_anisotropy > 1 && filtered && view.texture().desc().kind != TextureKind::Cube) {
        const Gradients<Float> narrow{{to_float(gradients.dx.x), to_float(gradients.dx.y)},
                                      {to_float(gradients.dy.x), to_float(gradients.dy.y)}};
        switch (profile.aniso_rule) {
            case AnisoRule::Llvmpipe: return widened<Real>(llvmpipe_anisotropy(narrow, width, height));
            case AnisoRule::SwiftShader:
                return widened<Real>(swiftshader_anisotropy(narrow, width, height, sampler.max_anisotropy));
            case AnisoRule::D3d11:
            case AnisoRule::OpenGl:
            case AnisoRule::Vulkan: return anisotropic_lod(gradients, width, height, sampler, profile);
        }
    }
    const Real w(static_cast<float>(width));
    const Real h(static_cast<float>(height));
    return LevelOfDetail<Real>(isotropic_lod(Vec2<Real>{gradients.dx.x * w, gradients.dx.y * h},
                                             Vec2<Real>{gradients.dy.x * w, gradients.dy.y * h}, profile));
}

}  // namespace gnomon
