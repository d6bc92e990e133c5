// Two moments of a depth distribution and the bound they give. [Donnelly06] section 3, [Lauritzen08] 3.1
#pragma once

#include "sim/lanes.h"
#include "sim/math.h"

namespace gnomon::techniques {

template <class Real>
struct Moments {
    Real first;   // M1 = E(x). [Donnelly06] eq. 1, [Lauritzen08] eq. 3.1
    Real second;  // M2 = E(x^2). [Donnelly06] eq. 2, [Lauritzen08] eq. 3.1
};

/// Moments of a single depth.
template <class Real>
Moments<Real> moments_of_depth(const Real& depth) {
    return {depth, depth * depth};
}

/// mu = M1. [Donnelly06] eq. 3, [Lauritzen08] eq. 3.2
template <class Real>
Real mean(const Moments<Real>& m) {
    return m.first;
}

/// sigma^2 = M2 - M1^2. [Donnelly06] eq. 4, [Lauritzen08] eq. 3.2. Cancels when it is small against M1^2 ([Donnelly06] 5.3);
/// may come out negative.
template <class Real>
Real variance(const Moments<Real>& m) {
    return m.second - m.first * m.first;
}

/// Upper bound on P(x >= t): sigma^2 / (sigma^2 + (t - mu)^2) for t > mu, otherwise 1. [Donnelly06] eq. 5, section 4 step 4;
/// [Lauritzen08] eq. 3.3. `min_variance` > 0 keeps rounding from turning lit surfaces dark; 0 leaves the equation as it stands
/// (and 0/0 as no light).
template <class Real>
Real chebyshev_upper_bound(const Moments<Real>& m, const Real& t, const Real& min_variance) {
    const Real sigma2 = max(variance(m), min_variance);
    const Real d = t - mean(m);
    const Real bound = sigma2 / max(sigma2 + d * d, Real(0x1p-126f));
    return select(t <= mean(m), Real(1.0f), bound);
}

}  // namespace gnomon::techniques
