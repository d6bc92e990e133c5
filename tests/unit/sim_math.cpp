// rcp, rsqrt, exp2, log2 and sin_cos: worst errors over floats, against libm in long double, and the bounds that sim/math.h
// states.
#include "sim/denormals.h"
#include "sim/math.h"
#include "sim/parallel.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <mutex>

using namespace gnomon;

namespace {

struct Worst {
    double error_ulp = 0;
    float at = 0;
};

/// Distance of two neighbouring floats at |exact|, not below 2^-149.
long double ulp_of(long double exact) {
    int exponent = 0;
    std::frexp(exact, &exponent);
    return std::ldexp(1.0L, std::max(exponent - 24, -149));
}

/// Runs f over the floats with bits first, first + stride, ... < last and finds the largest error in units of scale(exact).
template <class F, class Exact, class Scale>
Worst sweep(std::uint32_t first, std::uint32_t last, std::uint32_t stride, const F& f, const Exact& exact, const Scale& scale) {
    Worst worst;
    std::mutex mutex;
    Workers workers;
    constexpr std::uint32_t kPieces = 64;
    const std::uint64_t count = (std::uint64_t{last} - first + stride - 1) / stride;
    workers.for_each(kPieces, [&](std::size_t piece) {
        Worst local;
        const std::uint64_t begin = count * piece / kPieces;
        const std::uint64_t end = count * (piece + 1) / kPieces;
        for (std::uint64_t i = begin; i < end; i += kLanes) {
            std::array<float, kLanes> x;
            for (std::size_t k = 0; k < kLanes; ++k)
                x[k] = std::bit_cast<float>(first + static_cast<std::uint32_t>(std::min(i + k, end - 1)) * stride);
            const auto got = f(Float::load(x.data())).lanes();
            for (std::size_t k = 0; k < kLanes; ++k) {
                const long double truth = exact(static_cast<long double>(x[k]));
                const auto error = static_cast<double>(std::fabs(static_cast<long double>(got[k]) - truth) / scale(truth));
                if (!(error <= local.error_ulp)) local = {error, x[k]};
            }
        }
        const std::lock_guard lock(mutex);
        if (!(local.error_ulp <= worst.error_ulp)) worst = local;
    });
    return worst;
}

std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }

void report(const char* what, const Worst& worst) {
    fmt::print("  {}: worst error {:.4f} ULP at {:a}\n", what, worst.error_ulp, worst.at);
}

void check_all(std::uint32_t stride) {
    const auto log2_scale = [](long double y) { return ulp_of(std::max(std::fabs(y), 1.0L)); };
    const Worst r = sweep(
        bits(0x1p-125f), bits(0x1p125f), stride, [](Float x) { return rcp(x); }, [](long double x) { return 1 / x; }, ulp_of);
    const Worst s = sweep(
        bits(0x1p-126f), bits(0x1.fffffep127f), stride, [](Float x) { return rsqrt(x); },
        [](long double x) { return 1 / std::sqrt(x); }, ulp_of);
    const Worst e_up = sweep(
        bits(0x1p-30f), bits(127.99999f), stride, [](Float x) { return exp2(x); }, [](long double x) { return std::exp2(x); },
        ulp_of);
    const Worst e_down = sweep(
        bits(-0x1p-30f), bits(-126.0f), stride, [](Float x) { return exp2(x); }, [](long double x) { return std::exp2(x); },
        ulp_of);
    const Worst e_tiny = sweep(
        bits(-126.0f), bits(-151.0f), std::max(stride / 64, 1u), [](Float x) { return exp2(x); },
        [](long double x) { return std::exp2(x); }, ulp_of);
    const Worst l = sweep(
        1, bits(0x1.fffffep127f), stride, [](Float x) { return log2(x); }, [](long double x) { return std::log2(x); },
        log2_scale);
    // D3D11.3 22.10: absolute 2^-21 in [0.5, 2], relative 2^-21 elsewhere.
    const Worst near = sweep(
        bits(0.5f), bits(2.0f), std::max(stride / 64, 1u), [](Float x) { return log2(x); },
        [](long double x) { return std::log2(x); }, [](long double) { return 0x1p-24L; });
    report("rcp", r);
    report("rsqrt", s);
    report("exp2, x > 0", e_up);
    report("exp2, x < 0", e_down);
    report("exp2, denormal results", e_tiny);
    report("log2 (of max(1, |log2 x|))", l);
    report("log2 in [1/2, 2] (of 2^-24 absolute)", near);
    CHECK(r.error_ulp <= 0.5);
    CHECK(s.error_ulp < 1.5);  // half an ULP of the root can weigh a whole one of the quotient, and half one for the division
    CHECK(e_up.error_ulp < 2.0);
    CHECK(e_down.error_ulp < 2.0);
    CHECK(e_tiny.error_ulp < 2.0);
    CHECK(l.error_ulp < 3.0);
    CHECK(near.error_ulp <= 8.0);
    for (const Worst& worst : {r, s, e_up, e_down, l}) CHECK(worst.error_ulp > 0.25);  // the sweep saw something
}

