// Four power moments of a depth distribution: how 16 bits store them, and the bounds they give. [Peters15]:
// sections 3 and 4 and the shaders that come with it
#pragma once

#include "sim/lanes.h"
#include "sim/math.h"
#include "sim/vec.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::techniques {

/// Of depths in [0, 1].
template <class Real>
struct PowerMoments {
    Real first;   // b1 = E(x). [Peters15]
    Real second;  // b2 = E(x^2)
    Real third;   // b3 = E(x^3)
    Real fourth;  // b4 = E(x^4)
};

/// Moments of a single depth. [Peters15]
template <class Real>
PowerMoments<Real> power_moments_of_depth(const Real& depth) {
    const Real squared = depth * depth;
    return {depth, squared, squared * depth, squared * squared};
}

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// By Gauss and Jordan, the largest pivot first.
constexpr Matrix4 inverse(Matrix4 m) {
    Matrix4 out{};
    for (std::size_t i = 0; i < 4; ++i) out[i][i] = 1.0;
    const auto magnitude = [](double x) { return x < 0.0 ? -x : x; };
    for (std::size_t k = 0; k < 4; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < 4; ++i)
            if (magnitude(m[i][k]) > magnitude(m[pivot][k])) pivot = i;
        std::swap(m[k], m[pivot]);
        std::swap(out[k], out[pivot]);
        const double factor = 1.0 / m[k][k];
        for (std::size_t j = 0; j < 4; ++j) {
            m[k][j] *= factor;
            out[k][j] *= factor;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            if (i == k) continue;
            const double share = m[i][k];
            for (std::size_t j = 0; j < 4; ++j) {
                m[i][j] -= share * m[k][j];
                out[i][j] -= share * out[k][j];
            }
        }
    }
    return out;
}

/// The affine transform that makes the moments of depths fill [0, 1]^4 as far as can be, so that fixed point loses the least of
/// them: row vector (b1, b2, b3, b4) times the matrix, plus the offset. [Peters15] (optimised quantisation), for depths in [0,
/// 1]
inline constexpr Matrix4 kQuantisation{{{-2.07224649, 13.7948857237, 0.105877704, 9.7924062118},
                                        {32.23703778, -59.4683975703, -1.9077466311, -33.7652110555},
                                        {-68.571074599, 82.0359750338, 9.3496555107, 47.9456096605},
                                        {39.3703274134, -35.364903257, -6.6543490743, -23.9728048165}}};
inline constexpr double kQuantisationOffset = 0.035955884801;  // of the first component
inline constexpr Matrix4 kDequantisation = inverse(kQuantisation);

/// v times m, summed from the first row on; v's numbers are the rows' weights.
template <class Real>
Vec4<Real> row_times(const Vec4<Real>& v, const Matrix4& m) {
    const auto constant = [&](std::size_t i, std::size_t j) { return Real(static_cast<typename Real::Scalar>(m[i][j])); };
    const auto column = [&](std::size_t j) {
        return ((v.x * constant(0, j) + v.y * constant(1, j)) + v.z * constant(2, j)) + v.w * constant(3, j);
    };
    return {column(0), column(1), column(2), column(3)};
}

/// What is stored of the moments, and the moments of what was stored (and filtered: both are affine). [Peters15]
template <class Real>
Vec4<Real> quantised(const PowerMoments<Real>& b) {
    const Vec4<Real> sums = row_times(Vec4<Real>{b.first, b.second, b.third, b.fourth}, kQuantisation);
    return {sums.x + Real(static_cast<typename Real::Scalar>(kQuantisationOffset)), sums.y, sums.z, sums.w};
}
template <class Real>
PowerMoments<Real> dequantised(const Vec4<Real>& stored) {
    const Real offset(static_cast<typename Real::Scalar>(kQuantisationOffset));
    const Vec4<Real> b = row_times(Vec4<Real>{stored.x - offset, stored.y, stored.z, stored.w}, kDequantisation);
    return {b.x, b.y, b.z, b.w};
}

/// b' = (1 - alpha) b + alpha (1/2, 1/2, 1/2, 1/2): a share of depths that are 0 and 1 by halves is mixed in, so that rounding
/// cannot push the moments to where no distribution has them. [Peters15] (moment bias)
template <class Real>
PowerMoments<Real> biased(const PowerMoments<Real>& b, const Real& alpha) {
    const auto mixed = [&](const Real& moment) { return moment + alpha * (Real(0.5f) - moment); };
    return {mixed(b.first), mixed(b.second), mixed(b.third), mixed(b.fourth)};
}

/// B = L D L^T of the Hankel matrix B = (1 b1 b2; b1 b2 b3; b2 b3 b4), with D = diag(1, d22, d33) and L unit lower triangular:
/// l21 = b1, l31 = b2. [Peters15] 4.1
template <class Real>
struct HankelFactors {
    Real d22;  // the variance
    Real d33;
    Real l32;
};

/// DEVIATION([Peters15], tests/techniques/peters15_msm.cpp): a diagonal that comes out below an ULP of 1 is that ULP, as the
/// rounding of moments hides no less in it. One that rounds to 0 or less would put a shadow's edge on the depth of the
/// receiver.
template <class Real>
HankelFactors<Real> hankel_factors(const PowerMoments<Real>& b) {
    const Real least(std::numeric_limits<typename Real::Scalar>::epsilon());
    const Real d22 = max(b.second - b.first * b.first, least);
    const Real l32_d22 = b.third - b.first * b.second;
    const Real l32 = l32_d22 / d22;
    const Real d33 = max((b.fourth - b.second * b.second) - l32_d22 * l32, least);
    return {d22, d33, l32};
}

