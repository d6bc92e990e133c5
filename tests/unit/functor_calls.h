// Pixel functors run over a whole target, and the lanes of its pixels for calls beside them.
#pragma once

#include "pipeline/program.h"
#include "sim/denormals.h"
#include "tests/oracle/random.h"
#include "tests/unit/pipeline_programs.h"

#include <array>
#include <cstring>
#include <utility>
#include <vector>

namespace gnomon::testing {

inline constexpr int kFunctorSide = 16;  // pixels of the square targets
inline constexpr std::size_t kFunctorPixels = std::size_t{kFunctorSide} * kFunctorSide;

struct WholeTarget {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{v.in.position, NoVaryings<typename V::Real>{}};
    }
};

/// What a functor wrote to each of its targets, components of pixels row by row, and what was counted.
struct FunctorResult {
    std::vector<std::vector<float>> targets{};
    Tally tally{};

    [[nodiscard]] float at(std::size_t pixel, std::size_t component, std::size_t target = 0) const {
        return targets[target][pixel * 4 + component];
    }
};

template <class Pixel>
FunctorResult run_functor(Device& device, const Pixel& pixel) {
    static const Program program = make_program<WholeTarget, Pixel>("test.functor");
    static const WholeTarget vertex;
    const BufferId triangle = upload(device, {{-1, 1, 0.5f, 1, 0, 0}, {3, 1, 0.5f, 1, 0, 0}, {-1, -3, 0.5f, 1, 0, 0}});
    Draw draw{.label = "functor",
              .program = &program,
              .vertex_constants = constants_of(vertex),
              .pixel_constants = constants_of(pixel),
              .vertices = triangle,
              .count = 3};
    const auto targets = static_cast<std::size_t>(program.targets());
    for (std::size_t t = 0; t < targets; ++t)
        draw.color[t] =
            device.create_texture("target", {.format = Format::Rgba32Float, .width = kFunctorSide, .height = kFunctorSide});
    device.enable_counters(true);
    device.take_tally();
    device.execute(draw);
    FunctorResult result;
    result.tally = device.take_tally();
    for (std::size_t t = 0; t < targets; ++t) result.targets.push_back(floats_of(device.texture(draw.color[t].texture)));
    return result;
}

/// Calls body(centre, pixels) for the quads of such a target, as many as a wave has; lane i is pixel pixels[i], row by row.
template <class Real, class Body>
void for_quads(const Body& body) {
    constexpr int kQuadsPerRow = kFunctorSide / 2;
    for (int first = 0; first < kQuadsPerRow * kQuadsPerRow; first += kQuadsPerWave) {
        std::array<typename Real::Scalar, kLanes> x{};
        std::array<typename Real::Scalar, kLanes> y{};
        std::array<std::size_t, kLanes> pixels{};
        for (int i = 0; i < kLanes; ++i) {
            const int quad = first + i / 4;
            const int column = quad % kQuadsPerRow * 2 + (i & 1);
            const int row = quad / kQuadsPerRow * 2 + (i >> 1 & 1);
            const auto l = static_cast<std::size_t>(i);
            x[l] = static_cast<typename Real::Scalar>(column) + static_cast<typename Real::Scalar>(0.5);
            y[l] = static_cast<typename Real::Scalar>(row) + static_cast<typename Real::Scalar>(0.5);
            pixels[l] = static_cast<std::size_t>(row * kFunctorSide + column);
        }
        body(Vec2<Real>{Real::load(x.data()), Real::load(y.data())}, pixels);
    }
}

/// Calls body(Real{}) with the lanes of the profile's arithmetic, denormals as the profile has them.
template <class Body>
void with_arithmetic(const Profile& profile, const Body& body) {
    const DenormalScope denormals(profile.flush_denormals);
    if (profile.arithmetic == Arithmetic::Fp64) {
        body(Double{});
    } else {
        body(Float{});
    }
}

/// A texture whose levels and layers are filled with random values of fill(random), of floats or codes of 32 bits.
template <class Fill>
TextureId random_texture(Device& device, const TextureDesc& desc, std::uint64_t seed, const Fill& fill) {
    const TextureId id = device.create_texture("texture", desc);
    oracle::Random random(seed);
    const auto words = static_cast<std::size_t>(format_info(desc.format).bytes_per_texel) / 4;
    for (int layer = 0; layer < desc.layers; ++layer)
        for (int level = 0; level < desc.levels; ++level) {
            const Texture& texture = device.texture(id);
            std::vector<std::uint32_t> texels(static_cast<std::size_t>(texture.width(level) * texture.height(level)) * words);
            for (auto& word : texels) word = std::bit_cast<std::uint32_t>(fill(random));
            device.execute(WriteTexture{id, level, std::as_bytes(std::span(texels)), layer});
        }
    return id;
}

}  // namespace gnomon::testing
