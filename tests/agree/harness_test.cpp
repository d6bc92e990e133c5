// The sampling harness on every usable Vulkan device here: what no driver may differ in comes back as it must.
// With no device the device tests are left out, and the exit code 4 says so to CTest.
#include "sim/error.h"
#include "tests/agree/generated_texture.h"
#include "tests/agree/names.h"
#include "tests/agree/sampling.h"
#include "tests/peer/device_tests.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <set>

namespace gnomon::agree {
namespace {

constexpr TexelFormat kFormats[] = {TexelFormat::R32f,  TexelFormat::Rg32f,     TexelFormat::Rg16f,
                                    TexelFormat::Rgba8, TexelFormat::Rg16Unorm, TexelFormat::D32f};

// Runs a check on each device, with the validation layer where it is installed; the layer must have nothing to say.
void on_each_device(const std::function<void(SamplingPeer&)>& check_on) {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        INFO("device " << device.name);
        SamplingPeer machine(device, {.validate = true});
        check_on(machine);
        for (const std::string& message : machine.validation_messages()) FAIL_CHECK(message);
    }
}

// The centre of texel (x, y) of a level; the texel may lie outside.
Point centre(const Levels& texture, int level, int x, int y) {
    const auto along = [level](int texel, int size) {
        return (static_cast<float>(texel) + 0.5f) / static_cast<float>(level_size(size, level));
    };
    return {.u = along(x, texture.width), .v = along(y, texture.height), .lod = static_cast<float>(level)};
}

// A sample as bits and hexadecimal floats.
std::string text(const Sample& s) {
    std::string all;
    for (const float x : s) all += fmt::format(" {:08x} ({:a})", std::bit_cast<std::uint32_t>(x), x);
    return all;
}

// The stored components of a sample are the texel: floats to the bit. A unorm's quotient may be rounded otherwise than to
// nearest, but must give the stored integer back; Vulkan leaves open how precise the division is.
bool is_texel(TexelFormat format, const Sample& got, const Sample& texel) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(component_count(format)); ++i) {
        const bool is_unorm = format == TexelFormat::Rgba8 || format == TexelFormat::Rg16Unorm;
        const float steps = format == TexelFormat::Rgba8 ? 255.0f : 65535.0f;
        const bool same = is_unorm ? std::abs(got[i] - texel[i]) * steps < 0.01f
                                   : std::bit_cast<std::uint32_t>(got[i]) == std::bit_cast<std::uint32_t>(texel[i]);
        if (!same) return false;
    }
    return true;
}

// Nearest samples at `points` are `expected`.
struct Probe {
    std::vector<Point> points{};
    std::vector<Sample> expected{};
};
void check_probe(SamplingPeer& machine, const Levels& texture, const SamplerState& sampler, const Probe& probe) {
    const std::vector<Sample> samples = machine.sample(texture, sampler, Instruction::Lod, probe.points);
    REQUIRE(samples.size() == probe.points.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (is_texel(texture.format, samples[i], probe.expected[i])) continue;
        FAIL_CHECK(fmt::format("{}, u {:a} v {:a} lod {}: got{}, expected{}", name_of(texture.format), probe.points[i].u,
                               probe.points[i].v, probe.points[i].lod, text(samples[i]), text(probe.expected[i])));
    }
}

// d32f, 4 x 4, one level: texel (x, y) holds (x + 4 y) / 16.
Levels depth_ramp() {
    Levels texture{.format = TexelFormat::D32f, .width = 4, .height = 4};
    std::vector<std::byte>& bytes = texture.levels.emplace_back();
    for (int i = 0; i < 16; ++i) {
        const auto depth = std::bit_cast<std::array<std::byte, sizeof(float)>>(static_cast<float>(i) / 16);
        bytes.insert(bytes.end(), depth.begin(), depth.end());
    }
    return texture;
}

