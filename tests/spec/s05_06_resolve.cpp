// D3D11.3 5.6.6, 19.2.4: resolving samples to their mean, and custom resolves that load every sample (22.4.7).
#include "pipeline/program.h"
#include "tests/oracle/output_merger.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texel.h"
#include "tests/unit/output_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

/// Vertices as pipeline_programs.h has them.
struct Position {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    struct Varyings {
        Real a;
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{v.in.position, Varyings<Real>{v.in.a}};
    }
};

/// A resolve of moments: sum of weights[s] * sample s, in order.
struct WeightedResolve {
    MultisampledTexture source;
    std::array<float, 16> weights{};
    static constexpr auto fields() {
        return std::tuple{Field{"source", &WeightedResolve::source}, Field{"weights", &WeightedResolve::weights}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Int y = truncate_to_int(f.position.y);
        Vec4<Real> sum{Real(0.0f), Real(0.0f), Real(0.0f), Real(0.0f)};
        for (int s = 0; s < f.samples(source); ++s) {
            const Vec4<Real> texel = f.load(source, x, y, s);
            const Real weight(weights[static_cast<std::size_t>(s)]);
            sum = {sum.x + texel.x * weight, sum.y + texel.y * weight, sum.z + texel.z * weight, sum.w + texel.w * weight};
        }
        return sum;
    }
};

const Program& resolve_program() {
    static const Program program = make_program<Position, WeightedResolve>("test.weighted-resolve");
    return program;
}

constexpr int kWidth = 19;  // no multiple of any number of lanes
constexpr int kHeight = 35;

/// Random texels in every sample; moments as shadow maps have them: the square beside the value, near 1.
void fill(Canvas& canvas, TextureId id, std::uint64_t seed) {
    Random random(seed);
    const FormatInfo& format = canvas.device.texture(id).info();
    const Profile& profile = canvas.device.profile();
    const auto bytes = static_cast<std::size_t>(format.bytes_per_texel);
    for (int s = 0; s < canvas.samples; ++s) {
        std::vector<std::byte> texels(canvas.pixels() * bytes);
        for (std::size_t i = 0; i < canvas.pixels(); ++i) {
            const double depth = 0.75 + 0.25 * static_cast<double>(random.unit());
            for (int c = 0; c < format.components; ++c) {
                const std::uint32_t moment = oracle::component_code(format.format, profile, std::pow(depth, c + 1), c);
                const bool is_float32 = format.type == ComponentType::Float32;
                oracle::store_code(format.format, &texels[i * bytes], c, i % 2 == 0 || is_float32 ? moment : random.bits());
            }
        }
        canvas.device.execute(WriteTexture{id, 0, texels, 0, s});
    }
}

}  // namespace

TEST_CASE("box resolve of every format is the mean of the samples", "[5.6.6][19.2.4][resolve]") {
    for (const char* name : {"d3d11", "ideal"}) {
        const Profile profile = load_profile(name);
        for (const FormatInfo& format : kFormats) {
            if (format.is_depth || format.is_integer()) continue;
            for (const int samples : {2, 4, 8, 16}) {
                Canvas canvas(profile, kWidth, kHeight, samples, 2);
                const TextureId source = canvas.target(format.format);
                const TextureId destination =
                    canvas.device.create_texture("mean", {.format = format.format, .width = kWidth, .height = kHeight});
                fill(canvas, source, static_cast<std::uint64_t>(samples));
                canvas.device.execute(Resolve{source, destination});
                const oracle::Arithmetic arithmetic(profile);
                for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                    for (int c = 0; c < format.components; ++c) {
                        double sum = 0;
                        double exact = 0;
                        for (int s = 0; s < samples; ++s) {
                            const double value =
                                oracle::texel_value(format.format, profile, canvas.code(source, i, c, 0, s), c);
                            sum = s == 0 ? value : arithmetic.round(sum + value);
                            exact += value / samples;
                        }
                        const std::uint32_t expected =
                            oracle::component_code(format.format, profile, arithmetic.round(sum / samples), c);
                        const std::uint32_t found = canvas.code(destination, i, c);
                        INFO(name << ", " << format.name << ", " << samples << " samples, pixel " << i << ", component " << c);
                        if (found != expected) REQUIRE(found == expected);
                        // And what that rounding costs: against the exact mean, less than a step of the format from it, and
                        // (N - 1) roundings of sums below N.
                        if (std::isnan(exact) || std::isinf(exact)) continue;
                        const std::uint32_t ideal = oracle::component_code(format.format, profile, exact, c);
                        const double here = oracle::texel_value(format.format, profile, found, c);
                        const double there = oracle::texel_value(format.format, profile, ideal, c);
                        const double step = format.type == ComponentType::Float32
                                                ? std::fabs(exact) * samples * arithmetic.unit() * 2
                                            : format.type == ComponentType::Float16 || format.type == ComponentType::Float11
                                                ? std::fmax(std::fabs(exact), 0x1p-14) *
                                                      (format.type == ComponentType::Float16 ? 0x1p-10 : 0x1p-5)
                                                : 0.03;
                        if (std::fabs(here - there) > step) REQUIRE(std::fabs(here - there) <= step);
                    }
                }
            }
        }
    }
}

