// D3D11.3 3.1.5, 3.1.6, 3.2.2: 16, 11 and 10 bit floats: every code to binary32, and both sides of every code and midpoint
// back.
#include "sim/half.h"
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/codec.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// A float of 5 exponent bits and `mantissa` fraction bits, without sign: rules (a) to (e) of 3.1.5 and 3.1.6.
double value_of(std::uint32_t code, int mantissa) {
    const int exponent = static_cast<int>(code >> mantissa);
    const auto fraction = static_cast<double>(code & ((1u << mantissa) - 1u)) / static_cast<double>(1 << mantissa);
    if (exponent == 31) return fraction != 0 ? std::nan("") : HUGE_VAL;
    if (exponent == 0) return std::ldexp(fraction, -14);
    return std::ldexp(1 + fraction, exponent - 15);
}

constexpr std::uint32_t infinity_code(int mantissa) { return 31u << mantissa; }
bool is_nan_code(std::uint32_t code, int mantissa) { return code > infinity_code(mantissa) && code < 32u << mantissa; }

/// The code of x >= 0 by 3.2.2 ("the maximum representable ... value results, NOT including signed infinity") or to nearest
/// even, where what rounds to 2^16 is infinity. Compares with the values of the codes, nothing else.
std::uint32_t narrowed(long double x, int mantissa, Narrowing narrowing) {
    const std::uint32_t infinity = infinity_code(mantissa);
    if (x == static_cast<long double>(HUGE_VAL)) return infinity;
    // The largest code whose value is not above x.
    std::uint32_t code = 0;
    for (std::uint32_t step = 1u << (mantissa + 4); step > 0; step /= 2)
        if (code + step < infinity && static_cast<long double>(value_of(code + step, mantissa)) <= x) code += step;
    if (narrowing == Narrowing::TowardZero) return code;
    const auto below = static_cast<long double>(value_of(code, mantissa));
    const long double above = code + 1 == infinity ? 65536.0L : static_cast<long double>(value_of(code + 1, mantissa));
    const long double middle = (below + above) / 2;
    return x > middle || (x == middle && code % 2 != 0) ? code + 1 : code;
}

/// Every finite code's value, the midpoint to the next and 2^16, each with its neighbours in Scalar.
template <class Scalar>
std::vector<Scalar> neighbourhoods(int mantissa) {
    std::vector<Scalar> values;
    const auto add = [&](double x) {
        const auto center = static_cast<Scalar>(x);
        for (const Scalar y : {center, std::nextafter(center, Scalar(-1)), std::nextafter(center, Scalar(HUGE_VALF))})
            values.push_back(y);
    };
    const std::uint32_t infinity = infinity_code(mantissa);
    for (std::uint32_t code = 0; code < infinity; ++code) {
        const double here = value_of(code, mantissa);
        const double next = code + 1 == infinity ? 65536.0 : value_of(code + 1, mantissa);
        add(here);
        add((here + next) / 2);
        if constexpr (std::is_same_v<Scalar, double>) {
            // So near the midpoint that binary32 would call it a tie.
            add((here + next) / 2 * (1 + 0x1p-50));
            add((here + next) / 2 * (1 - 0x1p-50));
        }
    }
    for (const double x : {65536.0, 1e10, 3e38, 0x1p-126, 0x1p-149, 0x1p-127, 1e-40}) add(x);
    if constexpr (std::is_same_v<Scalar, double>)
        for (const double x : {1e300, 1e-300, 1e-310, 0x1p-150, 3.5e38}) values.push_back(x);
    values.push_back(Scalar(HUGE_VALF));
    return values;
}

/// Applies `convert` (lanes of Real to codes) to all values.
template <class Real, class Convert>
std::vector<std::uint32_t> converted(const std::vector<typename Real::Scalar>& values, const Convert& convert) {
    std::vector<std::uint32_t> codes;
    for (std::size_t first = 0; first < values.size(); first += kLanes) {
        std::array<typename Real::Scalar, kLanes> wave;
        for (std::size_t l = 0; l < wave.size(); ++l) wave[l] = values[std::min(first + l, values.size() - 1)];
        const auto lanes = Int(convert(Real::load(wave.data()))).lanes();
        for (std::size_t l = 0; l < wave.size() && first + l < values.size(); ++l)
            codes.push_back(static_cast<std::uint32_t>(lanes[l]));
    }
    return codes;
}