bool compare(Compare compare, float reference, float texel) {
    switch (compare) {
        case Compare::None:
        case Compare::Never: return false;
        case Compare::Less: return reference < texel;
        case Compare::Equal: return reference == texel;
        case Compare::LessEqual: return reference <= texel;
        case Compare::Greater: return reference > texel;
        case Compare::NotEqual: return reference != texel;
        case Compare::GreaterEqual: return reference >= texel;
        case Compare::Always: return true;
    }
    return false;
}

}  // namespace

TEST_CASE("nearest samples at texel centres are the uploaded texels, at every level", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        for (const TexelFormat format : kFormats)
            for (const auto& [width, height] : {std::pair{16, 16}, std::pair{13, 6}, std::pair{1, 5}}) {
                const int levels = full_levels(width, height);
                const Levels texture = random_levels(format, width, height, levels, 1);
                const SamplerState sampler{.mip = Mip::Nearest};
                INFO(name_of(format) << ' ' << width << 'x' << height << ' ' << machine.unsupported_because(texture, sampler));
                REQUIRE(machine.supports(texture, sampler));

                Probe probe;
                for (int level = 0; level < levels; ++level)
                    for (int y = 0; y < level_size(height, level); ++y)
                        for (int x = 0; x < level_size(width, level); ++x) {
                            probe.points.push_back(centre(texture, level, x, y));
                            probe.expected.push_back(texel_value(texture, level, x, y));
                        }
                check_probe(machine, texture, sampler, probe);
            }
    });
}

TEST_CASE("the LOD and the gradient pick the level", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        const Levels texture = random_levels(TexelFormat::R32f, 32, 32, 6, 2);
        const SamplerState sampler{.mip = Mip::Nearest};
        std::vector<Point> points;
        std::vector<float> expected;
        for (int level = 0; level < 6; ++level)
            for (const float offset : {-0.375f, 0.0f, 0.375f}) {
                Point point = centre(texture, level, 0, 0);
                point.lod = static_cast<float>(level) + offset;
                point.dudx = point.dvdy = std::ldexp(1.0f, level) / 32;
                points.push_back(point);
                expected.push_back(texel_value(texture, level, 0, 0)[0]);
            }
        CHECK(std::set<float>(expected.begin(), expected.end()).size() == 6);
        for (const Instruction instruction : {Instruction::Lod, Instruction::Gradient}) {
            const std::vector<Sample> samples = machine.sample(texture, sampler, instruction, points);
            for (std::size_t i = 0; i < samples.size(); ++i) {
                INFO(name_of(instruction) << " lod " << points[i].lod << " dudx " << points[i].dudx);
                CHECK(samples[i][0] == expected[i]);
            }
        }

        // One level in the view: the others do not exist.
        for (const Sample& sample : machine.sample(texture, {.mip = Mip::Base}, Instruction::Lod, {points.data() + 12, 1}))
            CHECK(sample[0] ==
                  texel_value(texture, 0, static_cast<int>(points[12].u * 32), static_cast<int>(points[12].v * 32))[0]);
    });
}

TEST_CASE("linear filtering halfway between texels is their mean", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        for (const TexelFormat format : kFormats) {
            const Levels texture = random_levels(format, 8, 8, 1, 3);
            const SamplerState sampler{.min = Filter::Linear, .mag = Filter::Linear};
            INFO(name_of(format));
            if (!machine.supports(texture, sampler)) {
                CHECK_THROWS_AS(machine.sample(texture, sampler, Instruction::Lod, std::vector<Point>(1)), Error);
                continue;
            }
            const std::vector<Point> points{{.u = 3.0f / 8, .v = 2.5f / 8}, {.u = 3.5f / 8, .v = 3.0f / 8}};
            const std::vector<Sample> samples = machine.sample(texture, sampler, Instruction::Lod, points);
            const Sample left = texel_value(texture, 0, 2, 2);
            const Sample right = texel_value(texture, 0, 3, 2);
            const Sample below = texel_value(texture, 0, 3, 3);
            for (std::size_t i = 0; i < static_cast<std::size_t>(component_count(format)); ++i) {
                CHECK(samples[0][i] == Approx((left[i] + right[i]) / 2).margin(1.0 / 255));
                CHECK(samples[1][i] == Approx((right[i] + below[i]) / 2).margin(1.0 / 255));
            }
        }
    });
}

