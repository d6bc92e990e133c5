// D3D11.3 22.4.19: comparison sampling with the reference quantised as depth output is.
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/functor_calls.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/aniso.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr std::array kOps{CompareOp::Never,   CompareOp::Less,     CompareOp::Equal,        CompareOp::LessEqual,
                          CompareOp::Greater, CompareOp::NotEqual, CompareOp::GreaterEqual, CompareOp::Always};

/// reference OP texel on values that order as the codes do.
template <class Value>
bool passes(CompareOp op, Value reference, Value texel) {
    switch (op) {
        case CompareOp::Never: return false;
        case CompareOp::Less: return reference < texel;
        case CompareOp::Equal: return reference == texel;
        case CompareOp::LessEqual: return reference <= texel;
        case CompareOp::Greater: return reference > texel;
        case CompareOp::NotEqual: return reference != texel;
        case CompareOp::GreaterEqual: return reference >= texel;
        case CompareOp::Always: return true;
    }
    return false;
}

int unorm_bits(Format format) {
    switch (format_info(format).type) {
        case ComponentType::Unorm8: return 8;
        case ComponentType::Unorm16:
        case ComponentType::Depth16: return 16;
        case ComponentType::Depth24: return 24;
        case ComponentType::Snorm8:
        case ComponentType::Srgb8:
        case ComponentType::Snorm16:
        case ComponentType::Float16:
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth32: return 0;
    }
    return 0;
}

}  // namespace

TEST_CASE("the reference meets the texel as a code of the format", "[22.4.19]") {
    for (const Format format : {Format::D16, Format::D24, Format::R16Unorm, Format::R8Unorm}) {
        const int bits = unorm_bits(format);
        const std::uint32_t last = (1u << bits) - 1u;
        oracle::Random random(static_cast<std::uint64_t>(bits));
        for (int k = 0; k < 300; ++k) {
            const auto stored = static_cast<std::uint32_t>(k == 0 ? 0 : k == 1 ? last : random.between(0, last));
            const std::vector<std::uint32_t> codes{stored};
            const Texture texture = texture_of(format, 1, 1, codes);
            // References around the boundaries of the stored code.
            std::vector<Coordinate> coordinates;
            for (const double half : {-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5}) {
                const auto z = static_cast<float>((stored + half) / last);
                for (const float reference : {z, std::nextafter(z, 2.0f), std::nextafter(z, -2.0f)})
                    coordinates.push_back({0.5f, 0.5f, 0.0f, reference});
            }
            for (const float reference : {-1.0f, 2.0f, std::nanf(""), HUGE_VALF, -HUGE_VALF})
                coordinates.push_back({0.5f, 0.5f, 0.0f, reference});
            for (const CompareOp op : kOps) {
                const Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .compare = op};
                const auto got = compare_all(texture, sampler, Profile{}, coordinates);
                for (std::size_t i = 0; i < got.size(); ++i) {
                    const float expected = passes(op, oracle::unorm_code(coordinates[i].reference, bits), stored) ? 1.0f : 0.0f;
                    if (got[i] != expected)
                        FAIL(fmt::format("{} code {:#x} {} reference {:a}: {}, expected {}", name_of(format), stored,
                                         name_of(op), coordinates[i].reference, got[i], expected));
                }
            }
        }
    }
}

TEST_CASE("float depth compares as it is, after the clamp", "[22.4.19]") {
    oracle::Random random(4);
    for (int k = 0; k < 300; ++k) {
        const float stored = k == 0 ? 0.0f : k == 1 ? 1.0f : random.unit();
        const std::vector<std::uint32_t> codes{std::bit_cast<std::uint32_t>(stored)};
        const Texture texture = texture_of(Format::D32Float, 1, 1, codes);
        std::vector<Coordinate> coordinates;
        for (const float r :
             {stored, std::nextafter(stored, 2.0f), std::nextafter(stored, -2.0f), -0.5f, 1.5f, random.unit(), HUGE_VALF})
            coordinates.push_back({0.5f, 0.5f, 0.0f, r});
        for (const CompareOp op : kOps) {
            const auto got = compare_all(texture, {.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .compare = op},
                                         Profile{}, coordinates);
            for (std::size_t i = 0; i < got.size(); ++i) {
                float reference = coordinates[i].reference;
                reference = reference < 0x1p-126f ? 0.0f : reference > 1.0f ? 1.0f : reference;  // denormals are 0 here
                const float expected = passes(op, reference, stored) ? 1.0f : 0.0f;
                if (got[i] != expected)
                    FAIL(fmt::format("stored {:a} {} reference {:a}: {}, expected {}", stored, name_of(op),
                                     coordinates[i].reference, got[i], expected));
            }
        }
    }
}

