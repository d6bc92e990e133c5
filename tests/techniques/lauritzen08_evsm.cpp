// [Lauritzen08] 4.2: exponential warps, how far a format lets them go, and the bounds that they give. [Salvi08] for esm.
#include "sim/half.h"
#include "techniques/esm.h"
#include "techniques/evsm.h"
#include "tests/oracle/random.h"
#include "tests/techniques/bound_interval.h"
#include "tests/techniques/frames.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

constexpr double kExp2Error = 1.2 * 0x1p-23;  // sim/math.h: below 1.2 ULP

std::array<ExponentialWarp, 2> warps_of(float c) { return {positive_warp(c), negative_warp(c)}; }

template <class Real>
Warped<typename Real::Scalar> warped(const ExponentialWarp& warp, float depth) {
    const Warped<Real> all = warp(Real(depth));
    return {lane(all.value, 0), lane(all.slope, 0)};
}

/// The exponent that a warp has after its constant was rounded to fp32.
double exponent_of(const ExponentialWarp& warp) { return static_cast<double>(warp.exponent2) * std::log(2.0); }

/// e^{power c}, as the light pass computes it at depth 1 where the warp is largest.
float largest_moment(float c, int power) {
    const float value = warped<Float>(positive_warp(c), 1.0f).value;
    return power == 2 ? lane(moments_of_depth(Float(value)).second, 0)
                      : lane(EsmEncoding{positive_warp(c).exponent2}.encode(Float(1.0f)).x, 0);
}

}  // namespace

TEST_CASE("exponential warps: values and slopes", "[lauritzen08][4.2]") {
    for (const float c : {0.5f, 5.5f, 10.0f, 40.0f, 44.36f})
        for (const ExponentialWarp& warp : warps_of(c)) {
            const double exact_c = exponent_of(warp);
            const auto exponent2 = static_cast<double>(warp.exponent2);
            // fp32: x rounds once and is at most 1, its product with the exponent rounds once; the value loses as much times
            // ln(2), and exp2's own error. The slope has three factors more that round. 1.01 holds the second order.
            const double value_error = 1.01 * (std::log(2.0) * exponent2 * (0x1p-25 + 0x1p-24) + kExp2Error);
            const double slope_error = value_error + 1.01 * 3 * kUnit;
            // Double: the same steps with units of 2^-53, and 2^-50 of scalar::exp2.
            const double double_error = exponent2 * 0x1p-51 + 0x1p-48;
            for (int i = 0; i <= 1024; ++i) {
                const float depth = static_cast<float>(i) / 1024.0f + (i % 3 == 1 ? 0x1.2345p-14f : 0.0f);
                const double x = 2.0 * static_cast<double>(depth) - 1.0;
                const auto sign = static_cast<double>(warp.sign);
                const double value = sign * std::exp(sign * exact_c * x);
                const double slope = 2.0 * exact_c * std::fabs(value);
                const Warped<float> fp32 = warped<Float>(warp, depth);
                const Warped<double> fp64 = warped<Double>(warp, depth);
                const auto is_near = [](double got, double wanted, double error) {
                    return std::fabs(got - wanted) <= error * std::fabs(wanted);
                };
                // The slope's constant 2 ln(2) c / ln(2) is one fp32 number in either arithmetic.
                if (!is_near(static_cast<double>(fp32.value), value, value_error) ||
                    !is_near(static_cast<double>(fp32.slope), slope, slope_error) ||
                    !is_near(fp64.value, value, double_error) || !is_near(fp64.slope, slope, double_error + 1.01 * 2 * kUnit))
                    FAIL(fmt::format(
                        "c {:a} sign {} depth {:a}: {:a} slope {:a}, Double {:a} slope {:a}, expected {:a} slope {:a}", c,
                        warp.sign, depth, fp32.value, fp32.slope, fp64.value, fp64.slope, value, slope));
            }
        }
}

