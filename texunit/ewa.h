// Elliptical weighted averages: every texel under the pixel's ellipse instead of probes along a line.
// [Heckbert89] 3.5.8, [Greene86]; Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_sample_aniso
#pragma once

#include "texunit/filter.h"
#include "texunit/lod.h"
#include "texunit/peer_address.h"

namespace gnomon {

/// An ellipse A u^2 + B u v + C v^2 < F around a position, and the box of texels that holds it.
template <class Real>
struct Ellipse {
    Real a, b, c;                          // scaled so that F is 1
    Real center_u, center_v;               // texels, centres at whole numbers
    Int first_u, last_u, first_v, last_v;  // texels, address mode not applied
};

/// Radius of the largest ellipse that is walked, texels of the level it is walked on: four times what 16 times a minor axis of
/// two texels gives. Larger ones (a level of detail held down by bias, clamp or missing levels) shrink to it, or would take
/// seconds.
inline constexpr float kEwaRadius = 128.0f;

/// The ellipse with the derivative vectors as conjugate radii, widened by the texels' own reconstruction filter ("+ 1").
/// Vectors in texels of the level. [Heckbert89] 3.5.8
template <class Real>
Ellipse<Real> make_ellipse(const Vec2<Real>& center, const Vec2<Real>& x, const Vec2<Real>& y) {
    const Real one(1.0f);
    const Real two(2.0f);
    const Real longest = max(max(abs(x.x), abs(x.y)), max(abs(y.x), abs(y.y)));
    const Real scale = select(longest > Real(kEwaRadius), Real(kEwaRadius) / longest, one);
    const Vec2<Real> p{x.x * scale, x.y * scale};
    const Vec2<Real> q{y.x * scale, y.y * scale};
    const Real a = p.y * p.y + q.y * q.y + one;
    const Real b = -two * (p.x * p.y + q.x * q.y);
    const Real c = p.x * p.x + q.x * q.x + one;
    const Real f = a * c - b * b * Real(0.25f);

    // The box: where the ellipse is level, u = sqrt(C), and where it is upright, v = sqrt(A). A NaN coordinate is 0.
    const Real u = select(is_nan(center.x), Real(0.0f), center.x);
    const Real v = select(is_nan(center.y), Real(0.0f), center.y);
    const Real half_width = sqrt(c);
    const Real half_height = sqrt(a);
    const auto up = [](const Real& value) { return Int(0) - bounded_truncate_to_int(floor(-value)); };
    const auto down = [](const Real& value) { return bounded_truncate_to_int(floor(value)); };
    return {a / f, b / f, c / f, u, v, up(u - half_width), down(u + half_width), up(v - half_height), down(v + half_height)};
}

/// Calls `visit(u, v, r2, inside)` for the texels of all lanes' boxes; r2 is the ellipse's quadratic form, below 1 inside.
template <class Real, class Visit>
void for_ellipse(const Ellipse<Real>& e, const Visit& visit) {
    const Real one(1.0f);
    Int v = e.first_v;
    while (any(v <= e.last_v)) {
        const Real dv = Real(v) - e.center_v;
        Int u = e.first_u;
        while (any(u <= e.last_u)) {
            const Real du = Real(u) - e.center_u;
            const Real r2 = e.a * du * du + e.b * du * dv + e.c * dv * dv;
            const Mask inside = (r2 < one) & (u <= e.last_u) & (v <= e.last_v);
            if (any(inside)) visit(u, v, r2, inside);
            u = u + Int(1);
        }
        v = v + Int(1);
    }
}

/// A weighted mean of texels that keeps constants constant: the first texel plus the mean of the differences from it, limited
/// to the range of the texels; where that is not finite, the plain quotient decides.
template <std::size_t kCount, class Real>
class WeightedMean {
public:
    void add(const std::array<Real, kCount>& texel, const Real& weight, Mask inside) {
        const Mask first = inside & !started_;
        for (std::size_t c = 0; c < kCount; ++c) {
            base_[c] = select(first, texel[c], base_[c]);
            low_[c] = select(inside, select(first, texel[c], min(low_[c], texel[c])), low_[c]);
            high_[c] = select(inside, select(first, texel[c], max(high_[c], texel[c])), high_[c]);
            difference_[c] = select(inside, difference_[c] + weight * (texel[c] - base_[c]), difference_[c]);
            sum_[c] = select(inside, sum_[c] + weight * texel[c], sum_[c]);
        }
        weight_ = select(inside, weight_ + weight, weight_);
        started_ = started_ | inside;
    }
    [[nodiscard]] Real total_weight() const { return weight_; }
    [[nodiscard]] std::array<Real, kCount> mean(Reduction reduction) const {
        if (reduction == Reduction::Minimum) return low_;
        if (reduction == Reduction::Maximum) return high_;
        std::array<Real, kCount> result;
        for (std::size_t c = 0; c < kCount; ++c) {
            const Real mean = clamp(base_[c] + difference_[c] / weight_, low_[c], high_[c]);
            const Real plain = sum_[c] / weight_;
            const Mask finite = abs(plain - plain) == Real(0.0f);
            result[c] = select(finite, mean, plain);
        }
        return result;
    }

private:
    Mask started_{false};
    std::array<Real, kCount> base_{};
    std::array<Real, kCount> low_{};
    std::array<Real, kCount> high_{};
    std::array<Real, kCount> difference_{};
    std::array<Real, kCount> sum_{};
    Real weight_{0.0f};
};

/// exp(-2 r^2), the Gaussian of [Heckbert89] 3.5.8 with its usual width.
template <class Real>
Real ewa_weight(const Real& r2) {
    return exp2(r2 * Real(static_cast<typename Real::Scalar>(-2.8853900817779268)));  // -2 / ln 2
}

}  // namespace gnomon