/// An unsigned format: what is below 0 becomes 0.
template <class Real, class Convert>
void check_unsigned(int mantissa, Narrowing narrowing, const Convert& convert) {
    using Scalar = typename Real::Scalar;
    std::vector<Scalar> values = neighbourhoods<Scalar>(mantissa);
    const std::size_t positive = values.size();
    for (std::size_t i = 0; i < positive; i += 7) values.push_back(-values[i]);
    for (const Scalar x : {-Scalar(HUGE_VALF), Scalar(-1), Scalar(-0.0), Scalar(-1e-40)}) values.push_back(x);
    values.push_back(std::numeric_limits<Scalar>::quiet_NaN());
    values.push_back(-std::numeric_limits<Scalar>::quiet_NaN());
    const auto codes = converted<Real>(values, convert);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Scalar x = values[i];
        const bool right = std::isnan(x)
                               ? is_nan_code(codes[i], mantissa)
                               : codes[i] == (x > 0 ? narrowed(static_cast<long double>(x), mantissa, narrowing) : 0u);
        if (!right)
            FAIL(fmt::format("{} fraction bits {}: {:a} became {:#x} = {:a}, expected {:#x}", mantissa, name_of(narrowing), x,
                             codes[i], value_of(codes[i], mantissa),
                             x > 0 ? narrowed(static_cast<long double>(x), mantissa, narrowing) : 0u));
    }
}

/// A half: the sign is kept, of zeros too.
template <class Real, class Convert>
void check_half(Narrowing narrowing, const Convert& convert) {
    using Scalar = typename Real::Scalar;
    std::vector<Scalar> values = neighbourhoods<Scalar>(10);
    const std::size_t positive = values.size();
    for (std::size_t i = 0; i < positive; ++i) values.push_back(-values[i]);
    values.push_back(std::numeric_limits<Scalar>::quiet_NaN());
    const auto codes = converted<Real>(values, convert);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Scalar x = values[i];
        const std::uint32_t sign = std::signbit(x) ? 0x8000u : 0u;
        const bool right = std::isnan(x) ? is_nan_code(codes[i] & 0x7fffu, 10)
                                         : codes[i] == (sign | narrowed(std::fabs(static_cast<long double>(x)), 10, narrowing));
        if (!right)
            FAIL(fmt::format("half {}: {:a} became {:#06x}, expected {:#06x}", name_of(narrowing), x, codes[i],
                             sign | narrowed(std::fabs(static_cast<long double>(x)), 10, narrowing)));
    }
}

constexpr std::array kNarrowings{Narrowing::TowardZero, Narrowing::NearestEven};

/// Bit-equal, or both NaN.
bool same(float got, double expected) {
    if (std::isnan(expected)) return std::isnan(got);
    return static_cast<double>(got) == expected && std::signbit(got) == std::signbit(expected);
}

}  // namespace

TEST_CASE("all 65536 halfs are the numbers their bits say", "[3.1.5][3.2.2]") {
    for (const bool flush : {false, true}) {
        const DenormalScope denormals(flush);  // half denormals are normal in binary32: nothing may flush them
        for (std::uint32_t code = 0; code < 65536; ++code) {
            const double magnitude = value_of(code & 0x7fffu, 10);
            const double expected = (code & 0x8000u) != 0 ? -magnitude : magnitude;
            const float on_lanes = lane(float_from_half_bits(Int(static_cast<std::int32_t>(code))), 0);
            const float scalar = float_from_half(Half{static_cast<std::uint16_t>(code)});
            if (!same(on_lanes, expected) || !same(scalar, expected))
                FAIL(fmt::format("{:#06x}: {:a} and {:a}, expected {:a}, flush {}", code, on_lanes, scalar, expected, flush));
        }
    }
}