TEST_CASE("exponential warps rise with depth", "[lauritzen08][4.2]") {
    for (const float c : {0.1f, 1.0f, 5.5f, 40.0f, 44.36f})
        for (const ExponentialWarp& warp : warps_of(c)) {
            // A step of 2^-16 in depth is one of 2c 2^-16 > 2^-19 relative, well above the 2 x 1.2 ULP of two exponentials.
            for (int i = 0; i < 65536; ++i) {
                const Warped<float> here = warped<Float>(warp, static_cast<float>(i) / 65536.0f);
                const Warped<float> next = warped<Float>(warp, static_cast<float>(i + 1) / 65536.0f);
                if (!(next.value > here.value && here.slope > 0.0f))
                    FAIL(fmt::format("c {:a} sign {} depth {:a}: {:a}, then {:a}", c, warp.sign,
                                     static_cast<float>(i) / 65536.0f, here.value, next.value));
            }
            // From one float to the next the argument never falls (roundings keep order), so that only the errors of two
            // exponentials can turn the order over.
            oracle::Random random(static_cast<std::uint64_t>(c * 16.0f));
            for (int i = 0; i < 20000; ++i) {
                const float depth = random.unit();
                const float next = std::nextafter(depth, 2.0f);
                const auto a = static_cast<double>(warped<Float>(warp, depth).value);
                const auto b = static_cast<double>(warped<Float>(warp, next).value);
                if (!(b - a >= -2.02 * kExp2Error * std::fabs(a)))
                    FAIL(fmt::format("case {}: c {:a} sign {} depth {:a}: {:a}, then {:a}", i, c, warp.sign, depth, a, b));
            }
        }
}

TEST_CASE("exponents: the limit of a format is the last that its largest number holds", "[lauritzen08][4.2]") {
    const double largest32 = static_cast<double>(std::numeric_limits<float>::max());
    CHECK(largest_of(format_info(Format::Rg16Float)) == 65504.0);
    CHECK(largest_of(format_info(Format::Rg32Float)) == largest32);
    for (const int power : {1, 2}) {
        const double limit16 = exponent_limit(format_info(Format::Rgba16Float), power);
        const double limit32 = exponent_limit(format_info(Format::Rgba32Float), power);
        CHECK(limit16 == Approx(std::log(65504.0) / power - 1e-4).epsilon(1e-12));
        CHECK(limit32 == Approx(std::log(largest32) / power - 1e-4).epsilon(1e-12));

        // At the limit: finite, and less than the largest number by e^{-power 1e-4} and the errors of the shader, which are
        // those of the test above at x = 1: below 2^-16 of e^{power c} for an exponent of 128.
        const double margin = power * 1e-4 + 0x1p-16;
        const auto moment16 = static_cast<double>(largest_moment(static_cast<float>(limit16), power));
        const auto moment32 = static_cast<double>(largest_moment(static_cast<float>(limit32), power));
        INFO("power " << power << ": " << moment16 << " of 65504, " << moment32 << " of " << largest32);
        CHECK(moment16 < 65504.0);
        CHECK(moment16 > 65504.0 * (1 - margin));
        CHECK(moment32 < largest32);
        CHECK(moment32 > largest32 * (1 - margin));
        for (const Narrowing narrowing : {Narrowing::TowardZero, Narrowing::NearestEven}) {
            const std::uint16_t bits = half_from_float(static_cast<float>(moment16), narrowing).bits;
            CHECK(bits <= 0x7bff);
            CHECK(bits >= 0x7bfe);
        }

        // 4e-4 above the limit e^{power c} passes 65520, from where nearest-even narrowing gives infinity; toward zero it is
        // held at 65504. fp32 has overflowed before anything is stored.
        const float above16 = largest_moment(static_cast<float>(limit16 + 4e-4), power);
        CHECK(half_from_float(above16, Narrowing::TowardZero).bits == 0x7bff);
        CHECK(half_from_float(above16, Narrowing::NearestEven).bits == 0x7c00);
        CHECK(std::isinf(largest_moment(static_cast<float>(limit32 + 4e-4), power)));

        // Of several samples the sum stays finite, too; that of two would not at the limit of one.
        for (const int samples : {2, 8, 16}) {
            const double limit = exponent_limit(format_info(Format::Rgba32Float), power, samples);
            const float moment = largest_moment(static_cast<float>(limit), power);
            CHECK(std::isfinite(static_cast<float>(samples) * moment));
            CHECK(std::isinf(static_cast<float>(samples) * static_cast<float>(moment32)));
        }
    }
}

