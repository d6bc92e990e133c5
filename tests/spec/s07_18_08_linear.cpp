// D3D11.3 7.18.8: linear sampling with 8-bit weights, against the oracle: weights exactly, results to the bit and to a bound.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

TEST_CASE("every pair of 8-bit weights, from impulses", "[7.18.8]") {
    // A texel of 2^16 among zeros: the filtered value is the product of the two weights, an integer. All 256 x 256 pairs, all
    // four corners.
    for (int corner = 0; corner < 4; ++corner) {
        std::vector<std::uint32_t> codes(16 * 16, 0);
        codes[static_cast<std::size_t>((5 + corner / 2) * 16 + 7 + corner % 2)] = std::bit_cast<std::uint32_t>(65536.0f);
        const Texture texture = texture_of(Format::R32Float, 16, 16, codes);
        std::vector<Coordinate> coordinates;
        for (int v = 0; v < 256; ++v)
            for (int u = 0; u < 256; ++u)
                coordinates.push_back(
                    {(7.5f + static_cast<float>(u) / 256.0f) / 16.0f, (5.5f + static_cast<float>(v) / 256.0f) / 16.0f});
        for (const BilinearForm form : {BilinearForm::Lerp, BilinearForm::Products}) {
            Profile profile;
            profile.bilinear_form = form;
            const auto got = sample_all(texture, Sampler{}, profile, coordinates);
            for (int v = 0; v < 256; ++v)
                for (int u = 0; u < 256; ++u) {
                    const int expected = (corner % 2 == 1 ? u : 256 - u) * (corner / 2 == 1 ? v : 256 - v);
                    const float value = got[static_cast<std::size_t>(v * 256 + u)][0];
                    if (value != static_cast<float>(expected))
                        FAIL(fmt::format("{} corner {} weights {} {}: {} / 65536, expected {}", name_of(form), corner, u, v,
                                         value, expected));
                }
        }
    }
}

TEST_CASE("weights round to nearest even, or truncate where the profile says so", "[7.18.8][3.2.4.1]") {
    const std::vector<std::uint32_t> codes{0u, std::bit_cast<std::uint32_t>(256.0f)};
    const Texture texture = texture_of(Format::R32Float, 2, 1, codes);
    std::vector<Coordinate> coordinates;
    for (int k = 0; k <= 4 * 256; ++k) coordinates.push_back({(0.5f + static_cast<float>(k) / 1024.0f) / 2.0f, 0.5f});
    const auto nearest = sample_all(texture, Sampler{}, Profile{}, coordinates);
    Profile truncating;
    truncating.texel_rounding = FixedRounding::Truncate;
    const auto truncated = sample_all(texture, Sampler{}, truncating, coordinates);
    for (int k = 0; k <= 1024; ++k) {
        const int quarter = k % 4;
        int rounded = k / 4 + (quarter == 3 ? 1 : 0);
        if (quarter == 2 && rounded % 2 != 0) ++rounded;
        INFO("k " << k);
        REQUIRE(nearest[static_cast<std::size_t>(k)][0] == static_cast<float>(rounded));
        REQUIRE(truncated[static_cast<std::size_t>(k)][0] == static_cast<float>(k / 4));
    }
}

