// D3D11.3 22.4.15: arrays in pixel functors. Every lane has a slice of its own, to nearest even and clamped, and the level of
// detail is that of u and v.
#include "tests/unit/functor_calls.h"
#include "texunit/aniso.h"
#include "texunit/sample.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

enum class Call { Implicit, Gradient, Level };
constexpr std::array kCalls{Call::Implicit, Call::Gradient, Call::Level};

/// Samples an array on a curved path, so that no two quads have the same derivatives; slices go from far below to far above.
struct ArraySample {
    TextureId map = TextureId::None;
    Sampler sampler{};
    int call = 0;
    float slice_per_pixel = 0.5f;

    static constexpr glm::ivec2 kOffset{1, -2};
    static constexpr auto fields() {
        using A = ArraySample;
        return std::tuple{Field{"map", &A::map}, Field{"sampler", &A::sampler}, Field{"call", &A::call},
                          Field{"slice_per_pixel", &A::slice_per_pixel}};
    }

    template <class Real>
    Vec3<Real> coordinate(const Vec2<Real>& at) const {
        const Real slice = (at.x - at.y) * Real(slice_per_pixel) + Real(1.0f);
        const Real nan(std::numeric_limits<float>::quiet_NaN());
        return {at.x * at.x * Real(1.0f / 512.0f) + at.y * Real(1.0f / 64.0f), at.y * at.y * Real(1.0f / 64.0f),
                select(at.y > Real(15.0f), nan, slice)};
    }
    template <class Real>
    static Gradients<Real> gradients(const Vec2<Real>& at) {
        return {{at.x * Real(1.0f / 256.0f), Real(0.0f)}, {at.x * Real(1.0f / 1024.0f), at.y * Real(1.0f / 128.0f)}};
    }
    template <class Real>
    static Real level(const Vec2<Real>& at) {
        return at.x * Real(0.375f) - Real(1.0f);
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Real> at{f.position.x, f.position.y};
        const SampleOperands<Real> operands{.offset = kOffset, .lod_bias = Real(0.25f)};
        const Vec3<Real> c = coordinate(at);
        switch (static_cast<Call>(call)) {
            case Call::Implicit: return f.sample(map, sampler, c, operands);
            case Call::Gradient: return f.sample_gradient(map, sampler, c, gradients(at), operands);
            case Call::Level: return f.sample_level(map, sampler, c, level(at), operands);
        }
        return f.load(map, Int(0), Int(0));
    }

    /// The same by calls of the texture unit.
    template <class Real>
    LevelOfDetail<Real> lod(const Vec2<Real>& at, const TextureView& view, const Profile& profile) const {
        const Vec3<Real> c = coordinate(at);
        switch (static_cast<Call>(call)) {
            case Call::Implicit: return level_of_detail(quad_gradients(Vec2<Real>{c.x, c.y}, profile), view, sampler, profile);
            case Call::Gradient: return level_of_detail(gradients(at), view, sampler, profile);
            case Call::Level: return LevelOfDetail<Real>(level(at));
        }
        return LevelOfDetail<Real>(Real(0.0f));
    }
};

std::vector<Sampler> all_filters() {
    std::vector<Sampler> samplers;
    for (const TexelFilter min : {TexelFilter::Nearest, TexelFilter::Linear})
        for (const TexelFilter mag : {TexelFilter::Nearest, TexelFilter::Linear})
            for (const MipFilter mip : {MipFilter::Base, MipFilter::Nearest, MipFilter::Linear})
                for (const int anisotropy : {1, 16})
                    samplers.push_back({.min = min,
                                        .mag = mag,
                                        .mip = mip,
                                        .address_u = AddressMode::Wrap,
                                        .address_v = AddressMode::Mirror,
                                        .max_anisotropy = anisotropy});
    return samplers;
}

std::string describe(const Profile& profile, const ArraySample& pixel) {
    return fmt::format("{}: call {}, min {}, mag {}, mip {}, anisotropy {}", profile.name, pixel.call,
                       name_of(pixel.sampler.min), name_of(pixel.sampler.mag), name_of(pixel.sampler.mip),
                       pixel.sampler.max_anisotropy);
}

constexpr int kLayers = 5;

/// The functor's result against the texture unit's, pixel by pixel and to the bit, and what it cost.
template <class Real>
void check_against_unit(Device& device, const ArraySample& pixel) {
    const FunctorResult drawn = run_functor(device, pixel);
    const Texture& texture = device.texture(pixel.map);
    const TextureView view(texture);
    const SampleOperands<Real> operands{.offset = ArraySample::kOffset, .lod_bias = Real(0.25f)};
    SampleCost cost;
    std::set<std::uint32_t> seen;
    for_quads<Real>([&](const Vec2<Real>& at, const auto& pixels) {
        const LevelOfDetail<Real> lod = pixel.lod(at, view, device.profile());
        const Vec3<Real> c = pixel.coordinate(at);
        const Vec4<Real> color = sample(view, pixel.sampler, device.profile(), c, lod, operands);
        const SampleCost wave = sample_cost(view, pixel.sampler, device.profile(), c, lod, operands, kAllLanes);
        cost = {cost.probes + wave.probes, cost.texels + wave.texels};
        const std::array expected{bits_of(to_float(color.x)).lanes(), bits_of(to_float(color.y)).lanes(),
                                  bits_of(to_float(color.z)).lanes(), bits_of(to_float(color.w)).lanes()};
        for (std::size_t i = 0; i < pixels.size(); ++i)
            for (std::size_t k = 0; k < 4; ++k) {
                const auto wanted = static_cast<std::uint32_t>(expected[k][i]);
                const auto got = std::bit_cast<std::uint32_t>(drawn.at(pixels[i], k));
                if (got != wanted) FAIL(fmt::format("pixel {} component {}: {:#x}, expected {:#x}", pixels[i], k, got, wanted));
                seen.insert(got);
            }
    });
    CHECK(seen.size() > 40);
    CHECK(drawn.tally.counters.texture_instructions == kFunctorPixels);
    CHECK(drawn.tally.counters.texture_probes == cost.probes);
    CHECK(drawn.tally.counters.texels_fetched == cost.texels);
    CHECK(drawn.tally.of(pixel.map).read == cost.texels * static_cast<std::uint64_t>(texture.info().bytes_per_texel));
}