/// d33 c, where B c = (1, t, t^2): the factor does not move the roots of c1 + c2 x + c3 x^2, and it keeps all numbers small.
/// [Peters15] 4.1
template <class Real>
Vec3<Real> solve_hankel(const PowerMoments<Real>& b, const HankelFactors<Real>& hankel, const Real& t) {
    // L y = (1, t, t^2).
    const Real y2 = t - b.first;
    const Real y3 = (t * t - b.second) - hankel.l32 * y2;
    // L^T c = D^-1 y.
    const Real c2 = y2 * (hankel.d33 / hankel.d22) - hankel.l32 * y3;
    return {(hankel.d33 - b.first * c2) - b.second * y3, c2, y3};
}

template <class Real>
struct Roots {
    Real lower, upper;
};

/// Of c1 + c2 x + c3 x^2; a negative discriminant counts as 0, and a root at infinity comes back as 2^60 or -2^60.
/// DEVIATION([Peters15], tests/techniques/peters15_msm.cpp): by the sum that does not cancel, [Higham02] 1.8. A receiver at a
/// depth of the map makes c3 nearly 0 and one root huge, and the usual formula, -p/2 +- sqrt(p^2/4 - q), then loses the other,
/// which counts.
template <class Real>
Roots<Real> quadratic_roots(const Vec3<Real>& c) {
    const Real zero(0.0f);
    const Real far(0x1p60f);
    const Real root = sqrt(max(c.y * c.y - Real(4.0f) * (c.z * c.x), zero));
    const Real q = Real(-0.5f) * (c.y + select(c.y < zero, zero - root, root));
    const Real a = q / c.z;
    const Real b = c.x / q;
    return {clamp(min(a, b), zero - far, far), clamp(max(a, b), zero - far, far)};
}

/// Share of the depth p in a distribution over the three depths p, q and r: E((x - q) (x - r)) / ((p - q) (p - r)).
/// [Peters15] 4.1
template <class Real>
Real weight_of_three(const PowerMoments<Real>& b, const Real& p, const Real& q, const Real& r) {
    return (q * r - b.first * (q + r) + b.second) / ((p - q) * (p - r));
}

/// Where a distribution over three depths, t among them, has the other two. [Peters15] 4.1
template <class Real>
Roots<Real> depths_beside(const PowerMoments<Real>& b, const Real& t) {
    return quadratic_roots(solve_hankel(b, hankel_factors(b), t));
}

/// 1 less the share of depths below t, the others being z.lower and z.upper.
template <class Real>
Real visibility_of_three(const PowerMoments<Real>& b, const Real& t, const Roots<Real>& z) {
    const Real one(1.0f);
    const Real between = one - weight_of_three(b, z.lower, t, z.upper);
    const Real beyond = weight_of_three(b, t, z.lower, z.upper);
    return select(t <= z.lower, one, saturate(select(t <= z.upper, between, beyond)));
}

/// Sharp upper bound on P(x >= t) over all distributions with these moments: 1 less the greatest lower bound on the shadow
/// intensity P(x < t) that [Peters15] 4.1 gives ("Hamburger 4MSM"). Of the distributions, the one over t and two other
/// depths has the fewest depths below t (Markov and Stieltjes). Never above [Donnelly06] eq. 5, which uses b1 and b2 alone.
template <class Real>
Real hamburger_upper_bound(const PowerMoments<Real>& b, const Real& t) {
    return visibility_of_three(b, t, depths_beside(b, t));
}

/// The third depth z of a distribution over 0, t, 1 and it: E(x (1 - x) (x - t) (x - z)) = 0. Where 0, t and 1 are enough, any
/// does: 1. [Peters15] (Hausdorff 4MSM)
template <class Real>
Real depth_within(const PowerMoments<Real>& b, const Real& t) {
    const Real below = (b.second - b.third) - t * (b.first - b.second);
    const Real z = ((b.third - b.fourth) - t * (b.second - b.third)) / below;
    return select(below == Real(0.0f), Real(1.0f), saturate(z));
}

/// 1 less the share of depths below t in a distribution over 0, t, z and 1, for t in (0, 1]: 1 - E(p(x)) with the cubic p that
/// is 1 at the depths below t and 0 at the others, by Newton's divided differences. [Peters15] (Hausdorff 4MSM)
template <class Real>
Real visibility_of_four(const PowerMoments<Real>& b, const Real& t, const Real& z) {
    const Real one(1.0f);
    const Mask below = z < t;
    const Real inner = b.first - b.second;                  // E(x (1 - x))
    const Real inner_z = (b.second - b.third) - z * inner;  // E(x (1 - x) (x - z))
    const Real slope = one / select(below, z - one, z);     // p = (1 - x) (1 - slope x + bend x (x - z))
    const Real bend = select(below, slope * ((t - z) + one) / (t - z), slope) / t;
    return saturate((b.first + inner * slope) - inner_z * bend);
}

/// Sharp upper bound on P(x >= t) over all distributions on [0, 1] with these moments ("Hausdorff 4MSM"): at most the
/// Hamburger bound, and equal to it where its depths lie in [0, 1]. [Peters15] (Hausdorff 4MSM)
template <class Real>
Real hausdorff_upper_bound(const PowerMoments<Real>& b, const Real& t) {
    const Real zero(0.0f);
    const Real one(1.0f);
    const Real inside = min(t, one);
    const Roots<Real> z = depths_beside(b, inside);
    const Real four = visibility_of_four(b, inside, depth_within(b, inside));
    const Real bound = select((z.lower >= zero) & (z.upper <= one), visibility_of_three(b, inside, z), four);
    return select(t <= zero, one, bound);
}

}  // namespace gnomon::techniques