TEST_CASE("comparison results are filtered like any texel", "[22.4.19][7.18.15]") {
    for (const Format format : {Format::D16, Format::D24, Format::D32Float, Format::R32Float}) {
        oracle::Random random(static_cast<std::uint64_t>(format));
        for (int round = 0; round < 50; ++round) {
            const int width = random.integer(1, 9);
            const int height = random.integer(1, 9);
            std::vector<std::uint32_t> codes(static_cast<std::size_t>(width * height));
            for (auto& code : codes) code = moderate_code(format, random);
            const Texture texture = texture_of(format, width, height, codes);
            const CompareOp op = kOps[static_cast<std::size_t>(random.integer(0, 7))];
            const std::array modes{AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp, AddressMode::Border};
            const Sampler sampler{.address_u = modes[static_cast<std::size_t>(random.integer(0, 3))],
                                  .address_v = modes[static_cast<std::size_t>(random.integer(0, 3))],
                                  .compare = op,
                                  .border = glm::vec4(1.0f, 0.0f, 0.0f, 0.0f)};
            std::vector<Coordinate> coordinates;
            for (int i = 0; i < 200; ++i)
                coordinates.push_back({random.in(-1.5f, 2.5f), random.in(-1.5f, 2.5f), 0.0f, random.unit()});
            const auto got = compare_all(texture, sampler, Profile{}, coordinates);
            for (std::size_t i = 0; i < got.size(); ++i) {
                const int bits = unorm_bits(format);
                const double reference = bits == 0 ? static_cast<double>(coordinates[i].reference)
                                                   : oracle::unorm_code(coordinates[i].reference, bits);
                oracle::Image image{width, height, {}, 0};
                for (const std::uint32_t code : codes)
                    image.texels.push_back(
                        passes(op, reference, bits == 0 ? static_cast<double>(std::bit_cast<float>(code)) : code));
                image.border = passes(op, reference, bits == 0 ? 1.0 : static_cast<double>((1u << bits) - 1u));
                const auto u = oracle::linear_axis(coordinates[i].u, width, oracle_mode(sampler.address_u));
                const auto v = oracle::linear_axis(coordinates[i].v, height, oracle_mode(sampler.address_v));
                // Texels are 0 and 1, weights have 16 bits: exact.
                const double exact = oracle::bilinear(image.taps(u, v), u.weight, v.weight);
                if (static_cast<double>(got[i]) != exact)
                    FAIL(fmt::format("{} round {} {} uv ({:a}, {:a}) reference {:a}: {:a}, exact {:a}", name_of(format), round,
                                     name_of(op), coordinates[i].u, coordinates[i].v, coordinates[i].reference, got[i], exact));
            }
        }
    }
}

TEST_CASE("an unquantised reference is the profile's choice", "[22.4.19]") {
    // 0.3 lies between codes; raw comparison sees that it is not the texel.
    const std::uint32_t code = oracle::unorm_code(0.3f, 16);
    const std::vector<std::uint32_t> codes{code};
    const Texture texture = texture_of(Format::D16, 1, 1, codes);
    const Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .compare = CompareOp::Equal};
    Profile raw;
    raw.compare_reference = CompareReference::Raw;
    const std::vector<Coordinate> at{{0.5f, 0.5f, 0.0f, 0.3f}};
    CHECK(compare_all(texture, sampler, Profile{}, at)[0] == 1.0f);
    CHECK(compare_all(texture, sampler, raw, at)[0] == 0.0f);
}

TEST_CASE("the border takes part in comparisons at the format's precision", "[22.4.19][7.18.9.1]") {
    // Border 0.5 and reference 0.5 are the same depth. The reference is quantised to 32768 / 65535, above one half: a border
    // that keeps full precision would make "0.5 <= 0.5" fail in D16.
    for (const Format format : {Format::D16, Format::D24, Format::D32Float}) {
        const std::vector<std::uint32_t> codes{0};
        const Texture texture = texture_of(format, 1, 1, codes);
        const Sampler sampler{.min = TexelFilter::Nearest,
                              .mag = TexelFilter::Nearest,
                              .address_u = AddressMode::Border,
                              .compare = CompareOp::LessEqual,
                              .border = glm::vec4(0.5f)};
        INFO(name_of(format));
        CHECK(compare_all(texture, sampler, Profile{}, std::vector<Coordinate>{{2.0f, 0.5f, 0.0f, 0.5f}})[0] == 1.0f);
    }
}

