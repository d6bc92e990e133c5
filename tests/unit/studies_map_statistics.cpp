// What became of numbers that a map cannot hold, counted in textures made by hand.
#include "studies/map_statistics.h"

#include <catch2/catch.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

template <class Code>
void write(Device& device, TextureId texture, const std::vector<Code>& codes, int level = 0, int layer = 0) {
    device.execute(WriteTexture{texture, level, std::as_bytes(std::span(codes)), layer});
}

/// Of one texture with one level.
template <class Code>
MapStatistics statistics_of(const TextureDesc& desc, const std::vector<Code>& codes) {
    Device device(Profile{}, 1);
    const std::array maps{device.create_texture("map", desc)};
    write(device, maps[0], codes);
    return map_statistics(device, maps);
}

}  // namespace

TEST_CASE("map statistics of halves: the largest number, infinity and NaN of either sign", "[studies]") {
    // Two texels per line, two components each.
    const std::vector<std::uint16_t> codes{
        0x0000, 0x8000, 0x3c00, 0x7bfe,  // nothing
        0x7bff, 0x0000, 0x0000, 0xfbff,  // saturated, both signs
        0x7c00, 0x3c00, 0x3c00, 0xfc00,  // infinite
        0x7e00, 0x0000, 0xfc01, 0x7fff,  // NaN, also twice in one texel
        0x7bff, 0xfbff, 0x7bff, 0x7c00,  // twice saturated counts once; saturated and infinite in each row once
        0x7c00, 0xfe00, 0x0001, 0x83ff,  // infinite and NaN; denormals
    };
    const MapStatistics counts = statistics_of({.format = Format::Rg16Float, .width = 2, .height = 6}, codes);
    CHECK(counts.texels == 12);
    CHECK(counts.saturated == 4);
    CHECK(counts.infinite == 4);
    CHECK(counts.nan == 3);
}

TEST_CASE("map statistics of 32-bit floats, one and four components", "[studies]") {
    const std::vector<std::uint32_t> codes{0x7f7fffff, 0xff7fffff, 0x7f7ffffe, 0x7f800000, 0xff800000, 0x7fc00000,
                                           0xff800001, 0x3f800000, 0x00000001, 0x80000000, 0x477fe000, 0x47800000};
    const MapStatistics one = statistics_of({.format = Format::R32Float, .width = 4, .height = 3}, codes);
    CHECK(one == MapStatistics{.texels = 12, .saturated = 2, .infinite = 2, .nan = 2});  // 65504 is nothing special here
    const MapStatistics four = statistics_of({.format = Format::Rgba32Float, .width = 3, .height = 1}, codes);
    CHECK(four == MapStatistics{.texels = 3, .saturated = 1, .infinite = 2, .nan = 1});
}

TEST_CASE("map statistics: every map and slice, level 0 alone, and odd sides without their padding", "[studies]") {
    Device device(Profile{}, 1);
    const std::array maps{
        device.create_texture(
            "array",
            {.format = Format::R16Float, .width = 3, .height = 3, .levels = 2, .kind = TextureKind::Array, .layers = 2}),
        device.create_texture("flat", {.format = Format::R32Float, .width = 1, .height = 2})};
    write<std::uint16_t>(device, maps[0], {0x7bff, 0, 0, 0, 0, 0, 0, 0, 0x7bff});
    write<std::uint16_t>(device, maps[0], {0, 0, 0, 0, 0x7c00, 0, 0, 0, 0}, 0, 1);
    write<std::uint16_t>(device, maps[0], {0x7e00}, 1);
    write<std::uint32_t>(device, maps[1], {0x7fc00000, 0x7f800000});
    CHECK(map_statistics(device, maps) == MapStatistics{.texels = 20, .saturated = 2, .infinite = 2, .nan = 1});
    CHECK(map_statistics(device, std::span(maps).first(1)) ==
          MapStatistics{.texels = 18, .saturated = 2, .infinite = 1, .nan = 0});
    CHECK(map_statistics(device, {}) == MapStatistics{});
}

TEST_CASE("map statistics of formats without such numbers: texels alone", "[studies]") {
    const std::vector<std::uint16_t> ones(8, 0xffff);
    CHECK(statistics_of({.format = Format::Rg16Unorm, .width = 2, .height = 2}, ones) == MapStatistics{.texels = 4});
    const std::vector<float> depths(4, 1.0f);
    CHECK(statistics_of({.format = Format::D32Float, .width = 2, .height = 2}, depths) == MapStatistics{.texels = 4});
}

TEST_CASE("the worse of two map statistics is the larger of each count", "[studies]") {
    const MapStatistics a{.texels = 10, .saturated = 2, .infinite = 30, .nan = 4};
    const MapStatistics b{.texels = 10, .saturated = 20, .infinite = 3, .nan = 5};
    const MapStatistics larger{.texels = 10, .saturated = 20, .infinite = 30, .nan = 5};
    CHECK(worse(a, b) == larger);
    CHECK(worse(b, a) == larger);
    CHECK(worse(a, {}) == a);
}