/// sin_cos over the floats of [first, last] and their negatives, in units of 2^-24 absolute.
Worst sweep_sin_cos(const char* range, float first, float last, std::uint32_t stride) {
    const auto unit = [](long double) { return 0x1p-24L; };
    const auto sine = [](long double x) { return std::sin(x); };
    const auto cosine = [](long double x) { return std::cos(x); };
    Worst worst;
    for (const float sign : {1.0f, -1.0f}) {
        const std::uint32_t begin = bits(sign * first);
        const std::uint32_t end = bits(sign * last) + 1;
        const Worst s = sweep(begin, end, stride, [](Float x) { return sin_cos(x).sin; }, sine, unit);
        const Worst c = sweep(begin, end, stride, [](Float x) { return sin_cos(x).cos; }, cosine, unit);
        for (const Worst& one : {s, c})
            if (!(one.error_ulp <= worst.error_ulp)) worst = one;
    }
    fmt::print("  sin_cos {}: worst error {:.4f} of 2^-24 absolute at {:a}\n", range, worst.error_ulp, worst.at);
    return worst;
}

void check_sin_cos(std::uint32_t stride) {
    const Worst near = sweep_sin_cos("to 100 pi", 0x1p-30f, 314.159271f, stride);
    const Worst middle = sweep_sin_cos("from 100 pi to 2^12 quarter turns", 314.159271f, 6433.0f, std::max(stride / 4, 1u));
    const Worst far = sweep_sin_cos("to 2^20", 6433.0f, 0x1p20f, std::max(stride / 4, 1u));
    CHECK(near.error_ulp < 2.0);  // 2^-23; D3D11.3 22.10.20 asks for 0.0008
    CHECK(middle.error_ulp < 2.0);
    CHECK(far.error_ulp < 0x1p-4 * 0x1p24);  // products with the turns are rounded: half an ULP of the argument
    for (const Worst& worst : {near, middle}) CHECK(worst.error_ulp > 0.5);  // the sweep saw something
}

}  // namespace

TEST_CASE("sin_cos stays within its stated error", "[math][22.10.20]") { check_sin_cos(1031); }

TEST_CASE("sin_cos over every seventh float", "[.][sweep][math]") { check_sin_cos(7); }

TEST_CASE("rcp, rsqrt, exp2 and log2 stay within their stated errors", "[math][22.10]") { check_all(1031); }

TEST_CASE("rcp, rsqrt, exp2 and log2 over every mantissa and all exponents", "[.][sweep][math]") {
    check_all(29);
    // Every float of the binades that the others are scaled copies of.
    const Worst r =
        sweep(bits(1.0f), bits(2.0f), 1, [](Float x) { return rcp(x); }, [](long double x) { return 1 / x; }, ulp_of);
    const Worst s = sweep(
        bits(1.0f), bits(4.0f), 1, [](Float x) { return rsqrt(x); }, [](long double x) { return 1 / std::sqrt(x); }, ulp_of);
    const Worst e =
        sweep(bits(0.25f), bits(1.0f), 1, [](Float x) { return exp2(x); }, [](long double x) { return std::exp2(x); }, ulp_of);
    const Worst l = sweep(
        bits(0.5f), bits(2.0f), 1, [](Float x) { return log2(x); }, [](long double x) { return std::log2(x); },
        [](long double) { return 0x1p-24L; });
    report("rcp in [1, 2)", r);
    report("rsqrt in [1, 4)", s);
    report("exp2 in [1/4, 1)", e);
    report("log2 in [1/2, 2) (of 2^-24 absolute)", l);
    CHECK(r.error_ulp <= 0.5);
    CHECK(s.error_ulp < 1.5);
    CHECK(e.error_ulp < 2.0);
    CHECK(l.error_ulp < 3.0);
}

