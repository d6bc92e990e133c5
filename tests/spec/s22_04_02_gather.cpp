// D3D11.3 22.4.2 to 22.4.5: gather returns the four texels of a bilinear filter, unfiltered and to the bit.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

template <class Real>
using Gathered = std::array<typename Real::Scalar, 4>;

template <class Real>
Vec3<Real> all_lanes(const std::array<double, 3>& v) {
    using Scalar = typename Real::Scalar;
    return {Real(static_cast<Scalar>(v[0])), Real(static_cast<Scalar>(v[1])), Real(static_cast<Scalar>(v[2]))};
}
template <class Real>
Gathered<Real> lane_of(const Vec4<Real>& v) {
    return {lane(v.x, kLanes - 1), lane(v.y, kLanes - 1), lane(v.z, kLanes - 1), lane(v.w, kLanes - 1)};
}

template <class Real>
Gathered<Real> gathered(const TextureView& view, const Sampler& sampler, const Profile& profile,
                        const std::array<double, 3>& coordinate, int component = 0, const glm::ivec2& offset = {0, 0}) {
    const DenormalScope denormals(profile.flush_denormals);
    return lane_of<Real>(gather(view, sampler, profile, all_lanes<Real>(coordinate), component, offset));
}
template <class Real>
Gathered<Real> compared(const TextureView& view, const Sampler& sampler, const Profile& profile,
                        const std::array<double, 3>& coordinate, double reference, const glm::ivec2& offset = {0, 0}) {
    const DenormalScope denormals(profile.flush_denormals);
    const Real wide(static_cast<typename Real::Scalar>(reference));
    return lane_of<Real>(gather_compare(view, sampler, profile, all_lanes<Real>(coordinate), wide, offset));
}

/// "(-,+),(+,+),(+,-),(-,-)": the column (0 left, 1 right) and row (0 upper, 1 lower) of each result.
constexpr std::array<std::array<int, 2>, 4> kOrder{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
/// The same as indices of taps in the order of 7.18.8: (floor, floor), (ceil, floor), (floor, ceil), (ceil, ceil).
constexpr std::array<std::size_t, 4> kTaps{2, 3, 1, 0};

constexpr std::array kModes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border,
                            AddressMode::MirrorOnce};

/// Left or upper texel under a linear filter; u is a multiple of 2^-7, so u size is exact. 7.18.8
int floor_texel(double u, int size) {
    const double steps = (u * size - 0.5) * 256.0;
    double whole = std::floor(steps);
    const double rest = steps - whole;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<int>(std::floor(whole / 256.0));
}

/// 7.18.9; -1 is the border.
int addressed(int t, int size, AddressMode mode) {
    if (t >= 0 && t < size) return t;
    switch (mode) {
        case AddressMode::Wrap: return (t % size + size) % size;
        case AddressMode::Mirror: {
            if (t < 0) t = -t - 1;
            const bool flip = (t / size) % 2 != 0;
            return flip ? size - t % size - 1 : t % size;
        }
        case AddressMode::Clamp: return std::clamp(t, 0, size - 1);
        case AddressMode::MirrorOnce: return std::min(t < 0 ? -t - 1 : t, size - 1);
        case AddressMode::Border: return -1;
    }
    return 0;
}

Texture numbered(Format format, int width, int height) {
    const auto components = static_cast<std::size_t>(format_info(format).components);
    std::vector<std::uint32_t> codes;
    for (std::size_t i = 0; i < static_cast<std::size_t>(width * height); ++i)
        for (std::size_t c = 0; c < components; ++c)
            codes.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(i * 4 + c + 1)));
    return texture_of(format, width, height, codes);
}

}  // namespace

