// What a pixel covers of a map, from the derivatives of its quad, and the rectangle of texels that holds it.
// D3D11.3 7.18.11 (footprint, limit of anisotropy)
#pragma once

#include "sim/lanes.h"
#include "sim/math.h"
#include "sim/vec.h"
#include "techniques/common/receiver.h"

#include <glm/vec2.hpp>

namespace gnomon::techniques {

/// The parallelogram centre + a dx + b dy, |a|, |b| <= 1/2.
template <class Real>
struct PixelFootprint {
    Vec2<Real> dx;  // normalised coordinates or texels
    Vec2<Real> dy;
};

/// In the coordinates of `uv`. Takes derivatives: not behind a branch.
template <class F, class Real = typename F::Real>
PixelFootprint<Real> pixel_footprint(const F& f, const Vec2<Real>& uv) {
    return {{f.ddx(uv.x), f.ddx(uv.y)}, {f.ddy(uv.x), f.ddy(uv.y)}};
}
/// Of a position in a map: the derivatives that it brings along, or the quad's.
template <class F, class Real = typename F::Real>
PixelFootprint<Real> pixel_footprint(const F& f, const MapPosition<Real>& at) {
    return pixel_footprint(f, at.uv);
}
template <class F, class Real = typename F::Real>
PixelFootprint<Real> pixel_footprint(const F& f, const GradientPosition<Real>& at) {
    if (at.has_gradients) return {at.gradients.dx, at.gradients.dy};
    return pixel_footprint(f, at.uv);
}

/// Normalised coordinates to those of a map of so many texels.
template <class Real>
Vec2<Real> to_texels(const Vec2<Real>& uv, const glm::ivec2& size) {
    return {uv.x * Real(static_cast<float>(size.x)), uv.y * Real(static_cast<float>(size.y))};
}
template <class Real>
PixelFootprint<Real> to_texels(const PixelFootprint<Real>& footprint, const glm::ivec2& size) {
    return {to_texels(footprint.dx, size), to_texels(footprint.dy, size)};
}

/// The footprint (texels) with its shorter vector lengthened to 1 / `limit` (>= 1) of the longer one where it is less, as a
/// texture unit lengthens the minor axis past its limit of anisotropy; of no length, it becomes perpendicular. The axes are the
/// vectors themselves: EXT_texture_filter_anisotropic (Px, Py), Vulkan 1.3 (Scale Factor Operation). Holds the footprint.
template <class Real>
PixelFootprint<Real> with_anisotropy_limit(const PixelFootprint<Real>& footprint, float limit) {
    const Real x_length = sqrt(dot(footprint.dx, footprint.dx));
    const Real y_length = sqrt(dot(footprint.dy, footprint.dy));
    const auto lengthened = [&](const Vec2<Real>& shorter, const Real& length, const Vec2<Real>& longer, const Real& longest) {
        const Real share(1.0f / limit);
        const Real least = longest * share;
        const Real factor = least / length;
        const Mask widens = length < least;
        const Mask has_length = length > Real(0.0f);
        const Vec2<Real> longer_now{select(has_length, shorter.x * factor, (Real(0.0f) - longer.y) * share),
                                    select(has_length, shorter.y * factor, longer.x * share)};
        return Vec2<Real>{select(widens, longer_now.x, shorter.x), select(widens, longer_now.y, shorter.y)};
    };
    return {lengthened(footprint.dx, x_length, footprint.dy, y_length),
            lengthened(footprint.dy, y_length, footprint.dx, x_length)};
}

/// Sides (texels) no shorter than `least`; one without length lies along an axis.
template <class Real>
PixelFootprint<Real> with_least_width(const PixelFootprint<Real>& footprint, const Real& least) {
    const Real zero(0.0f);
    const auto widened = [&](const Vec2<Real>& side, const Vec2<Real>& axis) {
        const Real length = sqrt(dot(side, side));
        const Real scale = least / length;
        const Mask is_short = length < least;
        const Mask has_length = length > zero;
        return Vec2<Real>{select(is_short, select(has_length, side.x * scale, axis.x), side.x),
                          select(is_short, select(has_length, side.y * scale, axis.y), side.y)};
    };
    return {widened(footprint.dx, {least, zero}), widened(footprint.dy, {zero, least})};
}

/// Texel (i, j) covers [i, i + 1] x [j, j + 1].
template <class Real>
struct TexelRectangle {
    Vec2<Real> low;
    Vec2<Real> high;
};

template <class Real>
Real area(const TexelRectangle<Real>& rectangle) {
    return (rectangle.high.x - rectangle.low.x) * (rectangle.high.y - rectangle.low.y);
}

/// Sides of rectangles, texels.
struct SideLimits {
    float least = 1.0f;
    float most = 16384.0f;  // >= least
};

/// The smallest rectangle with sides along the axes and in the limits that holds the footprint (texels) around `centre`; of
/// what is not a number, the least.
template <class Real>
TexelRectangle<Real> bounding_rectangle(const PixelFootprint<Real>& footprint, const Vec2<Real>& centre,
                                        const SideLimits& limits) {
    const auto half_side = [&](const Real& x, const Real& y) {
        return Real(0.5f) * clamp_to_numbers(abs(x) + abs(y), Real(limits.least), Real(limits.most));
    };
    const Vec2<Real> half{half_side(footprint.dx.x, footprint.dy.x), half_side(footprint.dx.y, footprint.dy.y)};
    return {{centre.x - half.x, centre.y - half.y}, {centre.x + half.x, centre.y + half.y}};
}

/// What lies inside a map, and at least half a texel of it per axis, which a rectangle has that is a texel wide and whose
/// centre is in the map. Always finite.
template <class Real>
TexelRectangle<Real> clamped_to(const TexelRectangle<Real>& rectangle, const glm::ivec2& size) {
    const Real half(0.5f);
    const Vec2<Real> end{Real(static_cast<float>(size.x)), Real(static_cast<float>(size.y))};
    const Vec2<Real> low{clamp_to_numbers(rectangle.low.x, Real(0.0f), end.x - half),
                         clamp_to_numbers(rectangle.low.y, Real(0.0f), end.y - half)};
    return {low,
            {clamp_to_numbers(rectangle.high.x, low.x + half, end.x), clamp_to_numbers(rectangle.high.y, low.y + half, end.y)}};
}

}  // namespace gnomon::techniques
