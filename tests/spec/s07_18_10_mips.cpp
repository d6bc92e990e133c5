// D3D11.3 7.18.10: which mip levels a level of detail selects, and their weights.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// A chain whose level n is constant 1024 n.
Texture constant_levels(int width, int height, int levels) {
    Texture texture({.format = Format::R32Float, .width = width, .height = height, .levels = levels});
    for (int level = 0; level < levels; ++level) {
        const std::vector<float> values(static_cast<std::size_t>(texture.width(level) * texture.height(level)),
                                        1024.0f * static_cast<float>(level));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

/// 8.8 fixed point as an integer count of 1/256, nearest even.
std::int64_t fixed_lod(float lod) { return oracle::fixed8(std::clamp(lod, -1000.0f, 1000.0f)); }

std::vector<Coordinate> lods() {
    std::vector<Coordinate> coordinates;
    for (int k = -3 * 1024; k < 9 * 1024; ++k) coordinates.push_back({0.3f, 0.7f, static_cast<float>(k) / 1024.0f});
    oracle::Random random(9);
    for (int k = 0; k < 4000; ++k) coordinates.push_back({random.unit(), random.unit(), random.in(-2.0f, 9.0f)});
    for (const float x : {HUGE_VALF, -HUGE_VALF, 1e30f, -1e30f, 0.0f, -0.0f}) coordinates.push_back({0.5f, 0.5f, x});
    return coordinates;
}

}  // namespace

TEST_CASE("linear mip weights are the fraction of the 8.8 level of detail", "[7.18.10]") {
    for (const int levels : {1, 2, 4, 7}) {
        const Texture texture = constant_levels(64, 64, levels);
        const Sampler sampler{.mip = MipFilter::Linear};
        const auto coordinates = lods();
        const auto got = sample_all(texture, sampler, Profile{}, coordinates);
        for (std::size_t i = 0; i < got.size(); ++i) {
            // 1024 per level and 1/256 steps: 4 per step, exact.
            const std::int64_t available =
                std::clamp<std::int64_t>(fixed_lod(std::max(coordinates[i].lod, 0.0f)), 0, 256 * (levels - 1));
            const float expected = static_cast<float>(4 * available);
            if (got[i][0] != expected)
                FAIL(fmt::format("levels {} lod {:a}: {}, expected {}", levels, coordinates[i].lod, got[i][0], expected));
        }
    }
}

TEST_CASE("the nearest mip is the integer part of the 8.8 level of detail plus one half", "[7.18.10]") {
    for (const int levels : {1, 2, 4, 7}) {
        const Texture texture = constant_levels(64, 64, levels);
        const auto coordinates = lods();
        for (const TexelFilter filter : {TexelFilter::Linear, TexelFilter::Nearest}) {
            const auto got =
                sample_all(texture, Sampler{.min = filter, .mag = filter, .mip = MipFilter::Nearest}, Profile{}, coordinates);
            for (std::size_t i = 0; i < got.size(); ++i) {
                const std::int64_t level =
                    std::clamp<std::int64_t>((fixed_lod(std::max(coordinates[i].lod, 0.0f)) + 128) / 256, 0, levels - 1);
                if (got[i][0] != 1024.0f * static_cast<float>(level))
                    FAIL(fmt::format("levels {} lod {:a}: level {}, expected {}", levels, coordinates[i].lod, got[i][0] / 1024,
                                     level));
            }
        }
    }
}

TEST_CASE("lanes on different levels read their own texels", "[7.18.10]") {
    // Values that tell level, x and y apart; nearest texel, nearest mip, odd sizes.
    Texture texture({.format = Format::R32Float, .width = 37, .height = 19, .levels = 6});
    for (int level = 0; level < 6; ++level) {
        std::vector<float> values;
        for (int y = 0; y < texture.height(level); ++y)
            for (int x = 0; x < texture.width(level); ++x) values.push_back(static_cast<float>(level * 10000 + y * 100 + x));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    oracle::Random random(3);
    std::vector<Coordinate> coordinates;
    for (int i = 0; i < 20000; ++i)
        coordinates.push_back({random.in(-1.0f, 2.0f), random.in(-1.0f, 2.0f), random.in(-1.0f, 7.0f)});
    const auto got = sample_all(texture,
                                Sampler{.min = TexelFilter::Nearest,
                                        .mag = TexelFilter::Nearest,
                                        .mip = MipFilter::Nearest,
                                        .address_u = AddressMode::Wrap,
                                        .address_v = AddressMode::Mirror},
                                Profile{}, coordinates);
    for (std::size_t i = 0; i < got.size(); ++i) {
        const auto level =
            static_cast<int>(std::clamp<std::int64_t>((fixed_lod(std::max(coordinates[i].lod, 0.0f)) + 128) / 256, 0, 5));
        const auto x = oracle::point_axis(coordinates[i].u, texture.width(level), oracle::Address::Wrap).texel[0];
        const auto y = oracle::point_axis(coordinates[i].v, texture.height(level), oracle::Address::Mirror).texel[0];
        const auto expected = static_cast<float>(level * 10000 + y * 100 + x);
        if (got[i][0] != expected)
            FAIL(fmt::format("uv ({:a}, {:a}) lod {:a}: {}, expected {}", coordinates[i].u, coordinates[i].v,
                             coordinates[i].lod, got[i][0], expected));
    }
}

TEST_CASE("the mip filter Base never leaves level 0", "[7.18.10]") {
    const Texture texture = constant_levels(16, 16, 5);
    for (const auto& color : sample_all(texture, Sampler{.mip = MipFilter::Base}, Profile{}, lods())) REQUIRE(color[0] == 0.0f);
    for (const auto& color :
         sample_all(texture, Sampler{.min = TexelFilter::Nearest, .mip = MipFilter::Base, .min_lod = 3.0f}, Profile{}, lods()))
        REQUIRE(color[0] == 0.0f);
}

TEST_CASE("a coarser level nobody needs does not leak its NaN", "[7.18.10][7.18.16]") {
    Texture texture = constant_levels(4, 4, 3);
    const std::vector<float> nans(4, std::nanf(""));
    texture.set_level_bytes(1, std::as_bytes(std::span(nans)).data(), 16);
    const std::vector<Coordinate> coordinates{{0.5f, 0.5f, 0.0f}, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, -1.0f}, {0.5f, 0.5f, 2.0f}};
    const auto got = sample_all(texture, Sampler{.mip = MipFilter::Linear}, Profile{}, coordinates);
    CHECK(got[0][0] == 0.0f);
    CHECK(got[1][0] != got[1][0]);
    CHECK(got[2][0] == 0.0f);
    CHECK(got[3][0] == 2048.0f);
}
