// D3D11.3 7.18.9, 22.4.15: mirror-once, texel offsets before the address mode at every level, slices of arrays.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/address.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr std::array kModes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border,
                            AddressMode::MirrorOnce};
constexpr std::array kSizes{1, 2, 3, 5, 16};
constexpr int kBorder = -1;

/// The pseudo-code of 7.18.9, where % and / are C's.
int addressed(int scaled, int size, AddressMode mode) {
    if (!(scaled < 0 || scaled > size - 1)) return scaled;
    switch (mode) {
        case AddressMode::Wrap:
            scaled = scaled % size;
            if (scaled < 0) scaled += size;
            return scaled;
        case AddressMode::Mirror: {
            if (scaled < 0) scaled = -scaled - 1;
            const bool flip = ((scaled / size) & 1) != 0;
            scaled %= size;
            return flip ? size - scaled - 1 : scaled;
        }
        case AddressMode::Clamp: return std::max(0, std::min(scaled, size - 1));
        case AddressMode::MirrorOnce:
            if (scaled < 0) scaled = -scaled - 1;
            return std::max(0, std::min(scaled, size - 1));
        case AddressMode::Border: return kBorder;
    }
    return 0;
}

/// Left or only texel of a coordinate before the address mode, by 7.18.7 and 7.18.8; u is a multiple of 2^-7, so that u size is
/// exact and range reduction, which "does not change expected texture sampling behavior", has nothing to lose.
int texel_of(double u, int size, bool linear) {
    const double steps = (u * size - (linear ? 0.5 : 0.0)) * 256.0;
    double whole = std::floor(steps);
    const double rest = steps - whole;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<int>(std::floor(whole / 256.0));
}