TEST_CASE("resolve takes one slice of an array to one level and slice", "[5.6.6][resolve]") {
    Device device(load_profile("d3d11"), 2);
    const TextureId source = device.create_texture(
        "samples",
        {.format = Format::R32Float, .width = 6, .height = 4, .kind = TextureKind::Array, .layers = 3, .samples = 4});
    const TextureId destination = device.create_texture(
        "mean", {.format = Format::R32Float, .width = 12, .height = 8, .levels = 2, .kind = TextureKind::Array, .layers = 2});
    for (int layer = 0; layer < 3; ++layer)
        for (int s = 0; s < 4; ++s) {
            const std::vector<float> texels(24, static_cast<float>(100 * layer + s));
            device.execute(WriteTexture{source, 0, std::as_bytes(std::span(texels)), layer, s});
        }
    device.execute(Resolve{TargetView(source, 0, 2), TargetView(destination, 1, 1)});
    for (int level = 0; level < 2; ++level)
        for (int layer = 0; layer < 2; ++layer) {
            const auto bytes = device.texture(destination).level_bytes(level, layer);
            for (std::size_t i = 0; i < bytes.size(); i += 4) {
                float value = 0;
                std::memcpy(&value, &bytes[i], 4);
                REQUIRE(value == (level == 1 && layer == 1 ? 201.5f : 0.0f));
            }
        }
}

TEST_CASE("a shader resolves by loading each sample", "[22.4.7][22.4.6][resolve]") {
    // With weights 1/N it is the box resolve, bit by bit; with others the weighted sum.
    for (const Format format : {Format::Rg32Float, Format::Rgba16Float, Format::Rgba16Unorm, Format::Rgba8Srgb}) {
        for (const int samples : {2, 4, 8, 16}) {
            for (const bool box : {true, false}) {
                const Profile profile = load_profile("d3d11");
                Canvas canvas(profile, kWidth, kHeight, samples, 2);
                const TextureId source = canvas.target(format);
                fill(canvas, source, 77);
                const TextureDesc desc{.format = format, .width = kWidth, .height = kHeight};
                const TextureId custom = canvas.device.create_texture("custom", desc);
                const TextureId mean = canvas.device.create_texture("mean", desc);
                WeightedResolve functor{.source = {source}};
                for (std::size_t s = 0; s < static_cast<std::size_t>(samples); ++s)
                    functor.weights[s] = box ? 1.0f / static_cast<float>(samples) : static_cast<float>(s % 3) * 0.375f;
                Draw draw =
                    make_draw(resolve_program(), upload(canvas.device, canvas.corners({0, 0, kWidth, kHeight}, 0.5f)), 0, 6);
                draw.pixel_constants = constants_of(functor);
                draw.color[0] = custom;
                canvas.device.execute(draw);
                canvas.device.execute(Resolve{source, mean});
                const oracle::Arithmetic arithmetic(profile);
                for (std::size_t i = 0; i < canvas.pixels(); ++i) {
                    for (int c = 0; c < format_info(format).components; ++c) {
                        double sum = 0;
                        for (int s = 0; s < samples; ++s) {
                            const double value = oracle::texel_value(format, profile, canvas.code(source, i, c, 0, s), c);
                            const auto weight = static_cast<double>(functor.weights[static_cast<std::size_t>(s)]);
                            sum = arithmetic.round(sum + arithmetic.round(value * weight));
                        }
                        const std::uint32_t found = canvas.code(custom, i, c);
                        INFO(format_info(format).name << ", " << samples << " samples, pixel " << i << ", component " << c);
                        if (const auto expected = oracle::component_code(format, profile, sum, c); found != expected)
                            REQUIRE(found == expected);
                        if (box && found != canvas.code(mean, i, c)) REQUIRE(found == canvas.code(mean, i, c));
                    }
                }
            }
        }
    }
}