TEMPLATE_TEST_CASE("the four texels come counter-clockwise from the lower left, any component", "[22.4.2][22.4.4]", Float,
                   Double) {
    oracle::Random random(1);
    int borders = 0;
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{5, 4}, std::pair{16, 16}}) {
        const Texture texture = numbered(Format::Rgba32Float, width, height);
        for (int round = 0; round < 4000; ++round) {
            const Sampler sampler{.address_u = kModes[static_cast<std::size_t>(random.integer(0, 4))],
                                  .address_v = kModes[static_cast<std::size_t>(random.integer(0, 4))],
                                  .border = {-1.0f, -2.0f, -3.0f, -4.0f}};
            const double u = random.integer(-300, 500) / 128.0;
            const double v = random.integer(-300, 500) / 128.0;
            const int component = random.integer(0, 3);
            // gather4 has an immediate offset of [-8, 7], gather4_po one of [-32, 31].
            const glm::ivec2 offset(random.integer(-32, 31), random.integer(-32, 31));
            const auto got = gathered<TestType>(texture, sampler, Profile{}, {u, v, 0}, component, offset);
            for (std::size_t i = 0; i < 4; ++i) {
                const int x = addressed(floor_texel(u, width) + offset.x + kOrder[i][0], width, sampler.address_u);
                const int y = addressed(floor_texel(v, height) + offset.y + kOrder[i][1], height, sampler.address_v);
                const bool border = x < 0 || y < 0;
                borders += border;
                const int expected = border ? -1 - component : (y * width + x) * 4 + component + 1;
                if (got[i] != static_cast<typename TestType::Scalar>(expected))
                    FAIL(fmt::format("{}x{} {} {} at ({:a}, {:a}) offset ({}, {}) component {} result {}: {}, expected {}",
                                     width, height, name_of(sampler.address_u), name_of(sampler.address_v), u, v, offset.x,
                                     offset.y, component, i, got[i], expected));
            }
        }
    }
    CHECK(borders > 1000);
}

TEST_CASE("the four are the texels a bilinear filter weights, those of weight 0 too", "[22.4.2]") {
    oracle::Random random(2);
    const Texture texture = numbered(Format::R32Float, 7, 9);
    for (int round = 0; round < 5000; ++round) {
        const AddressMode mode = kModes[static_cast<std::size_t>(random.integer(0, 4))];
        const Sampler sampler{.address_u = mode, .address_v = mode, .border = glm::vec4(-1.0f)};
        std::array<double, 3> at{static_cast<double>(random.in(-3.0f, 4.0f)), static_cast<double>(random.in(-3.0f, 4.0f)), 0};
        if (random.chance(4)) at = {(random.integer(0, 6) + 0.5) / 7, (random.integer(0, 8) + 0.5) / 9, 0};  // on a centre
        const SampleRecord record = record_sample(texture, sampler, Profile{}, SampleRequest{.coordinate = at});
        const auto& taps = record.probes.at(0).levels.at(0).taps;
        const auto got = gathered<Float>(texture, sampler, Profile{}, at);
        for (std::size_t i = 0; i < 4; ++i)
            if (static_cast<double>(got[i]) != taps.at(kTaps[i]).value[0])
                FAIL(fmt::format("round {} {} at ({:a}, {:a}): result {} is {}, the filter reads {}", round, name_of(mode),
                                 at[0], at[1], i, got[i], taps[kTaps[i]].value[0]));
    }
}

TEMPLATE_TEST_CASE("floats come back unaltered: denormals, zeros, infinities; NaN as NaN", "[22.4.2]", Float, Double) {
    std::vector<std::uint32_t> codes{0x00000001u, 0x80000001u, 0x007fffffu, 0x807fffffu, 0x00800000u, 0x00000000u,
                                     0x80000000u, 0x7f800000u, 0xff800000u, 0x7fc00000u, 0x7f800001u, 0xffffffffu,
                                     0x7f7fffffu, 0x3f800001u, 0x00400000u, 0x80400000u};
    oracle::Random random(3);
    while (codes.size() < 256) codes.push_back(random.bits());
    const Texture texture = texture_of(Format::R32Float, 16, 16, codes);
    for (const bool flush : {true, false}) {
        Profile profile;
        profile.flush_denormals = flush;
        for (int y = 0; y < 15; ++y)
            for (int x = 0; x < 15; ++x) {
                const auto got = gathered<TestType>(texture, Sampler{}, profile, {(x + 1) / 16.0, (y + 1) / 16.0, 0});
                for (std::size_t i = 0; i < 4; ++i) {
                    const std::uint32_t code = codes[static_cast<std::size_t>((y + kOrder[i][1]) * 16 + x + kOrder[i][0])];
                    const auto value = std::bit_cast<float>(code);
                    bool same = false;
                    if constexpr (std::is_same_v<TestType, Float>) {
                        same = std::bit_cast<std::uint32_t>(got[i]) == code;
                    } else {
                        // Asked as bits: the test itself may run where denormals are flushed.
                        same = std::bit_cast<std::uint64_t>(got[i]) == std::bit_cast<std::uint64_t>(static_cast<double>(value));
                    }
                    if (std::isnan(value) ? !std::isnan(got[i]) : !same)
                        FAIL(fmt::format("code {:#010x} came back as {:a}, flush {}", code, got[i], flush));
                }
            }
    }
}

