// Elementary functions in double for the host side: scenes, cameras, filter kernels.
//
// libm differs between versions, and between processors within one version (it picks FMA variants at run time), and compilers
// fold calls with constant arguments through yet another library. Everything that ends up in a picture uses these instead:
// only + - * /, so the same bits everywhere. Series are Taylor series cut where the next term is below 2^-60 of the result.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace gnomon::scalar {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kLn2 = 0.69314718055994530942;
inline constexpr double kLog2E = 1.44269504088896340736;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

/// sin and cos of one angle.
struct SinCos {
    double sin;
    double cos;
};

/// sin(x) and cos(x) for |x| <= 2^20 rad, error below 1e-15 absolute for |x| <= 100.
inline SinCos sincos(double x) {
    // Reduce to r in [-pi/4, pi/4] with pi/2 split in two, so that the product with the quadrant loses nothing.
    constexpr double kHalfPiHigh = 0x1.921fb544p+0;       // 33 leading bits of pi/2
    constexpr double kHalfPiLow = 0x1.0b4611a626331p-34;  // the rest
    const double quadrant = std::floor(x * (2.0 / kPi) + 0.5);
    const double r = (x - quadrant * kHalfPiHigh) - quadrant * kHalfPiLow;

    // Sum both series from the smallest term up.
    const double r2 = r * r;
    double sin_sum = 0;
    double cos_sum = 0;
    for (int k = 9; k >= 1; --k) {
        sin_sum = -(1.0 + sin_sum) * r2 / ((2.0 * k) * (2.0 * k + 1.0));
        cos_sum = -(1.0 + cos_sum) * r2 / ((2.0 * k - 1.0) * (2.0 * k));
    }
    const double s = r + r * sin_sum;
    const double c = 1.0 + cos_sum;

    // Turn back by whole quadrants.
    switch (static_cast<std::int64_t>(quadrant) & 3) {
        case 0: return {s, c};
        case 1: return {c, -s};
        case 2: return {-s, -c};
        default: return {-c, s};
    }
}

inline double sin(double x) { return sincos(x).sin; }
inline double cos(double x) { return sincos(x).cos; }
inline double tan(double x) {
    const auto [s, c] = sincos(x);
    return s / c;
}

/// atan(x), absolute error below 2^-49.
inline double atan(double x) {
    // atan(x) = 2 atan(x / (1 + sqrt(1 + x^2))), three times, brings |x| below 0.2; then the series.
    double t = x;
    for (int i = 0; i < 3; ++i) t = t / (1.0 + std::sqrt(1.0 + t * t));
    const double t2 = t * t;
    double sum = 0;
    for (int k = 14; k >= 1; --k) sum = -t2 * (1.0 / (2.0 * k + 1.0) + sum);
    return 8.0 * (t + t * sum);
}

/// 2^x for x in [-1000, 1000], relative error below 2^-50.
inline double exp2(double x) {
    const double n = std::floor(x + 0.5);
    const double t = (x - n) * kLn2;  // [-ln2/2, ln2/2]
    double sum = 0;
    for (int k = 15; k >= 1; --k) sum = (1.0 + sum) * t / k;
    const auto exponent = static_cast<std::uint64_t>(static_cast<std::int64_t>(n) + 1023);
    return (1.0 + sum) * std::bit_cast<double>(exponent << 52);
}

inline double exp(double x) { return exp2(x * kLog2E); }

/// log2(x) for normal positive x, absolute error below 2^-48.
inline double log2(double x) {
    // x = 2^n m with m in [sqrt(1/2), sqrt(2)); log m = 2 atanh((m-1)/(m+1)).
    auto bits = std::bit_cast<std::uint64_t>(x);
    auto n = static_cast<std::int64_t>(bits >> 52) - 1023;
    double m = std::bit_cast<double>((bits & 0xfffffffffffffu) | 0x3ff0000000000000u);
    if (m > 1.41421356237309504880) {
        m *= 0.5;
        n += 1;
    }
    const double s = (m - 1.0) / (m + 1.0);
    const double s2 = s * s;
    double sum = 0;
    for (int k = 14; k >= 1; --k) sum = s2 * (1.0 / (2.0 * k + 1.0) + sum);
    return static_cast<double>(n) + 2.0 * kLog2E * (s + s * sum);
}

inline double log(double x) { return log2(x) * kLn2; }

/// x^y for x > 0.
inline double pow(double x, double y) { return exp2(y * log2(x)); }

}  // namespace gnomon::scalar