TEST_CASE("transcendental special values", "[math]") {
    const float inf = HUGE_VALF;
    const float nan = std::nanf("");
    const auto at = [](auto f, float x) { return lane(f(Float(x)), 0); };
    const auto f_exp2 = [](Float x) { return exp2(x); };
    const auto f_log2 = [](Float x) { return log2(x); };
    for (int n = -149; n <= 127; ++n) {
        CHECK(at(f_exp2, static_cast<float>(n)) == std::ldexp(1.0f, n));
        CHECK(at(f_log2, std::ldexp(1.0f, n)) == static_cast<float>(n));
    }
    CHECK(at(f_exp2, inf) == inf);
    CHECK(at(f_exp2, -inf) == 0.0f);
    CHECK(at(f_exp2, 128.0f) == inf);
    CHECK(at(f_exp2, 1e30f) == inf);
    CHECK(at(f_exp2, -200.0f) == 0.0f);
    CHECK(at(f_exp2, -0.0f) == 1.0f);
    CHECK(std::isnan(at(f_exp2, nan)));
    CHECK(at(f_log2, 0.0f) == -inf);
    CHECK(at(f_log2, -0.0f) == -inf);
    CHECK(at(f_log2, inf) == inf);
    CHECK(std::isnan(at(f_log2, -1.0f)));
    CHECK(std::isnan(at(f_log2, -inf)));
    CHECK(std::isnan(at(f_log2, nan)));
    CHECK(at([](Float x) { return rcp(x); }, 0.0f) == inf);
    CHECK(at([](Float x) { return rcp(x); }, -0.0f) == -inf);
    CHECK(at([](Float x) { return rsqrt(x); }, 0.0f) == inf);
    CHECK(std::isnan(at([](Float x) { return rsqrt(x); }, -1.0f)));
    // Doubles.
    const auto d = [](Double x) { return lane(x, 0); };
    CHECK(d(exp2(Double(HUGE_VAL))) == HUGE_VAL);
    CHECK(d(exp2(Double(-HUGE_VAL))) == 0.0);
    CHECK(std::isnan(d(exp2(Double(std::nan(""))))));
    CHECK(d(log2(Double(0.0))) == -HUGE_VAL);
    CHECK(d(log2(Double(HUGE_VAL))) == HUGE_VAL);
    CHECK(std::isnan(d(log2(Double(-1.0)))));
    CHECK(std::isnan(d(log2(Double(std::nan(""))))));
}

namespace {

struct SinCosBits {
    std::uint32_t sin;
    std::uint32_t cos;
    bool operator==(const SinCosBits&) const = default;
};
SinCosBits sin_cos_bits(float x) {
    const SinCosLanes<Float> both = sin_cos(Float(x));
    return {bits(lane(both.sin, 0)), bits(lane(both.cos, 0))};
}

}  // namespace

TEST_CASE("special values of sin_cos", "[math][22.10.20]") {
    constexpr std::uint32_t kOne = 0x3f800000;
    constexpr std::uint32_t kNan = 0x7fc00000;
    CHECK(sin_cos_bits(0.0f) == SinCosBits{0, kOne});
    CHECK(sin_cos_bits(-0.0f) == SinCosBits{0x80000000, kOne});
    CHECK(sin_cos_bits(-0x1p-149f) == SinCosBits{0x80000001, kOne});
    for (const float x : {HUGE_VALF, -HUGE_VALF, std::nanf(""), -std::nanf("")})
        CHECK(sin_cos_bits(x) == SinCosBits{kNan, kNan});
    // Numbers of any size give numbers in [-1, 1].
    for (std::uint32_t x = 0; x < bits(HUGE_VALF); x += 4099) {
        const SinCosLanes<Float> both = sin_cos(Float(std::bit_cast<float>(x)));
        const float s = lane(both.sin, 0);
        const float c = lane(both.cos, 0);
        if (!(std::fabs(s) <= 1.0f && std::fabs(c) <= 1.0f))
            FAIL(fmt::format("{:a}: {:a} and {:a}", std::bit_cast<float>(x), s, c));
        // Odd and even.
        const SinCosBits negated = sin_cos_bits(-std::bit_cast<float>(x));
        if (negated != SinCosBits{bits(-s), bits(c)}) FAIL(fmt::format("{:a} and its negative", std::bit_cast<float>(x)));
    }
    CHECK(sin_cos_bits(0x1p20f) == sin_cos_bits(0x1p100f));
}

TEST_CASE("sin_cos has the same bits in every lane and at every width", "[math]") {
    // The bits of 2^18 floats of all sizes, some of them NaN, through FNV-1a: one constant for all builds.
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](std::int32_t word) { hash = (hash ^ static_cast<std::uint32_t>(word)) * 0x100000001b3u; };
    for (std::uint32_t n = 0; n < 1u << 18; n += kLanes) {
        std::array<std::int32_t, kLanes> x;
        for (std::uint32_t i = 0; i < kLanes; ++i) x[i] = static_cast<std::int32_t>((n + i) * 16411u);
        const SinCosLanes<Float> both = sin_cos(float_of_bits(Int::load(x.data())));
        const auto s = bits_of(both.sin).lanes();
        const auto c = bits_of(both.cos).lanes();
        for (std::size_t i = 0; i < x.size(); ++i) {
            add(s[i]);
            add(c[i]);
        }
    }
    INFO(fmt::format("{:#x}", hash));
    CHECK(hash == 0x2b2d968e8834956au);
}

