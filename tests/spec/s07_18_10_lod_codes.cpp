// D3D11.3 7.18.10: every code of the fixed-point level of detail, its weight between two levels and the nearest level's ties.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr int kLevels = 7;

/// Level n of 64x64 texels is constant 2^16 n, so that a weight of any 16 bits reads off exactly.
Texture numbered_levels() {
    Texture texture({.format = Format::R32Float, .width = 64, .height = 64, .levels = kLevels});
    for (int level = 0; level < kLevels; ++level) {
        const std::vector<float> values(static_cast<std::size_t>(texture.width(level) * texture.height(level)),
                                        65536.0f * static_cast<float>(level));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

/// Steps of 2^-bits: nearest, ties to even, or toward minus infinity.
std::int64_t fixed_lod(double lod, int bits, FixedRounding rounding) {
    const double scaled = std::ldexp(lod, bits);
    double whole = std::floor(scaled);
    const double rest = scaled - whole;
    if (rounding == FixedRounding::NearestEven && (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0))) whole += 1;
    return static_cast<std::int64_t>(whole);
}

/// Level n + f / steps as a texel of numbered_levels.
template <class Real>
std::vector<typename Real::Scalar> values_at(const Texture& texture, const Sampler& sampler, const Profile& profile,
                                             const std::vector<double>& lods) {
    using Scalar = typename Real::Scalar;
    std::vector<Scalar> out;
    for (std::size_t first = 0; first < lods.size(); first += kLanes) {
        std::array<Scalar, kLanes> wave;
        for (std::size_t l = 0; l < wave.size(); ++l) wave[l] = static_cast<Scalar>(lods[std::min(first + l, lods.size() - 1)]);
        const Vec4<Real> color = sample(TextureView(texture), sampler, profile, Vec2<Real>{Real(0.3f), Real(0.6f)},
                                        LevelOfDetail<Real>(Real::load(wave.data())));
        for (int l = 0; l < kLanes && first + static_cast<std::size_t>(l) < lods.size(); ++l) out.push_back(lane(color.x, l));
    }
    return out;
}

std::int64_t limited(std::int64_t code, int bits) {
    return std::clamp<std::int64_t>(code, 0, std::int64_t{kLevels - 1} << bits);
}

/// floor(lod + 1/2), ceil(lod + 1/2) - 1, or the nearest even, of a code that is not negative.
std::int64_t nearest_of(std::int64_t code, int bits, MipTie tie) {
    const std::int64_t steps = std::int64_t{1} << bits;
    const std::int64_t half = steps / 2;
    switch (tie) {
        case MipTie::Up: return (code + half) / steps;
        case MipTie::Down: return (code + half - 1) / steps;
        case MipTie::Even: return code % steps == half ? (code / steps + 1) / 2 * 2 : (code + half) / steps;
    }
    return -1;
}

}  // namespace

TEST_CASE("every code between two levels is the weight of the coarser", "[7.18.10]") {
    const Texture texture = numbered_levels();
    for (const int bits : {4, 6, 8}) {
        Profile profile;
        profile.lod_fraction_bits = bits;
        for (int level = 0; level < kLevels - 1; ++level)
            for (int code = 0; code < 1 << bits; ++code) {
                const double lod = level + std::ldexp(code, -bits);
                const SampleRecord record = record_sample(texture, Sampler{.mip = MipFilter::Linear}, profile,
                                                          SampleRequest{.coordinate = {0.3, 0.6, 0}, .lod = lod});
                INFO("bits " << bits << " level " << level << " code " << code);
                REQUIRE(record.result[0] == 65536 * lod);
                const auto& levels = record.probes.at(0).levels;
                REQUIRE(levels.at(0).level == level);
                REQUIRE(levels.at(0).weight == 1 - std::ldexp(code, -bits));
                REQUIRE(levels.size() == (code == 0 ? 1u : 2u));
                if (code == 0) continue;
                REQUIRE(levels.at(1).level == level + 1);
                REQUIRE(levels.at(1).weight == std::ldexp(code, -bits));
            }
    }
}

TEMPLATE_TEST_CASE("levels of detail round to their codes as the profile says", "[7.18.10][3.2.4.1]", Float, Double) {
    const Texture texture = numbered_levels();
    std::vector<double> lods;
    for (int k = -2048; k < 7 * 1024; ++k) lods.push_back(k / 1024.0);  // quarters of the finest code
    oracle::Random random(3);
    for (int i = 0; i < 20000; ++i) lods.push_back(static_cast<double>(random.in(-1.0f, 8.0f)));
    for (const int bits : {1, 4, 6, 8})
        for (const FixedRounding rounding : {FixedRounding::NearestEven, FixedRounding::Truncate}) {
            Profile profile;
            profile.lod_fraction_bits = bits;
            profile.lod_rounding = rounding;
            const auto got = values_at<TestType>(texture, Sampler{.mip = MipFilter::Linear}, profile, lods);
            for (std::size_t i = 0; i < lods.size(); ++i) {
                const std::int64_t code = limited(fixed_lod(std::max(lods[i], 0.0), bits, rounding), bits);
                const double expected = std::ldexp(static_cast<double>(code), 16 - bits);
                if (static_cast<double>(got[i]) != expected)
                    FAIL(fmt::format("bits {} {} lod {:a}: {:a}, expected {:a}", bits, name_of(rounding), lods[i], got[i],
                                     expected));
            }
        }
}

