// Chebyshev's bound in double, and how far errors of the moments can move it. [Donnelly06] eq. 5
#pragma once

#include <cmath>

namespace gnomon::testing {

inline constexpr double kUnit = 0x1p-24;  // half an ULP of fp32, relative

/// sigma^2 / (sigma^2 + d^2) where d > 0, else 1.
inline double chebyshev(double sigma2, double d) {
    if (d <= 0) return 1;
    if (sigma2 <= 0) return 0;
    return sigma2 / (sigma2 + d * d);
}

struct Interval {
    double low, high;
};

/// All that p_max(t) may be when the first moment errs by e1 and the second by e2: eq. 5 grows with sigma^2 and falls with
/// t - mu. The subtraction, square and quotient of the shader add their own roundings; `unit` is theirs.
inline Interval bound_interval(double m1, double m2, double t, double e1, double e2, double unit) {
    const double sigma2 = m2 - m1 * m1;
    const double e_sigma2 = e2 + (2 * std::fabs(m1) + e1) * e1 + 2 * unit * m1 * m1 + unit * std::fabs(sigma2);
    const double d = t - m1;
    const double e_d = e1 + unit * std::fabs(d);
    return {chebyshev(sigma2 - e_sigma2, d + e_d) * (1 - 4 * unit) - 4 * unit,
            chebyshev(sigma2 + e_sigma2, d - e_d) * (1 + 4 * unit) + 4 * unit};
}

}  // namespace gnomon::testing
