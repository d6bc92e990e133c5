// D3D11.3 7.18.16.3: results lie between the texels they come from, constants stay, weights act monotonically.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/mipmap.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Any code with a finite value, up to the largest the format holds.
std::uint32_t finite_code(Format format, oracle::Random& random, int component) {
    const ComponentType type = format_info(format).type;
    if (type == ComponentType::Float11) return static_cast<std::uint32_t>(random.between(0, component < 2 ? 0x7bf : 0x3df));
    if (type == ComponentType::Float16) {
        const std::uint32_t code = random.bits() & 0xffffu;
        return (code & 0x7c00u) == 0x7c00u ? code & 0x83ffu : code;
    }
    if (type == ComponentType::Float32) {
        // Differences of two texels must not overflow: magnitudes below 2^126.
        const std::uint32_t code = random.bits();
        return (code >> 23 & 0xffu) > 252u ? code & 0x807fffffu : code;
    }
    return moderate_code(format, random, component);
}

}  // namespace

TEST_CASE("filtered values lie between the smallest and largest texel", "[7.18.16][7.18.16.3]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format) + 100);
        for (int round = 0; round < 60; ++round) {
            const auto count = static_cast<std::size_t>(16 * info.components);
            std::vector<std::uint32_t> codes(count);
            const bool near = round % 3 == 0;  // neighbouring codes: where rounding could step outside
            const std::uint32_t base = moderate_code(info.format, random, 2);
            for (std::size_t i = 0; i < count; ++i)
                codes[i] = near ? std::max(base, 4u) - static_cast<std::uint32_t>(random.integer(0, 3))
                                : finite_code(info.format, random, static_cast<int>(i) % info.components);
            const Texture texture = texture_of(info.format, 4, 4, codes);
            std::vector<Coordinate> coordinates;
            for (int i = 0; i < 100; ++i) coordinates.push_back({random.in(0.125f, 0.875f), random.in(0.125f, 0.875f)});
            const auto got = sample_all(texture, Sampler{}, Profile{}, coordinates);
            for (int c = 0; c < info.components; ++c) {
                oracle::Image image{4, 4, {}, 0};
                for (std::size_t i = static_cast<std::size_t>(c); i < count; i += static_cast<std::size_t>(info.components)) {
                    double value = code_value(info.format, codes[i], c);
                    if (std::fabs(value) < 0x1p-126) value = 0;  // denormals count as 0 in arithmetic
                    image.texels.push_back(value);
                }
                for (std::size_t i = 0; i < got.size(); ++i) {
                    const auto u = oracle::linear_axis(coordinates[i].u, 4, oracle::Address::Clamp);
                    const auto v = oracle::linear_axis(coordinates[i].v, 4, oracle::Address::Clamp);
                    const auto taps = image.taps(u, v);
                    const auto [low, high] = std::ranges::minmax(taps);
                    const auto value = static_cast<double>(got[i][static_cast<std::size_t>(c)]);
                    if (!(value >= low && value <= high))
                        FAIL(fmt::format("{} round {} uv ({:a}, {:a}) channel {}: {:a} outside [{:a}, {:a}], weights {} {}",
                                         info.name, round, coordinates[i].u, coordinates[i].v, c, value, low, high, u.weight,
                                         v.weight));
                }
            }
        }
    }
}