namespace {

/// Compares on a curved path, so that no two quads have the same derivatives.
struct CompareQuad {
    TextureId map = TextureId::None;
    Sampler sampler{};
    static constexpr auto fields() {
        return std::tuple{Field{"map", &CompareQuad::map}, Field{"sampler", &CompareQuad::sampler}};
    }

    template <class Real>
    static Vec2<Real> coordinate(const Vec2<Real>& at) {
        return {at.x * at.x * Real(1.0f / 256.0f) + at.y * Real(1.0f / 512.0f), at.y * at.y * Real(1.0f / 1024.0f)};
    }
    template <class Real>
    static Real reference(const Vec2<Real>& at) {
        return (at.x + at.y) * Real(1.0f / 32.0f);
    }
    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Real> at{f.position.x, f.position.y};
        const Real result = f.sample_compare_quad(map, sampler, coordinate(at), reference(at));
        return Vec4<Real>{result, f.sample_compare(map, sampler, coordinate(at), reference(at)), result, result};
    }
};

std::vector<Sampler> comparison_samplers(int anisotropy) {
    std::vector<Sampler> samplers;
    for (const TexelFilter min : {TexelFilter::Nearest, TexelFilter::Linear})
        for (const TexelFilter mag : {TexelFilter::Nearest, TexelFilter::Linear})
            for (const MipFilter mip : {MipFilter::Base, MipFilter::Nearest, MipFilter::Linear})
                samplers.push_back({.min = min, .mag = mag, .mip = mip, .max_anisotropy = anisotropy});
    return samplers;
}

/// The functor's result against the texture unit's, to the bit, and what both of its comparisons cost.
template <class Real>
std::vector<float> check_quad_comparison(Device& device, const CompareQuad& pixel) {
    const FunctorResult drawn = run_functor(device, pixel);
    const TextureView view(device.texture(pixel.map));
    const Profile& profile = device.profile();
    SampleCost cost;
    const auto count = [&](const Vec2<Real>& uv, const LevelOfDetail<Real>& lod) {
        const SampleCost wave =
            sample_cost(view, pixel.sampler, profile, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, lod, {}, kAllLanes);
        cost = {cost.probes + wave.probes, cost.texels + wave.texels};
    };
    std::vector<float> results(kFunctorPixels);
    for_quads<Real>([&](const Vec2<Real>& at, const auto& pixels) {
        const Vec2<Real> uv = CompareQuad::coordinate(at);
        const Real reference = CompareQuad::reference(at);
        const LevelOfDetail<Real> lod = level_of_detail(quad_gradients(uv, profile), view, pixel.sampler, profile);
        const LevelOfDetail<Real> top(Real(0.0f));
        const auto quad = to_float(sample_compare(view, pixel.sampler, profile, uv, reference, lod)).lanes();
        const auto base = to_float(sample_compare(view, pixel.sampler, profile, uv, reference, top)).lanes();
        count(uv, lod);
        count(uv, top);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            results[pixels[i]] = drawn.at(pixels[i], 0);
            if (drawn.at(pixels[i], 0) != quad[i] || drawn.at(pixels[i], 1) != base[i])
                FAIL(fmt::format("pixel {}: {:a} and {:a}, expected {:a} and {:a}", pixels[i], drawn.at(pixels[i], 0),
                                 drawn.at(pixels[i], 1), quad[i], base[i]));
        }
    });
    CHECK(drawn.tally.counters.texture_instructions == 2 * kFunctorPixels);
    CHECK(drawn.tally.counters.texture_probes == cost.probes);
    CHECK(drawn.tally.counters.texels_fetched == cost.texels);
    const Sampler& s = pixel.sampler;
    const bool takes_derivatives = s.mip != MipFilter::Base || s.min != s.mag || s.max_anisotropy > 1;
    CHECK(drawn.tally.counters.derivatives == (takes_derivatives ? kFunctorPixels : 0));
    return results;
}

}  // namespace

