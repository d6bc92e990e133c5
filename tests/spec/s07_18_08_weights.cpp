// D3D11.3 7.18.8, 3.2.4.1: the fixed-point weights of a linear filter: all of them, at every precision, rounding and carry.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

Texture texture_of_floats(int width, int height, const std::vector<float>& values) {
    Texture texture({.format = Format::R32Float, .width = width, .height = height});
    texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), values.size() * 4);
    return texture;
}

/// Worst error of a filter of values within [-1, 1], in units of 2^-24: half an ULP of what each operation can reach. A lerp
/// rounds a difference, a product and a sum below 2 (or, fused, the last two at once); of the two inner ones a mean goes on.
/// Products round twice per texel, whose weights sum to 1, and three sums.
double bound_of(BilinearForm form) {
    switch (form) {
        case BilinearForm::Lerp:
        case BilinearForm::PlainLerp: return 6 * 0x1p-24;
        case BilinearForm::FusedLerp: return 4 * 0x1p-24;
        case BilinearForm::Products: return 5 * 0x1p-24;
    }
    return 0;
}

}  // namespace

TEST_CASE("all 65536 pairs of weights over a texel cell sum to one and weight their texels", "[7.18.8][3.2.4.2]") {
    oracle::Random random(1);
    std::vector<float> values(16);
    for (float& value : values) value = random.in(-1.0f, 1.0f);
    const Texture texture = texture_of_floats(4, 4, values);
    for (const BilinearForm form :
         {BilinearForm::Lerp, BilinearForm::Products, BilinearForm::PlainLerp, BilinearForm::FusedLerp}) {
        Profile profile;
        profile.bilinear_form = form;
        double worst = 0;
        for (int v = 0; v < 256; ++v)
            for (int u = 0; u < 256; ++u) {
                const SampleRecord record =
                    record_sample(texture, Sampler{}, profile,
                                  SampleRequest{.coordinate = {(1.5 + u / 256.0) / 4, (0.5 + v / 256.0) / 4, 0}});
                const auto& taps = record.probes.at(0).levels.at(0).taps;
                if (taps.size() != 4) FAIL(fmt::format("weights {} {}: {} taps", u, v, taps.size()));
                // (floor, floor), (ceil, floor), (floor, ceil), (ceil, ceil)
                double sum = 0;
                double exact = 0;
                for (int tap = 0; tap < 4; ++tap) {
                    const TapRecord& t = taps[static_cast<std::size_t>(tap)];
                    const int wu = (tap & 1) != 0 ? u : 256 - u;
                    const int wv = (tap & 2) != 0 ? v : 256 - v;
                    const int x = 1 + (tap & 1);
                    const int y = tap >> 1;
                    if (t.x != x || t.y != y || t.weight != wu * wv / 65536.0)
                        FAIL(fmt::format("{} weights {} {} tap {}: texel ({}, {}) weight {:a}", name_of(form), u, v, tap, t.x,
                                         t.y, t.weight));
                    sum += t.weight;
                    exact += wu * wv / 65536.0 * static_cast<double>(values[static_cast<std::size_t>(4 * y + x)]);
                }
                const double error = std::fabs(record.result[0] - exact);
                worst = std::max(worst, error);
                if (sum != 1.0 || error > bound_of(form))
                    FAIL(fmt::format("{} weights {} {}: sum of weights {:a}, {:a} for {:a}", name_of(form), u, v, sum,
                                     record.result[0], exact));
            }
        CHECK(worst > 0);
    }
}

TEST_CASE("weights of 1 to 8 bits round and carry as the profile says", "[7.18.8][3.2.4.1][7.18.16.1]") {
    // Texels 0, 1, 2, 3 at positions of 1/4096 texel; an integer ramp makes every result exact: texel + weight.
    const Texture texture = texture_of_floats(4, 1, {0.0f, 1.0f, 2.0f, 3.0f});
    int carries = 0;
    for (int bits = 1; bits <= 8; ++bits)
        for (const FixedRounding rounding : {FixedRounding::NearestEven, FixedRounding::Truncate})
            for (const TexelCarry carry : {TexelCarry::Texel, TexelCarry::Weight}) {
                Profile profile;
                profile.texel_fraction_bits = bits;
                profile.texel_rounding = rounding;
                profile.texel_carry = carry;
                const int steps = 1 << bits;
                for (int position = 0; position < 3 * 4096; ++position) {
                    const SampleRecord record = record_sample(
                        texture, Sampler{}, profile, SampleRequest{.coordinate = {(position / 4096.0 + 0.5) / 4, 0.5, 0}});
                    const auto& taps = record.probes.at(0).levels.at(0).taps;
                    // scaledU in steps: nearest, ties to even, or the floor.
                    const int per_step = 4096 / steps;
                    int fixed = position / per_step;
                    const int rest = position % per_step;
                    if (rounding == FixedRounding::NearestEven &&
                        (2 * rest > per_step || (2 * rest == per_step && fixed % 2 != 0)))
                        ++fixed;
                    int texel = fixed / steps;
                    int weight = fixed % steps;
                    if (carry == TexelCarry::Weight) {  // the texel comes from the unrounded coordinate
                        texel = position / 4096;
                        weight = fixed - texel * steps;
                        carries += weight == steps;
                    }
                    const double w = static_cast<double>(weight) / steps;
                    const bool right = taps.at(0).x == texel && taps.at(1).x == std::min(texel + 1, 3) &&
                                       taps[0].weight + taps.at(2).weight == 1 - w && taps[1].weight + taps.at(3).weight == w &&
                                       record.result[0] == std::min(texel + w, 3.0);
                    if (!right)
                        FAIL(fmt::format(
                            "bits {} {} carry {} position {} / 4096: texels {} {} weight {:a} result {:a}, expected "
                            "{} weight {:a}",
                            bits, name_of(rounding), name_of(carry), position, taps[0].x, taps[1].x, taps[1].weight,
                            record.result[0], texel, w));
                }
            }
    CHECK(carries > 100);
}