namespace {

struct FloatCounts {
    std::size_t saturated = 0;
    std::size_t infinite = 0;
    std::size_t nan = 0;
};

/// Components of a map of floats by their bits.
FloatCounts counts_of(const std::vector<std::byte>& map, bool is_half) {
    const std::size_t size = is_half ? 2 : 4;
    const std::uint32_t largest = is_half ? 0x7bffu : 0x7f7fffffu;
    FloatCounts counts;
    for (std::size_t i = 0; i < map.size(); i += size) {
        std::uint32_t code = 0;
        std::memcpy(&code, map.data() + i, size);
        const std::uint32_t magnitude = code & (is_half ? 0x7fffu : 0x7fffffffu);
        counts.saturated += magnitude == largest;
        counts.infinite += magnitude == largest + 1;
        counts.nan += magnitude > largest + 1;
    }
    return counts;
}

FloatCounts counts_of_evsm4(Format format, const char* c, const char* clamp, const std::string& profile, int samples = 1) {
    const Shot shot = shoot(
        "evsm4",
        {.map_size = 64, .map_samples = samples, .format = format, .set = {{"positive", c}, {"negative", c}, {"clamp", clamp}}},
        {.profile = profile, .width = 64, .height = 48});
    for (const float v : shot.visibility)
        if (clamp == std::string("on") && v != Frame::kNoSurface && !(v >= 0.0f && v <= 1.0f))
            FAIL(fmt::format("{} {} c {} samples {}: visibility {:a}", profile, name_of(format), c, samples, v));
    return counts_of(shot.maps.front(), format == Format::Rgba16Float);
}

}  // namespace

TEST_CASE("exponents above the limit: toward zero saturates, nearest even overflows, fp32 always does", "[lauritzen08][4.2]") {
    // e^{2 8 x} passes 65504 at x = 0.693 and e^{2 60 x} the largest fp32 number at x = 0.739: depths beyond 0.85 and 0.87.
    const FloatCounts toward_zero = counts_of_evsm4(Format::Rgba16Float, "8", "off", "d3d11");
    CHECK(toward_zero.saturated > 100);
    CHECK(toward_zero.infinite == 0);
    CHECK(toward_zero.nan == 0);
    for (const char* profile : {"g80", "ideal"}) {
        INFO(profile);
        const FloatCounts nearest = counts_of_evsm4(Format::Rgba16Float, "8", "off", profile);
        CHECK(nearest.infinite > 100);
        CHECK(nearest.nan == 0);
    }
    for (const char* profile : {"d3d11", "g80", "ideal"}) {
        INFO(profile);
        CHECK(counts_of_evsm4(Format::Rgba32Float, "60", "off", profile).infinite > 100);
    }
}

TEST_CASE("exponents held at the limit: nothing saturates or overflows", "[lauritzen08][4.2]") {
    for (const char* profile : {"d3d11", "g80", "ideal"})
        for (const auto& [format, c] : {std::pair{Format::Rgba16Float, "8"}, std::pair{Format::Rgba32Float, "60"}})
            // A resolve adds up the samples of a texel before it divides.
            for (const int samples : {1, 8}) {
                INFO(profile << " " << name_of(format) << " samples " << samples);
                const FloatCounts counts = counts_of_evsm4(format, c, "on", profile, samples);
                // Nearest even rounds e^{2c} = 65491 up to 65504, which is not more than the format holds.
                if (format == Format::Rgba32Float || profile == std::string("d3d11")) CHECK(counts.saturated == 0);
                CHECK(counts.infinite == 0);
                CHECK(counts.nan == 0);
            }
    // One limit per number of samples: only 32-bit floats are added up in the format that they are stored in.
    const FormatInfo& half = format_info(Format::Rg16Float);
    const FormatInfo& full = format_info(Format::Rg32Float);
    CHECK(exponent_limit(half, 2, 8) == exponent_limit(half, 2));
    CHECK(exponent_limit(full, 2, 8) == Approx(exponent_limit(full, 2) - 1.5 * std::log(2.0)).epsilon(1e-12));
}

