// D3D11.3 16.9, 22.5.1: what a pixel functor may say beside its colours: discard, a depth, a coverage mask.
#include "tests/oracle/random.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr int kSize = 12;

struct OutputBench {
    Canvas canvas;
    TextureId color, depth;

    explicit OutputBench(int samples) : canvas(load_profile("d3d11"), kSize, kSize, samples, 2) {
        color = canvas.target(Format::R32Float);
        depth = canvas.target(Format::D32FloatS8);
        canvas.device.execute(ClearColor{color, glm::vec4(-1.0f)});
        canvas.device.execute(ClearDepth{depth, 0.5f});
        canvas.device.execute(ClearStencil{depth, 3});
    }
    /// Draws at depth 0.25 with stencil counting what passes.
    void draw(unsigned features, const Image& colors, const Image& control) {
        Draw draw = canvas.everything(image_program(1, features), 0.25f, {canvas.image(colors), canvas.image(control)});
        draw.color[0] = color;
        draw.depth = depth;
        draw.stencil.test = true;
        draw.stencil.front = draw.stencil.back = {.depth_fail = StencilOp::Decrement, .pass = StencilOp::Increment};
        canvas.device.execute(draw);
    }
    void check(std::size_t i, int s, bool reached, bool passes, float value, float z) const {
        INFO("pixel " << i << ", sample " << s);
        REQUIRE(canvas.value(color, i, 0, 0, s) == (passes ? value : -1.0f));
        REQUIRE(canvas.value(depth, i, 0, 0, s) == (passes ? z : 0.5f));
        REQUIRE(canvas.stencil(depth, i, 0, s) == (!reached ? 3 : passes ? 4 : 2));
    }
};

}  // namespace

TEST_CASE("a discarded pixel leaves colour, depth and stencil alone", "[22.5.1][16.9][discard]") {
    for (const int samples : {1, 4}) {
        OutputBench bench(samples);
        Random random(1);
        Image colors;
        Image control;
        for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
            colors.emplace_back(static_cast<float>(i));
            control.emplace_back(random.chance(2) ? 1.0f : 0.0f, 0, 0, 0);
        }
        bench.draw(kDiscards, colors, control);
        for (int s = 0; s < samples; ++s)
            for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
                const bool kept = control[i].x == 0.0f;
                bench.check(i, s, kept, kept, static_cast<float>(i), 0.25f);
            }
    }
}

TEST_CASE("a run per sample discards its sample alone", "[22.5.1][3.5.4][discard][msaa]") {
    OutputBench bench(4);
    Random random(2);
    Image colors;
    Image control;
    for (std::size_t i = 0; i < 4 * bench.canvas.pixels(); ++i) {
        colors.emplace_back(static_cast<float>(i));
        control.emplace_back(random.chance(2) ? 1.0f : 0.0f, 0, 0, 0);
    }
    bench.draw(kDiscards | kPerSample, colors, control);
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
            const std::size_t at = s * bench.canvas.pixels() + i;
            const bool kept = control[at].x == 0.0f;
            bench.check(i, static_cast<int>(s), kept, kept, static_cast<float>(at), 0.25f);
        }
}

TEST_CASE("a depth output replaces the interpolated one at every sample", "[16.9.2][depth]") {
    for (const int samples : {1, 4}) {
        for (const bool per_sample : {false, true}) {
            OutputBench bench(samples);
            Random random(3);
            Image colors;
            Image control;
            for (std::size_t i = 0; i < static_cast<std::size_t>(samples) * bench.canvas.pixels(); ++i) {
                colors.emplace_back(static_cast<float>(i));
                control.emplace_back(0, static_cast<float>(random.integer(0, 64)) / 64.0f, 0, 0);
            }
            bench.draw(kDepth | (per_sample ? unsigned{kPerSample} : 0u), colors, control);
            int passed = 0;
            for (std::size_t s = 0; s < static_cast<std::size_t>(samples); ++s)
                for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
                    const std::size_t at = (per_sample ? s * bench.canvas.pixels() : 0) + i;
                    const float z = control[at].y;
                    passed += z < 0.5f ? 1 : 0;
                    bench.check(i, static_cast<int>(s), true, z < 0.5f, static_cast<float>(at), z);
                }
            CHECK(passed > 40 * samples);
        }
    }
}

TEST_CASE("a coverage output is ANDed with coverage and sample mask, at either frequency", "[16.9.4][17.17][msaa]") {
    for (const int samples : {1, 2, 4, 16}) {
        for (const bool per_sample : {false, true}) {
            OutputBench bench(samples);
            Random random(4);
            Image colors;
            Image control;
            for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
                colors.emplace_back(static_cast<float>(i));
                control.emplace_back(0, 0, static_cast<float>(random.integer(-70000, 70000)), 0);  // all bits of an integer
            }
            // Each run of a functor per sample gives the same mask: bit s of it answers for sample s.
            Image all_colors;
            Image all_control;
            for (int s = 0; s < samples; ++s) {
                all_colors.insert(all_colors.end(), colors.begin(), colors.end());
                all_control.insert(all_control.end(), control.begin(), control.end());
            }
            bench.draw(kCoverage | (per_sample ? unsigned{kPerSample} : 0u), all_colors, all_control);
            for (int s = 0; s < samples; ++s)
                for (std::size_t i = 0; i < bench.canvas.pixels(); ++i) {
                    const bool kept = (static_cast<std::int32_t>(control[i].z) >> s & 1) != 0;
                    bench.check(i, s, kept, kept, static_cast<float>(i), 0.25f);
                }
        }
    }
}