TEMPLATE_TEST_CASE("an exact level of detail is the weight to the last bit", "[7.18.10]", Float, Double) {
    Texture texture({.format = Format::R32Float, .width = 2, .height = 2, .levels = 2});
    const float one = 1.0f;
    texture.set_level_bytes(1, std::as_bytes(std::span(&one, 1)).data(), 4);
    Profile profile;
    profile.lod_fraction_bits = kExactBits;
    std::vector<double> lods{0x1p-100, 0x1p-24, 1 - 0x1p-24, 0.5 - 0x1p-25};
    oracle::Random random(4);
    for (int i = 0; i < 5000; ++i) lods.push_back(static_cast<double>(random.unit()));
    const auto got = values_at<TestType>(texture, Sampler{.mip = MipFilter::Linear}, profile, lods);
    for (std::size_t i = 0; i < lods.size(); ++i)
        if (static_cast<double>(got[i]) != lods[i]) FAIL(fmt::format("lod {:a}: weight {:a}", lods[i], got[i]));
}

TEMPLATE_TEST_CASE("the nearest level of every code, with the tie as the profile says", "[7.18.10]", Float, Double) {
    const Texture texture = numbered_levels();
    for (const int bits : {1, 4, 6, 8})
        for (const FixedRounding rounding : {FixedRounding::NearestEven, FixedRounding::Truncate})
            for (const MipTie tie : {MipTie::Up, MipTie::Down, MipTie::Even}) {
                Profile profile;
                profile.lod_fraction_bits = bits;
                profile.lod_rounding = rounding;
                profile.mip_tie = tie;
                std::vector<double> lods;
                for (int k = -1024; k <= 8 * 1024; ++k) lods.push_back(k / 1024.0);
                const auto got = values_at<TestType>(texture, Sampler{.mip = MipFilter::Nearest}, profile, lods);
                for (std::size_t i = 0; i < lods.size(); ++i) {
                    const std::int64_t code = limited(fixed_lod(std::max(lods[i], 0.0), bits, rounding), bits);
                    const std::int64_t expected = std::clamp<std::int64_t>(nearest_of(code, bits, tie), 0, kLevels - 1);
                    if (static_cast<double>(got[i]) != 65536.0 * static_cast<double>(expected))
                        FAIL(fmt::format("bits {} {} tie {} lod {:a}: level {}, expected {}", bits, name_of(rounding),
                                         name_of(tie), lods[i], got[i] / 65536, expected));
                }
            }
}

TEMPLATE_TEST_CASE("an exact level of detail switches levels between neighbouring numbers", "[7.18.10]", Float, Double) {
    using Scalar = typename TestType::Scalar;
    const Texture texture = numbered_levels();
    for (const MipTie tie : {MipTie::Up, MipTie::Down, MipTie::Even}) {
        Profile profile;
        profile.lod_fraction_bits = kExactBits;
        profile.mip_tie = tie;
        for (int level = 0; level < kLevels - 1; ++level) {
            const auto middle = static_cast<Scalar>(level + 0.5);
            const std::vector<double> lods{static_cast<double>(std::nextafter(middle, Scalar(-1))), static_cast<double>(middle),
                                           static_cast<double>(std::nextafter(middle, Scalar(100)))};
            const auto got = values_at<TestType>(texture, Sampler{.mip = MipFilter::Nearest}, profile, lods);
            const int at_tie = tie == MipTie::Up ? level + 1 : tie == MipTie::Down ? level : (level + 1) / 2 * 2;
            INFO("tie " << name_of(tie) << " between " << level << " and " << level + 1);
            CHECK(static_cast<double>(got[0]) == 65536.0 * level);
            CHECK(static_cast<double>(got[1]) == 65536.0 * at_tie);
            CHECK(static_cast<double>(got[2]) == 65536.0 * (level + 1));
        }
    }
}

TEST_CASE("limits between two codes round to a code like any level of detail", "[7.18.10][7.18.11]") {
    // "The selected miplevels are clamped to ... any other settings for clamping miplevels": MinLOD and MaxLOD are floats.
    const Texture texture = numbered_levels();
    for (const float limit : {1.3f, 2.001f, 0.999f, 3.49999f}) {
        const double expected =
            std::ldexp(static_cast<double>(fixed_lod(static_cast<double>(limit), 8, FixedRounding::NearestEven)), 8);
        const auto lowest =
            values_at<Float>(texture, Sampler{.mip = MipFilter::Linear, .min_lod = limit}, Profile{}, {-5.0, 0.5});
        const auto highest =
            values_at<Float>(texture, Sampler{.mip = MipFilter::Linear, .max_lod = limit}, Profile{}, {5.0, 100.0});
        INFO("limit " << limit);
        CHECK(static_cast<double>(lowest[0]) == expected);
        CHECK(static_cast<double>(lowest[1]) == expected);
        CHECK(static_cast<double>(highest[0]) == expected);
        CHECK(static_cast<double>(highest[1]) == expected);
    }
}