namespace {

/// What a call prints on stderr.
std::string stderr_of(const std::function<void()>& call) {
    std::fflush(stderr);
    std::FILE* file = std::tmpfile();
    REQUIRE(file != nullptr);
    const int saved = ::dup(STDERR_FILENO);
    ::dup2(::fileno(file), STDERR_FILENO);
    call();
    std::fflush(stderr);
    ::dup2(saved, STDERR_FILENO);
    ::close(saved);
    std::rewind(file);
    std::string text;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) text.push_back(static_cast<char>(c));
    std::fclose(file);
    return text;
}

void make_passes(std::string_view technique, const TechniqueRequest& request) {
    Device device(Profile{}, 1);
    const Technique& t = find_technique(technique);
    (void)t.make(device, resolve_settings(t, request));
}

}  // namespace

TEST_CASE("an exponent above the limit is warned of once, a default never", "[lauritzen08][4.2]") {
    const auto wish = [](const char* clamp) {
        make_passes("evsm4", {.map_size = 16, .format = Format::Rgba16Float, .set = {{"positive", "5.875"}, {"clamp", clamp}}});
    };
    CHECK(stderr_of([&] { wish("on"); }) == "warning: positive=5.875: rgba16f holds up to 5.5448; that is taken\n");
    CHECK(stderr_of([&] { wish("on"); }).empty());
    CHECK(stderr_of([&] { wish("off"); }) ==
          "warning: positive=5.875: rgba16f holds up to 5.5448; larger values saturate or become infinite\n");
    CHECK(stderr_of([&] { wish("off"); }).empty());
    CHECK(stderr_of([] { make_passes("evsm4", {.map_size = 16, .format = Format::Rgba16Float}); }).empty());
    CHECK(stderr_of([] { make_passes("esm", {.map_size = 16, .format = Format::R16Float}); }).empty());
    CHECK(stderr_of([] { make_passes("evsm2", {.map_size = 16, .set = {{"positive", "44"}}}); }).empty());
}

TEST_CASE("the bound of evsm4 is at most that of evsm2, and less somewhere", "[lauritzen08][4.2]") {
    // Both hold the same two moments of the positive warp.
    const ParameterTexts exponents{{"positive", "20"}};
    const Shot two = shoot("evsm2", {.map_size = 128, .set = exponents});
    const Shot four = shoot("evsm4", {.map_size = 128, .set = {{"positive", "20"}, {"negative", "20"}}});
    std::size_t less = 0;
    for (std::size_t i = 0; i < two.visibility.size(); ++i) {
        if (!(four.visibility[i] <= two.visibility[i]))
            FAIL(fmt::format("pixel {}: {:a} of both, {:a} of one", i, four.visibility[i], two.visibility[i]));
        less += four.visibility[i] < two.visibility[i];
    }
    CHECK(less > 100);
}

namespace {

/// Four depths and their shares, which sum to 1.
struct Distribution {
    std::array<double, 4> depth{};
    std::array<double, 4> share{};

    /// E(f(depth)).
    [[nodiscard]] double mean(const std::function<double(double)>& f) const {
        double sum = 0;
        for (std::size_t i = 0; i < depth.size(); ++i) sum += share[i] * f(depth[i]);
        return sum;
    }
};

/// Depths are multiples of 2^-16, so that two of them are equal or well apart.
Distribution random_distribution(oracle::Random& random) {
    Distribution d;
    double total = 0;
    for (std::size_t i = 0; i < d.depth.size(); ++i) {
        d.depth[i] = random.integer(0, 65536) * 0x1p-16;
        d.share[i] = random.integer(0, 256);
        total += d.share[i];
    }
    if (total == 0) d.share[0] = total = 1;
    for (double& share : d.share) share /= total;
    return d;
}

double bound_in_double(const Moments<double>& m, double t) {
    return lane(chebyshev_upper_bound(Moments<Double>{Double(m.first), Double(m.second)}, Double(t), Double(0.0)), 0);
}

}  // namespace

