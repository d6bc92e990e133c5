// UNORM and fixed-point conversions against exact integers. D3D11.3 3.2.3.5, 3.2.3.6, 3.2.4.1
#include "sim/denormals.h"
#include "sim/fixed.h"
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/oracle/texture.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;

namespace {

/// Scalar, lanes and double lanes of one value against the integer oracle.
void check_unorm(float x, int bits) {
    const std::uint32_t expected = oracle::unorm_code(x, bits);
    const std::uint32_t scalar = unorm_from_float(x, bits);
    const auto lanes = static_cast<std::uint32_t>(lane(unorm_from_float(Float(x), bits), kLanes - 1));
    const auto doubles = static_cast<std::uint32_t>(lane(unorm_from_float(Double(x), bits), 0));
    if (scalar != expected || lanes != expected || doubles != expected)
        FAIL(fmt::format("{:a} to {} bits: scalar {:#x}, lanes {:#x}, double {:#x}, expected {:#x}", x, bits, scalar, lanes,
                         doubles, expected));
}

/// code / (2^bits - 1) to nearest even, checked by cross-multiplication: no float nearer, ties even.
bool is_nearest(float x, std::uint32_t code, int bits) {
    const long double exact = static_cast<long double>(code) / static_cast<long double>((1u << bits) - 1u);
    const auto distance = [&](float y) { return std::fabs(static_cast<long double>(y) - exact); };
    return distance(x) <= distance(std::nextafter(x, 2.0f)) && distance(x) <= distance(std::nextafter(x, -2.0f));
}

}  // namespace

TEST_CASE("every code of 8, 16 and 24 bits round-trips through its nearest float", "[fixed][3.2.3.5][19.1.2]") {
    for (const int bits : {1, 2, 8, 10, 16, 24}) {
        const std::uint32_t last = (1u << bits) - 1u;
        for (std::uint32_t base = 0; base <= last; base += kLanes) {
            const Int codes = min(Int(static_cast<int>(base)) + lane_index(), Int(static_cast<int>(last)));
            const Float values = float_from_unorm(codes, bits);
            const auto back = unorm_from_float(values, bits).lanes();
            const auto floats = values.lanes();
            const auto ints = codes.lanes();
            for (std::size_t i = 0; i < kLanes; ++i) {
                const auto code = static_cast<std::uint32_t>(ints[i]);
                const float scalar = float_from_unorm(code, bits);
                if (back[i] != ints[i] || scalar != floats[i] || unorm_from_float(scalar, bits) != code ||
                    !is_nearest(scalar, code, bits))
                    FAIL(fmt::format("code {:#x} of {} bits: {:a} (lanes {:a}), back {:#x}", code, bits, scalar, floats[i],
                                     back[i]));
            }
        }
    }
}

TEST_CASE("every rounding boundary of 8 and 16 bits", "[fixed][3.2.3.6]") {
    for (const int bits : {8, 16}) {
        const std::uint32_t last = (1u << bits) - 1u;
        for (std::uint32_t n = 0; n < last; ++n) {
            // The real boundary (n + 1/2) / last lies between two floats or on one.
            float x = static_cast<float>((static_cast<double>(n) + 0.5) / last);
            x = std::nextafter(std::nextafter(x, -1.0f), -1.0f);
            for (int k = 0; k < 5; ++k, x = std::nextafter(x, 2.0f)) check_unorm(x, bits);
        }
    }
}

TEST_CASE("boundaries of 24 bits and special values", "[fixed][3.2.3.6]") {
    oracle::Random random(3);
    for (int i = 0; i < 300000; ++i) {
        const auto n = static_cast<std::uint32_t>(random.between(0, 0xfffffe));
        float x = static_cast<float>((static_cast<double>(n) + 0.5) / 16777215.0);
        check_unorm(x, 24);
        check_unorm(std::nextafter(x, 2.0f), 24);
        check_unorm(random.any_float(), random.integer(1, 24));
        check_unorm(random.in(-0.1f, 1.1f), random.integer(1, 24));
    }
    for (const int bits : {8, 16, 24})
        for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, HUGE_VALF, -HUGE_VALF, std::nanf(""), -std::nanf(""), 0x1p-149f,
                              0x1.fffffep-1f, 0x1.000002p+0f, 0.5f})
            check_unorm(x, bits);
}

TEST_CASE("fixed point rounds to nearest even and saturates", "[fixed][3.2.4.1]") {
    oracle::Random random(4);
    for (int i = 0; i < 200000; ++i) {
        const int bits = 8;
        const float x =
            random.chance(2) ? static_cast<float>(random.integer(-100000, 100000)) / 512.0f : random.in(-16384.0f, 16384.0f);
        const std::int64_t expected = oracle::fixed8(x);
        if (fixed_from_float(static_cast<double>(x), bits) != expected)
            FAIL(fmt::format("{:a}: {}, expected {}", x, fixed_from_float(static_cast<double>(x), bits), expected));
    }
    CHECK(fixed_from_float(std::nan(""), 8) == 0);
    CHECK(fixed_from_float(1e30, 8) == INT32_MAX);
    CHECK(fixed_from_float(HUGE_VAL, 8) == INT32_MAX);
    CHECK(fixed_from_float(-HUGE_VAL, 8) <= -INT32_MAX);
    CHECK(fixed_from_float(0.5, 0) == 0);
    CHECK(fixed_from_float(1.5, 0) == 2);
    CHECK(fixed_from_float(-2.5, 0) == -2);
}
