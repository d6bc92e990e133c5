// Every operation of Float, Int, Mask and Double against its scalar meaning: NaN, infinities, zeros and denormals included.
#include "sim/denormals.h"
#include "sim/double_lanes.h"
#include "sim/lanes.h"
#include "tests/oracle/random.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

using namespace gnomon;

namespace {

const std::vector<float>& interesting() {
    static const std::vector<float> values = [] {
        std::vector<float> v{0.0f,
                             -0.0f,
                             1.0f,
                             -1.0f,
                             0.5f,
                             -0.5f,
                             1.5f,
                             2.5f,
                             -2.5f,
                             0x1p-126f,
                             -0x1p-126f,
                             0x1p-149f,
                             -0x1p-149f,
                             0x1.fffffcp-127f,
                             0x1.fffffep127f,
                             -0x1.fffffep127f,
                             HUGE_VALF,
                             -HUGE_VALF,
                             std::nanf(""),
                             -std::nanf(""),
                             std::bit_cast<float>(0x7f800001u),
                             2147483520.0f,
                             2147483648.0f,
                             -2147483648.0f,
                             4294967296.0f,
                             0x1p24f,
                             16777217.0f,
                             8388607.5f,
                             0.49999997f,
                             1e-30f};
        oracle::Random random(11);
        for (int i = 0; i < 98; ++i) v.push_back(random.any_float());
        return v;
    }();
    return values;
}

bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b); }
bool same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b);
}

std::uint32_t raw(float x) { return std::bit_cast<std::uint32_t>(x); }
std::uint64_t raw(double x) { return std::bit_cast<std::uint64_t>(x); }

/// op on lanes against op on scalars, for all pairs of interesting values; the pair differs in every lane.
template <class Lanes, class LaneOp, class ScalarOp>
void check_binary(const char* name, const LaneOp& op, const ScalarOp& expected) {
    using Scalar = typename Lanes::Scalar;
    const auto& values = interesting();
    const std::size_t n = values.size();
    for (std::size_t i = 0; i < n * n; i += kLanes) {
        std::array<Scalar, kLanes> a, b;
        for (std::size_t k = 0; k < kLanes; ++k) {
            a[k] = static_cast<Scalar>(values[std::min(i + k, n * n - 1) / n]);
            b[k] = static_cast<Scalar>(values[std::min(i + k, n * n - 1) % n]);
        }
        const auto got = op(Lanes::load(a.data()), Lanes::load(b.data()));
        for (std::size_t k = 0; k < kLanes; ++k) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(got)>, Mask>) {
                const bool bit = (got.bits() >> k & 1u) != 0;
                if (bit != expected(a[k], b[k])) FAIL(fmt::format("{} ({:#x}, {:#x}): {}", name, raw(a[k]), raw(b[k]), bit));
            } else {
                const Scalar value = got.lanes()[k];
                if (!same(value, expected(a[k], b[k])))
                    FAIL(fmt::format("{} ({:#x}, {:#x}): {:#x}, expected {:#x}", name, raw(a[k]), raw(b[k]), raw(value),
                                     raw(expected(a[k], b[k]))));
            }
        }
    }
}

template <class Lanes, class LaneOp, class ScalarOp>
void check_unary(const char* name, const LaneOp& op, const ScalarOp& expected) {
    check_binary<Lanes>(name, [&](const Lanes& a, const Lanes&) { return op(a); }, [&](auto a, auto) { return expected(a); });
}

/// The rules of min and max: a NaN operand gives the other; of two zeros, the second. D3D11.3 3.1.3.1
template <class Scalar>
Scalar rule_min(Scalar a, Scalar b) {
    if (b != b) return a;
    if (a != a) return b;
    return a < b ? a : b;
}
template <class Scalar>
Scalar rule_max(Scalar a, Scalar b) {
    if (b != b) return a;
    if (a != a) return b;
    return a > b ? a : b;
}

