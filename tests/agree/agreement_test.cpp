// Gnomon's texture unit against drivers written by others: profiles `llvmpipe` and `swiftshader` bit for bit, profile `d3d11`
// within what its 8-bit weights explain. With no device the exit code 4 says so to CTest.
#include "tests/agree/adapter.h"
#include "tests/agree/generated_texture.h"
#include "tests/agree/names.h"
#include "tests/oracle/random.h"
#include "tests/peer/device_tests.h"
#include "texunit/sample.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

namespace gnomon::agree {
namespace {

constexpr std::size_t kSamplesPerCase = 100'000;

struct Kind {
    std::string_view name;
    Filter filter = Filter::Nearest;
    Mip mip = Mip::Base;
    bool compares = false;
    float anisotropy = 1;
};
constexpr Kind kKinds[] = {
    {"nearest", Filter::Nearest, Mip::Base},
    {"nearest, nearest mip", Filter::Nearest, Mip::Nearest},
    {"bilinear", Filter::Linear, Mip::Base},
    {"bilinear, nearest mip", Filter::Linear, Mip::Nearest},
    {"trilinear", Filter::Linear, Mip::Linear},
    {"compare nearest", Filter::Nearest, Mip::Base, true},
    {"compare bilinear", Filter::Linear, Mip::Base, true},
    {"compare trilinear", Filter::Linear, Mip::Linear, true},
    {"anisotropic", Filter::Linear, Mip::Linear, false, 16},
};

/// The preset that claims to be this driver; empty for others.
std::string preset_of(const peer::PeerDevice& device) {
    if (device.name.find("llvmpipe") != std::string::npos) return "llvmpipe";
    if (device.name.find("SwiftShader") != std::string::npos) return "swiftshader";
    return {};
}

/// Steps between two floats of one sign, or a large number.
std::int64_t ulps(float a, float b) {
    const auto order = [](float x) {
        const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(x));
        return (bits & 0x80000000) != 0 ? 0x80000000 - bits : bits;
    };
    return std::abs(order(a) - order(b));
}

bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b); }

/// One size, sampler and instruction out of those that a kind of sample allows.
struct Setting {
    Levels texture;
    SamplerState sampler;
    Instruction instruction = Instruction::Lod;
};
Setting setting_of(TexelFormat format, const Kind& kind, oracle::Random& random) {
    const std::array sizes{1, 2, 4, 16, 64, 128, 3, 5, 7, 12, 37, 100};
    const auto size = [&] { return sizes[static_cast<std::size_t>(random.integer(0, 11))]; };
    const int width = size();
    const int height = size();
    const int levels = kind.mip == Mip::Base ? 1 : random.integer(1, full_levels(width, height));
    Setting setting{.texture = random_levels(format, width, height, levels, random.next()), .sampler = {}};
    const auto address = [&] { return static_cast<Address>(random.integer(0, 4)); };
    SamplerState& sampler = setting.sampler;
    sampler.min = sampler.mag = kind.filter;
    sampler.mip = kind.mip;
    sampler.address_u = address();
    sampler.address_v = address();
    sampler.max_anisotropy = kind.anisotropy;
    sampler.border = random.integer(0, 2);
    if (kind.compares) sampler.compare = static_cast<Compare>(random.integer(1, 8));
    if (random.chance(3)) sampler.lod_bias = random.in(-2.0f, 2.0f);
    if (random.chance(4)) sampler.min_lod = random.in(0.0f, 3.0f);
    if (random.chance(4)) sampler.max_lod = sampler.min_lod + random.in(0.3f, 3.0f);
    setting.instruction = random.chance(2) || kind.anisotropy > 1 ? Instruction::Gradient : Instruction::Lod;
    return setting;
}

/// Inside and around the texture, on texel centres and borders and one step beside them; now and then far away.
float coordinate_of(int size, oracle::Random& random) {
    switch (random.integer(0, 5)) {
        case 0:
        case 1: return random.in(-0.1f, 1.1f);
        case 2: return random.in(-3.0f, 4.0f);
        case 3: return static_cast<float>(random.integer(-size, 2 * size)) * 0.5f / static_cast<float>(size);
        case 4: {
            const float on = static_cast<float>(random.integer(0, 2 * size)) * 0.5f / static_cast<float>(size);
            return std::nextafter(on, random.chance(2) ? 2.0f : -2.0f);
        }
        default: return random.chance(8) ? random.in(-1e4f, 1e4f) : random.in(0.0f, 1.0f);
    }
}