TEST_CASE("addressing modes", "[agree][device]") {
    constexpr int kSize = 4;
    const auto addressed = [](Address address, int x) -> int {  // -1: the border
        const int period = ((x % (2 * kSize)) + 2 * kSize) % (2 * kSize);
        switch (address) {
            case Address::Wrap: return period % kSize;
            case Address::Mirror: return period < kSize ? period : 2 * kSize - 1 - period;
            case Address::Clamp: return std::clamp(x, 0, kSize - 1);
            case Address::Border: return x < 0 || x >= kSize ? -1 : x;
            case Address::MirrorOnce: return std::min(x < 0 ? -1 - x : x, kSize - 1);
        }
        return -1;
    };
    on_each_device([&](SamplingPeer& machine) {
        const Levels texture = random_levels(TexelFormat::Rgba8, kSize, kSize, 1, 4);
        for (const auto& [address, name] : kEnumNames<Address>)
            for (int border = 0; border < (address == Address::Border ? 3 : 1); ++border) {
                SamplerState sampler{.address_u = address, .address_v = Address::Clamp, .border = border};
                INFO(name << " border " << border);
                if (!machine.supports(texture, sampler)) {
                    CHECK(address == Address::MirrorOnce);
                    continue;
                }
                const float rgb = border == 2 ? 1.0f : 0.0f;
                const Sample border_color{rgb, rgb, rgb, border == 0 ? 0.0f : 1.0f};
                Probe along_u;
                Probe along_v;
                for (int x = -10; x <= 13; ++x) {
                    const int texel = addressed(address, x);
                    along_u.points.push_back(centre(texture, 0, x, 1));
                    along_u.expected.push_back(texel < 0 ? border_color : texel_value(texture, 0, texel, 1));
                    along_v.points.push_back(centre(texture, 0, 1, x));
                    along_v.expected.push_back(texel < 0 ? border_color : texel_value(texture, 0, 1, texel));
                }
                check_probe(machine, texture, sampler, along_u);
                std::swap(sampler.address_u, sampler.address_v);
                check_probe(machine, texture, sampler, along_v);
            }
    });
}

TEST_CASE("the border colour of every format", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        for (const TexelFormat format : kFormats)
            for (int border = 0; border < 3; ++border) {
                INFO(name_of(format) << " border " << border);
                const Levels texture = random_levels(format, 4, 4, 1, 5);
                const SamplerState sampler{.address_u = Address::Border, .address_v = Address::Border, .border = border};
                const float rgb = border == 2 ? 1.0f : 0.0f;
                Probe probe;
                for (const auto& [x, y] : {std::pair{-1, 2}, std::pair{4, 2}, std::pair{2, -1}, std::pair{2, 4}}) {
                    probe.points.push_back(centre(texture, 0, x, y));
                    probe.expected.push_back({rgb, rgb, rgb, border == 0 ? 0.0f : 1.0f});
                }
                check_probe(machine, texture, sampler, probe);
            }
    });
}

TEST_CASE("every comparison, by every instruction", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        const Levels texture = depth_ramp();
        std::vector<Point> points;
        for (const float reference : {0.0f, 5.0f / 16, 0.5f, 1.0f})
            for (int y = 0; y < 4; ++y)
                for (int x = 0; x < 4; ++x) points.push_back(centre(texture, 0, x, y)), points.back().reference = reference;
        for (const auto& [op, name] : kEnumNames<Compare>) {
            if (op == Compare::None) continue;
            const SamplerState sampler{.compare = op};
            REQUIRE(machine.supports(texture, sampler));
            for (const Instruction instruction : {Instruction::Lod, Instruction::Gradient}) {
                const std::vector<Sample> samples = machine.sample(texture, sampler, instruction, points);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const float texel = static_cast<float>(i % 16) / 16;
                    const float expected = compare(op, points[i].reference, texel) ? 1.0f : 0.0f;
                    INFO(name << ' ' << name_of(instruction) << ", reference " << points[i].reference << ", texel " << texel);
                    CHECK(samples[i] == Sample{expected, expected, expected, expected});
                }
            }
        }
    });
}

