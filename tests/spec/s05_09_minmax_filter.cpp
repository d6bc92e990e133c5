// D3D11.3 5.9.4.5.6: minimum and maximum over the texels that a filter would weight, component by component.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr std::array kReductions{Reduction::Minimum, Reduction::Maximum};

/// min and max of 3.1.3.1: of a number and NaN, the number.
double reduced(Reduction reduction, double a, double b) {
    return reduction == Reduction::Minimum ? std::fmin(a, b) : std::fmax(a, b);
}
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

Texture texture_of_floats(int width, int height, int components, const std::vector<float>& values) {
    Texture texture({.format = components == 4 ? Format::Rgba32Float : Format::R32Float, .width = width, .height = height});
    texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), values.size() * 4);
    return texture;
}

float any_number(oracle::Random& random) {
    switch (random.integer(0, 9)) {
        case 0: return std::nanf("");
        case 1: return HUGE_VALF;
        case 2: return -HUGE_VALF;
        case 3: return 1.0f;  // ties
        default: return random.in(-8.0f, 8.0f);
    }
}

}  // namespace

TEMPLATE_TEST_CASE("texels of weight zero do not count, others count whatever their weight", "[5.9.4.5.6]", Float, Double) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        oracle::Random random(seed);
        std::vector<float> values(16);
        for (float& value : values) value = any_number(random);
        const Texture texture = texture_of_floats(2, 2, 4, values);
        std::vector<Coordinate> coordinates;
        std::vector<std::array<int, 2>> weights;
        for (const int v : {0, 1, 100, 255, 256})
            for (const int u : {0, 1, 128, 255, 256}) {
                coordinates.push_back(
                    {(0.5f + static_cast<float>(u) / 256.0f) / 2.0f, (0.5f + static_cast<float>(v) / 256.0f) / 2.0f});
                weights.push_back({u, v});
            }
        for (const Reduction reduction : kReductions)
            for (const TexelCarry carry : {TexelCarry::Texel, TexelCarry::Weight}) {
                Profile profile;
                profile.texel_carry = carry;
                const auto got = sample_all<TestType>(texture, Sampler{.reduction = reduction}, profile, coordinates);
                for (std::size_t i = 0; i < got.size(); ++i)
                    for (std::size_t c = 0; c < 4; ++c) {
                        double expected = std::nan("");
                        for (std::size_t tap = 0; tap < 4; ++tap) {
                            const int wu = (tap & 1) != 0 ? weights[i][0] : 256 - weights[i][0];
                            const int wv = (tap & 2) != 0 ? weights[i][1] : 256 - weights[i][1];
                            if (wu * wv != 0) expected = reduced(reduction, expected, static_cast<double>(values[4 * tap + c]));
                        }
                        if (!same(static_cast<double>(got[i][c]), expected))
                            FAIL(fmt::format("seed {} {} weights {} {} component {}: {:a}, expected {:a}", seed,
                                             name_of(reduction), weights[i][0], weights[i][1], c, got[i][c], expected));
                    }
            }
    }
}

TEST_CASE("a weight that rounds to zero or one leaves texels out", "[5.9.4.5.6][7.18.8]") {
    const Texture texture = texture_of_floats(3, 1, 1, {1.0f, 2.0f, 3.0f});
    for (const TexelCarry carry : {TexelCarry::Texel, TexelCarry::Weight}) {
        Profile profile;
        profile.texel_carry = carry;
        const auto at = [&](double texels, Reduction reduction) {
            return record_sample(texture, Sampler{.reduction = reduction}, profile,
                                 SampleRequest{.coordinate = {(0.5 + texels) / 3, 0.5, 0}})
                .result[0];
        };
        INFO(name_of(carry));
        CHECK(at(0x1p-11, Reduction::Maximum) == 1.0);      // weight 0 of the right texel
        CHECK(at(1 - 0x1p-11, Reduction::Minimum) == 2.0);  // weight 0 of the left one, whoever carries
        CHECK(at(1 - 0x1p-11, Reduction::Maximum) == 2.0);
        CHECK(at(0x1p-8, Reduction::Maximum) == 2.0);
        CHECK(at(1 - 0x1p-8, Reduction::Minimum) == 1.0);
    }
}