std::vector<Point> points_of(const Setting& setting, std::size_t count, oracle::Random& random) {
    std::vector<Point> points(count);
    for (Point& point : points) {
        point.u = coordinate_of(setting.texture.width, random);
        point.v = coordinate_of(setting.texture.height, random);
        // Derivatives of 1/4 to 16 texels at any angle to each other.
        const auto derivative = [&](int size) {
            const float texels = std::ldexp(random.in(-1.0f, 1.0f), random.integer(-2, 4));
            return texels / static_cast<float>(size);
        };
        point.dudx = derivative(setting.texture.width);
        point.dvdx = derivative(setting.texture.height);
        point.dudy = derivative(setting.texture.width);
        point.dvdy = derivative(setting.texture.height);
        point.lod = random.in(-1.5f, 7.5f);
        point.reference = random.chance(4) ? static_cast<float>(random.integer(0, 4)) / 4.0f : random.unit();
    }
    return points;
}

/// Samples of a driver; anisotropy on llvmpipe by quads, twice each as it works on eight lanes with the levels of the first.
std::vector<Sample> sample_on(SamplingPeer& machine, const Setting& setting, std::vector<Point>& points) {
    const bool quads = setting.sampler.max_anisotropy > 1 && preset_of(machine.description()) == "llvmpipe";
    if (!quads) return machine.sample(setting.texture, setting.sampler, setting.instruction, points);
    std::vector<Point> doubled;
    for (Point& point : points) {
        const std::vector<Point> quad = as_quads(std::span(&point, 1));
        for (int i = 0; i < 2; ++i) doubled.insert(doubled.end(), quad.begin(), quad.end());
        // What the driver sees of the derivatives.
        point.dudx = quad[1].u - quad[0].u;
        point.dvdx = quad[1].v - quad[0].v;
        point.dudy = quad[2].u - quad[0].u;
        point.dvdy = quad[2].v - quad[0].v;
    }
    const std::vector<Sample> all = machine.sample(setting.texture, setting.sampler, setting.instruction, doubled);
    std::vector<Sample> samples(points.size());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = all[8 * i];
    return samples;
}

std::string describe(const Setting& setting, const Point& p) {
    const SamplerState& s = setting.sampler;
    return fmt::format(
        "{} {}x{} {} levels, {} {} / {} {}, bias {:a} lod {:a} to {:a}, {} {}, uv ({:a}, {:a}), dx ({:a}, {:a}), dy ({:a}, "
        "{:a}), lod {:a}, reference {:a}",
        name_of(setting.texture.format), setting.texture.width, setting.texture.height, setting.texture.levels.size(),
        name_of(s.min), name_of(s.mip), name_of(s.address_u), name_of(s.address_v), s.lod_bias, s.min_lod, s.max_lod,
        name_of(setting.instruction), name_of(s.compare), p.u, p.v, p.dudx, p.dvdx, p.dudy, p.dvdy, p.lod, p.reference);
}

/// Calls judge(setting, point, theirs, ours, components) over at least kSamplesPerCase samples of one kind on one device.
template <class Judge>
std::size_t compare_kind(SamplingPeer& machine, const Profile& profile, TexelFormat format, const Kind& kind,
                         const Judge& judge) {
    std::size_t samples = 0;
    const std::size_t per_setting = kind.anisotropy > 1 ? 256 : 2048;
    const std::size_t wanted = kind.anisotropy > 1 ? kSamplesPerCase / 8 : kSamplesPerCase;
    for (std::uint64_t seed = 0; samples < wanted; ++seed) {
        oracle::Random random(seed * 1000 + static_cast<std::uint64_t>(&kind - kKinds) * 10 +
                              static_cast<std::uint64_t>(format));
        const Setting setting = setting_of(format, kind, random);
        if (!machine.supports(setting.texture, setting.sampler)) {
            if (seed > 200 && samples == 0) return 0;  // the driver cannot do this at all
            continue;
        }
        std::vector<Point> points = points_of(setting, per_setting, random);
        const std::vector<Sample> theirs = sample_on(machine, setting, points);
        const std::vector<Sample> ours = sample_by(profile, setting.texture, setting.sampler, setting.instruction, points);
        for (std::size_t i = 0; i < points.size(); ++i) judge(setting, points[i], theirs[i], ours[i]);
        samples += points.size();
    }
    return samples;
}

constexpr TexelFormat kFormats[] = {TexelFormat::Rg32f, TexelFormat::Rg16f,     TexelFormat::R32f,
                                    TexelFormat::Rgba8, TexelFormat::Rg16Unorm, TexelFormat::D32f};

bool applies(TexelFormat format, const Kind& kind) { return kind.compares == (format == TexelFormat::D32f); }