/// Texel (x, y) of level n is n 4096 + y 64 + x + 1; the border is -1.
Texture numbered(int width, int height) {
    Texture texture({.format = Format::R32Float, .width = width, .height = height, .levels = full_level_count(width, height)});
    for (int level = 0; level < texture.desc().levels; ++level) {
        std::vector<float> values;
        for (int y = 0; y < texture.height(level); ++y)
            for (int x = 0; x < texture.width(level); ++x) values.push_back(static_cast<float>(level * 4096 + y * 64 + x + 1));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

/// Whether the taps of a level are the texels the text selects.
bool right_taps(const LevelRecord& level, const Texture& texture, const Sampler& sampler, const SampleRequest& request,
                bool linear) {
    const int width = texture.width(level.level);
    const int height = texture.height(level.level);
    const int left = texel_of(request.coordinate[0], width, linear) + request.offset.x;
    const int top = texel_of(request.coordinate[1], height, linear) + request.offset.y;
    if (level.taps.size() != (linear ? 4u : 1u)) return false;
    for (int tap = 0; tap < static_cast<int>(level.taps.size()); ++tap) {
        const TapRecord& t = level.taps[static_cast<std::size_t>(tap)];
        const int x = addressed(left + (tap & 1), width, sampler.address_u);
        const int y = addressed(top + (tap >> 1), height, sampler.address_v);
        const bool border = x == kBorder || y == kBorder;
        if (t.border != border) return false;
        if (!border && (t.x != x || t.y != y)) return false;
        if (t.value[0] != (border ? -1.0 : level.level * 4096 + y * 64 + x + 1)) return false;
    }
    return true;
}

std::string text(const Texture& texture, const Sampler& sampler, const SampleRequest& r, const LevelRecord& level) {
    std::string taps;
    for (const TapRecord& t : level.taps) taps += fmt::format(" ({}, {}){}", t.x, t.y, t.border ? " border" : "");
    return fmt::format("{}x{} level {} {} {} at ({:a}, {:a}) offset ({}, {}): taps{}", texture.desc().width,
                       texture.desc().height, level.level, name_of(sampler.address_u), name_of(sampler.address_v),
                       r.coordinate[0], r.coordinate[1], r.offset.x, r.offset.y, taps);
}

}  // namespace

TEST_CASE("offset texel indices wrap as the specification's pseudo-code", "[7.18.9]") {
    for (const int size : {1, 2, 3, 5, 16, 17, 1000, 16384})
        for (const AddressMode mode : kModes)
            for (int t = -10 * size - 40; t <= 10 * size + 40; t += size > 100 ? 37 : 1) {
                const int expected = addressed(t, size, mode);
                const int got = lane(apply_address_mode(Int(t), Int(size), mode, true), 0);
                const bool border = (outside(Int(t), Int(size), mode).bits() & 1u) != 0;
                if (border != (expected == kBorder) || (!border && got != expected) || got < 0 || got >= size)
                    FAIL(fmt::format("{} of {} in {}: {} border {}, expected {}", name_of(mode), t, size, got, border,
                                     expected));
            }
}

TEST_CASE("mirror-once mirrors about 0 and clamps beyond", "[7.18.9]") {
    for (const int size : kSizes)
        for (int t = -10 * size - 1; t <= 10 * size + 1; ++t) {
            const int expected = std::min(t < 0 ? -t - 1 : t, size - 1);
            const int got = lane(apply_address_mode(Int(t), Int(size), AddressMode::MirrorOnce), 0);
            if (got != expected) FAIL(fmt::format("{} in {}: {}, expected {}", t, size, got, expected));
        }
    // Through the whole instruction: u and -u read the same texels of a symmetric kernel, 1 and beyond the last one.
    const Texture texture = numbered(16, 1);
    const Sampler sampler{.address_u = AddressMode::MirrorOnce};
    const auto at = [&](float u) { return sample_all(texture, sampler, Profile{}, std::vector<Coordinate>{{u, 0.5f}})[0][0]; };
    for (int k = 0; k <= 12 * 64; ++k) {
        const float u = static_cast<float>(k) / 64.0f;
        INFO("u " << u);
        CHECK(at(u) == at(-u));
        if (u >= 1.0f) CHECK(at(u) == 16.0f);
    }
    CHECK(at(0.25f) != at(0.5f));
}

TEST_CASE("every offset with every address mode on every size, nearest and linear", "[7.18.9][22.4.15]") {
    int borders = 0;
    for (const bool linear : {false, true})
        for (const int size : kSizes) {
            const Texture texture = numbered(size, 16);
            for (const AddressMode mode : kModes) {
                Sampler sampler{.address_u = mode, .address_v = AddressMode::Clamp, .border = glm::vec4(-1.0f)};
                if (!linear) sampler.min = sampler.mag = TexelFilter::Nearest;
                for (int offset = -8; offset <= 7; ++offset)
                    for (int k = -12 * 128; k <= 12 * 128; k += 11) {
                        const SampleRequest request{.coordinate = {k / 128.0, 0.46875, 0}, .offset = {offset, 0}};
                        const SampleRecord record = record_sample(texture, sampler, Profile{}, request);
                        const LevelRecord& level = record.probes.at(0).levels.at(0);
                        if (!right_taps(level, texture, sampler, request, linear)) FAIL(text(texture, sampler, request, level));
                        borders += level.taps[0].border;
                    }
            }
        }
    CHECK(borders > 1000);
}

TEST_CASE("offsets count texels of each level that is read, on both axes", "[22.4.15]") {
    // "The offsets are added to the texture coordinates, in texel space, relative to each miplevel being accessed."
    oracle::Random random(2);
    for (const auto& [width, height] :
         {std::pair{16, 5}, std::pair{3, 16}, std::pair{5, 1}, std::pair{2, 2}, std::pair{16, 16}}) {
        const Texture texture = numbered(width, height);
        const int levels = texture.desc().levels;
        std::vector<int> seen(static_cast<std::size_t>(levels), 0);
        for (int round = 0; round < 6000; ++round) {
            Sampler sampler{.mip = random.chance(2) ? MipFilter::Linear : MipFilter::Nearest,
                            .address_u = kModes[static_cast<std::size_t>(random.integer(0, 4))],
                            .address_v = kModes[static_cast<std::size_t>(random.integer(0, 4))],
                            .border = glm::vec4(-1.0f)};
            const bool linear = random.chance(2);
            if (!linear) sampler.min = sampler.mag = TexelFilter::Nearest;
            const SampleRequest request{.coordinate = {random.integer(-256, 384) / 128.0, random.integer(-256, 384) / 128.0, 0},
                                        .lod = random.integer(0, 2 * levels) / 2.0,
                                        .offset = {random.integer(-8, 7), random.integer(-8, 7)}};
            const SampleRecord record = record_sample(texture, sampler, Profile{}, request);
            for (const LevelRecord& level : record.probes.at(0).levels) {
                if (!right_taps(level, texture, sampler, request, linear)) FAIL(text(texture, sampler, request, level));
                ++seen.at(static_cast<std::size_t>(level.level));
            }
        }
        for (const int count : seen) CHECK(count > 100);
    }
}

TEST_CASE("offsets also move comparisons and codes", "[22.4.15][22.4.19]") {
    const Texture depths =
        texture_of(Format::D32Float, 4, 1,
                   std::vector<std::uint32_t>{std::bit_cast<std::uint32_t>(0.1f), std::bit_cast<std::uint32_t>(0.3f),
                                              std::bit_cast<std::uint32_t>(0.5f), std::bit_cast<std::uint32_t>(0.7f)});
    const Sampler nearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .address_u = AddressMode::Wrap};
    const Texture numbers = texture_of(Format::R32Uint, 4, 1, std::vector<std::uint32_t>{10, 11, 12, 13});
    for (int offset = -8; offset <= 7; ++offset) {
        const int texel = ((1 + offset) % 4 + 4) % 4;
        const SampleRequest compared{.coordinate = {0.375, 0.5, 0}, .reference = 0.4, .offset = {offset, 0}};
        const SampleRequest read{.coordinate = {0.375, 0.5, 0}, .offset = {offset, 0}};
        INFO("offset " << offset);
        CHECK(record_sample(depths, nearest, Profile{}, compared).result[0] == (texel >= 2 ? 1.0 : 0.0));  // 0.4 <= depth
        CHECK(record_sample(numbers, nearest, Profile{}, read).result[0] == 10.0 + texel);
    }
}