TEST_CASE("every format gives one of its texels, component by component", "[5.9.4.5.6]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format));
        std::vector<std::uint32_t> codes;
        for (int i = 0; i < 36; ++i)
            for (int c = 0; c < info.components; ++c) codes.push_back(moderate_code(info.format, random, c));
        const Texture texture = texture_of(info.format, 6, 6, codes);
        int mixed = 0;
        for (const Reduction reduction : kReductions)
            for (int round = 0; round < 300; ++round) {
                const int x = random.integer(0, 4);
                const int y = random.integer(0, 4);
                const double u = (x + 0.5 + random.integer(3, 253) / 256.0) / 6;
                const double v = (y + 0.5 + random.integer(3, 253) / 256.0) / 6;
                const auto got =
                    record_sample(texture, Sampler{.reduction = reduction}, Profile{}, SampleRequest{.coordinate = {u, v, 0}})
                        .result;
                std::array<int, 4> from{};
                for (int c = 0; c < info.components; ++c) {
                    double expected = std::nan("");
                    for (int tap = 0; tap < 4; ++tap) {
                        const int texel = (y + (tap >> 1)) * 6 + x + (tap & 1);
                        const double value =
                            code_value(info.format, codes[static_cast<std::size_t>(texel * info.components + c)], c);
                        if (!(reduced(reduction, expected, value) == expected)) from[static_cast<std::size_t>(c)] = tap;
                        expected = reduced(reduction, expected, value);
                    }
                    if (got[static_cast<std::size_t>(c)] != expected)
                        FAIL(fmt::format("{} {} round {} component {}: {:a}, expected {:a}", info.name, name_of(reduction),
                                         round, c, got[static_cast<std::size_t>(c)], expected));
                }
                mixed += info.components > 1 && from[0] != from[1];
            }
        if (info.components > 1) CHECK(mixed > 50);  // components come from different texels
    }
}

TEST_CASE("two levels are one set of texels; a level of weight zero is not in it", "[5.9.4.5.6][7.18.10]") {
    Texture texture({.format = Format::R32Float, .width = 4, .height = 4, .levels = 3});
    const std::vector<float> fine{5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20};
    const std::vector<float> middle{-1, 2, 3, 40};
    const std::vector<float> coarse{std::nanf("")};
    texture.set_level_bytes(0, std::as_bytes(std::span(fine)).data(), 64);
    texture.set_level_bytes(1, std::as_bytes(std::span(middle)).data(), 16);
    texture.set_level_bytes(2, std::as_bytes(std::span(coarse)).data(), 4);
    const auto at = [&](double lod, Reduction reduction, MipFilter mip = MipFilter::Linear) {
        return record_sample(texture, Sampler{.mip = mip, .reduction = reduction}, Profile{},
                             SampleRequest{.coordinate = {0.5, 0.5, 0}, .lod = lod})
            .result[0];
    };
    // The middle of level 0 is between 10, 11, 14 and 15.
    CHECK(at(0, Reduction::Minimum) == 10);
    CHECK(at(0, Reduction::Maximum) == 15);
    CHECK(at(0.25, Reduction::Minimum) == -1);
    CHECK(at(0.25, Reduction::Maximum) == 40);
    CHECK(at(0x1p-8, Reduction::Maximum) == 40);   // one code is enough
    CHECK(at(0x1p-10, Reduction::Maximum) == 15);  // and less than half of one is none
    CHECK(at(1, Reduction::Minimum) == -1);
    CHECK(at(1, Reduction::Maximum) == 40);
    CHECK(at(1.5, Reduction::Minimum) == -1);  // NaN loses
    CHECK(at(1.5, Reduction::Maximum) == 40);
    CHECK(std::isnan(at(2, Reduction::Minimum)));
    CHECK(at(0.5, Reduction::Maximum, MipFilter::Nearest) == 40);
    CHECK(at(0.25, Reduction::Maximum, MipFilter::Nearest) == 15);
}