template <class Lanes>
void check_real_operations() {
    using S = typename Lanes::Scalar;
    check_binary<Lanes>("+", [](Lanes a, Lanes b) { return a + b; }, [](S a, S b) { return a + b; });
    check_binary<Lanes>("-", [](Lanes a, Lanes b) { return a - b; }, [](S a, S b) { return a - b; });
    check_binary<Lanes>("*", [](Lanes a, Lanes b) { return a * b; }, [](S a, S b) { return a * b; });
    check_binary<Lanes>("/", [](Lanes a, Lanes b) { return a / b; }, [](S a, S b) { return a / b; });
    check_binary<Lanes>("+=", [](Lanes a, Lanes b) { return a += b; }, [](S a, S b) { return a + b; });
    check_binary<Lanes>("-=", [](Lanes a, Lanes b) { return a -= b; }, [](S a, S b) { return a - b; });
    check_binary<Lanes>("*=", [](Lanes a, Lanes b) { return a *= b; }, [](S a, S b) { return a * b; });
    check_unary<Lanes>("negate", [](Lanes a) { return -a; }, [](S a) { return -a; });
    check_binary<Lanes>("<", [](Lanes a, Lanes b) { return a < b; }, [](S a, S b) { return a < b; });
    check_binary<Lanes>(">", [](Lanes a, Lanes b) { return a > b; }, [](S a, S b) { return a > b; });
    check_binary<Lanes>("<=", [](Lanes a, Lanes b) { return a <= b; }, [](S a, S b) { return a <= b; });
    check_binary<Lanes>(">=", [](Lanes a, Lanes b) { return a >= b; }, [](S a, S b) { return a >= b; });
    check_binary<Lanes>("==", [](Lanes a, Lanes b) { return a == b; }, [](S a, S b) { return a == b; });
    check_binary<Lanes>("!=", [](Lanes a, Lanes b) { return a != b; }, [](S a, S b) { return a != b; });
    check_binary<Lanes>("min", [](Lanes a, Lanes b) { return min(a, b); }, [](S a, S b) { return rule_min(a, b); });
    check_binary<Lanes>("max", [](Lanes a, Lanes b) { return max(a, b); }, [](S a, S b) { return rule_max(a, b); });
    check_unary<Lanes>("is_nan", [](Lanes a) { return is_nan(a); }, [](S a) { return a != a; });
    check_unary<Lanes>(
        "saturate", [](Lanes a) { return saturate(a); }, [](S a) { return a > S(0) ? (a < S(1) ? a : S(1)) : S(0); });
    check_unary<Lanes>("abs", [](Lanes a) { return abs(a); }, [](S a) { return std::fabs(a); });
    check_unary<Lanes>("sqrt", [](Lanes a) { return sqrt(a); }, [](S a) { return std::sqrt(a); });
    check_unary<Lanes>("floor", [](Lanes a) { return floor(a); }, [](S a) { return std::floor(a); });
}

std::int32_t truncated(float x, double limit) {
    if (x != x) return 0;
    const double d = static_cast<double>(x);
    return static_cast<std::int32_t>(d > limit ? limit : d < -limit ? -limit : d);
}

}  // namespace

TEST_CASE("Float operations are IEEE fp32, one rounding each", "[lanes]") {
    check_real_operations<Float>();
    check_unary<Float>("round", [](Float a) { return round(a); }, [](float a) { return std::nearbyint(a); });
    check_unary<Float>("bits", [](Float a) { return float_of_bits(bits_of(a)); }, [](float a) { return a; });
}

TEST_CASE("Double operations are IEEE fp64", "[lanes]") { check_real_operations<Double>(); }

TEST_CASE("operations flush denormals inside a DenormalScope and not outside", "[lanes][3.1.3.2]") {
    // Operands that the compiler cannot see through: it would fold x * 1 and constants without flushing.
    volatile float tiny = 0x1p-127f;
    volatile float one = 1.0f;
    volatile float half = 0.5f;
    volatile float least = 0x1p-126f;
    {
        const DenormalScope denormals(true);
        CHECK(raw(lane(Float(tiny) * Float(one), 0)) == 0u);
        CHECK(raw(lane(Float(-tiny) * Float(one), 0)) == 0x80000000u);      // keeps the sign
        CHECK(raw(lane(Float(least) * Float(half), 0)) == 0u);              // result
        CHECK(raw(lane(Float(tiny) + Float(least), 0)) == raw(0x1p-126f));  // operand
        CHECK(all(Float(tiny) == Float(0.0f * one)));
        CHECK(none(Float(tiny) > Float(0.0f * one)));
        CHECK(raw(lane(select(Mask(true), Float(tiny), Float(one)), 0)) == 0x00400000u);  // moves keep bits
        CHECK(lane(bits_of(Float(tiny)), 0) == 0x00400000);
        {
            const DenormalScope inner(false);
            CHECK(raw(lane(Float(tiny) * Float(one), 0)) == 0x00400000u);
        }
        CHECK(raw(lane(Float(tiny) * Float(one), 0)) == 0u);
    }
    CHECK(raw(lane(Float(tiny) * Float(one), 0)) == 0x00400000u);
}

TEST_CASE("select, masks and lane order", "[lanes]") {
    for (std::uint32_t pattern = 0; pattern <= kAllLanes; pattern += kLanes == 16 ? 7 : 1) {
        const Mask m = Mask::from_bits(pattern);
        REQUIRE(m.bits() == pattern);
        REQUIRE((!m).bits() == (~pattern & kAllLanes));
        REQUIRE(any(m) == (pattern != 0));
        REQUIRE(all(m) == (pattern == kAllLanes));
        REQUIRE(none(m) == (pattern == 0));
        const Mask other = Mask::from_bits(pattern * 0x9e37u & kAllLanes);
        REQUIRE((m & other).bits() == (pattern & other.bits()));
        REQUIRE((m | other).bits() == (pattern | other.bits()));
        REQUIRE((m ^ other).bits() == (pattern ^ other.bits()));
        const auto ints = select(m, lane_index(), Int(-1)).lanes();
        const auto floats = select(m, Float(lane_index()), Float(-1.0f)).lanes();
        const auto doubles = select(m, Double(lane_index()), Double(-1.0)).lanes();
        for (std::size_t i = 0; i < kLanes; ++i) {
            const int expected = (pattern >> i & 1u) != 0 ? static_cast<int>(i) : -1;
            REQUIRE(ints[i] == expected);
            REQUIRE(floats[i] == static_cast<float>(expected));
            REQUIRE(doubles[i] == expected);
        }
    }
    CHECK(Mask().bits() == 0);
    CHECK(Mask(true).bits() == kAllLanes);
    CHECK(Mask(false).bits() == 0);
}