TEST_CASE("a constant texture gives that constant, for every format, filter and mode", "[7.18.16]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format) + 200);
        for (int round = 0; round < 40; ++round) {
            std::vector<std::uint32_t> one(static_cast<std::size_t>(info.components));
            for (std::size_t c = 0; c < one.size(); ++c) one[c] = finite_code(info.format, random, static_cast<int>(c));
            Texture texture({.format = info.format, .width = 5, .height = 3, .levels = 3});
            for (int level = 0; level < 3; ++level) {
                std::vector<std::uint32_t> codes;
                for (int i = 0; i < texture.width(level) * texture.height(level); ++i)
                    codes.insert(codes.end(), one.begin(), one.end());
                const Texture flat = texture_of(info.format, texture.width(level), texture.height(level), codes);
                const auto bytes = flat.level_bytes(0);
                texture.set_level_bytes(level, bytes.data(), bytes.size());
            }
            std::vector<Coordinate> coordinates;
            for (int i = 0; i < 64; ++i)
                coordinates.push_back({random.in(-3.0f, 3.0f), random.in(-3.0f, 3.0f), random.in(-1.0f, 4.0f)});
            for (const AddressMode mode : {AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp})
                for (const TexelFilter filter : {TexelFilter::Nearest, TexelFilter::Linear})
                    for (const MipFilter mip : {MipFilter::Base, MipFilter::Nearest, MipFilter::Linear}) {
                        const auto got = sample_all(
                            texture, {.min = filter, .mag = filter, .mip = mip, .address_u = mode, .address_v = mode},
                            Profile{}, coordinates);
                        for (const auto& color : got)
                            for (std::size_t c = 0; c < one.size(); ++c) {
                                double expected = code_value(info.format, one[c], static_cast<int>(c));
                                const bool tiny = std::fabs(expected) < 0x1p-126;
                                if (static_cast<double>(color[c]) != expected && !(tiny && color[c] == 0.0f))
                                    FAIL(fmt::format("{} {} {} {} channel {}: {:a}, expected {:a}", info.name, name_of(mode),
                                                     name_of(filter), name_of(mip), c, color[c], expected));
                            }
                    }
        }
    }
}

TEST_CASE("filtered values are monotone in each weight", "[7.18.16]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format) + 300);
        for (int round = 0; round < 30; ++round) {
            std::vector<std::uint32_t> codes(static_cast<std::size_t>(4 * info.components));
            for (std::size_t i = 0; i < codes.size(); ++i)
                codes[i] = finite_code(info.format, random, static_cast<int>(i) % info.components);
            const Texture texture = texture_of(info.format, 2, 2, codes);
            // Along u at a fixed v, the direction is that of the two rows mixed: monotone, up or down. Same along v.
            for (const bool along_u : {true, false}) {
                const float other = 0.25f + static_cast<float>(random.integer(0, 255)) / 512.0f;
                std::vector<Coordinate> coordinates;
                for (int w = 0; w < 256; ++w) {
                    const float moving = 0.25f + static_cast<float>(w) / 512.0f;
                    coordinates.push_back(along_u ? Coordinate{moving, other} : Coordinate{other, moving});
                }
                const auto got = sample_all(texture, Sampler{}, Profile{}, coordinates);
                for (int c = 0; c < info.components; ++c) {
                    const auto channel = static_cast<std::size_t>(c);
                    bool up = true;
                    bool down = true;
                    for (std::size_t w = 1; w < got.size(); ++w) {
                        up = up && got[w][channel] >= got[w - 1][channel];
                        down = down && got[w][channel] <= got[w - 1][channel];
                    }
                    // Mixing along v after u, each row's value moves by its own rounding: only along v is strict monotony
                    // promised by one lerp; along u both rows must move the same way.
                    const double t00 = code_value(info.format, codes[channel], c);
                    const double t10 = code_value(info.format, codes[static_cast<std::size_t>(info.components) + channel], c);
                    const double t01 =
                        code_value(info.format, codes[static_cast<std::size_t>(2 * info.components) + channel], c);
                    const double t11 =
                        code_value(info.format, codes[static_cast<std::size_t>(3 * info.components) + channel], c);
                    const bool same_way = !along_u || ((t10 >= t00) == (t11 >= t01));
                    if (same_way && !up && !down)
                        FAIL(fmt::format(
                            "{} round {} {} channel {}: not monotone; texels {:a} {:a} {:a} {:a}, other weight {:a}", info.name,
                            round, along_u ? "u" : "v", c, t00, t10, t01, t11, other));
                }
            }
        }
    }
}