TEMPLATE_TEST_CASE("all codes of 16, 11 and 10 bit floats sample as their numbers", "[3.1.5][3.1.6]", Float, Double) {
    const Sampler nearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    std::vector<Coordinate> coordinates;
    for (int i = 0; i < 65536; ++i)
        coordinates.push_back({(static_cast<float>(i % 256) + 0.5f) / 256.0f, (static_cast<float>(i / 256) + 0.5f) / 256.0f});
    std::vector<std::uint32_t> halfs;
    std::vector<std::uint32_t> packed_codes;
    for (std::uint32_t i = 0; i < 65536; ++i) {
        halfs.push_back(i);
        packed_codes.push_back(i & 0x7ffu);
        packed_codes.push_back((i * 5 + 3) & 0x7ffu);
        packed_codes.push_back((i * 3 + 1) & 0x3ffu);
    }
    const auto got = sample_all<TestType>(texture_of(Format::R16Float, 256, 256, halfs), nearest, Profile{}, coordinates);
    const auto small =
        sample_all<TestType>(texture_of(Format::R11G11B10Float, 256, 256, packed_codes), nearest, Profile{}, coordinates);
    for (std::uint32_t i = 0; i < 65536; ++i) {
        const double magnitude = value_of(i & 0x7fffu, 10);
        if (!same(static_cast<float>(got[i][0]), (i & 0x8000u) != 0 ? -magnitude : magnitude))
            FAIL(fmt::format("half {:#06x}: {:a}", i, got[i][0]));
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t code = packed_codes[3 * i + c];
            if (!same(static_cast<float>(small[i][c]), value_of(code, c < 2 ? 6 : 5)))
                FAIL(fmt::format("component {} code {:#x}: {:a}, expected {:a}", c, code, small[i][c],
                                 value_of(code, c < 2 ? 6 : 5)));
        }
        if (small[i][3] != 1) FAIL(fmt::format("alpha of texel {}: {:a}", i, small[i][3]));
    }
}

TEST_CASE("floats become halfs, both sides of every code and midpoint", "[3.1.5][3.2.2]") {
    for (const bool flush : {false, true})
        for (const Narrowing narrowing : kNarrowings) {
            const DenormalScope denormals(flush);
            check_half<Float>(narrowing, [&](Float x) { return half_bits_from_float(x, narrowing); });
            check_half<Float>(narrowing,
                              [&](Float x) { return Codec<ComponentType::Float16, 1>::code_of<Float>(x, 0, narrowing); });
            check_half<Float>(narrowing, [&](Float x) {
                std::array<std::int32_t, kLanes> codes;
                for (std::size_t l = 0; l < codes.size(); ++l) codes[l] = half_from_float(x.lanes()[l], narrowing).bits;
                return Int::load(codes.data());
            });
        }
}

TEST_CASE("floats become 11 and 10 bit floats, both sides of every code and midpoint", "[3.1.6][3.2.2]") {
    for (const bool flush : {false, true})
        for (const Narrowing narrowing : kNarrowings) {
            const DenormalScope denormals(flush);
            using Packed = Codec<ComponentType::Float11, 3>;
            check_unsigned<Float>(6, narrowing, [&](Float x) { return unsigned_float_bits_from_float<6>(x, narrowing); });
            check_unsigned<Float>(5, narrowing, [&](Float x) { return unsigned_float_bits_from_float<5>(x, narrowing); });
            check_unsigned<Float>(6, narrowing, [&](Float x) { return Packed::code_of<Float>(x, 1, narrowing); });
            check_unsigned<Float>(5, narrowing, [&](Float x) { return Packed::code_of<Float>(x, 2, narrowing); });
        }
}

TEST_CASE("doubles become small floats with one rounding", "[3.1.5][3.1.6][3.2.2]") {
    // Through binary32 a double just above a midpoint would become the midpoint, and then the even neighbour below.
    for (const Narrowing narrowing : kNarrowings) {
        check_half<Double>(narrowing,
                           [&](const Double& x) { return Codec<ComponentType::Float16, 1>::code_of<Double>(x, 0, narrowing); });
        using Packed = Codec<ComponentType::Float11, 3>;
        check_unsigned<Double>(6, narrowing, [&](const Double& x) { return Packed::code_of<Double>(x, 0, narrowing); });
        check_unsigned<Double>(5, narrowing, [&](const Double& x) { return Packed::code_of<Double>(x, 2, narrowing); });
    }
    const auto half = [](double x, Narrowing narrowing) {
        return lane(Codec<ComponentType::Float16, 1>::code_of<Double>(Double(x), 0, narrowing), 0);
    };
    CHECK(half((1 + 0x1p-11) * (1 + 0x1p-50), Narrowing::NearestEven) == 0x3c01);
    CHECK(half(1 + 0x1p-11, Narrowing::NearestEven) == 0x3c00);
    CHECK(half((1 + 0x1p-11) * (1 + 0x1p-50), Narrowing::TowardZero) == 0x3c00);
    CHECK(half(1 - 0x1p-50, Narrowing::TowardZero) == 0x3bff);
    CHECK(half(0x1p-25 * (1 + 0x1p-50), Narrowing::NearestEven) == 0x0001);
    CHECK(half(0x1p-25, Narrowing::NearestEven) == 0x0000);
}