TEST_CASE("the profile of a driver returns the driver's bits", "[agree][device]") {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        if (preset_of(device).empty()) {
            fmt::print("  {}: no profile claims to be this driver; a measured one is owed\n", device.name);
            continue;
        }
        SamplingPeer machine(device);
        Profile profile = load_profile(preset_of(device));
        if (profile.name == "llvmpipe") profile.flush_denormals = false;  // its compute shaders keep them
        for (const TexelFormat format : kFormats) {
            for (const Kind& kind : kKinds) {
                if (!applies(format, kind)) continue;
                std::size_t equal = 0;
                std::int64_t worst = 0;
                std::string worst_case;
                const auto count = static_cast<std::size_t>(component_count(format));
                const std::size_t samples =
                    compare_kind(machine, profile, format, kind,
                                 [&](const Setting& setting, const Point& point, const Sample& theirs, const Sample& ours) {
                                     bool all = true;
                                     for (std::size_t c = 0; c < count; ++c) {
                                         if (same(theirs[c], ours[c])) continue;
                                         all = false;
                                         if (ulps(theirs[c], ours[c]) <= worst) continue;
                                         worst = ulps(theirs[c], ours[c]);
                                         worst_case = fmt::format("{}: component {} is {:a} there, {:a} here",
                                                                  describe(setting, point), c, theirs[c], ours[c]);
                                     }
                                     equal += all ? 1u : 0u;
                                 });
                fmt::print("  {:<12} {:<10} {:<22} {:>8} samples, {:>8} equal to the bit, worst {} ULP\n", profile.name,
                           name_of(format), kind.name, samples, equal, worst);
                INFO(profile.name << " " << name_of(format) << " " << kind.name << ": " << worst_case);
                CHECK(static_cast<double>(equal) >= 0.999 * static_cast<double>(samples));
                CHECK(worst <= 1);
            }
        }
    }
}

/// How far texel positions can lie apart: half a step of 1/256 texel, and roundings of the coordinate on the way.
double position_error(float coordinate, int size) {
    return 1.0 / 512 + (std::fabs(static_cast<double>(coordinate)) + 1.0) * size * 0x1p-22;
}

/// Whether the position may fall on either side of a border between texels.
bool near_border(float coordinate, int size) {
    const double texels = static_cast<double>(coordinate) * size;
    return std::fabs(texels - std::nearbyint(texels)) <= position_error(coordinate, size);
}

/// The largest difference that 8-bit weights and levels of detail explain, for texels in [0, 1]: a filtered value moves by at
/// most one per texel of each axis and by at most one per level.
double explained(const Setting& setting, const Point& point, std::string_view driver) {
    double bound = position_error(point.u, setting.texture.width) + position_error(point.v, setting.texture.height);
    bound += 8 * 0x1p-23;  // three or four lerps of numbers up to 1, each of up to three roundings, on either side
    if (setting.sampler.mip == Mip::Linear) {
        bound += 1.0 / 512 + 64 * 0x1p-23;
        // The piecewise linear logarithms of the drivers: log2(1 + x) - x is at most 0.0861 before it is halved or quartered.
        if (setting.instruction == Instruction::Gradient) bound += driver == "llvmpipe" ? 0.0431 : 0.0216;
    }
    if (driver == "llvmpipe" && setting.texture.format == TexelFormat::Rgba8) {
        bound += 3 * 0.5 / 255;  // each lerp rounds to a code
        if (setting.sampler.mip == Mip::Linear) bound += 0.5 / 255 + 1.0 / 256;
    }
    return bound;
}

TEST_CASE("profile d3d11 differs from the drivers by what 8-bit weights explain", "[agree][device]") {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        const std::string driver = preset_of(device);
        if (driver.empty()) continue;
        SamplingPeer machine(device);
        const Profile profile = load_profile("d3d11");
        for (const TexelFormat format : kFormats) {
            for (const Kind& kind : kKinds) {
                if (!applies(format, kind) || kind.anisotropy > 1 || kind.mip == Mip::Nearest) continue;
                double worst = 0;
                double worst_share = 0;
                std::size_t judged = 0;
                std::size_t beyond = 0;
                std::string worst_case;
                const auto count = static_cast<std::size_t>(component_count(format));
                const std::size_t samples = compare_kind(
                    machine, profile, format, kind,
                    [&](const Setting& setting, const Point& point, const Sample& theirs, const Sample& ours) {
                        // Nearest: another texel near a border between texels, else the same number to a rounding.
                        const bool nearest = kind.filter == Filter::Nearest;
                        if (nearest &&
                            (near_border(point.u, setting.texture.width) || near_border(point.v, setting.texture.height)))
                            return;
                        ++judged;
                        const double bound = nearest ? 0x1p-23 : explained(setting, point, driver);
                        for (std::size_t c = 0; c < count; ++c) {
                            const double difference = std::fabs(static_cast<double>(theirs[c]) - static_cast<double>(ours[c]));
                            worst = std::max(worst, difference);
                            worst_share = std::max(worst_share, difference / bound);
                            if (difference <= bound) continue;
                            if (beyond++ == 0)
                                worst_case = fmt::format("{}: component {} is {:a} there, {:a} here, {} apart, {} explained",
                                                         describe(setting, point), c, theirs[c], ours[c], difference, bound);
                        }
                    });
                fmt::print(
                    "  d3d11 and {:<12} {:<10} {:<18} {:>8} judged of {:>8}, worst difference {:.6f}, {:.2f} of its bound\n",
                    driver, name_of(format), kind.name, judged, samples, worst, worst_share);
                INFO(driver << " " << name_of(format) << " " << kind.name << ": " << worst_case);
                CHECK(beyond == 0);
                CHECK(2 * judged > samples);
                if (kind.filter == Filter::Linear) CHECK(worst > 0);
            }
        }
    }
}