TEST_CASE("a weight of one is the next texel to the bit", "[7.18.8]") {
    // 1e8 + 1 (3 - 1e8) is 0 in binary32: only a texel that is taken whole gives 3.
    const Texture texture = texture_of_floats(2, 2, {1e8f, 3.0f, 1e8f, 1e8f});
    Profile profile;
    profile.texel_carry = TexelCarry::Weight;
    const double u = (0.5 + 1 - 0x1p-12) / 2;
    const double v = 0.25;
    for (const BilinearForm form :
         {BilinearForm::Lerp, BilinearForm::Products, BilinearForm::PlainLerp, BilinearForm::FusedLerp}) {
        profile.bilinear_form = form;
        const SampleRecord right = record_sample(texture, Sampler{}, profile, SampleRequest{.coordinate = {u, v, 0}});
        INFO(name_of(form));
        CHECK(right.probes.at(0).levels.at(0).taps.at(1).weight == 1);
        CHECK(right.result[0] == 3.0);
        // The same along v, between the lower texels' 1e8 and, one row up, 3: nothing of the upper row is left.
        const SampleRecord below = record_sample(texture_of_floats(2, 2, {1e8f, 1e8f, 3.0f, 1e8f}), Sampler{}, profile,
                                                 SampleRequest{.coordinate = {v, u, 0}});
        CHECK(below.result[0] == 3.0);
    }
    // Where the texel carries, the same position is on the next texel with weight 0.
    profile.texel_carry = TexelCarry::Texel;
    const SampleRecord carried = record_sample(texture, Sampler{}, profile, SampleRequest{.coordinate = {u, v, 0}});
    CHECK(carried.probes.at(0).levels.at(0).taps.at(0).x == 1);
    CHECK(carried.probes.at(0).levels.at(0).taps.at(1).weight == 0);
    CHECK(carried.result[0] == 3.0);
}

TEST_CASE("weights act monotonically along a cell", "[7.18.8][7.18.16]") {
    // "In a bilinear filter operation, colors must increase or decrease monotonically as a function of the U or V filter
    // weights."
    oracle::Random random(5);
    for (int round = 0; round < 200; ++round) {
        const float a = std::ldexp(random.in(-2.0f, 2.0f), random.integer(-20, 20));
        const float b =
            random.chance(2) ? std::nextafter(a, 1e30f) : std::ldexp(random.in(-2.0f, 2.0f), random.integer(-20, 20));
        const Texture texture = texture_of_floats(2, 1, {a, b});
        std::vector<Coordinate> coordinates;
        for (int w = 0; w <= 256; ++w) coordinates.push_back({(0.5f + static_cast<float>(w) / 256.0f) / 2.0f, 0.5f});
        for (const TexelCarry carry : {TexelCarry::Texel, TexelCarry::Weight}) {
            Profile profile;
            profile.texel_carry = carry;
            const auto got = sample_all(texture, Sampler{}, profile, coordinates);
            for (std::size_t w = 1; w < got.size(); ++w)
                if (b >= a ? got[w][0] < got[w - 1][0] : got[w][0] > got[w - 1][0])
                    FAIL(fmt::format("round {} {:a} to {:a} weight {}: {:a} after {:a}", round, a, b, w, got[w][0],
                                     got[w - 1][0]));
            if (got.front()[0] != a || got.back()[0] != b)
                FAIL(fmt::format("round {} ends {:a} {:a}, expected {:a} {:a}", round, got.front()[0], got.back()[0], a, b));
        }
    }
}
