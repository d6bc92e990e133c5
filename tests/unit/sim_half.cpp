// Half conversions against the processor's own (F16C), or against an independent reference where it has none.
// D3D11.3 3.1.5, 3.2.2
#include "sim/denormals.h"
#include "sim/half.h"
#include "sim/parallel.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texture.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <atomic>
#include <bit>
#include <mutex>

#if defined(__F16C__)
#include <immintrin.h>
#endif

using namespace gnomon;

namespace {

/// Reference conversion from the definition: the largest half not above |x|, then the neighbour if the mode asks for it.
/// Walks the 31744 finite magnitudes by bisection; halves order as their bits do.
std::uint16_t reference_half(float x, Narrowing narrowing) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000u);
    if (x != x) return static_cast<std::uint16_t>(sign | 0x7e00u | (bits >> 13 & 0x3ffu));
    const double magnitude = std::fabs(static_cast<double>(x));
    if (magnitude == HUGE_VAL) return static_cast<std::uint16_t>(sign | 0x7c00u);
    std::uint32_t low = 0;  // the largest half <= magnitude
    std::uint32_t high = 0x7c00u;
    while (high - low > 1) {
        const std::uint32_t middle = (low + high) / 2;
        (oracle::half_value(middle) <= magnitude ? low : high) = middle;
    }
    if (narrowing == Narrowing::TowardZero) return static_cast<std::uint16_t>(sign | low);
    // The next number above 65504 would be 65536: infinity takes its place.
    const double below = oracle::half_value(low);
    const double above = low + 1 == 0x7c00u ? 65536.0 : oracle::half_value(low + 1);
    const double to_below = magnitude - below;
    const double to_above = above - magnitude;
    const bool up = to_above < to_below || (to_above == to_below && low % 2 == 1);
    return static_cast<std::uint16_t>(sign | (low + (up ? 1u : 0u)));
}

constexpr bool kHardware =
#if defined(__F16C__)
    true;
#else
    false;
#endif

/// Eight conversions at once by the processor.
void expected_halves(const float* x, Narrowing narrowing, std::uint16_t* out) {
#if defined(__F16C__)
    const __m256 v = _mm256_loadu_ps(x);
    const __m128i h = narrowing == Narrowing::TowardZero ? _mm256_cvtps_ph(v, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC)
                                                         : _mm256_cvtps_ph(v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out), h);
#else
    for (int i = 0; i < 8; ++i) out[i] = reference_half(x[i], narrowing);
#endif
}

struct Mismatch {
    std::mutex mutex;
    std::atomic<bool> found = false;
    std::string text;

    void report(std::uint32_t bits, Narrowing narrowing, const char* what, std::uint32_t got, std::uint32_t expected) {
        const std::lock_guard lock(mutex);
        found = true;
        text = fmt::format("{} {} of {:#010x} ({:a}): {:#06x}, expected {:#06x}", what, name_of_mode(narrowing), bits,
                           std::bit_cast<float>(bits), got, expected);
    }
    static const char* name_of_mode(Narrowing n) { return n == Narrowing::TowardZero ? "toward zero" : "nearest even"; }
};

/// `count` floats from bits first, first + stride, ...: scalar and lanes against the expectation.
void check_block(std::uint32_t first, std::uint32_t stride, std::uint32_t count, Mismatch& mismatch) {
    for (const Narrowing narrowing : {Narrowing::TowardZero, Narrowing::NearestEven}) {
        for (std::uint32_t i = 0; i < count; i += 16) {
            std::array<float, 16> x;
            std::array<std::uint16_t, 16> expected;
            for (std::uint32_t k = 0; k < 16; ++k) x[k] = std::bit_cast<float>(first + (i + k) * stride);
            expected_halves(x.data(), narrowing, expected.data());
            expected_halves(x.data() + 8, narrowing, expected.data() + 8);
            for (std::uint32_t l = 0; l < 16; l += kLanes) {
                const auto lanes = half_bits_from_float(Float::load(x.data() + l), narrowing).lanes();
                for (std::uint32_t k = 0; k < kLanes; ++k)
                    if (static_cast<std::uint32_t>(lanes[k]) != expected[l + k]) [[unlikely]]
                        mismatch.report(std::bit_cast<std::uint32_t>(x[l + k]), narrowing, "lanes",
                                        static_cast<std::uint32_t>(lanes[k]), expected[l + k]);
            }
            for (std::uint32_t k = 0; k < 16; ++k) {
                const Half half = half_from_float(x[k], narrowing);
                if (half.bits != expected[k]) [[unlikely]]
                    mismatch.report(std::bit_cast<std::uint32_t>(x[k]), narrowing, "scalar", half.bits, expected[k]);
            }
        }
    }
}

}  // namespace