TEST_CASE("a functor's comparison has the level of detail and the anisotropy of its quad", "[22.4.19][7.18.11]") {
    for (const Profile& profile : profile_presets()) {
        for (const Format format : {Format::D16, Format::D32Float}) {
            Device device(profile, 1);
            const TextureId map = random_texture(device, {.format = format, .width = 64, .height = 64, .levels = 7}, 19,
                                                 [&](oracle::Random& random) { return moderate_code(format, random); });
            const auto isotropic = comparison_samplers(1);
            const auto anisotropic = comparison_samplers(16);
            for (std::size_t i = 0; i < isotropic.size(); ++i) {
                const auto run = [&](const Sampler& sampler) {
                    INFO(fmt::format("{} {}: min {}, mag {}, mip {}, anisotropy {}", profile.name, name_of(format),
                                     name_of(sampler.min), name_of(sampler.mag), name_of(sampler.mip), sampler.max_anisotropy));
                    std::vector<float> results;
                    with_arithmetic(profile, [&]<class Real>(Real) {
                        results = check_quad_comparison<Real>(device, {.map = map, .sampler = sampler});
                    });
                    return results;
                };
                const auto one = run(isotropic[i]);
                const auto many = run(anisotropic[i]);
                CHECK(one != many);
                CHECK(std::set(many.begin(), many.end()).size() > 10);  // fractions, of nearest taps, too
            }
        }
    }
}

TEST_CASE("an anisotropic comparison is the mean of its probes, nearest or linear", "[22.4.19][7.18.11]") {
    // Columns of 0.25 and 0.75; eight texels long and one wide, the footprint has eight probes at k/9 of its line.
    constexpr int kWidth = 64;
    constexpr int kProbes = 8;
    const auto passes_at = [](int column) { return std::clamp(column, 0, kWidth - 1) % 3 != 0 ? 1.0 : 0.0; };
    Texture texture({.format = Format::D32Float, .width = kWidth, .height = 4});
    std::vector<float> depths;
    for (int i = 0; i < kWidth * 4; ++i) depths.push_back(i % kWidth % 3 != 0 ? 0.75f : 0.25f);
    texture.set_level_bytes(0, std::as_bytes(std::span(depths)).data(), depths.size() * 4);

    std::vector<SampleRequest> requests;
    for (int i = 0; i < 1024; ++i) {  // sixteenths of a texel: no probe comes close to an edge between texels
        SampleRequest request{.coordinate = {i / 1024.0, 0.375, 0}, .reference = 0.5};
        request.gradient = SampleGradient{.dx = {8.0 / kWidth, 0, 0}, .dy = {0, 1.0 / 4, 0}};
        requests.push_back(request);
    }
    for (const TexelFilter filter : {TexelFilter::Nearest, TexelFilter::Linear}) {
        for (const MipFilter mip : {MipFilter::Base, MipFilter::Linear}) {
            const Sampler sampler{.min = filter, .mag = filter, .mip = mip, .max_anisotropy = 16};
            CHECK_NOTHROW(check_sampler(sampler, "sampler"));
            INFO(name_of(filter));
            const auto results = sample_all(texture, sampler, load_profile("d3d11"), requests);
            for (std::size_t i = 0; i < requests.size(); ++i) {
                double expected = 0;
                for (int k = 1; k <= kProbes; ++k) {
                    const double u = kWidth * requests[i].coordinate[0] + 8.0 * (k / (kProbes + 1.0) - 0.5);
                    const double left = std::floor(u - 0.5);
                    const double weight = u - 0.5 - left;
                    const int column = static_cast<int>(left);
                    expected +=
                        (filter == TexelFilter::Nearest ? passes_at(static_cast<int>(std::floor(u)))
                                                        : (1.0 - weight) * passes_at(column) + weight * passes_at(column + 1)) /
                        kProbes;
                }
                // Weights have 8 bits, and eight means of numbers up to 1 are rounded.
                const double tolerance = filter == TexelFilter::Nearest ? 0x1p-20 : 0x1p-9 + 0x1p-20;
                const double got = results[i].color[0];
                if (!(std::fabs(got - expected) <= tolerance))
                    FAIL(fmt::format("u {}: {:a}, expected {:a}", requests[i].coordinate[0], got, expected));
            }
            const SampleRecord record = record_sample(texture, sampler, load_profile("d3d11"), requests[500]);
            CHECK(record.probes.size() == std::size_t{kProbes});
            for (const ProbeRecord& probe : record.probes)
                CHECK(probe.levels[0].taps.size() == (filter == TexelFilter::Nearest ? 1u : 4u));
        }
    }
}