TEST_CASE("a gather takes (i0, j1), (i1, j1), (i1, j0), (i0, j0)", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        for (const TexelFormat format : kFormats) {
            INFO(name_of(format));
            const Levels texture = random_levels(format, 8, 8, 1, 6);
            const std::vector<Point> points{{.u = 3.0f / 8, .v = 5.0f / 8}, {.u = 1.25f / 8, .v = 2.25f / 8}, {.u = 0, .v = 0}};
            const std::array<std::array<int, 4>, 3> corners{{{2, 3, 4, 5}, {0, 1, 1, 2}, {7, 0, 7, 0}}};  // i0, i1, j0, j1
            const std::vector<Sample> samples = machine.sample(texture, {}, Instruction::Gather, points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto [i0, i1, j0, j1] = corners[i];
                const Sample expected{texel_value(texture, 0, i0, j1)[0], texel_value(texture, 0, i1, j1)[0],
                                      texel_value(texture, 0, i1, j0)[0], texel_value(texture, 0, i0, j0)[0]};
                INFO("point " << i << ": got" << text(samples[i]) << ", expected" << text(expected));
                for (std::size_t k = 0; k < 4; ++k) CHECK(std::abs(samples[i][k] - expected[k]) < 1e-6f);
            }
        }

        // A comparison per texel: (1, 1) to (2, 2) of the ramp are 5, 6, 9 and 10 sixteenths.
        const std::vector<Point> points{{.u = 0.5f, .v = 0.5f, .reference = 5.5f / 16},
                                        {.u = 0.5f, .v = 0.5f, .reference = 0.6f}};
        const std::vector<Sample> samples =
            machine.sample(depth_ramp(), {.compare = Compare::Less}, Instruction::Gather, points);
        CHECK(samples[0] == Sample{1, 1, 1, 0});
        CHECK(samples[1] == Sample{0, 1, 0, 0});
    });
}

TEST_CASE("anisotropic filtering keeps what lies across the footprint", "[agree][device]") {
    // Columns four texels wide, 0 and 1 by turns, at level 0; grey at all others. A footprint of 1 by 8 texels along a column
    // sees one value by anisotropic filtering and grey by isotropic.
    constexpr int kSize = 64;
    Levels texture = random_levels(TexelFormat::R32f, kSize, kSize, 7, 10);
    for (std::size_t level = 0; level < texture.levels.size(); ++level)
        for (std::size_t i = 0; i < texture.levels[level].size(); i += sizeof(float)) {
            const bool is_white = (i / sizeof(float) / 4) % 2 == 1;
            const float value = level > 0 ? 0.5f : is_white ? 1.0f : 0.0f;
            std::memcpy(texture.levels[level].data() + i, &value, sizeof(value));
        }
    std::vector<Point> points;
    for (int column = 0; column < 16; ++column)
        points.push_back(
            {.u = (4.0f * static_cast<float>(column) + 2) / kSize, .v = 0.5f, .dudx = 1.0f / kSize, .dvdy = 8.0f / kSize});
    const std::vector<Point> quads = as_quads(points);
    on_each_device([&](SamplingPeer& machine) {
        SamplerState sampler{.min = Filter::Linear, .mag = Filter::Linear, .mip = Mip::Linear};
        for (const Sample& sample : machine.sample(texture, sampler, Instruction::Gradient, quads)) CHECK(sample[0] == 0.5f);
        sampler.max_anisotropy = 8;
        if (!machine.supports(texture, sampler)) return;
        const std::vector<Sample> samples = machine.sample(texture, sampler, Instruction::Gradient, quads);
        for (std::size_t i = 0; i < points.size(); ++i) {
            INFO("column " << i);
            CHECK(samples[4 * i][0] == Approx(i % 2 == 1 ? 1.0 : 0.0).margin(0.05));
        }
    });
}