TEST_CASE("all probes of an anisotropic filter count", "[5.9.4.5.6][7.18.11]") {
    oracle::Random random(6);
    std::vector<float> values(64 * 4);
    for (float& value : values) value = random.in(-1.0f, 1.0f);
    const Texture texture = texture_of_floats(64, 4, 1, values);
    int different = 0;
    for (const Reduction reduction : kReductions)
        for (int x = 8; x < 56; ++x)
            for (const double fraction : {0.0, 0.25, 0.75}) {
                // Derivatives of 6 and 2 texels: ratio 3, probes at -1/4, 0 and 1/4 of 6 texels. One row, nearest texels.
                SampleRequest request{.coordinate = {(x + fraction) / 64, 0.375, 0}};
                request.gradient = {{6.0 / 64, 0, 0}, {0, 2.0 / 4, 0}};
                const Sampler sampler{.min = TexelFilter::Nearest,
                                      .mag = TexelFilter::Nearest,
                                      .mip = MipFilter::Nearest,
                                      .max_anisotropy = 8,
                                      .reduction = reduction};
                double expected = std::nan("");
                for (const double t : {-1.5, 0.0, 1.5})
                    expected =
                        reduced(reduction, expected,
                                static_cast<double>(values[64 + static_cast<std::size_t>(std::floor(x + fraction + t))]));
                const SampleRecord record = record_sample(texture, sampler, Profile{}, request);
                INFO(name_of(reduction) << " x " << x << " + " << fraction);
                REQUIRE(record.probes.size() == 3);
                REQUIRE(record.result[0] == expected);
                different += record.result[0] != record.probes[1].sum[0];
            }
    CHECK(different > 50);
}

TEST_CASE("the border colour is a texel like any other", "[5.9.4.5.6][7.18.9.1]") {
    const Texture texture = texture_of_floats(1, 1, 1, {2.0f});
    const auto at = [&](double u, Reduction reduction) {
        const Sampler sampler{.address_u = AddressMode::Border,
                              .address_v = AddressMode::Clamp,
                              .reduction = reduction,
                              .border = glm::vec4(7.0f)};
        return record_sample(texture, sampler, Profile{}, SampleRequest{.coordinate = {u, 0.5, 0}}).result[0];
    };
    CHECK(at(0.5, Reduction::Maximum) == 2);
    CHECK(at(0.25, Reduction::Maximum) == 7);
    CHECK(at(0.25, Reduction::Minimum) == 2);
    CHECK(at(-0.5, Reduction::Minimum) == 7);
    CHECK(at(-0.25, Reduction::Minimum) == 2);
}

TEST_CASE("cube edges and corners are in the set", "[5.9.4.5.6][7.18.12]") {
    // Face f is constant f + 1; over the edge between +x and +z, and at the corner of +x, +y and +z.
    Texture texture(
        {.format = Format::R32Float, .width = 2, .height = 2, .levels = 1, .kind = TextureKind::Cube, .layers = kCubeFaces});
    for (int face = 0; face < kCubeFaces; ++face) {
        const std::vector<float> values(4, static_cast<float>(face + 1));
        texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), 16, face);
    }
    const auto at = [&](std::array<double, 3> d, Reduction reduction) {
        return record_sample(texture, Sampler{.reduction = reduction}, Profile{}, SampleRequest{.coordinate = d}).result[0];
    };
    CHECK(at({1, 0, 0.9}, Reduction::Minimum) == 1);
    CHECK(at({1, 0, 0.9}, Reduction::Maximum) == 5);
    CHECK(at({1, 0.95, 0.9}, Reduction::Minimum) == 1);
    CHECK(at({1, 0.95, 0.9}, Reduction::Maximum) == 5);
    CHECK(at({1, 0.25, 0.25}, Reduction::Maximum) == 1);
}