TEMPLATE_TEST_CASE("slices round to nearest even and clamp to the array", "[22.4.15][5.3.6]", Float, Double) {
    using Scalar = typename TestType::Scalar;
    for (const int layers : {1, 2, 5, 300}) {
        Texture texture(
            {.format = Format::R32Float, .width = 2, .height = 2, .levels = 2, .kind = TextureKind::Array, .layers = layers});
        for (int layer = 0; layer < layers; ++layer)
            for (int level = 0; level < 2; ++level) {
                const std::vector<float> values(level == 0 ? 4 : 1, static_cast<float>(2 * layer + level));
                texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4, layer);
            }
        struct Case {
            double slice;
            int expected;
        };
        std::vector<Case> cases;
        for (int quarter = -16; quarter <= 4 * layers + 16; ++quarter) {
            const double slice = quarter / 4.0;
            double whole = std::floor(slice);
            if (slice - whole > 0.5 || (slice - whole == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
            cases.push_back({slice, std::clamp(static_cast<int>(whole), 0, layers - 1)});
        }
        for (const double slice : {HUGE_VAL, 1e30, 3e9, 1e6, 2147483648.0}) {
            cases.push_back({slice, layers - 1});
            cases.push_back({-slice, 0});
        }
        cases.push_back({std::nan(""), 0});  // 3.2.4.1: the integer of NaN is 0
        if (layers > 1) cases.push_back({static_cast<double>(std::nextafter(Scalar(0.5), Scalar(1))), 1});
        if (layers > 1) cases.push_back({static_cast<double>(std::nextafter(Scalar(1.5), Scalar(0))), 1});
        for (std::size_t first = 0; first < cases.size(); first += kLanes)
            for (const int level : {0, 1}) {
                std::array<Scalar, kLanes> slices;
                for (std::size_t l = 0; l < slices.size(); ++l)
                    slices[l] = static_cast<Scalar>(cases[std::min(first + l, cases.size() - 1)].slice);
                // Offsets do not act along the array.
                const SampleOperands<TestType> operands{.offset = {3, -2}};
                const Vec4<TestType> color =
                    sample(TextureView(texture), Sampler{.mip = MipFilter::Nearest}, Profile{},
                           Vec3<TestType>{TestType(0.3f), TestType(0.3f), TestType::load(slices.data())},
                           LevelOfDetail<TestType>(TestType(static_cast<float>(level))), operands);
                for (std::size_t l = 0; l < slices.size(); ++l) {
                    const Case& c = cases[std::min(first + l, cases.size() - 1)];
                    if (lane(color.x, static_cast<int>(l)) != static_cast<Scalar>(2 * c.expected + level))
                        FAIL(fmt::format("{} layers slice {:a} level {}: {}, expected slice {}", layers, c.slice, level,
                                         lane(color.x, static_cast<int>(l)), c.expected));
                }
            }
    }
}
