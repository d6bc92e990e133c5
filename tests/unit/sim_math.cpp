// rcp, rsqrt, exp2 and log2: worst errors over floats, against libm in long double, and the bounds that sim/math.h states.
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

}  // namespace

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

TEST_CASE("denormal operands of log2 and exp2 while denormals are flushed", "[math][3.1.3.2]") {
    // Through volatile: what a compiler folds at compile time knows nothing of the scope.
    volatile float tiny = 0x1p-130f;
    volatile float lowest = -126.0f;
    volatile float below = -127.0f;
    const DenormalScope denormals(true);
    CHECK(lane(log2(Float(tiny)), 0) == -HUGE_VALF);
    CHECK(lane(exp2(Float(lowest)), 0) == 0x1p-126f);
    CHECK(lane(exp2(Float(below)), 0) == 0.0f);
    CHECK(lane(exp2(Float(tiny)), 0) == 1.0f);
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