TEST_CASE("every half becomes its float", "[half][3.1.5]") {
    if (!kHardware) WARN("no F16C here: compared with the definition only");
    for (const bool flush : {false, true}) {
        const DenormalScope denormals(flush);
        for (std::uint32_t h = 0; h < 65536; h += kLanes) {
            const auto lanes = float_from_half_bits(Int(static_cast<int>(h)) + lane_index()).lanes();
            for (std::uint32_t k = 0; k < kLanes; ++k) {
                const std::uint32_t bits = h + k;
                const float scalar = float_from_half(Half{static_cast<std::uint16_t>(bits)});
                const double value = oracle::half_value(bits);
                const bool nan = (bits & 0x7fffu) > 0x7c00u;
                // A NaN keeps sign and payload and is quiet.
                const std::uint32_t expected = nan ? (bits & 0x8000u) << 16 | 0x7fc00000u | (bits & 0x3ffu) << 13
                                                   : std::bit_cast<std::uint32_t>(static_cast<float>(value));
                if (std::bit_cast<std::uint32_t>(scalar) != expected || std::bit_cast<std::uint32_t>(lanes[k]) != expected)
                    FAIL(fmt::format("half {:#06x}: scalar {:#010x}, lanes {:#010x}, expected {:#010x}; flush {}", bits,
                                     std::bit_cast<std::uint32_t>(scalar), std::bit_cast<std::uint32_t>(lanes[k]), expected,
                                     flush));
#if defined(__F16C__)
                const float hardware = _mm_cvtss_f32(_mm_cvtph_ps(_mm_cvtsi32_si128(static_cast<int>(bits))));
                if (std::bit_cast<std::uint32_t>(hardware) != expected)
                    FAIL(fmt::format("half {:#06x}: F16C says {:a}", bits, hardware));
#endif
            }
        }
    }
}

TEST_CASE("every half survives the way to float and back", "[half]") {
    for (std::uint32_t h = 0; h < 65536; ++h) {
        const bool nan = (h & 0x7fffu) > 0x7c00u;
        const std::uint32_t expected = nan ? h | 0x0200u : h;
        for (const Narrowing narrowing : {Narrowing::TowardZero, Narrowing::NearestEven})
            REQUIRE(half_from_float(float_from_half(Half{static_cast<std::uint16_t>(h)}), narrowing).bits == expected);
    }
}

TEST_CASE("float to half: boundaries, listed as bits", "[half][3.2.2]") {
    struct Case {
        std::uint32_t bits;
        std::uint16_t toward_zero, nearest;
    };
    for (const Case& c : std::vector<Case>{{0x00000000, 0x0000, 0x0000},
                                           {0x80000000, 0x8000, 0x8000},
                                           {0x33000000, 0x0000, 0x0000},  // 2^-25: the tie between 0 and 2^-24
                                           {0x33000001, 0x0000, 0x0001},
                                           {0x33c00000, 0x0001, 0x0002},  // 1.5 * 2^-24: a tie, up to even
                                           {0x387fc000, 0x03ff, 0x03ff},  // largest denormal
                                           {0x387fe000, 0x03ff, 0x0400},  // tie to the smallest normal
                                           {0x38800000, 0x0400, 0x0400},
                                           {0x477fe000, 0x7bff, 0x7bff},  // 65504
                                           {0x477fefff, 0x7bff, 0x7bff},
                                           {0x477ff000, 0x7bff, 0x7c00},  // 65520: ties to infinity
                                           {0x7f7fffff, 0x7bff, 0x7c00},
                                           {0x7f800000, 0x7c00, 0x7c00},
                                           {0xff800000, 0xfc00, 0xfc00},
                                           {0x7f800001, 0x7e00, 0x7e00},  // signalling NaN becomes quiet
                                           {0xffc02000, 0xfe01, 0xfe01},
                                           {0x00000001, 0x0000, 0x0000}}) {
        const auto x = std::bit_cast<float>(c.bits);
        INFO(fmt::format("{:#010x}", c.bits));
        CHECK(half_from_float(x, Narrowing::TowardZero).bits == c.toward_zero);
        CHECK(half_from_float(x, Narrowing::NearestEven).bits == c.nearest);
        CHECK(reference_half(x, Narrowing::TowardZero) == c.toward_zero);
        CHECK(reference_half(x, Narrowing::NearestEven) == c.nearest);
    }
}

TEST_CASE("a sample of all floats to half, both roundings", "[half][3.2.2]") {
    Mismatch mismatch;
    check_block(0, 16381, 262144 + 32, mismatch);      // all exponents, odd stride
    check_block(0x33000000u - 64, 1, 4096, mismatch);  // into the denormals
    check_block(0x38800000u - 65536, 1, 131072, mismatch);
    check_block(0x477f0000u, 1, 131072, mismatch);  // overflow
    check_block(0xff7fff00u, 1, 1024, mismatch);
    CHECK_FALSE(mismatch.found);
    if (mismatch.found) FAIL(mismatch.text);

    // The independent reference agrees with whatever was the expectation.
    oracle::Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const float x = random.chance(2) ? random.any_float() : std::ldexp(random.in(-2.0f, 2.0f), random.integer(-26, 16));
        for (const Narrowing narrowing : {Narrowing::TowardZero, Narrowing::NearestEven})
            if (half_from_float(x, narrowing).bits != reference_half(x, narrowing))
                FAIL(fmt::format("{:a}: {:#06x}, by definition {:#06x}", x, half_from_float(x, narrowing).bits,
                                 reference_half(x, narrowing)));
    }
}

TEST_CASE("narrowing is the same while denormals are flushed", "[half][3.1.3.2]") {
    const DenormalScope denormals(true);
    Mismatch mismatch;
    check_block(0, 65521, 65536, mismatch);
    check_block(0x33000000u - 64, 1, 4096, mismatch);
    if (mismatch.found) FAIL(mismatch.text);
    SUCCEED();
}

TEST_CASE("all floats to half, both roundings", "[.][sweep][half]") {
    if (!kHardware) {
        WARN("SKIPPED: no F16C here to compare all 2^32 floats with; the sample in the default run uses the definition");
        return;
    }
    Mismatch mismatch;
    Workers workers;
    workers.for_each(1u << 12, [&](std::size_t piece) {
        if (!mismatch.found) check_block(static_cast<std::uint32_t>(piece) << 20, 1, 1u << 20, mismatch);
    });
    if (mismatch.found) FAIL(mismatch.text);
    SUCCEED();
}
