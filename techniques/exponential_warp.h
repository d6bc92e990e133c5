// Exponential warps of depth, and how far a format lets them go. [Lauritzen08] 4.2, [Salvi08]
#pragma once

#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "techniques/moments.h"
#include "techniques/parameters.h"
#include "texunit/format.h"

namespace gnomon::techniques {

/// The largest finite number of a format of floats.
double largest_of(const FormatInfo& format);

/// The largest c for which e^c, raised to `power`, is a finite number of the format, less 1e-4 for the roundings of the shader:
/// ln(largest) / power. A second moment of e^{cx} is e^{2cx}, so `power` is 2 where moments are stored; x is at most 1.
double exponent_limit(const FormatInfo& format, int power);

/// The parameter clamp: whether exponents are held at the limit of the format.
Parameter clamp_parameter();

/// The exponent that a user wants, held at the limit of the format unless `clamp` says off; warns where a wish exceeds it. A
/// default that exceeds it is held without a word.
float chosen_exponent(const ParameterValues& parameters, std::string_view name, const FormatInfo& format, int power);

/// What a warp makes of a depth, and its slope there.
template <class Real>
struct Warped {
    Real value;
    Real slope;  // of the value over depth, positive
};

/// sign e^{sign c x} with x = 2 depth - 1: the positive or the negative warp of [Lauritzen08] 4.2. DEVIATION([Lauritzen08]
/// 4.2): x is in [-1, 1], not in [0, 1]; a factor e^{-c} does not change Chebyshev's bound, and the exponents reach as far down
/// as up, so c counts twice.
struct ExponentialWarp {
    float exponent2 = 0.0f;  // c / ln(2)
    float sign = 1.0f;

    static constexpr auto fields() {
        using E = ExponentialWarp;
        return std::tuple{Field{"exponent2", &E::exponent2}, Field{"sign", &E::sign}};
    }

    template <class Real>
    [[nodiscard]] Warped<Real> operator()(const Real& depth) const {
        const Real x = depth * Real(2.0f) - Real(1.0f);
        const Real magnitude = exp2(x * Real(sign * exponent2));
        constexpr float kTwoLn2 = static_cast<float>(2.0 * scalar::kLn2);
        return {magnitude * Real(sign), magnitude * Real(exponent2 * kTwoLn2)};
    }
};

ExponentialWarp positive_warp(float c);
ExponentialWarp negative_warp(float c);

/// Chebyshev's bound after a warp. The least variance of depth becomes that of warped depths by the slope at the receiver.
template <class Real>
Real warped_upper_bound(const Moments<Real>& moments, const Warped<Real>& receiver, float min_variance) {
    const Real floor = Real(min_variance) * (receiver.slope * receiver.slope);
    return chebyshev_upper_bound(moments, receiver.value, floor);
}

}  // namespace gnomon::techniques
