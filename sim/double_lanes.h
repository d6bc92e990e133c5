// Double: an IEEE binary64 per lane, with the interface of Float. The yardstick that profiles with fp64 arithmetic run on;
// plain loops, because it is asked for accuracy and not for speed.
#pragma once

#include "sim/lanes.h"

#include <cmath>

namespace gnomon {

/// A float as a double, denormals included where the processor takes them for zeros (sim/denormals.h).
inline double widened(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude >= 0x00800000u) return static_cast<double>(x);
    const double tiny = static_cast<double>(magnitude) * 0x1p-149;
    return bits == magnitude ? tiny : -tiny;
}

struct Double {
    using Scalar = double;
    std::array<double, kLanes> v;

    Double() : v{} {}
    Double(double x) { v.fill(x); }
    Double(float x) : Double(static_cast<double>(x)) {}
    Double(int x) : Double(static_cast<double>(x)) {}
    explicit Double(Float x) {
        const auto in = x.lanes();
        for (std::size_t i = 0; i < v.size(); ++i) v[i] = widened(in[i]);
    }
    explicit Double(Int x) {
        const auto in = x.lanes();
        for (std::size_t i = 0; i < v.size(); ++i) v[i] = in[i];
    }
    static Double load(const double* p) {
        Double out;
        for (std::size_t i = 0; i < out.v.size(); ++i) out.v[i] = p[i];
        return out;
    }
    void store(double* p) const {
        for (std::size_t i = 0; i < v.size(); ++i) p[i] = v[i];
    }
    [[nodiscard]] std::array<double, kLanes> lanes() const { return v; }

    template <class Op>
    static Double map(const Op& op) {
        Double out;
        for (std::size_t i = 0; i < out.v.size(); ++i) out.v[i] = op(i);
        return out;
    }
    template <class Op>
    static Mask test(const Op& op) {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < kLanes; ++i) bits |= static_cast<std::uint32_t>(op(i)) << i;
        return Mask::from_bits(bits);
    }

    friend Double operator+(const Double& a, const Double& b) {
        return map([&](std::size_t i) { return a.v[i] + b.v[i]; });
    }
    friend Double operator-(const Double& a, const Double& b) {
        return map([&](std::size_t i) { return a.v[i] - b.v[i]; });
    }
    friend Double operator*(const Double& a, const Double& b) {
        return map([&](std::size_t i) { return a.v[i] * b.v[i]; });
    }
    friend Double operator/(const Double& a, const Double& b) {
        return map([&](std::size_t i) { return a.v[i] / b.v[i]; });
    }
    friend Double operator-(const Double& a) {
        return map([&](std::size_t i) { return -a.v[i]; });
    }
    Double& operator+=(const Double& b) { return *this = *this + b; }
    Double& operator-=(const Double& b) { return *this = *this - b; }
    Double& operator*=(const Double& b) { return *this = *this * b; }

    friend Mask operator<(const Double& a, const Double& b) {
        return test([&](std::size_t i) { return a.v[i] < b.v[i]; });
    }
    friend Mask operator<=(const Double& a, const Double& b) {
        return test([&](std::size_t i) { return a.v[i] <= b.v[i]; });
    }
    friend Mask operator==(const Double& a, const Double& b) {
        return test([&](std::size_t i) { return a.v[i] == b.v[i]; });
    }
    friend Mask operator>(const Double& a, const Double& b) { return b < a; }
    friend Mask operator>=(const Double& a, const Double& b) { return b <= a; }
    friend Mask operator!=(const Double& a, const Double& b) { return !(a == b); }
};

inline Double select(Mask m, const Double& yes, const Double& no) {
    const std::uint32_t bits = m.bits();
    return Double::map([&](std::size_t i) { return (bits >> i & 1u) != 0 ? yes.v[i] : no.v[i]; });
}
inline Mask is_nan(const Double& x) { return x != x; }
inline Double min(const Double& a, const Double& b) { return select((a < b) | is_nan(b), a, b); }
inline Double max(const Double& a, const Double& b) { return select((a > b) | is_nan(b), a, b); }
inline Double clamp(const Double& x, const Double& low, const Double& high) { return min(max(x, low), high); }
inline Double clamp_to_numbers(const Double& x, const Double& low, const Double& high) { return clamp(x, low, high); }
inline Double saturate(const Double& x) { return clamp(x, Double(0.0), Double(1.0)); }
inline Double abs(const Double& x) {
    return Double::map([&](std::size_t i) { return std::fabs(x.v[i]); });
}
inline Double fused_multiply_add(const Double& a, const Double& b, const Double& c) {
    return Double::map([&](std::size_t i) { return std::fma(a.v[i], b.v[i], c.v[i]); });
}
inline Double sqrt(const Double& x) {
    return Double::map([&](std::size_t i) { return std::sqrt(x.v[i]); });
}
inline Double floor(const Double& x) {
    return Double::map([&](std::size_t i) { return std::floor(x.v[i]); });
}

/// One rounding to nearest even.
inline Float to_float(const Double& x) {
    std::array<float, kLanes> out;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(x.v[i]);
    return Float::load(out.data());
}
inline Float to_float(Float x) { return x; }

/// To a float that any narrower format rounds as it would have rounded `x` itself: toward zero, with the last bit set where
/// something was lost ("round to odd"). Double to half through binary32 would otherwise round twice.
inline Float to_float_for_narrowing(const Double& x) {
    std::array<float, kLanes> out;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float nearest = static_cast<float>(x.v[i]);
        const double back = static_cast<double>(nearest);
        auto bits = std::bit_cast<std::uint32_t>(nearest);
        if (back == back && back != x.v[i]) {
            if (std::fabs(back) > std::fabs(x.v[i])) --bits;  // away from zero: one step back
            bits |= 1u;
        }
        out[i] = std::bit_cast<float>(bits);
    }
    return Float::load(out.data());
}
inline Float to_float_for_narrowing(Float x) { return x; }

/// To integer toward zero: NaN gives 0, out of range saturates.
inline Int truncate_to_int(const Double& x) {
    std::array<std::int32_t, kLanes> out;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double limited = x.v[i] < -2147483647.0 ? -2147483647.0 : x.v[i] > 2147483647.0 ? 2147483647.0 : x.v[i];
        out[i] = limited == limited ? static_cast<std::int32_t>(limited) : 0;
    }
    return Int::load(out.data());
}
inline Int bounded_truncate_to_int(const Double& x) { return truncate_to_int(x); }

/// To integer, nearest even; same limits.
inline Int bounded_round_to_int(const Double& x) {
    return truncate_to_int(Double::map([&](std::size_t i) { return std::nearbyint(x.v[i]); }));
}

inline double lane(const Double& x, int i) { return x.v[static_cast<std::size_t>(i)]; }

}  // namespace gnomon
