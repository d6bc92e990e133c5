// Mip generation against a box filter in double: every level from the stored level above, rounded to the format once.
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/mipmap.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Share of texel i of the level above that texel x of the level below covers, by areas: intervals of [0, above) cut in
/// `below`.
long double area_weight(int x, int i, int below, int above) {
    const long double left = static_cast<long double>(x) * above / below;
    const long double right = static_cast<long double>(x + 1) * above / below;
    const long double overlap = std::min<long double>(right, i + 1) - std::max<long double>(left, i);
    return overlap > 0 ? overlap / (right - left) : 0;
}

}  // namespace

TEST_CASE("every level is the mean over the area it covers in the level above", "[mips]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        for (const auto& [width, height] :
             {std::pair{16, 8}, std::pair{17, 5}, std::pair{1, 9}, std::pair{7, 1}, std::pair{33, 31}, std::pair{3, 3}}) {
            oracle::Random random(static_cast<std::uint64_t>(info.format) * 100 + static_cast<std::uint64_t>(width));
            Texture texture(
                {.format = info.format, .width = width, .height = height, .levels = full_level_count(width, height)});
            std::vector<std::uint32_t> codes(static_cast<std::size_t>(width * height * info.components));
            for (std::size_t i = 0; i < codes.size(); ++i)
                codes[i] = moderate_code(info.format, random, static_cast<int>(i) % info.components);
            const auto bytes = texture_of(info.format, width, height, codes).level_bytes(0);
            texture.set_level_bytes(0, bytes.data(), bytes.size());
            Workers workers(2);
            generate_mips(texture, Profile{}, workers);
            for (int level = 1; level < texture.desc().levels; ++level)
                for (int y = 0; y < texture.height(level); ++y)
                    for (int x = 0; x < texture.width(level); ++x)
                        for (int c = 0; c < info.components; ++c) {
                            long double exact = 0;
                            for (int j = 0; j < texture.height(level - 1); ++j)
                                for (int i = 0; i < texture.width(level - 1); ++i)
                                    exact += area_weight(x, i, texture.width(level), texture.width(level - 1)) *
                                             area_weight(y, j, texture.height(level), texture.height(level - 1)) *
                                             static_cast<long double>(
                                                 code_value(info.format, code_at(texture, level - 1, i, j, c), c));
                            const auto got =
                                static_cast<long double>(code_value(info.format, code_at(texture, level, x, y, c), c));
                            // fp32: 3 + 3 weights, products and sums on values up to 1; then the format's own rounding.
                            long double bound = 12 * 0x1p-24L;
                            if (info.type == ComponentType::Float16) bound += std::max(std::fabs(exact) * 0x1p-10L, 0x1p-24L);
                            if (info.type == ComponentType::Unorm8) bound += 0.5L / 255;
                            if (info.type == ComponentType::Snorm8) bound += 0.5L / 127;
                            if (info.type == ComponentType::Snorm16) bound += 0.5L / 32767;
                            if (info.type == ComponentType::Srgb8) bound += 1.4L / 255;  // the curve is at most 2.28 steep at 1
                            if (info.type == ComponentType::Float11)
                                bound += std::max(exact * (c < 2 ? 0x1p-6L : 0x1p-5L), c < 2 ? 0x1p-20L : 0x1p-19L);
                            if (info.type == ComponentType::Unorm16 || info.type == ComponentType::Depth16)
                                bound += 0.5L / 65535;
                            if (info.type == ComponentType::Depth24) bound += 0.5L / 16777215;
                            if (!(std::fabs(got - exact) <= bound))
                                FAIL(fmt::format("{} {}x{} level {} texel ({}, {}) channel {}: {:a}, exact {:a}", info.name,
                                                 width, height, level, x, y, c, static_cast<double>(got),
                                                 static_cast<double>(exact)));
                        }
        }
    }
}

TEST_CASE("mips of a power of two in unorm8 are exactly rounded means", "[mips][3.2.3.6]") {
    oracle::Random random(6);
    Texture texture({.format = Format::R8Unorm, .width = 64, .height = 64, .levels = 7});
    std::vector<std::uint32_t> codes(64 * 64);
    for (auto& code : codes) code = random.bits() & 0xffu;
    const auto bytes = texture_of(Format::R8Unorm, 64, 64, codes).level_bytes(0);
    texture.set_level_bytes(0, bytes.data(), bytes.size());
    Workers workers(1);
    generate_mips(texture, load_profile("ideal"), workers);
    for (int level = 1; level < 7; ++level)
        for (int y = 0; y < texture.height(level); ++y)
            for (int x = 0; x < texture.width(level); ++x) {
                std::uint32_t sum = 0;
                for (int k = 0; k < 4; ++k) sum += code_at(texture, level - 1, 2 * x + k % 2, 2 * y + k / 2, 0);
                const std::uint32_t got = code_at(texture, level, x, y, 0);
                // sum / 4 + 1/2 truncated; exact ties may fall either way by the rounding of c / 255.
                const bool tie = sum % 4 == 2;
                if (got != (sum + 2) / 4 && !(tie && got == sum / 4))
                    FAIL(fmt::format("level {} ({}, {}): {}, sum of four {}", level, x, y, got, sum));
            }
}

TEST_CASE("mips do not depend on threads", "[mips]") {
    std::vector<std::vector<std::byte>> chains;
    for (const int threads : {1, 2, 8}) {
        oracle::Random random(7);
        Texture texture({.format = Format::Rg16Float, .width = 517, .height = 301, .levels = 10});
        std::vector<std::uint32_t> codes(517 * 301 * 2);
        for (auto& code : codes) code = moderate_code(Format::Rg16Float, random);
        const auto bytes = texture_of(Format::Rg16Float, 517, 301, codes).level_bytes(0);
        texture.set_level_bytes(0, bytes.data(), bytes.size());
        Workers workers(threads);
        generate_mips(texture, Profile{}, workers);
        chains.emplace_back();
        for (int level = 0; level < 10; ++level) {
            const auto one = texture.level_bytes(level);
            chains.back().insert(chains.back().end(), one.begin(), one.end());
        }
    }
    CHECK(chains[0] == chains[1]);
    CHECK(chains[0] == chains[2]);
}
