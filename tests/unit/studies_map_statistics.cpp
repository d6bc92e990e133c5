// What became of numbers that a map cannot hold, counted in textures made by hand.
#include "studies/map_statistics.h"

#include <catch2/catch.hpp>

#include <bit>
#include <span>
#include <vector>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

template <class Code>
Texture texture_of(const TextureDesc& desc, const std::vector<Code>& codes, int layer = 0) {
    Texture texture(desc);
    const auto bytes = std::as_bytes(std::span(codes));
    texture.set_level_bytes(0, bytes.data(), bytes.size(), layer);
    return texture;
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
    const Texture texture = texture_of<std::uint16_t>({.format = Format::Rg16Float, .width = 2, .height = 6}, codes);
    const MapStatistics counts = map_statistics(texture);
    CHECK(counts.texels == 12);
    CHECK(counts.saturated == 4);
    CHECK(counts.infinite == 4);
    CHECK(counts.nan == 3);
}

TEST_CASE("map statistics of 32-bit floats, one and four components", "[studies]") {
    const std::vector<std::uint32_t> codes{0x7f7fffff, 0xff7fffff, 0x7f7ffffe, 0x7f800000, 0xff800000, 0x7fc00000,
                                           0xff800001, 0x3f800000, 0x00000001, 0x80000000, 0x477fe000, 0x47800000};
    const MapStatistics one =
        map_statistics(texture_of<std::uint32_t>({.format = Format::R32Float, .width = 4, .height = 3}, codes));
    CHECK(one == MapStatistics{.texels = 12, .saturated = 2, .infinite = 2, .nan = 2});  // 65504 is nothing special here
    const MapStatistics four =
        map_statistics(texture_of<std::uint32_t>({.format = Format::Rgba32Float, .width = 3, .height = 1}, codes));
    CHECK(four == MapStatistics{.texels = 3, .saturated = 1, .infinite = 2, .nan = 1});
}

TEST_CASE("map statistics: every slice, level 0 alone, and odd sides without their padding", "[studies]") {
    const TextureDesc desc{
        .format = Format::R16Float, .width = 3, .height = 3, .levels = 2, .kind = TextureKind::Array, .layers = 2};
    Texture texture(desc);
    const std::vector<std::uint16_t> first{0x7bff, 0, 0, 0, 0, 0, 0, 0, 0x7bff};
    const std::vector<std::uint16_t> second{0, 0, 0, 0, 0x7c00, 0, 0, 0, 0};
    const std::vector<std::uint16_t> mip{0x7e00};
    const auto write = [&](int level, const std::vector<std::uint16_t>& codes, int layer) {
        const auto bytes = std::as_bytes(std::span(codes));
        texture.set_level_bytes(level, bytes.data(), bytes.size(), layer);
    };
    write(0, first, 0);
    write(0, second, 1);
    write(1, mip, 0);
    CHECK(map_statistics(texture) == MapStatistics{.texels = 18, .saturated = 2, .infinite = 1, .nan = 0});
}

TEST_CASE("map statistics of formats without such numbers: texels alone", "[studies]") {
    const std::vector<std::uint16_t> ones(8, 0xffff);
    CHECK(map_statistics(texture_of<std::uint16_t>({.format = Format::Rg16Unorm, .width = 2, .height = 2}, ones)) ==
          MapStatistics{.texels = 4});
    const std::vector<float> depths(4, 1.0f);
    CHECK(map_statistics(texture_of<float>({.format = Format::D32Float, .width = 2, .height = 2}, depths)) ==
          MapStatistics{.texels = 4});
}

TEST_CASE("map statistics add up", "[studies]") {
    MapStatistics sum{.texels = 1, .saturated = 2, .infinite = 3, .nan = 4};
    sum += {.texels = 10, .saturated = 20, .infinite = 30, .nan = 40};
    CHECK(sum == MapStatistics{.texels = 11, .saturated = 22, .infinite = 33, .nan = 44});
    CHECK(
        worse({.texels = 4, .saturated = 2, .infinite = 3, .nan = 0}, {.texels = 4, .saturated = 1, .infinite = 5, .nan = 0}) ==
        MapStatistics{.texels = 4, .saturated = 2, .infinite = 5, .nan = 0});
}