TEST_CASE("Int operations wrap", "[lanes]") {
    oracle::Random random(5);
    std::vector<std::int32_t> values{0, 1, -1, INT32_MAX, INT32_MIN, 255, -256, 0x40000000};
    for (int i = 0; i < 56; ++i) values.push_back(static_cast<std::int32_t>(random.bits()));
    const auto u = [](std::int32_t x) { return static_cast<std::uint32_t>(x); };
    const auto s = [](std::uint32_t x) { return static_cast<std::int32_t>(x); };
    for (const std::int32_t a : values)
        for (const std::int32_t b : values) {
            INFO(a << " " << b);
            const int k = kLanes - 1;
            REQUIRE(lane(Int(a) + Int(b), k) == s(u(a) + u(b)));
            REQUIRE(lane(Int(a) - Int(b), k) == s(u(a) - u(b)));
            REQUIRE(lane(Int(a) * Int(b), k) == s(u(a) * u(b)));
            REQUIRE(lane(Int(a) & Int(b), k) == (a & b));
            REQUIRE(lane(Int(a) | Int(b), k) == (a | b));
            REQUIRE(lane(Int(a) ^ Int(b), k) == (a ^ b));
            REQUIRE(lane(~Int(a), k) == ~a);
            REQUIRE(all(Int(a) < Int(b)) == (a < b));
            REQUIRE(all(Int(a) > Int(b)) == (a > b));
            REQUIRE(all(Int(a) <= Int(b)) == (a <= b));
            REQUIRE(all(Int(a) >= Int(b)) == (a >= b));
            REQUIRE(all(Int(a) == Int(b)) == (a == b));
            REQUIRE(all(Int(a) != Int(b)) == (a != b));
            REQUIRE(lane(min(Int(a), Int(b)), k) == std::min(a, b));
            REQUIRE(lane(max(Int(a), Int(b)), k) == std::max(a, b));
            REQUIRE(lane(clamp(Int(a), Int(-100), Int(100)), k) == std::clamp(a, -100, 100));
            const int count = b & 31;
            REQUIRE(lane(shift_right(Int(a), count), k) == a >> count);
            REQUIRE(lane(shift_right_logical(Int(a), Int(count)), k) == s(u(a) >> count));
            REQUIRE(lane(shift_left(Int(a), Int(count)), k) == s(u(a) << count));
            REQUIRE(lane(shift_left<5>(Int(a)), k) == s(u(a) << 5));
            REQUIRE(lane(shift_right<5>(Int(a)), k) == a >> 5);
            REQUIRE(lane(shift_right_logical<5>(Int(a)), k) == s(u(a) >> 5));
            REQUIRE(lane(Float(Int(a)), k) == static_cast<float>(a));
            REQUIRE(lane(Double(Int(a)), k) == static_cast<double>(a));
        }
    alignas(64) const std::array<std::int32_t, 32> table{5, 7, 9, 11, 13};
    CHECK(lane(gather(table.data(), Int(3)), 0) == 11);
    CHECK(lane(gather_bits(reinterpret_cast<const std::byte*>(table.data()), Int(8)), kLanes - 1) == 9);
    CHECK(lane(gather_bits(reinterpret_cast<const std::byte*>(table.data()), Int(1)), 0) ==
          (7 << 24));  // unaligned, little endian
}

TEST_CASE("conversions to integers define NaN and overflow", "[lanes][3.2.4.1]") {
    for (const float x : interesting()) {
        INFO(fmt::format("{:a}", x));
        CHECK(lane(truncate_to_int(Float(x)), 0) == truncated(x, 2147483520.0));
        CHECK(lane(round_to_int(Float(x)), kLanes - 1) == truncated(std::nearbyint(x), 2147483520.0));
        if (x != x || std::fabs(x) < 2147483648.0f) {
            CHECK(lane(bounded_truncate_to_int(Float(x)), 0) == truncated(x, 2147483520.0));
            CHECK(lane(bounded_round_to_int(Float(x)), 0) == truncated(std::nearbyint(x), 2147483520.0));
        }
        CHECK(lane(truncate_to_int(Double(x)), 0) == truncated(x, 2147483647.0));
        CHECK(lane(bounded_round_to_int(Double(x)), 0) == truncated(std::nearbyint(x), 2147483647.0));
        const float back = lane(to_float(Double(x)), 0);
        CHECK(same(back, x));
    }
    CHECK(lane(to_float(Double(1.0 + 0x1p-24)), 0) == 1.0f);  // a tie to even
    CHECK(lane(to_float(Double(1.0 + 0x1.8p-23)), 0) == 1.0f + 0x1p-22f);
}