TEST_CASE("more points than one dispatch takes", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        const Levels texture = random_levels(TexelFormat::R32f, 64, 64, 1, 7);
        std::vector<Point> points((std::size_t{1} << 20) + 100);
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] = centre(texture, 0, static_cast<int>(i % 64), static_cast<int>(i / 64 % 64));
        const std::vector<Sample> samples = machine.sample(texture, {}, Instruction::Gradient, points);
        REQUIRE(samples.size() == points.size());
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i][0] != texel_value(texture, 0, static_cast<int>(i % 64), static_cast<int>(i / 64 % 64))[0]) ++wrong;
        CHECK(wrong == 0);
        CHECK(machine.sample(texture, {}, Instruction::Gradient, {}).empty());
    });
}

TEST_CASE("timing", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        const Levels texture = random_levels(TexelFormat::Rg32f, 16, 16, 1, 8);
        const std::vector<Point> points(4096);
        const SampleTiming timing = machine.time_samples(texture, {}, Instruction::Gradient, points, 3);
        REQUIRE(timing.sampling_ns.size() == 3);
        REQUIRE(timing.reading_ns.size() == 3);
        for (std::size_t i = 0; i < 3; ++i) CHECK((timing.sampling_ns[i] > 0 && timing.reading_ns[i] > 0));
        CHECK(std::isfinite(timing.ns_per_sample));
        CHECK_THROWS_AS(machine.time_samples(texture, {}, Instruction::Gradient, points, 0), Error);
        CHECK_THROWS_AS(machine.time_samples(texture, {}, Instruction::Gradient, {}, 1), Error);
    });
}

TEST_CASE("what a device cannot do, and what none could, is refused", "[agree][device]") {
    on_each_device([](SamplingPeer& machine) {
        const Levels color = random_levels(TexelFormat::Rgba8, 4, 4, 2, 9);
        const std::vector<Point> points(1);
        const auto refused = [&](const Levels& texture, const SamplerState& sampler) {
            CHECK_THROWS_AS(machine.sample(texture, sampler, Instruction::Gradient, points), Error);
        };
        CHECK_FALSE(machine.supports(color, {.compare = Compare::Less}));
        refused(color, {.compare = Compare::Less});
        CHECK_FALSE(machine.supports(color, {.max_anisotropy = 1000}));
        refused(color, {.max_anisotropy = 1000});
        refused(color, {.max_anisotropy = 0.5f});
        refused(color, {.lod_bias = std::numeric_limits<float>::quiet_NaN()});
        refused(color, {.min_lod = 2, .max_lod = 1});
        refused(color, {.border = 3});

        Levels broken = color;
        broken.levels[1].pop_back();
        refused(broken, {});
        broken = color;
        broken.levels.clear();
        refused(broken, {});
        broken = color;
        broken.width = 0;
        refused(broken, {});
        Levels depth = depth_ramp();
        depth.levels[0][3] = std::byte{0x7f};  // the exponent of NaN
        depth.levels[0][2] = std::byte{0xc0};
        refused(depth, {});
    });
}

TEST_CASE("generated textures", "[agree]") {
    for (const TexelFormat format : kFormats) {
        const Levels texture = random_levels(format, 12, 5, 4, 1);
        CHECK(texture.levels[3].size() == texel_bytes(format));  // 1 x 1
        CHECK(texture == random_levels(format, 12, 5, 4, 1));
        CHECK(texture != random_levels(format, 12, 5, 4, 2));
        std::set<float> values;
        for (int x = 0; x < 12; ++x) values.insert(texel_value(texture, 0, x, 4)[0]);
        CHECK(values.size() > 8);
        CHECK(*values.begin() >= 0);
        CHECK(*values.rbegin() <= 1);
    }
    CHECK_THROWS_AS(random_levels(TexelFormat::R32f, 4, 4, 4, 1), Error);
    CHECK_THROWS_AS(random_levels(TexelFormat::R32f, 0, 4, 1, 1), Error);
}

}  // namespace gnomon::agree