TEST_CASE("every format gathers its numbers and the defaults of components it lacks", "[22.4.2][22.4.4]") {
    for (const FormatInfo& info : kFormats) {
        if (info.is_integer()) continue;
        oracle::Random random(static_cast<std::uint64_t>(info.format));
        std::vector<std::uint32_t> codes;
        for (int i = 0; i < 36; ++i)
            for (int c = 0; c < info.components; ++c) codes.push_back(moderate_code(info.format, random, c));
        const Texture texture = texture_of(info.format, 6, 6, codes);
        for (int component = 0; component < 4; ++component)
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 5; ++x) {
                    const auto got =
                        gathered<Float>(texture, Sampler{}, Profile{}, {(x + 1) / 6.0, (y + 1) / 6.0, 0}, component);
                    for (std::size_t i = 0; i < 4; ++i) {
                        const int texel = (y + kOrder[i][1]) * 6 + x + kOrder[i][0];
                        const double expected =
                            component < info.components
                                ? code_value(info.format, codes[static_cast<std::size_t>(texel * info.components + component)],
                                             component)
                            : component == 3 ? 1.0
                                             : 0.0;
                        if (static_cast<double>(got[i]) != expected)
                            FAIL(fmt::format("{} component {} texel {}: {:a}, expected {:a}", info.name, component, texel,
                                             got[i], expected));
                    }
                }
    }
}

