// D3D11.3 22.4.6: codes of unsigned integers loaded by pixel functors, all 32 bits of every component.
#include "tests/unit/functor_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <climits>
#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Texel (x, y) of the pixel, moved; lower and upper halves of its codes, for a float holds no 32 bits.
struct LoadCodes {
    TextureLevels map;
    int move_x = 0;
    int move_y = 0;
    int level = 0;
    int layer = 0;
    static constexpr auto fields() {
        using L = LoadCodes;
        return std::tuple{Field{"map", &L::map}, Field{"move_x", &L::move_x}, Field{"move_y", &L::move_y},
                          Field{"level", &L::level}, Field{"layer", &L::layer}};
    }
    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x) + Int(move_x);
        const Int y = truncate_to_int(f.position.y) + Int(move_y);
        const Vec4<Int> codes = f.load_codes(map, x, y, {.level = level, .layer = layer});
        const auto low = [](Int code) { return Real(code & Int(0xffff)); };
        const auto high = [](Int code) { return Real(shift_right_logical<16>(code)); };
        return std::array{Vec4<Real>{low(codes.x), low(codes.y), low(codes.z), low(codes.w)},
                          Vec4<Real>{high(codes.x), high(codes.y), high(codes.z), high(codes.w)}};
    }
};

/// The same texels as numbers.
struct LoadNumbers {
    TextureLevels map;
    int move_x = 0;
    int move_y = 0;
    int level = 0;
    int layer = 0;
    static constexpr auto fields() {
        using L = LoadNumbers;
        return std::tuple{Field{"map", &L::map}, Field{"move_x", &L::move_x}, Field{"move_y", &L::move_y},
                          Field{"level", &L::level}, Field{"layer", &L::layer}};
    }
    template <class F>
    auto operator()(const F& f) const {
        const Int x = truncate_to_int(f.position.x) + Int(move_x);
        const Int y = truncate_to_int(f.position.y) + Int(move_y);
        const auto number = f.load(map, x, y, {.level = level, .layer = layer});
        return std::array{number, number};
    }
};

constexpr int kLevels = 3;
constexpr int kLayers = 4;

/// Where a load lands in the texture; nothing outside of it.
const std::byte* texel_at(const Texture& texture, const LoadCodes& pixel, std::size_t i) {
    const std::int64_t x = static_cast<std::int64_t>(i % kFunctorSide) + pixel.move_x;
    const std::int64_t y = static_cast<std::int64_t>(i / kFunctorSide) + pixel.move_y;
    const int levels = pixel.map.levels == 0 ? kLevels - pixel.map.first_level : pixel.map.levels;
    if (pixel.level < 0 || pixel.level >= levels || pixel.layer < 0 || pixel.layer >= kLayers) return nullptr;
    const int level = pixel.map.first_level + pixel.level;
    if (x < 0 || y < 0 || x >= texture.width(level) || y >= texture.height(level)) return nullptr;
    return texture.row(level, static_cast<int>(y), pixel.layer) + x * texture.info().bytes_per_texel;
}

/// Returns how many pixels saw a texel.
std::size_t check_codes(Device& device, const LoadCodes& pixel) {
    const FunctorResult drawn = run_functor(device, pixel);
    const Texture& texture = device.texture(pixel.map.texture);
    const auto components = static_cast<std::size_t>(texture.info().components);
    std::size_t inside = 0;
    for (std::size_t i = 0; i < kFunctorPixels; ++i) {
        std::array<std::uint32_t, 4> expected{0, 0, 0, components == 4 ? 0u : 1u};  // D3D11.3 19.1.3.3
        if (const std::byte* texel = texel_at(texture, pixel, i); texel != nullptr) {
            std::memcpy(expected.data(), texel, components * 4);
            ++inside;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const auto got = static_cast<std::uint32_t>(drawn.at(i, k, 0)) | static_cast<std::uint32_t>(drawn.at(i, k, 1))
                                                                                 << 16;
            if (got != expected[k]) FAIL(fmt::format("pixel {} component {}: {:#x}, expected {:#x}", i, k, got, expected[k]));
        }
    }
    // Counted like a load of numbers.
    const FunctorResult numbers =
        run_functor(device, LoadNumbers{pixel.map, pixel.move_x, pixel.move_y, pixel.level, pixel.layer});
    CHECK(drawn.tally.counters == numbers.tally.counters);
    CHECK(drawn.tally.counters.texture_instructions == kFunctorPixels);
    CHECK(drawn.tally.of(pixel.map.texture) == numbers.tally.of(pixel.map.texture));
    CHECK(drawn.tally.of(pixel.map.texture).read == kFunctorPixels * components * 4);
    return inside;
}

}  // namespace

TEST_CASE("codes of unsigned integers reach a functor to the bit", "[22.4.6][19.1.4]") {
    for (const char* profile : {"d3d11", "ideal", "nv40"}) {
        for (const Format format : {Format::R32Uint, Format::Rg32Uint, Format::Rgba32Uint}) {
            INFO(profile << " " << name_of(format));
            Device device(load_profile(profile), 1);
            // Codes that are neither floats of their own value nor survive as floats, among them.
            const std::array<std::uint32_t, 6> edges{0xffffffffu, 0x7fffffffu, 0x80000000u, 0x01000001u, 0x7f800001u, 1u};
            const TextureId map = random_texture(
                device,
                {.format = format, .width = 13, .height = 7, .levels = kLevels, .kind = TextureKind::Array, .layers = kLayers},
                7, [&](oracle::Random& random) {
                    return random.chance(3) ? edges[static_cast<std::size_t>(random.integer(0, 5))] : random.bits();
                });
            for (int level = 0; level < kLevels; ++level)
                for (int layer = 0; layer < kLayers; ++layer)
                    CHECK(check_codes(device, {.map = map, .level = level, .layer = layer}) ==
                          static_cast<std::size_t>((13 >> level) * (7 >> level)));
            // Views of some levels count from their first.
            CHECK(check_codes(device, {.map = {map, 1, 1}, .layer = 2}) == 6 * 3);
            CHECK(check_codes(device, {.map = {map, 1, 0}, .level = 1}) == 3 * 1);
            CHECK(check_codes(device, {.map = {map, 0, 1}, .level = 1}) == 0);
            CHECK(check_codes(device, {.map = {map, 1, 0}, .level = INT_MAX}) == 0);
            // Out of range is 0.
            CHECK(check_codes(device, {.map = map, .move_x = -3, .move_y = -2}) == 13 * 7);
            for (const int far : {-64, 64, INT_MAX - 20, INT_MIN}) {
                CHECK(check_codes(device, {.map = map, .move_x = far}) == 0);
                CHECK(check_codes(device, {.map = map, .move_y = far}) == 0);
            }
            for (const int outside : {-1, kLevels, kLayers, INT_MIN, INT_MAX}) {
                CHECK(check_codes(device, {.map = map, .level = outside}) == 0);
                if (outside != kLevels) CHECK(check_codes(device, {.map = map, .layer = outside}) == 0);
            }
        }
    }
}