TEST_CASE("with a small exponent the warped bound is that of plain depth", "[lauritzen08][4.2]") {
    // (e^{cx} - 1) / c = x + r with |r| <= e = (e^c - 1 - c) / c on [-1, 1]. Neither shift nor scale changes the bound, so it
    // is that of x with moments, and a receiver, that err by at most e. Cancellation in double: 2^-50 / c^2 of the second
    // moment.
    for (const float c : {0x1p-4f, 0x1p-7f, 0x1p-10f}) {
        oracle::Random random(4);
        const auto exact = static_cast<double>(c);
        const double e = (std::exp(exact) - 1 - exact) / exact;
        double worst = 0;
        for (int i = 0; i < 2000; ++i) {
            const Distribution d = random_distribution(random);
            const double t = random.integer(0, 65536) * 0x1p-16;
            for (const ExponentialWarp& warp : warps_of(c)) {
                const auto value = [&](double z) { return warped<Double>(warp, static_cast<float>(z)).value; };
                const Moments<Double> m{Double(d.mean(value)), Double(d.mean([&](double z) { return value(z) * value(z); }))};
                const double got = lane(warped_upper_bound(m, warp(Double(t)), 0.0f), 0);
                const double m1 = d.mean([](double z) { return 2 * z - 1; });
                const double m2 = d.mean([](double z) { return (2 * z - 1) * (2 * z - 1); });
                const Interval allowed =
                    bound_interval(m1, m2, 2 * t - 1, 2 * e, (2 + e) * e + 0x1p-50 / (exact * exact), 0x1p-50 / exact);
                if (!(got >= allowed.low && got <= allowed.high))
                    FAIL(fmt::format("case {}: c {:a} sign {} t {:a}: {:a}, allowed [{:a}, {:a}]", i, c, warp.sign, t, got,
                                     allowed.low, allowed.high));
                worst = std::max(worst, std::fabs(got - chebyshev(m2 - m1 * m1, 2 * t - 1 - m1)));
            }
        }
        INFO("c " << c << ": bounds differ by up to " << worst);
        CHECK(worst > 0);
    }
}

TEST_CASE("the least variance of depth is that of the warped depth by its slope", "[lauritzen08][4.2]") {
    // One depth z = 0.7 and a receiver 0.01 behind it: floor v (2c)^2 e^{2cx}, distance e^{cx} - e^{cz}.
    for (const float c : {1.0f, 10.0f, 40.0f})
        for (const ExponentialWarp& warp : warps_of(c)) {
            const auto sign = static_cast<double>(warp.sign);
            const double z = warped<Double>(warp, 0.7f).value;
            const double apart = 2 * exponent_of(warp) * (static_cast<double>(0.71f) - static_cast<double>(0.7f));
            const double d = sign * (1 - std::exp(-sign * apart));  // over the receiver's magnitude
            const double v = 1e-4 * 4 * exponent_of(warp) * exponent_of(warp);
            const double got =
                lane(warped_upper_bound(Moments<Double>{Double(z), Double(z * z)}, warp(Double(0.71f)), 1e-4f), 0);
            // The constants 1e-4 and 2 ln(2) c are fp32 numbers.
            CHECK(got == Approx(v / (v + d * d)).epsilon(8 * kUnit));
        }
}