TEST_CASE("gather reads the view's finest level, and of the sampler only the address modes", "[22.4.2][5.8.4][5.8.6]") {
    Texture texture({.format = Format::Rg32Float, .width = 16, .height = 16, .levels = 5});
    for (int level = 0; level < 5; ++level) {
        std::vector<float> values(static_cast<std::size_t>(2 * texture.width(level) * texture.height(level)),
                                  static_cast<float>(level + 1));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    const Sampler odd{.min = TexelFilter::Nearest,
                      .mag = TexelFilter::Nearest,
                      .mip = MipFilter::Linear,
                      .max_anisotropy = 16,
                      .reduction = Reduction::Minimum,
                      .lod_bias = 3.0f,
                      .min_lod = 2.5f,
                      .max_lod = 0.5f};
    for (int base = 0; base < 5; ++base) {
        const float expected = static_cast<float>(base + 1);
        CHECK(gathered<Float>(TextureView(texture, base, 5 - base), odd, Profile{}, {0.4, 0.6, 0}) ==
              Gathered<Float>{expected, expected, expected, expected});
    }
    // A nearest filter would read one texel.
    const Texture four = numbered(Format::R32Float, 2, 2);
    CHECK(gathered<Float>(four, odd, Profile{}, {0.5, 0.5, 0}) == Gathered<Float>{9, 13, 5, 1});

    // "since the clamp of 0.1 requires mip 0 to be present, gather4 will fetch from mip 0"; a clamp of 1 ignores it.
    struct Case {
        float min_lod;
        int base;
        bool present;
    };
    for (const Case& c : {Case{0.0f, 0, true}, Case{0.1f, 0, true}, Case{0.999f, 0, true}, Case{1.0f, 0, false},
                          Case{3.5f, 1, false}, Case{1.5f, 1, true}, Case{2.0f, 1, false}, Case{1.0f, 1, true},
                          Case{0.5f, 2, true}, Case{3.999f, 3, true}, Case{4.0f, 3, false}}) {
        const TextureView view(texture, c.base, 5 - c.base, c.min_lod);
        const float number = c.present ? static_cast<float>(c.base + 1) : 0.0f;
        INFO("clamp " << c.min_lod << " base " << c.base);
        CHECK(gathered<Float>(view, Sampler{}, Profile{}, {0.4, 0.6, 0}, 1) == Gathered<Float>{number, number, number, number});
        CHECK(gathered<Float>(view, Sampler{}, Profile{}, {0.4, 0.6, 0}, 2) == Gathered<Float>{0, 0, 0, 0});
        CHECK(gathered<Float>(view, Sampler{}, Profile{}, {0.4, 0.6, 0}, 3) == Gathered<Float>{1, 1, 1, 1});
        // "the out of bounds result is used as the comparison value against the reference"
        for (const double reference : {-1.0, 0.0, 0.5, 9.0}) {
            const float passes = reference <= static_cast<double>(number) ? 1.0f : 0.0f;
            CHECK(compared<Float>(view, Sampler{.compare = CompareOp::LessEqual}, Profile{}, {0.4, 0.6, 0}, reference) ==
                  Gathered<Float>{passes, passes, passes, passes});
        }
    }
}

TEMPLATE_TEST_CASE("each comparison comes back on its own, with every operator", "[22.4.3][22.4.5]", Float, Double) {
    oracle::Random random(5);
    for (const Format format :
         {Format::D16, Format::D24, Format::D32Float, Format::R32Float, Format::R8Unorm, Format::R16Snorm}) {
        const int levels = format == Format::R8Unorm ? 3 : 4;  // few values, so that equality happens
        std::vector<std::uint32_t> codes;
        for (int i = 0; i < 64; ++i) {
            const int k = random.integer(0, levels);
            switch (format) {
                case Format::D32Float:
                case Format::R32Float: codes.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(k) / 4.0f)); break;
                default: codes.push_back(static_cast<std::uint32_t>(k * 50)); break;
            }
        }
        const Texture texture = texture_of(format, 8, 8, codes);
        std::array<int, 8> passed{};
        for (int round = 0; round < 2000; ++round) {
            const auto op = static_cast<CompareOp>(random.integer(0, 7));
            const Sampler sampler{.address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap, .compare = op};
            // References that the format can hold: quantisation has nothing to do.
            const std::uint32_t held = codes[static_cast<std::size_t>(random.integer(0, 63))];
            const double reference = code_value(format, held);
            const double u = random.integer(-128, 256) / 128.0;
            const double v = random.integer(-128, 256) / 128.0;
            const glm::ivec2 offset(random.integer(-32, 31), random.integer(-32, 31));
            const auto got = compared<TestType>(texture, sampler, Profile{}, {u, v, 0}, reference, offset);
            for (std::size_t i = 0; i < 4; ++i) {
                const int x = addressed(floor_texel(u, 8) + offset.x + kOrder[i][0], 8, AddressMode::Wrap);
                const int y = addressed(floor_texel(v, 8) + offset.y + kOrder[i][1], 8, AddressMode::Wrap);
                const std::uint32_t code = codes[static_cast<std::size_t>(y * 8 + x)];
                const bool less = held < code;  // no negative codes: their order is that of the numbers
                const bool equal = held == code;
                const std::array results{false, less, equal, less || equal, !less && !equal, !equal, !less, true};
                const bool expected = results[static_cast<std::size_t>(op)];
                passed[static_cast<std::size_t>(op)] += expected;
                if (got[i] != static_cast<typename TestType::Scalar>(expected ? 1 : 0))
                    FAIL(fmt::format("{} {} round {} result {}: {}, codes {:#x} and {:#x}", format_info(format).name,
                                     name_of(op), round, i, got[i], held, code));
            }
        }
        for (std::size_t op = 1; op < 8; ++op) CHECK(passed[op] > 20);
    }
}

TEST_CASE("comparisons see infinities as they are, NaN as NaN, denormals as zero", "[22.4.3]") {
    const std::vector<std::uint32_t> codes{0x7f800000u, 0xff800000u, 0x7fc00000u, 0x00000001u};  // inf, -inf, NaN, denormal
    const Texture texture = texture_of(Format::R32Float, 2, 2, codes);
    const auto with = [&](CompareOp op, double reference) {
        return compared<Float>(texture, Sampler{.compare = op}, Profile{}, {0.5, 0.5, 0}, reference);
    };
    // Results: NaN (lower left), denormal, -inf, inf.
    CHECK(with(CompareOp::Less, 0.0) == Gathered<Float>{0, 0, 0, 1});
    CHECK(with(CompareOp::Equal, 0.0) == Gathered<Float>{0, 1, 0, 0});
    CHECK(with(CompareOp::NotEqual, 0.0) == Gathered<Float>{1, 0, 1, 1});
    CHECK(with(CompareOp::LessEqual, HUGE_VAL) == Gathered<Float>{0, 0, 0, 1});
    CHECK(with(CompareOp::GreaterEqual, -HUGE_VAL) == Gathered<Float>{0, 0, 1, 0});
    CHECK(with(CompareOp::NotEqual, std::nan("")) == Gathered<Float>{1, 1, 1, 1});
    CHECK(with(CompareOp::Always, std::nan("")) == Gathered<Float>{1, 1, 1, 1});
    CHECK(with(CompareOp::Never, 0.0) == Gathered<Float>{0, 0, 0, 0});
}

