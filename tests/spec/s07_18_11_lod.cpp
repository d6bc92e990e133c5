// D3D11.3 7.18.11: isotropic level of detail, bias, clamps, magnification.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/lod.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

TEST_CASE("the implicit level of detail is log2 of the longer derivative", "[7.18.11]") {
    double worst = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        oracle::Random random(seed);
        const int width = 1 << random.integer(0, 14);
        const int height = random.integer(1, 16384);
        const float scale = std::ldexp(1.0f, random.integer(-18, 2));
        std::array<float, kLanes> u;
        std::array<float, kLanes> v;
        for (std::size_t i = 0; i < kLanes; ++i) {
            u[i] = random.in(-scale, scale);
            v[i] = random.in(-scale, scale);
        }
        for (const LodSharing sharing : {LodSharing::Quad, LodSharing::Pixel}) {
            Profile profile;
            profile.lod_sharing = sharing;
            const Gradients<Float> d = quad_gradients(Vec2<Float>{Float::load(u.data()), Float::load(v.data())}, profile);
            const Float w(static_cast<float>(width));
            const Float h(static_cast<float>(height));
            const auto got =
                isotropic_lod(Vec2<Float>{d.dx.x * w, d.dx.y * h}, Vec2<Float>{d.dy.x * w, d.dy.y * h}, profile).lanes();
            for (std::size_t i = 0; i < kLanes; ++i) {
                const std::size_t quad = i / 4 * 4;
                const std::size_t row = sharing == LodSharing::Quad ? quad : quad + (i & 2);
                const std::size_t column = sharing == LodSharing::Quad ? quad : quad + (i & 1);
                // The derivatives are fp32 subtractions, everything after is exact here.
                const auto length = [&](std::size_t a, std::size_t b) {
                    return std::hypot(static_cast<long double>(u[b] - u[a]) * width,
                                      static_cast<long double>(v[b] - v[a]) * height);
                };
                const long double exact = std::log2(std::max(length(row, row + 1), length(column, column + 2)));
                const double error = std::fabs(static_cast<double>(static_cast<long double>(got[i]) - exact));
                worst = std::max(worst, error);
                // The squared length carries at most 4 roundings: 4 * 2^-24 / ln 2 / 2; log2 below 3 ULP of at most 64.
                if (!(error <= 0.5 * 3 * 0x1p-18 + 3 * 0x1p-24))
                    FAIL(fmt::format("seed {} lane {} {}: {:a}, exact {:a}", seed, i, name_of(sharing), got[i],
                                     static_cast<double>(exact)));
            }
        }
    }
    CHECK(worst > 0);
    CHECK(worst < 0x1p-8);  // far below one step of the 8.8 level of detail
}

namespace {

Texture levels_256() {
    Texture texture({.format = Format::R32Float, .width = 256, .height = 256, .levels = 9});
    for (int level = 0; level < 9; ++level) {
        const std::vector<float> values(static_cast<std::size_t>(texture.width(level) * texture.height(level)),
                                        1024.0f * static_cast<float>(level));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

float level_of(const Texture& texture, const Sampler& sampler, float lod) {
    return sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{0.5f, 0.5f, lod}})[0][0] / 1024.0f;
}

}  // namespace

TEST_CASE("bias is added before the clamps", "[7.18.11]") {
    const Texture texture = levels_256();
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .lod_bias = 1.5f}, 2.0f) == 3.5f);
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .lod_bias = -16.0f}, 18.0f) == 2.0f);
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .lod_bias = 15.99f}, -20.0f) == 0.0f);
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .lod_bias = 3.0f}, -1.0f) == 2.0f);  // negative levels of detail count
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .lod_bias = 4.0f, .max_lod = 3.25f}, 2.0f) == 3.25f);
    CHECK(level_of(texture, {.mip = MipFilter::Linear, .min_lod = 2.75f}, 1.0f) == 2.75f);
    CHECK(level_of(texture, {.mip = MipFilter::Linear}, 100.0f) == 8.0f);
}

TEST_CASE("the smallest level of detail wins over the largest", "[7.18.11]") {
    // "The ordering of min/max guarantees that if MinLOD > MaxLOD, then MinLOD takes precedence."
    const Texture texture = levels_256();
    for (const float lod : {0.0f, 3.0f, 7.0f}) {
        INFO("lod " << lod);
        CHECK(level_of(texture, {.mip = MipFilter::Linear, .min_lod = 5.0f, .max_lod = 2.0f}, lod) == 5.0f);
    }
}

TEST_CASE("a level of detail that is no number still selects a level", "[7.18.11]") {
    const Texture texture = levels_256();
    const float level = level_of(texture, {.mip = MipFilter::Linear, .min_lod = 2.0f, .max_lod = 6.0f}, std::nanf(""));
    CHECK((level == 2.0f || level == 6.0f));
}

TEST_CASE("magnification is decided after the clamp", "[7.18.11]") {
    // Two texels 0 and 1: nearest and linear differ.
    Texture texture({.format = Format::R32Float, .width = 2, .height = 1, .levels = 2});
    const std::vector<float> fine{0.0f, 1.0f};
    const std::vector<float> coarse{0.0f};
    texture.set_level_bytes(0, std::as_bytes(std::span(fine)).data(), 8);
    texture.set_level_bytes(1, std::as_bytes(std::span(coarse)).data(), 4);
    const auto at = [&](const Sampler& sampler, float lod) {
        return sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{0.375f, 0.5f, lod}})[0][0];
    };
    const Sampler nearest_mag{.min = TexelFilter::Linear, .mag = TexelFilter::Nearest, .mip = MipFilter::Base};
    CHECK(at(nearest_mag, -1.0f) == 0.0f);
    CHECK(at(nearest_mag, 0.0f) == 0.0f);
    CHECK(at(nearest_mag, 0.01f) == 0.25f);
    Sampler clamped = nearest_mag;
    clamped.max_lod = 0.0f;
    CHECK(at(clamped, 5.0f) == 0.0f);  // the clamp brings it to 0: magnified
    clamped = nearest_mag;
    clamped.min_lod = 0.5f;
    CHECK(at(clamped, -5.0f) == 0.25f);
    const Sampler linear_mag{.min = TexelFilter::Nearest, .mag = TexelFilter::Linear, .mip = MipFilter::Nearest};
    CHECK(at(linear_mag, -1.0f) == 0.25f);
    CHECK(at(linear_mag, 0.25f) == 0.0f);

    // Lanes that differ, in one wave.
    const std::vector<Coordinate> mixed{
        {0.375f, 0.5f, -1.0f}, {0.375f, 0.5f, 0.25f}, {0.375f, 0.5f, 0.0f}, {0.375f, 0.5f, 0.125f}};
    const auto got = sample_all(texture, nearest_mag, Profile{}, mixed);
    CHECK(got[0][0] == 0.0f);
    CHECK(got[1][0] == 0.25f);
    CHECK(got[2][0] == 0.0f);
    CHECK(got[3][0] == 0.25f);
}