TEST_CASE("point sampling yields the texel's bits", "[7.18.16]") {
    // Every half and unorm16 code through a texture; floats of any bits, NaN payloads included, as loads keep bits.
    std::vector<std::uint32_t> codes(256 * 256);
    for (std::uint32_t i = 0; i < 65536; ++i) codes[i] = i;
    std::vector<Coordinate> coordinates;
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x)
            coordinates.push_back({(static_cast<float>(x) + 0.5f) / 256.0f, (static_cast<float>(y) + 0.5f) / 256.0f});
    const Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    for (const Format format : {Format::R16Float, Format::R16Unorm, Format::D16}) {
        const auto got = sample_all(texture_of(format, 256, 256, codes), sampler, Profile{}, coordinates);
        for (std::uint32_t i = 0; i < 65536; ++i) {
            const double expected = code_value(format, i);
            const auto value = static_cast<double>(got[i][0]);
            if (value != expected && !(value != value && expected != expected))
                FAIL(fmt::format("{} code {:#x}: {:a}, expected {:a}", name_of(format), i, value, expected));
        }
    }
    oracle::Random random(8);
    for (auto& code : codes) code = random.bits();
    const auto got = sample_all(texture_of(Format::R32Float, 256, 256, codes), sampler, Profile{}, coordinates);
    for (std::size_t i = 0; i < codes.size(); ++i) REQUIRE(std::bit_cast<std::uint32_t>(got[i][0]) == codes[i]);
}

TEST_CASE("constant textures of infinities stay infinite", "[7.18.16][7.18.16.2]") {
    // "Filtering a constant-color texture always yields that color": a float format may hold infinity in every texel
    // (moments that overflow fp16 do), and a + w (b - a) would make NaN of it.
    const std::uint32_t inf = 0x7c00;
    const std::vector<std::uint32_t> codes(16, inf);
    const Texture texture = texture_of(Format::R16Float, 4, 4, codes);
    const auto got = sample_all(texture, Sampler{}, Profile{}, std::vector<Coordinate>{{0.5f, 0.5f}, {0.4f, 0.3f}});
    CHECK(got[0][0] == HUGE_VALF);
    CHECK(got[1][0] == HUGE_VALF);
}

TEST_CASE("mips, probes and ellipses keep constants and the range of the texels, for every profile", "[7.18.16][7.18.16.3]") {
    // Odd sizes, whose mip weights do not round to a sum of 1; the largest numbers, whose differences overflow.
    oracle::Random random(16);
    for (const Profile& profile : profile_presets()) {
        if (profile.address_arithmetic != AddressArithmetic::FixedPoint) continue;  // these make no such promise
        for (const float magnitude : {0.1f, 1.0f, 3.4e38f}) {
            const bool constant = magnitude < 1.0f;
            for (const auto& [width, height] : {std::pair{25, 1}, std::pair{13, 7}, std::pair{31, 57}}) {
                Texture texture(
                    {.format = Format::R32Float, .width = width, .height = height, .levels = full_level_count(width, height)});
                std::vector<float> texels(static_cast<std::size_t>(width * height), magnitude);
                if (!constant)
                    for (float& texel : texels) texel = random.chance(2) ? magnitude : -magnitude;
                texture.set_level_bytes(0, std::as_bytes(std::span(texels)).data(), texels.size() * 4);
                Workers workers(1);
                generate_mips(texture, profile, workers);
                for (const int anisotropy : {1, 16}) {
                    const Sampler sampler{.mip = MipFilter::Linear,
                                          .address_u = AddressMode::Wrap,
                                          .address_v = AddressMode::Mirror,
                                          .max_anisotropy = anisotropy};
                    std::vector<SampleRequest> requests;
                    for (int i = 0; i < 200; ++i) {
                        SampleRequest request{.coordinate = {random.in(-1.0f, 2.0f), random.in(-1.0f, 2.0f), 0}};
                        const auto derivative = [&] { return static_cast<double>(random.in(-0.3f, 0.3f)); };
                        request.gradient =
                            SampleGradient{.dx = {derivative(), derivative(), 0}, .dy = {derivative(), derivative(), 0}};
                        requests.push_back(request);
                    }
                    for (const SampleResult& result : gnomon::sample_all(texture, sampler, profile, requests)) {
                        const auto largest = static_cast<double>(magnitude);
                        const bool legal = constant ? result.color[0] == largest : std::fabs(result.color[0]) <= largest;
                        if (!legal)
                            FAIL(fmt::format("{} {}x{} anisotropy {}: {:a} from texels of magnitude {:a}", profile.name, width,
                                             height, anisotropy, result.color[0], largest));
                    }
                }
            }
        }
    }
}
