// D3D11.3 7.18.5, 7.18.6: range reduction keeps coordinates in [-10, 10] and does not change which texels are chosen.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/address.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

TEST_CASE("range reduction follows the specification bit for bit", "[7.18.6]") {
    oracle::Random random(1);
    std::vector<float> values{0.0f,        -0.0f,        1.0f,       -1.0f,       2.0f,      -2.0f,     10.0f,
                              -10.0f,      0x1p-30f,     -0x1p-30f,  1e10f,       -1e10f,    3.4e38f,   -3.4e38f,
                              0.99999994f, -0.99999994f, 1.9999999f, -1.9999999f, HUGE_VALF, -HUGE_VALF};
    for (int i = 0; i < 20000; ++i) {
        const float any = random.any_float();
        values.push_back(std::fabs(any) < 0x1p-126f ? 0.0f : any);
        values.push_back(random.in(-25.0f, 25.0f));
        values.push_back(static_cast<float>(random.integer(-40, 40)) * 0.5f +
                         static_cast<float>(random.integer(-3, 3)) * 0x1p-22f);
    }
    for (const AddressMode mode : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border})
        for (const float u : values) {
            const float got = lane(reduce_range(Float(u), mode), 0);
            const float expected = oracle::reduce_range(u, oracle_mode(mode));
            const bool same = got != got ? expected != expected : got == expected;
            if (!same) FAIL(fmt::format("{} of {:a}: {:a}, expected {:a}", name_of(mode), u, got, expected));
            if (std::isfinite(u)) REQUIRE((mode == AddressMode::Wrap ? got >= 0.0f && got <= 1.0f : std::fabs(got) <= 10.0f));
        }
}

TEST_CASE("range reduction does not change the chosen texels", "[7.18.6][7.18.7]") {
    // Coordinates that are exact multiples of 1/256 texel, tiles away: the texel by integer arithmetic on the unreduced
    // coordinate must be the one the texture unit reads.
    for (const int size : {1, 2, 4, 8, 64}) {
        std::vector<std::uint32_t> codes(static_cast<std::size_t>(size));
        for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = std::bit_cast<std::uint32_t>(static_cast<float>(i + 1));
        const Texture texture = texture_of(Format::R32Float, size, 1, codes);
        for (const AddressMode mode : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border}) {
            const Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .address_u = mode};
            std::vector<Coordinate> coordinates;
            std::vector<float> expected;
            for (int t = -40 * size; t < 40 * size; ++t)
                for (const int fraction : {0, 1, 128, 255}) {
                    coordinates.push_back({static_cast<float>(t * 256 + fraction) / static_cast<float>(256 * size), 0.5f});
                    const std::int64_t texel = oracle::address(t, size, oracle_mode(mode));
                    expected.push_back(texel < 0 ? 0.0f : static_cast<float>(texel + 1));
                }
            const auto got = sample_all(texture, sampler, Profile{}, coordinates);
            for (std::size_t i = 0; i < got.size(); ++i)
                if (got[i][0] != expected[i])
                    FAIL(fmt::format("size {} {} u {:a}: texel value {}, expected {}", size, name_of(mode), coordinates[i].u,
                                     got[i][0], expected[i]));
        }
    }
}