/// Coordinates, gradients and levels that no scene should have. Where the bits differ, the drivers read texels that integer
/// overflow and NaN led them to, or let a level of weight 0 leak its NaN; nearly all must still agree.
TEST_CASE("hostile coordinates on the drivers", "[agree][device]") {
    const float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        if (preset_of(device).empty()) continue;
        SamplingPeer machine(device);
        Profile profile = load_profile(preset_of(device));
        if (profile.name == "llvmpipe") profile.flush_denormals = false;
        std::size_t samples = 0;
        std::size_t equal = 0;
        for (std::uint64_t seed = 0; seed < 200; ++seed) {
            oracle::Random random(seed + 77000);
            const Setting setting =
                setting_of(TexelFormat::Rg32f, kKinds[static_cast<std::size_t>(random.integer(0, 4))], random);
            std::vector<Point> points = points_of(setting, 256, random);
            const auto nasty = [&] {
                const std::array values{0.0f, -0.0f, 1e-40f, -1e-40f, 1e30f, -1e30f, inf, -inf, nan, 1e10f, 65536.5f};
                return values[static_cast<std::size_t>(random.integer(0, 10))];
            };
            for (Point& point : points)
                for (float* member : {&point.u, &point.v, &point.dudx, &point.dvdx, &point.dudy, &point.dvdy})
                    if (random.chance(3)) *member = nasty();
            const std::vector<Sample> theirs = sample_on(machine, setting, points);
            const std::vector<Sample> ours = sample_by(profile, setting.texture, setting.sampler, setting.instruction, points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                ++samples;
                equal += same(theirs[i][0], ours[i][0]) && same(theirs[i][1], ours[i][1]) ? 1u : 0u;
            }
        }
        fmt::print("  {:<12} hostile coordinates: {} of {} equal to the bit\n", profile.name, equal, samples);
        CHECK(static_cast<double>(equal) >= 0.98 * static_cast<double>(samples));
    }
}

TEST_CASE("gather on the drivers", "[agree][device]") {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        if (preset_of(device).empty()) continue;
        SamplingPeer machine(device);
        const Profile profile = load_profile(preset_of(device));
        std::size_t samples = 0;
        std::size_t equal = 0;
        std::string different;
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            oracle::Random random(seed + 91000);
            Setting setting = setting_of(TexelFormat::Rg32f, kKinds[2], random);
            setting.instruction = Instruction::Gather;
            const std::vector<Point> points = points_of(setting, 512, random);
            const std::vector<Sample> theirs = machine.sample(setting.texture, setting.sampler, setting.instruction, points);
            const Texture texture = texture_of(setting.texture);
            const Sampler sampler = sampler_of(setting.sampler);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const Vec3<Float> at{Float(points[i].u), Float(points[i].v), Float(0.0f)};
                const Vec4<Float> ours = gather(TextureView(texture), sampler, profile, at, 0);
                const Sample values{lane(ours.x, 0), lane(ours.y, 0), lane(ours.z, 0), lane(ours.w, 0)};
                bool all = true;
                for (std::size_t c = 0; c < 4; ++c) all = all && same(theirs[i][c], values[c]);
                equal += all ? 1u : 0u;
                if (!all)
                    different = fmt::format("{}: ({:a}, {:a}, {:a}, {:a}) there, ({:a}, {:a}, {:a}, {:a}) here",
                                            describe(setting, points[i]), theirs[i][0], theirs[i][1], theirs[i][2],
                                            theirs[i][3], values[0], values[1], values[2], values[3]);
                ++samples;
            }
        }
        fmt::print("  {:<12} gather: {} of {} equal to the bit\n", profile.name, equal, samples);
        INFO(different);
        CHECK(samples > 20000);
        CHECK(equal == samples);
    }
}

}  // namespace
}  // namespace gnomon::agree