TEST_CASE("bilinear samples of every format against the oracle", "[7.18.8][7.18.16][19.1.3.3]") {
    // Bit-equal to the lerp form in fp32. Against the exact sum: three lerps, each with a rounded difference, product and sum
    // of values below 2, so at most 3 * 2^-23 each, of which the two inner ones are averaged: 6 * 2^-23 in all.
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format));
        double worst = 0;
        for (int round = 0; round < 40; ++round) {
            const int width = random.integer(1, 20);
            const int height = random.integer(1, 20);
            const auto count = static_cast<std::size_t>(width * height * info.components);
            std::vector<std::uint32_t> codes(count);
            for (std::size_t i = 0; i < count; ++i)
                codes[i] = moderate_code(info.format, random, static_cast<int>(i) % info.components);
            const Texture texture = texture_of(info.format, width, height, codes);
            const std::array modes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border};
            const Sampler sampler{.address_u = modes[static_cast<std::size_t>(random.integer(0, 3))],
                                  .address_v = modes[static_cast<std::size_t>(random.integer(0, 3))],
                                  .border = {0.25f, 0.5f, 0.75f, 1.0f}};
            std::vector<Coordinate> coordinates;
            for (int i = 0; i < 200; ++i) coordinates.push_back({random.in(-2.5f, 3.5f), random.in(-2.5f, 3.5f)});
            const auto got = sample_all(texture, sampler, Profile{}, coordinates);
            const auto ideal = sample_all<Double>(texture, sampler, load_profile("ideal"), coordinates);
            for (int c = 0; c < 4; ++c) {
                oracle::Image image{width, height, {}, static_cast<double>(sampler.border[c])};
                if (c < info.components)
                    for (std::size_t i = static_cast<std::size_t>(c); i < count; i += static_cast<std::size_t>(info.components))
                        image.texels.push_back(code_value(info.format, codes[i], c));
                for (std::size_t i = 0; i < coordinates.size(); ++i) {
                    const float value = got[i][static_cast<std::size_t>(c)];
                    if (c >= info.components) {
                        REQUIRE(value == (c == 3 ? 1.0f : 0.0f));  // defaults of missing components
                        continue;
                    }
                    const auto u = oracle::linear_axis(coordinates[i].u, width, oracle_mode(sampler.address_u));
                    const auto v = oracle::linear_axis(coordinates[i].v, height, oracle_mode(sampler.address_v));
                    const auto taps = image.taps(u, v);
                    const double exact = oracle::bilinear(taps, u.weight, v.weight);
                    const float lerped = oracle::lerp_form(taps, u.weight, v.weight);
                    worst = std::max(worst, std::fabs(static_cast<double>(value) - exact));
                    if (std::bit_cast<std::uint32_t>(value) != std::bit_cast<std::uint32_t>(lerped) ||
                        std::fabs(static_cast<double>(value) - exact) > 6 * 0x1p-23)
                        FAIL(fmt::format("{} {}x{} {} {} uv ({:a}, {:a}) channel {}: {:a}, lerp form {:a}, exact {:a}",
                                         info.name, width, height, name_of(sampler.address_u), name_of(sampler.address_v),
                                         coordinates[i].u, coordinates[i].v, c, value, lerped, exact));
                    // Exact weights differ by at most 1/512 per axis from the 8-bit ones, texels by at most 2; one axis can
                    // also sit at a discontinuity only where the texels repeat.
                    const double difference = std::fabs(ideal[i][static_cast<std::size_t>(c)] - exact);
                    if (difference > 2 * 2 * (1.0 / 512 + 1e-5))
                        FAIL(fmt::format("{} ideal uv ({:a}, {:a}) channel {}: {:a} is {} from {:a}", info.name,
                                         coordinates[i].u, coordinates[i].v, c, ideal[i][static_cast<std::size_t>(c)],
                                         difference, exact));
                }
            }
        }
        if (info.bits_per_component > 8) CHECK(worst > 0);
    }
}

TEST_CASE("the ideal profile filters with exact weights", "[7.18.8]") {
    oracle::Random random(77);
    const std::vector<std::uint32_t> codes{std::bit_cast<std::uint32_t>(1.0f), std::bit_cast<std::uint32_t>(-3.0f),
                                           std::bit_cast<std::uint32_t>(0.1f), std::bit_cast<std::uint32_t>(7.0f)};
    const Texture texture = texture_of(Format::R32Float, 2, 2, codes);
    std::vector<Coordinate> coordinates;
    for (int i = 0; i < 2000; ++i) coordinates.push_back({random.in(0.25f, 0.75f), random.in(0.25f, 0.75f)});
    const auto got = sample_all<Double>(texture, Sampler{}, load_profile("ideal"), coordinates);
    for (std::size_t i = 0; i < got.size(); ++i) {
        const long double u = static_cast<long double>(coordinates[i].u) * 2 - 0.5L;
        const long double v = static_cast<long double>(coordinates[i].v) * 2 - 0.5L;
        const long double exact =
            1.0L * (1 - u) * (1 - v) - 3.0L * u * (1 - v) + static_cast<long double>(0.1f) * (1 - u) * v + 7.0L * u * v;
        if (std::fabs(static_cast<long double>(got[i][0]) - exact) > 1e-14L)
            FAIL(fmt::format("uv ({:a}, {:a}): {:a}, exact {:a}", coordinates[i].u, coordinates[i].v, got[i][0],
                             static_cast<double>(exact)));
    }
}
