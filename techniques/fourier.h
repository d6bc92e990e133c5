// The shadow test as a Fourier series, a sum of products of functions of one depth each. [Annen07]
#pragma once

#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "sim/scalar_math.h"
#include "sim/vec.h"

#include <array>

namespace gnomon::techniques {

inline constexpr int kMaxFourierTerms = 16;

/// c_k = pi (2k - 1), k >= 1: the frequencies of a square wave of period 2. Radians per unit of depth. [Annen07]
constexpr double fourier_frequency(int k) { return scalar::kPi * (2.0 * k - 1.0); }

/// What the light pass makes of an occluder's depth z, and the camera pass of a receiver's d: sin(c_k .), cos(c_k .). Both take
/// c_k in fp32.
template <class Real>
SinCosLanes<Real> fourier_pair(int k, const Real& depth) {
    return sin_cos(Real(static_cast<float>(fourier_frequency(k))) * depth);
}

/// [-1, 1] as [0, 1], which formats without a sign hold, and back. Affine: filters do not notice.
template <class Real>
SinCosLanes<Real> store_pair(const SinCosLanes<Real>& pair) {
    const Real half(0.5f);
    return {pair.sin * half + half, pair.cos * half + half};
}
template <class Real>
SinCosLanes<Real> restore_pair(const Real& stored_sin, const Real& stored_cos) {
    const Real two(2.0f);
    const Real one(1.0f);
    return {stored_sin * two - one, stored_cos * two - one};
}

/// The pairs k and k + 1 of a depth as one texel.
template <class Real>
Vec4<Real> store_two_pairs(int k, const Real& depth) {
    const SinCosLanes<Real> first = store_pair(fourier_pair(k, depth));
    const SinCosLanes<Real> second = store_pair(fourier_pair(k + 1, depth));
    return {first.sin, first.cos, second.sin, second.cos};
}

/// The first M terms of the series; part of receivers' constants.
///
///   lit(d, z) = 1/2 + sum_{k=1..M} w_k [cos(c_k d) sin(c_k z) - sin(c_k d) cos(c_k z)] = 1/2 + sum_{k=1..M} w_k sin(c_k (z -
///   d))
///
/// nears 1 where z > d, 0 where z < d, and is 1/2 where z = d, for |z - d| < 1: the period is 2. Linear in what the map holds
/// of z, so that the mean of the map over a filter gives the mean of lit. [Annen07]
struct FourierSeries {
    int terms = 1;                                  // M, up to kMaxFourierTerms
    std::array<float, kMaxFourierTerms> weights{};  // w_k = 2 / c_k exp(-attenuation (k / M)^2)

    static constexpr auto fields() {
        using S = FourierSeries;
        return std::tuple{Field{"terms", &S::terms}, Field{"weights", &S::weights}};
    }

    /// The k-th term of a receiver and the (filtered) pair of the map.
    template <class Real>
    [[nodiscard]] Real term(int k, const SinCosLanes<Real>& receiver, const SinCosLanes<Real>& occluder) const {
        return Real(weights[static_cast<std::size_t>(k - 1)]) * (receiver.cos * occluder.sin - receiver.sin * occluder.cos);
    }

    /// lit where z - d is `distance`, on the host.
    [[nodiscard]] double at(double distance) const {
        double sum = 0.5;
        for (int k = 1; k <= terms; ++k)
            sum += static_cast<double>(weights[static_cast<std::size_t>(k - 1)]) * scalar::sin(fourier_frequency(k) * distance);
        return sum;
    }
};

/// `attenuation` >= 0 fades high frequencies, and with them the ringing of the cut series: 0 leaves the series as it is, which
/// overshoots by 8.95 % of the step (Gibbs). [Annen07]
inline FourierSeries fourier_series(int terms, double attenuation) {
    FourierSeries series{.terms = terms};
    for (int k = 1; k <= terms; ++k) {
        const double share = 1.0 * k / terms;
        series.weights[static_cast<std::size_t>(k - 1)] =
            static_cast<float>(2.0 / fourier_frequency(k) * scalar::exp(-attenuation * share * share));
    }
    return series;
}

}  // namespace gnomon::techniques