TEST_CASE("warped bounds are numbers for any receiver, up to the limit of fp32", "[lauritzen08][4.2]") {
    // Near depth 1 slopes are 2c e^c, whose square is no fp32 number from c = 39.9 on; near depth 0 squares are e^{-2c}, below
    // the smallest normal number from c = 43.7 on. The bound is one of [0, 1] nevertheless, the floor v (2c)^2 as a share of
    // the receiver's square remains: an occluder 2^-20 before the receiver leaves it lit.
    for (const float c : {39.8f, 40.0f, 42.0f, 44.36f})
        for (const ExponentialWarp& warp : warps_of(c))
            for (const float variance : {1e-7f, 1e-3f, 1.0f}) {
                const DenormalScope denormals(true);
                const EvsmEncoding encoding{.positive = warp, .negative = warp, .warps = 1};
                for (int i = 0; i < 1024; ++i) {
                    const float depth = 1.0f - static_cast<float>(i) / 1024.0f;
                    const auto texel = encoding.encode(Float(depth - 0x1p-20f));
                    const float bound =
                        lane(warped_upper_bound(Moments<Float>{texel.x, texel.y}, warp(Float(depth)), variance), 0);
                    // d = 2c 2^-20 of the receiver's square root at most, and the errors of two exponentials, 2^-16, and the
                    // variance may err by a rounding of the square: 2^-23. Against v (2c)^2 >= 6e-4.
                    if (!(bound >= 0.998f && bound <= 1.0f))
                        FAIL(fmt::format("c {:a} sign {} least variance {:g} depth {:a}: {:a}", c, warp.sign, variance, depth,
                                         bound));
                }
            }
}

TEST_CASE("a strictly monotonic warp keeps the bound a bound", "[lauritzen08][4]") {
    const std::vector<std::pair<const char*, std::function<double(double)>>> maps{
        {"z", [](double z) { return z; }},
        {"z^3", [](double z) { return z * z * z; }},
        {"sqrt z", [](double z) { return std::sqrt(z); }},
        {"ln(z + 1/8)", [](double z) { return std::log(z + 0.125); }},
        {"-1 / (z + 1/8)", [](double z) { return -1 / (z + 0.125); }},
        {"z + sin(20 z) / 21", [](double z) { return z + std::sin(20 * z) / 21; }},
        {"a kink at 1/3", [](double z) { return z < 1.0 / 3 ? 16 * z : 16.0 / 3 + (z - 1.0 / 3) / 16; }},
        {"e^{10 z}", [](double z) { return std::exp(10 * z); }},
        {"-e^{-10 z}", [](double z) { return -std::exp(-10 * z); }},
    };
    for (const auto& [name, map] : maps)
        for (int i = 0; i < 3000; ++i) {
            oracle::Random random(static_cast<std::uint64_t>(i));
            const Distribution d = random_distribution(random);
            const double t = random.chance(2) ? d.depth[0] : random.integer(0, 65536) * 0x1p-16;
            const double beyond = d.mean([&](double z) { return z >= t ? 1.0 : 0.0; });
            const double m1 = d.mean(map);
            const double m2 = d.mean([&](double z) { return map(z) * map(z); });
            const double got = bound_in_double({m1, m2}, map(t));
            // In exact arithmetic got >= beyond. Shares, sums and squares round: eight units of the largest number each.
            double largest = std::fabs(map(t));
            for (const double z : d.depth) largest = std::max(largest, std::fabs(map(z)));
            const double e1 = 8 * 0x1p-53 * largest;
            const double low = bound_interval(m1, m2, map(t), e1, e1 * largest, 0x1p-53).low;
            if (!(got >= std::min(beyond - 0x1p-50, low)))
                FAIL(fmt::format("case {}: {} t {:a}: bound {:a}, share {:a}", i, name, t, got, beyond));
        }
}