TEST_CASE("arrays gather from the nearest slice", "[22.4.2]") {
    Texture texture(
        {.format = Format::R32Float, .width = 2, .height = 2, .levels = 1, .kind = TextureKind::Array, .layers = 4});
    for (int layer = 0; layer < 4; ++layer) {
        const std::vector<float> values{10.0f * static_cast<float>(layer), 10.0f * static_cast<float>(layer) + 1,
                                        10.0f * static_cast<float>(layer) + 2, 10.0f * static_cast<float>(layer) + 3};
        texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), 16, layer);
    }
    for (const auto& [slice, layer] :
         {std::pair{0.5, 0}, std::pair{1.5, 2}, std::pair{2.5, 2}, std::pair{2.6, 3}, std::pair{-7.0, 0}, std::pair{99.0, 3}}) {
        const float first = 10.0f * static_cast<float>(layer);
        INFO("slice " << slice);
        CHECK(gathered<Float>(texture, Sampler{}, Profile{}, {0.5, 0.5, slice}) ==
              Gathered<Float>{first + 2, first + 3, first + 1, first});
    }
}

TEST_CASE("on cubes gather crosses edges like a filter; the missing corner is the mean of three", "[22.4.2][22.4.3][7.18.12]") {
    constexpr int kSize = 4;
    Texture texture({.format = Format::R32Float,
                     .width = kSize,
                     .height = kSize,
                     .levels = 1,
                     .kind = TextureKind::Cube,
                     .layers = kCubeFaces});
    oracle::Random random(7);
    for (int face = 0; face < kCubeFaces; ++face) {
        std::vector<float> values(kSize * kSize);
        for (float& value : values) value = random.unit();
        texture.set_level_bytes(0, std::as_bytes(std::span(values)).data(), values.size() * 4, face);
    }
    int corners = 0;
    int between = 0;
    for (int round = 0; round < 5000; ++round) {
        const auto component = [&] { return (random.chance(2) ? 1 : -1) * (1.0 - random.integer(0, 500) / 1024.0); };
        const std::array<double, 3> d{component(), component(), component()};
        const SampleRecord record = record_sample(texture, Sampler{}, Profile{}, SampleRequest{.coordinate = d});
        const auto& taps = record.probes.at(0).levels.at(0).taps;
        const auto got = gathered<Float>(texture, Sampler{}, Profile{}, d);
        const auto passed = compared<Float>(texture, Sampler{.compare = CompareOp::Less}, Profile{}, d, 0.5);
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t tap = kTaps[i];
            const auto is_more = [&](std::size_t t) { return 0.5 < taps.at(t).value[0] ? 1.0 : 0.0; };
            double expected = taps.at(tap).value[0];
            double expected_passed = is_more(tap);
            if (taps[tap].corner) {
                ++corners;
                expected = (taps.at(tap ^ 1).value[0] + taps.at(tap ^ 2).value[0] + taps.at(tap ^ 3).value[0]) / 3;
                // "the synthesis must occur after the comparison step": 0, 1/3, 2/3 or 1
                expected_passed = (is_more(tap ^ 1) + is_more(tap ^ 2) + is_more(tap ^ 3)) / 3;
                between += expected_passed > 0 && expected_passed < 1;
            }
            const double slack = taps[tap].corner ? 4 * 0x1p-24 : 0;
            if (std::fabs(static_cast<double>(got[i]) - expected) > slack ||
                std::fabs(static_cast<double>(passed[i]) - expected_passed) > slack)
                FAIL(fmt::format("round {} ({:a}, {:a}, {:a}) result {}: {:a} and {:a}, expected {:a} and {:a}", round, d[0],
                                 d[1], d[2], i, got[i], passed[i], expected, expected_passed));
        }
    }
    CHECK(corners > 100);
    CHECK(between > 20);
}
