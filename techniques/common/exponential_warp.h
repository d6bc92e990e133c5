// Exponential warps of depth, and how far a format lets them go. [Lauritzen08] 4.2, [Salvi08]
#pragma once

#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "techniques/common/moments.h"
#include "techniques/technique.h"
#include "texunit/format.h"

namespace gnomon::techniques {

/// The largest finite number of a format of floats.
double largest_of(const FormatInfo& format);

/// The largest c for which e^c, raised to `power`, is a finite number of the format, less 1e-4 for the roundings of the shader:
/// ln(largest) / power. A second moment of e^{cx} is e^{2cx}, so `power` is 2 where moments are stored; x is at most 1. The sum
/// of the `samples` of a texel, which a resolve takes in fp32, has to be finite, too.
double exponent_limit(const FormatInfo& format, int power, int samples = 1);

/// The parameter clamp: whether exponents are held at the limit of the format.
Parameter clamp_parameter();

/// Holds an exponent at the limit of the map unless `clamp` says off; warns where a wish exceeds it. A default that exceeds it
/// is held without a word.
void settle_exponent(TechniqueSettings& settings, std::string_view name, int power);

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
///
/// The bound stays what it is when warped depths are multiplied by a constant. Squares of the largest of them, and of slopes,
/// exceed fp32, those of the smallest fall below it: a power of two, which rounds nothing, brings them nearer to 1.
template <class Real>
Real warped_upper_bound(const Moments<Real>& moments, const Warped<Real>& receiver, float min_variance) {
    // Where receiver and mean are at most 1 and the largest depth is 2^64, no second moment exceeds that either.
    const Mask large = max(abs(receiver.value), abs(moments.first)) > Real(1.0f);
    const Real scale = select(large, Real(0x1p-24f), Real(0x1p+24f));
    const Real slope = receiver.slope * scale;
    const Moments<Real> scaled{moments.first * scale, (moments.second * scale) * scale};
    return chebyshev_upper_bound(scaled, receiver.value * scale, Real(min_variance) * (slope * slope));
}

}  // namespace gnomon::techniques