TEST_CASE("every code survives the way to float and back in either rounding", "[3.2.2][19.1.2]") {
    const auto check = [](int mantissa, std::uint32_t codes, const auto& widen, const auto& narrow) {
        for (std::uint32_t code = 0; code < codes; ++code)
            for (const Narrowing narrowing : kNarrowings) {
                const auto back =
                    static_cast<std::uint32_t>(lane(narrow(widen(Int(static_cast<std::int32_t>(code))), narrowing), 0));
                const std::uint32_t magnitude = code & ((32u << mantissa) - 1u);
                const bool right =
                    is_nan_code(magnitude, mantissa) ? is_nan_code(back & ((32u << mantissa) - 1u), mantissa) : back == code;
                if (!right) FAIL(fmt::format("{} fraction bits: {:#x} came back as {:#x}", mantissa, code, back));
            }
    };
    using Half16 = Codec<ComponentType::Float16, 1>;
    using Packed = Codec<ComponentType::Float11, 3>;
    check(
        10, 65536, [](Int c) { return Half16::number<Float>(c, 0); },
        [](Float x, Narrowing n) { return Half16::code_of<Float>(x, 0, n); });
    check(
        10, 65536, [](Int c) { return Half16::number<Double>(c, 0); },
        [](const Double& x, Narrowing n) { return Half16::code_of<Double>(x, 0, n); });
    check(
        6, 2048, [](Int c) { return Packed::number<Float>(c, 0); },
        [](Float x, Narrowing n) { return Packed::code_of<Float>(x, 0, n); });
    check(
        5, 1024, [](Int c) { return Packed::number<Float>(c, 2); },
        [](Float x, Narrowing n) { return Packed::code_of<Float>(x, 2, n); });
    check(
        6, 2048, [](Int c) { return Packed::number<Double>(c, 1); },
        [](const Double& x, Narrowing n) { return Packed::code_of<Double>(x, 1, n); });
    check(
        5, 1024, [](Int c) { return Packed::number<Double>(c, 2); },
        [](const Double& x, Narrowing n) { return Packed::code_of<Double>(x, 2, n); });
}

TEST_CASE("the finite limits of 3.2.2", "[3.2.2]") {
    using Packed = Codec<ComponentType::Float11, 3>;
    const auto small = [](float x, std::size_t component, Narrowing narrowing) {
        return lane(Packed::code_of<Float>(Float(x), component, narrowing), 0);
    };
    // Largest 11-bit float: 65024; 10-bit: 64512.
    CHECK(small(65024.0f, 0, Narrowing::TowardZero) == 0x7bf);
    CHECK(small(64512.0f, 2, Narrowing::TowardZero) == 0x3df);
    for (const float x : {65536.0f, 1e30f, 3.4e38f}) {
        CHECK(small(x, 0, Narrowing::TowardZero) == 0x7bf);
        CHECK(small(x, 2, Narrowing::TowardZero) == 0x3df);
        CHECK(small(x, 0, Narrowing::NearestEven) == 0x7c0);
        CHECK(small(x, 2, Narrowing::NearestEven) == 0x3e0);
    }
    // Half a step above the largest is a tie, whose even side is infinity.
    CHECK(small(65280.0f, 0, Narrowing::NearestEven) == 0x7c0);
    CHECK(small(std::nextafter(65280.0f, 0.0f), 0, Narrowing::NearestEven) == 0x7bf);
    CHECK(small(HUGE_VALF, 0, Narrowing::TowardZero) == 0x7c0);
    CHECK(small(-HUGE_VALF, 0, Narrowing::TowardZero) == 0);
    CHECK(small(-0.0f, 1, Narrowing::NearestEven) == 0);
    // Smallest denormals: 2^-20 and 2^-19.
    CHECK(small(0x1p-20f, 0, Narrowing::TowardZero) == 1);
    CHECK(small(0x1p-19f, 2, Narrowing::TowardZero) == 1);
    CHECK(small(std::nextafter(0x1p-20f, 0.0f), 0, Narrowing::TowardZero) == 0);
    CHECK(small(0x1p-21f, 0, Narrowing::NearestEven) == 0);
    CHECK(small(std::nextafter(0x1p-21f, 1.0f), 0, Narrowing::NearestEven) == 1);
}
