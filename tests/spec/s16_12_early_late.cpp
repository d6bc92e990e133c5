// D3D11.3 16.12: tests appear to follow the pixel functor unless it forces them early; then its discards, masks and depths come
// too late for depth and stencil. Random draws over one another against a model of one sample at a time.
#include "tests/oracle/output_merger.h"
#include "tests/oracle/random.h"
#include "tests/oracle/texel.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr int kSize = 12;
constexpr std::size_t kPixels = kSize * kSize;

struct Sample {
    float color = -1.0f;
    float z = 1.0f;
    int stencil = 0;

    bool operator==(const Sample&) const = default;
};

struct Result {
    std::vector<Sample> found;
    std::vector<Sample> expected;
    Counters counters;
};

/// The same draws for every value of `features`; what the functor wants is in images that only it looks at.
Result draw_all(unsigned features, int samples, std::uint64_t seed, bool stencil_test) {
    Canvas canvas(load_profile("d3d11"), kSize, kSize, samples, 2);
    const TextureId color = canvas.target(Format::R32Float);
    const TextureId depth = canvas.target(Format::D32FloatS8);
    canvas.device.execute(ClearColor{color, glm::vec4(-1.0f)});
    canvas.device.execute(ClearDepth{depth, 1.0f});
    canvas.device.enable_counters(true);
    Result result;
    result.expected.resize(kPixels * static_cast<std::size_t>(samples));
    Random random(seed);
    const bool early = (features & kEarly) != 0;
    for (int n = 0; n < 12; ++n) {
        Image colors;
        Image control;
        for (std::size_t i = 0; i < kPixels; ++i) {
            colors.emplace_back(static_cast<float>(n * 1000) + static_cast<float>(i));
            control.emplace_back(random.chance(3) ? 1.0f : 0.0f, static_cast<float>(random.integer(0, 32)) / 32.0f,
                                 static_cast<float>(random.integer(0, 15)), 0.0f);
        }
        const float z = static_cast<float>(random.integer(0, 32)) / 32.0f;
        const auto left = static_cast<float>(random.integer(0, 6));
        const auto top = static_cast<float>(random.integer(0, 6));
        Draw draw = canvas.rectangle(image_program(1, features), {left, top, kSize, kSize}, z,
                                     {canvas.image(colors), canvas.image(control)});
        draw.color[0] = color;
        draw.depth = depth;
        draw.depth_state.compare = std::array{CompareOp::Less, CompareOp::LessEqual, CompareOp::Greater, CompareOp::Always,
                                              CompareOp::NotEqual}[static_cast<std::size_t>(random.integer(0, 4))];
        draw.depth_state.write = !random.chance(4);
        draw.stencil.test = stencil_test;
        draw.stencil.reference = 2;
        draw.stencil.front = draw.stencil.back = {.compare = CompareOp::GreaterEqual,
                                                  .fail = StencilOp::Decrement,
                                                  .depth_fail = StencilOp::IncrementSaturate,
                                                  .pass = StencilOp::Increment};
        canvas.device.execute(draw);
        for (std::size_t i = 0; i < kPixels; ++i) {
            if (static_cast<float>(i % kSize) < left || static_cast<float>(i / kSize) < top) continue;
            for (int s = 0; s < samples; ++s) {
                Sample& sample = result.expected[static_cast<std::size_t>(s) * kPixels + i];
                const bool discarded = (features & kDiscards) != 0 && control[i].x > 0.0f;
                const bool masked = (features & kCoverage) != 0 && (static_cast<int>(control[i].z) >> s & 1) == 0;
                if (!early && (discarded || masked)) continue;
                const float own_z = !early && (features & kDepth) != 0 ? control[i].y : z;
                const bool depth_passes =
                    oracle::passes(draw.depth_state.compare, static_cast<double>(own_z), static_cast<double>(sample.z));
                bool passes = depth_passes;
                if (stencil_test) {
                    const auto outcome = oracle::stencil(draw.stencil, true, depth_passes, sample.stencil);
                    sample.stencil = outcome.stored;
                    passes = outcome.passes;
                }
                if (!passes) continue;
                if (draw.depth_state.write) sample.z = own_z;
                if (!discarded && !masked) sample.color = colors[i].x;
            }
        }
    }
    for (int s = 0; s < samples; ++s)
        for (std::size_t i = 0; i < kPixels; ++i)
            result.found.push_back(
                {canvas.value(color, i, 0, 0, s), canvas.value(depth, i, 0, 0, s), canvas.stencil(depth, i, 0, s)});
    result.counters = canvas.device.take_counters();
    return result;
}

}  // namespace

TEST_CASE("early and late tests give what the specification says of each", "[16.12][16.12.1][16.12.2][depth][stencil]") {
    for (const unsigned wish : {0u, unsigned{kDiscards}, unsigned{kDepth}, unsigned{kCoverage}}) {
        for (const int samples : {1, 4}) {
            for (const bool stencil_test : {false, true}) {
                int different = 0;
                for (std::uint64_t seed = 0; seed < 6; ++seed) {
                    const Result late = draw_all(wish, samples, seed, stencil_test);
                    const Result early = draw_all(wish | kEarly, samples, seed, stencil_test);
                    for (const Result* result : {&late, &early}) {
                        for (std::size_t i = 0; i < result->found.size(); ++i) {
                            INFO("features " << (result == &late ? wish : wish | kEarly) << ", samples " << samples
                                             << ", stencil " << stencil_test << ", seed " << seed << ", pixel " << i % kPixels
                                             << ", sample " << i / kPixels);
                            REQUIRE(result->found[i].color == result->expected[i].color);
                            REQUIRE(result->found[i].z == result->expected[i].z);
                            REQUIRE(result->found[i].stencil == result->expected[i].stencil);
                        }
                    }
                    different += late.found != early.found ? 1 : 0;
                    // A functor that has no say is not run where the tests fail, either way.
                    if (wish == 0) CHECK(late.counters == early.counters);
                    // One that has a say about depth is run for all.
                    if (wish == kDepth) CHECK(late.counters.lanes_shaded > early.counters.lanes_shaded);
                }
                CHECK(different == (wish == 0 ? 0 : 6));
            }
        }
    }
}