TEST_CASE("sin_cos of doubles", "[math][22.10.20]") {
    double worst = 0;
    for (int i = -200000; i <= 200000; ++i) {
        const double x = i * (314.2 / 200000);
        const SinCosLanes<Double> both = sin_cos(Double(x));
        worst = std::max({worst, static_cast<double>(std::fabs(lane(both.sin, 0) - std::sin(static_cast<long double>(x)))),
                          static_cast<double>(std::fabs(lane(both.cos, 0) - std::cos(static_cast<long double>(x))))});
    }
    fmt::print("  sin_cos of doubles to 100 pi: worst error {:.3g}\n", worst);
    CHECK(worst < 1e-15);
    const auto at = [](double x) { return std::pair{lane(sin_cos(Double(x)).sin, 0), lane(sin_cos(Double(x)).cos, 0)}; };
    CHECK(at(0.0) == std::pair{0.0, 1.0});
    CHECK(std::signbit(at(-0.0).first));
    CHECK(at(1e300) == at(0x1p20));
    for (const double x : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
        CHECK(std::isnan(at(x).first));
        CHECK(std::isnan(at(x).second));
    }
}

TEST_CASE("denormal operands of log2, exp2 and sin_cos while denormals are flushed", "[math][3.1.3.2]") {
    // Through volatile: what a compiler folds at compile time knows nothing of the scope.
    volatile float tiny = 0x1p-130f;
    volatile float lowest = -126.0f;
    volatile float below = -127.0f;
    const DenormalScope denormals(true);
    CHECK(lane(log2(Float(tiny)), 0) == -HUGE_VALF);
    CHECK(lane(exp2(Float(lowest)), 0) == 0x1p-126f);
    CHECK(lane(exp2(Float(below)), 0) == 0.0f);
    CHECK(lane(exp2(Float(tiny)), 0) == 1.0f);
    CHECK(bits(lane(sin_cos(Float(-tiny)).sin, 0)) == 0x80000000u);
    CHECK(lane(sin_cos(Float(tiny)).cos, 0) == 1.0f);
}

TEST_CASE("host functions in double agree with libm", "[math]") {
    double worst_exp2 = 0, worst_log2 = 0, worst_sin = 0, worst_pow = 0;
    for (int i = -200000; i <= 200000; ++i) {
        const double x = i * 0.00049;
        worst_sin = std::max({worst_sin, std::fabs(scalar::sin(x) - static_cast<double>(std::sin(static_cast<long double>(x)))),
                              std::fabs(scalar::cos(x) - static_cast<double>(std::cos(static_cast<long double>(x))))});
        const double y = i * 0.00499;
        worst_exp2 = std::max(
            worst_exp2, static_cast<double>(
                            std::fabs(static_cast<long double>(scalar::exp2(y)) / std::exp2(static_cast<long double>(y)) - 1)));
        const double z = std::exp(i * 0.003);
        worst_log2 = std::max(worst_log2, static_cast<double>(std::fabs(static_cast<long double>(scalar::log2(z)) -
                                                                        std::log2(static_cast<long double>(z)))));
        if (i % 100 == 0)
            worst_pow =
                std::max(worst_pow,
                         std::fabs(scalar::pow(1.0 + (i + 200000) * 1e-5, 2.4) / std::pow(1.0 + (i + 200000) * 1e-5, 2.4) - 1));
    }
    INFO("exp2 " << worst_exp2 << " log2 " << worst_log2 << " sin/cos " << worst_sin << " pow " << worst_pow);
    CHECK(worst_sin < 1e-15);
    CHECK(worst_exp2 < 0x1p-50);
    CHECK(worst_log2 < 0x1p-41);  // 1 ULP of results up to 866
    CHECK(worst_pow < 1e-13);
    double near_one = 0;
    for (int i = 0; i < 10000; ++i) {
        const double x = 0.5 + i * 1.5e-4;
        near_one = std::max(near_one, static_cast<double>(std::fabs(static_cast<long double>(scalar::log2(x)) -
                                                                    std::log2(static_cast<long double>(x)))));
    }
    CHECK(near_one < 0x1p-48);
    CHECK(std::fabs(scalar::tan(0.7) - std::tan(0.7)) < 1e-15);
    double worst_atan = 0;
    for (int i = -20000; i <= 20000; ++i) {
        const double x = std::copysign(std::exp(std::fabs(i) * 0.002 - 20), static_cast<double>(i));
        worst_atan = std::max(worst_atan, static_cast<double>(std::fabs(static_cast<long double>(scalar::atan(x)) -
                                                                        std::atan(static_cast<long double>(x)))));
    }
    INFO("atan " << worst_atan);
    CHECK(worst_atan < 0x1p-49);
    CHECK(std::fabs(scalar::exp(1.0) - 2.718281828459045) < 1e-15);
    CHECK(std::fabs(scalar::log(10.0) - 2.302585092994046) < 1e-15);
}