/// The slice of every pixel is its own number; so says each call.
struct SliceNumbers {
    TextureId map = TextureId::None;
    float slice_per_pixel = 0.0f;
    static constexpr auto fields() {
        using S = SliceNumbers;
        return std::tuple{Field{"map", &S::map}, Field{"slice_per_pixel", &S::slice_per_pixel}};
    }
    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real half(0.5f);
        const Real zero(0.0f);
        const Vec3<Real> c{half, half, (f.position.x - f.position.y) * Real(slice_per_pixel)};
        return Vec4<Real>{f.sample(map, {}, c).x, f.sample_gradient(map, {}, c, {{zero, zero}, {zero, zero}}).x,
                          f.sample_level(map, {}, c, zero).x, f.sample(map, {}, {half, half}).x};
    }
};

}  // namespace

TEST_CASE("a functor samples arrays as the texture unit does, a slice for each lane", "[22.4.15][22.4.17][22.4.18]") {
    for (const Profile& profile : profile_presets()) {
        for (const Format format : {Format::Rg32Float, Format::Rgba8Unorm}) {
            Device device(profile, 1);
            ArraySample pixel{
                .map = random_texture(
                    device,
                    {.format = format, .width = 32, .height = 16, .levels = 6, .kind = TextureKind::Array, .layers = kLayers},
                    1, [&](oracle::Random& random) {
                        return format == Format::Rg32Float ? std::bit_cast<std::uint32_t>(random.in(-1.0f, 1.0f))
                                                           : random.bits();
                    })};
            for (const Sampler& sampler : all_filters()) {
                if (sampler.filters() && !filters_format(format_info(format), profile)) continue;
                for (const Call call : kCalls) {
                    pixel.sampler = sampler;
                    pixel.call = static_cast<int>(call);
                    INFO(name_of(format) << " " << describe(profile, pixel));
                    with_arithmetic(profile, [&]<class Real>(Real) { check_against_unit<Real>(device, pixel); });
                }
            }
        }
    }
}

TEST_CASE("slices round to nearest even and clamp, lane by lane", "[22.4.15]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        Device device(load_profile(profile), 1);
        const TextureId map =
            device.create_texture("numbers", {.format = Format::R32Float, .kind = TextureKind::Array, .layers = kLayers});
        for (int layer = 0; layer < kLayers; ++layer) {
            const auto number = static_cast<float>(layer);
            device.execute(WriteTexture{map, 0, std::as_bytes(std::span(&number, 1)), layer});
        }
        for (const float per_pixel : {0.5f, 0.25f, 1.0f, 1e30f, -0.5f}) {
            const FunctorResult drawn = run_functor(device, SliceNumbers{map, per_pixel});
            for (std::size_t i = 0; i < kFunctorPixels; ++i) {
                const int steps = static_cast<int>(i % kFunctorSide) - static_cast<int>(i / kFunctorSide);
                const double slice = static_cast<double>(per_pixel) * steps;
                const double floor = std::floor(slice);
                const bool up = slice - floor == 0.5 ? std::fmod(floor, 2.0) != 0.0 : slice - floor > 0.5;
                const auto expected = static_cast<float>(std::fmax(0.0, std::fmin(kLayers - 1.0, up ? floor + 1.0 : floor)));
                INFO(profile << ", slice " << slice);
                for (std::size_t k = 0; k < 3; ++k) CHECK(drawn.at(i, k) == expected);
                CHECK(drawn.at(i, 3) == 0.0f);  // without a slice: the first
            }
        }
    }
}

TEST_CASE("slices have no part in the level of detail, and flat textures have one", "[22.4.15][7.18.11]") {
    Device device(load_profile("d3d11"), 1);
    const auto level_numbers = [&](const TextureDesc& desc) {
        const TextureId id = device.create_texture("levels", desc);
        for (int layer = 0; layer < desc.layers; ++layer)
            for (int level = 0; level < desc.levels; ++level) {
                const Texture& texture = device.texture(id);
                const std::vector<float> texels(static_cast<std::size_t>(texture.width(level) * texture.height(level)),
                                                static_cast<float>(level));
                device.execute(WriteTexture{id, level, std::as_bytes(std::span(texels)), layer});
            }
        return id;
    };
    TextureDesc desc{.format = Format::R32Float, .width = 32, .height = 16, .levels = 6};
    const TextureId flat = level_numbers(desc);
    desc.kind = TextureKind::Array;
    desc.layers = kLayers;
    const TextureId array = level_numbers(desc);
    const Sampler sampler{.mip = MipFilter::Linear, .address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap};
    const auto levels = [&](TextureId map, float slice_per_pixel) {
        return run_functor(device, ArraySample{.map = map, .sampler = sampler, .slice_per_pixel = slice_per_pixel}).targets[0];
    };
    const std::vector<float> still = levels(array, 0.0f);
    CHECK(std::set(still.begin(), still.end()).size() > 10);
    CHECK(levels(array, 0.5f) == still);
    CHECK(levels(array, 1000.0f) == still);
    CHECK(levels(flat, 1000.0f) == still);
}
