// Intervals that hold every result an arithmetic with rounding may have.
#pragma once

#include "tests/oracle/texel.h"

#include <algorithm>
#include <cmath>

namespace oracle {

struct Interval {
    double low = 0;
    double high = 0;

    [[nodiscard]] bool is_zero() const { return low == 0 && high == 0; }
    [[nodiscard]] bool has_zero() const { return low <= 0 && high >= 0; }
    [[nodiscard]] double magnitude() const { return std::fmax(std::fabs(low), std::fabs(high)); }
};

constexpr Interval point(double x) { return {x, x}; }
inline Interval max(const Interval& a, const Interval& b) { return {std::fmax(a.low, b.low), std::fmax(a.high, b.high)}; }
inline Interval min(const Interval& a, const Interval& b) { return {std::fmin(a.low, b.low), std::fmin(a.high, b.high)}; }
inline Interval hull(const Interval& a, const Interval& b) { return {std::fmin(a.low, b.low), std::fmax(a.high, b.high)}; }
inline Interval absolute(const Interval& a) {
    if (a.low >= 0) return a;
    if (a.high <= 0) return {-a.high, -a.low};
    return {0.0, a.magnitude()};
}

/// Operations with one rounding each. Results that the arithmetic has exactly stay points; everything else is widened by a
/// rounding and by what flushing or denormals lose, and reaches infinity where it passes the largest number.
class IntervalMath {
public:
    explicit IntervalMath(const Arithmetic& arithmetic) : arithmetic_(arithmetic) {}

    [[nodiscard]] Interval add(const Interval& a, const Interval& b) const { return widen({a.low + b.low, a.high + b.high}); }
    [[nodiscard]] Interval sub(const Interval& a, const Interval& b) const { return widen({a.low - b.high, a.high - b.low}); }
    [[nodiscard]] Interval mul(const Interval& a, const Interval& b) const {
        if (a.is_zero() || b.is_zero()) return {};
        return widen(corners(a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high));
    }
    [[nodiscard]] Interval square(const Interval& a) const {
        const Interval m = absolute(a);
        return m.is_zero() ? m : not_negative(widen({m.low * m.low, m.high * m.high}));
    }
    [[nodiscard]] Interval div(const Interval& a, const Interval& b) const {
        if (b.is_zero() && a.low > 0) return point(HUGE_VAL);
        if (b.has_zero() && a.low >= 0 && b.low >= 0)
            return {b.high > 0 ? always_widen(point(a.low / b.high)).low : 0.0, HUGE_VAL};
        if (b.has_zero()) return {-HUGE_VAL, HUGE_VAL};
        const Interval q = corners(a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high);
        return is_point(a) && is_point(b) && q.low * b.low != a.low ? always_widen(q) : widen(q);
    }
    [[nodiscard]] Interval sqrt(const Interval& a) const {
        const Interval r{std::sqrt(std::fmax(a.low, 0.0)), std::sqrt(std::fmax(a.high, 0.0))};
        return not_negative(is_point(a) && r.low * r.low != a.low ? always_widen(r) : widen(r));
    }
    /// a * b - c * d
    [[nodiscard]] Interval det(const Interval& a, const Interval& b, const Interval& c, const Interval& d) const {
        return sub(mul(a, b), mul(c, d));
    }
    [[nodiscard]] Interval sum_of_squares(const Interval& a, const Interval& b) const {
        return not_negative(add(square(a), square(b)));
    }
    /// log2 within 2 ULP of the larger of 1 and the result in binary32; in double within 2^-47 absolute and 2 ULP.
    [[nodiscard]] Interval log2(const Interval& a) const {
        const auto at = [](double x) { return x > 0 ? std::log2(x) : -HUGE_VAL; };
        const auto error = [&](double log) {
            if (std::isinf(log)) return 0.0;
            const double ulp = std::ldexp(arithmetic_.unit() * 2, std::ilogb(std::fmax(1.0, std::fabs(log))));
            return 2 * ulp + (arithmetic_.fp32 ? 0.0 : 0x1p-47);
        };
        const double low = at(a.low);
        const double high = at(a.high);
        return {low - error(low), high + error(high)};
    }
    [[nodiscard]] bool may_overflow(const Interval& a) const { return a.magnitude() > arithmetic_.largest(); }
    [[nodiscard]] bool may_underflow(const Interval& a) const {
        return !a.is_zero() && std::fmin(std::fabs(a.low), std::fabs(a.high)) < 0x1p20 * arithmetic_.tiny();
    }

private:
    static bool is_point(const Interval& a) { return a.low == a.high; }
    static Interval not_negative(const Interval& a) { return {std::fmax(a.low, 0.0), a.high}; }
    static Interval corners(double a, double b, double c, double d) {
        return {std::fmin(std::fmin(a, b), std::fmin(c, d)), std::fmax(std::fmax(a, b), std::fmax(c, d))};
    }
    [[nodiscard]] Interval widen(const Interval& a) const {
        const bool exact = arithmetic_.fp32 && is_point(a) && arithmetic_.round(a.low) == a.low;
        return exact ? a : always_widen(a);
    }
    [[nodiscard]] Interval always_widen(const Interval& a) const {
        Interval r{a.low - std::fabs(a.low) * arithmetic_.unit() - arithmetic_.tiny(),
                   a.high + std::fabs(a.high) * arithmetic_.unit() + arithmetic_.tiny()};
        if (std::isnan(r.low) || r.low < -arithmetic_.largest()) r.low = -HUGE_VAL;
        if (std::isnan(r.high) || r.high > arithmetic_.largest()) r.high = HUGE_VAL;
        return r;
    }

    Arithmetic arithmetic_;
};

}  // namespace oracle
