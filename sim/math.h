// Deterministic rcp, rsqrt, exp2, log2 and sin_cos on lanes: + - * / sqrt and integer operations only, so the same bits
// everywhere. Errors are the worst over every float (tests/unit/sim_math.cpp sweeps them and prints where the worst one is);
// all are within what D3D11.3 22.10 asks (2^-21 relative; log2 2^-21 absolute in [0.5, 2]; sincos 0.0008 absolute in
// [-100 pi, 100 pi]).
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"
#include "sim/scalar_math.h"

namespace gnomon {

/// 1/x, correctly rounded.
inline Float rcp(Float x) { return Float(1.0f) / x; }
inline Double rcp(const Double& x) { return Double(1.0) / x; }

/// 1/sqrt(x), two roundings: below 1.5 ULP, as half an ULP of the root can weigh a whole one of the quotient.
inline Float rsqrt(Float x) { return Float(1.0f) / sqrt(x); }
inline Double rsqrt(const Double& x) { return Double(1.0) / sqrt(x); }

/// 2^x, below 1.2 ULP; overflows to infinity, underflows through the denormals to 0; NaN stays.
inline Float exp2(Float x) {
    // x = n + t with t in [-1/2, 1/2]. Outside [-152, 129] the result is 0 or infinity.
    const Float limited = clamp(x, Float(-152.0f), Float(129.0f));
    const Float n = round(limited);
    const Float t = limited - n;

    // Taylor series of 2^t; the first term left out is below 2^-27.
    Float p(0x1.ffcbfcp-17f);            // ln2^7 / 7!
    p = p * t + Float(0x1.430912p-13f);  // ln2^6 / 6!
    p = p * t + Float(0x1.5d87fep-10f);  // ln2^5 / 5!
    p = p * t + Float(0x1.3b2ab6p-7f);   // ln2^4 / 4!
    p = p * t + Float(0x1.c6b08ep-5f);   // ln2^3 / 3!
    p = p * t + Float(0x1.ebfbep-3f);    // ln2^2 / 2!
    p = p * t + Float(0x1.62e43p-1f);    // ln2
    p = p * t + Float(1.0f);

    // Scale by 2^n in two halves, each a normal number.
    const Int whole = bounded_truncate_to_int(n);
    const Int half = shift_right<1>(whole);
    const Float scale_a = float_of_bits(shift_left<23>(half + Int(127)));
    const Float scale_b = float_of_bits(shift_left<23>(whole - half + Int(127)));
    return select(is_nan(x), x, p * scale_a * scale_b);
}

/// log2(x), below 1.3 ULP of the larger of 1 and the result; log2(0) = -inf, log2(inf) = inf, log2(x < 0) = NaN.
inline Float log2(Float x) {
    // Bring denormals into the normal range; x = 2^n m with m in [sqrt(1/2), sqrt(2)).
    const Mask tiny = x < Float(0x1p-126f);
    const Float normal = select(tiny, x * Float(0x1p24f), x);
    const Int bits = bits_of(normal) - Int(0x3f3504f3);  // bits of sqrt(1/2)
    const Int n = shift_right<23>(bits);
    const Float m = float_of_bits((bits & Int(0x007fffff)) + Int(0x3f3504f3));

    // log2(m) = 2/ln2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.1716.
    const Float s = (m - Float(1.0f)) / (m + Float(1.0f));
    const Float s2 = s * s;
    Float p(0x1.c71c72p-4f);             // 1/9
    p = p * s2 + Float(0x1.24924ap-3f);  // 1/7
    p = p * s2 + Float(0x1.99999ap-3f);  // 1/5
    p = p * s2 + Float(0x1.555556p-2f);  // 1/3
    const Float series = s + s * (s2 * p);
    const Float exponent = Float(n) - select(tiny, Float(24.0f), Float(0.0f));
    const Float result = exponent + series * Float(0x1.715476p+1f);  // 2/ln2

    const Float infinity = float_of_bits(Int(0x7f800000));
    const Float nan = float_of_bits(Int(0x7fc00000));
    const Float edge = select(x == Float(0.0f), -infinity, select(x == infinity, infinity, select(x < Float(0.0f), nan, x)));
    return select((x > Float(0.0f)) & (x < infinity), result, edge);
}

/// The same in double, through scalar_math.h.
inline Double exp2(const Double& x) {
    return Double::map([&](std::size_t i) {
        if (x.v[i] != x.v[i]) return x.v[i];
        if (x.v[i] >= -1000.0 && x.v[i] <= 1000.0) return scalar::exp2(x.v[i]);
        // Near the ends of the range in two halves, which overflow and underflow as they should.
        const double half = scalar::exp2(0.5 * (x.v[i] < -1100.0 ? -1100.0 : x.v[i] > 1100.0 ? 1100.0 : x.v[i]));
        return half * half;
    });
}
inline Double log2(const Double& x) {
    return Double::map([&](std::size_t i) {
        if (x.v[i] == 0.0) return -HUGE_VAL;
        if (!(x.v[i] > 0.0)) return std::nan("");
        if (x.v[i] == HUGE_VAL) return HUGE_VAL;
        return x.v[i] < 0x1p-1022 ? scalar::log2(x.v[i] * 0x1p54) - 54.0 : scalar::log2(x.v[i]);
    });
}

/// sin(x) and cos(x) of every lane, x in radians.
template <class Real>
struct SinCosLanes {
    Real sin;
    Real cos;
};

/// What an argument of sin_cos leaves after whole quarter turns.
struct QuarterTurns {
    Float rest;  // [-pi/4, pi/4] and what rounding adds
    Int turns;
};

/// Reduction by pi/2 in three parts (Cody and Waite). The first two have 12 bits at most, so that their products with less than
/// 2^12 turns are exact, and so are the differences: they are below 1 and multiples of 2^-24.
inline QuarterTurns reduce_quarter_turns(Float x) {
    const Int turns = bounded_round_to_int(x * Float(0x1.45f306p-1f));  // 2/pi
    const Float n(turns);
    const Float high = x - n * Float(0x1.92p+0f);         // bits 0 to -11 of pi/2
    const Float middle = high - n * Float(0x1.fb4p-12f);  // bits -12 to -23
    return {middle - n * Float(0x1.4442d2p-24f), turns};  // the rest
}

/// Error below 2^-23 absolute for |x| <= 100 pi; in [-1, 1] for all numbers, those beyond 2^20 taken for 2^20. Zeros keep their
/// sign through sin. NaN for NaN and infinities. Beyond 2^12 quarter turns the error is up to half an ULP of x.
/// D3D11.3 22.10.20
inline SinCosLanes<Float> sin_cos(Float x) {
    const auto [r, turns] = reduce_quarter_turns(clamp(x, Float(-0x1p20f), Float(0x1p20f)));

    // Taylor series; the first terms left out are below 2^-29 and 2^-33 at pi/4.
    const Float r2 = r * r;
    Float s(0x1.71de3ap-19f);              // 1 / 9!
    s = s * r2 + Float(-0x1.a01a02p-13f);  // -1 / 7!
    s = s * r2 + Float(0x1.111112p-7f);    // 1 / 5!
    s = s * r2 + Float(-0x1.555556p-3f);   // -1 / 3!
    const Float sine = select(r == Float(0.0f), r, r + r * (r2 * s));
    Float c(-0x1.27e4fcp-22f);             // -1 / 10!
    c = c * r2 + Float(0x1.a01a02p-16f);   // 1 / 8!
    c = c * r2 + Float(-0x1.6c16c2p-10f);  // -1 / 6!
    c = c * r2 + Float(0x1.555556p-5f);    // 1 / 4!
    c = c * r2 + Float(-0.5f);
    const Float cosine = r2 * c + Float(1.0f);

    // Turn back: odd quarters exchange the two, and signs follow the quadrant.
    const Mask odd = (turns & Int(1)) != Int(0);
    const auto negated_by = [](Float y, Int quarter) { return float_of_bits(bits_of(y) ^ shift_left<30>(quarter & Int(2))); };
    const Float sin_x = negated_by(select(odd, cosine, sine), turns);
    const Float cos_x = negated_by(select(odd, sine, cosine), turns + Int(1));
    const Float nan = float_of_bits(Int(0x7fc00000));
    const Mask finite = abs(x) < float_of_bits(Int(0x7f800000));
    return {select(finite, sin_x, nan), select(finite, cos_x, nan)};
}

/// The same in double, through scalar_math.h.
inline SinCosLanes<Double> sin_cos(const Double& x) {
    SinCosLanes<Double> result;
    for (std::size_t i = 0; i < x.v.size(); ++i) {
        const double limited = x.v[i] < -0x1p20 ? -0x1p20 : x.v[i] > 0x1p20 ? 0x1p20 : x.v[i];
        const bool finite = x.v[i] - x.v[i] == 0.0;
        const scalar::SinCos of = finite ? scalar::sincos(limited) : scalar::SinCos{std::nan(""), std::nan("")};
        result.sin.v[i] = x.v[i] == 0.0 ? x.v[i] : of.sin;
        result.cos.v[i] = of.cos;
    }
    return result;
}

}  // namespace gnomon