TEST_CASE("[Lauritzen08] figure 3.4: light bleeding falls as the exponent grows", "[lauritzen08][4.2]") {
    // Objects A and B, half of the filter each, and C behind both. Eq. 3.4 with dx = B - A and dy = C - B after the warp.
    struct Objects {
        float a, b, c;
    };
    for (const Objects& at : {Objects{0.125f, 0.5f, 0.5625f}, Objects{0.25f, 0.375f, 0.75f}, Objects{0.5f, 0.75f, 0.875f}}) {
        double before = 1;
        double before_negative = 0;
        std::string table;
        for (const float c : {0x1p-8f, 1.0f, 2.0f, 5.0f, 10.0f, 20.0f, 40.0f, 44.36f}) {
            const auto p = [&](const ExponentialWarp& warp) {
                const double a = warped<Double>(warp, at.a).value;
                const double b = warped<Double>(warp, at.b).value;
                return lane(warped_upper_bound(Moments<Double>{Double((a + b) / 2), Double((a * a + b * b) / 2)},
                                               warp(Double(at.c)), 0.0f),
                            0);
            };
            const double positive = p(positive_warp(c));
            const double negative = p(negative_warp(c));
            fmt::format_to(std::back_inserter(table), "c {:>8g}: positive {:.3e} negative {:.6f} both {:.3e}\n", c, positive,
                           negative, std::min(positive, negative));
            INFO("A " << at.a << " B " << at.b << " C " << at.c << "\n" << table);
            // The positive warp moves B towards A: p <= (phi(B) / 2)^2 / (phi(C) - phi(B))^2, which tends to 0. The negative
            // one moves B towards C: p tends to the half that B shows of itself.
            const double ratio = std::exp(2 * static_cast<double>(c) * static_cast<double>(at.c - at.b)) - 1;
            REQUIRE(positive < before);
            REQUIRE(positive <= 0.25 / (ratio * ratio) * (1 + 1e-6));
            REQUIRE(negative >= before_negative);
            REQUIRE(negative <= 0.5);
            before = positive;
            before_negative = negative;
        }
        CHECK(before < 1e-4);
        CHECK(before_negative > 0.49);
    }
}

TEST_CASE("esm: visibility is e^{c (z - d)}, at most 1", "[salvi08]") {
    for (const float c : {1.0f, 11.0f, 80.0f, 88.72f}) {
        const EsmEncoding encoding{.exponent2 = positive_warp(c).exponent2};
        const double exact_c = static_cast<double>(encoding.exponent2) * std::log(2.0);
        oracle::Random random(5);
        for (int i = 0; i < 20000; ++i) {
            const float z = random.unit();
            const float d = random.unit();
            const auto visibility = [&](float stored, float depth) {
                return lane(exponential_visibility(encoding.encode(Float(stored)).x, Float(depth), encoding), 0);
            };
            // One depth is exact: the same exponential twice. Occluders behind the receiver leave 1.
            REQUIRE(visibility(z, z) == 1.0f);
            if (z >= d + 0x1p-18f) REQUIRE(visibility(z, d) == 1.0f);
            // Both arguments round once, at most 2^-24 of c / ln(2) each; two exponentials and a quotient.
            const double expected = std::min(1.0, std::exp(exact_c * (static_cast<double>(z) - static_cast<double>(d))));
            const double error = 1.01 * (2 * exact_c * kUnit + 2 * kExp2Error + kUnit);
            const auto got = static_cast<double>(visibility(z, d));
            if (!(std::fabs(got - expected) <= error * expected + 0x1p-126))
                FAIL(fmt::format("case {}: c {:a} z {:a} d {:a}: {:a}, expected {:a}", i, c, z, d, got, expected));
        }
    }
}

TEST_CASE("esm bounds the share of occluders at or behind the receiver", "[salvi08]") {
    // Markov: E(e^{cz}) / e^{cd} >= P(z >= d). In double; the sum of four, its terms and the quotient round.
    for (int i = 0; i < 5000; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const Distribution d = random_distribution(random);
        const float c = random.in(0.0f, 88.0f);
        const EsmEncoding encoding{.exponent2 = positive_warp(c).exponent2};
        const double t = random.chance(2) ? d.depth[1] : random.integer(0, 65536) * 0x1p-16;
        const double filtered = d.mean([&](double z) { return lane(encoding.encode(Double(z)).x, 0); });
        const double got = lane(exponential_visibility(Double(filtered), Double(t), encoding), 0);
        const double beyond = d.mean([&](double z) { return z >= t ? 1.0 : 0.0; });
        if (!(got >= beyond * (1 - 0x1p-48) && got <= 1.0))
            FAIL(fmt::format("case {}: c {:a} t {:a}: {:a}, share {:a}", i, c, t, got, beyond));
    }
}
