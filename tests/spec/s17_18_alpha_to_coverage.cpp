// D3D11.3 17.18: alpha of the first colour becomes a mask: nothing at 0, everything at 1, never less for more.
#include "tests/unit/output_programs.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

const std::array kAlphas{0.0f,
                         -0.0f,
                         -1.0f,
                         -std::numeric_limits<float>::infinity(),
                         std::numeric_limits<float>::quiet_NaN(),
                         1.0f,
                         2.0f,
                         std::numeric_limits<float>::infinity(),
                         3e38f};

/// The mask of samples that were written, by pixel; alphas rise from 0 to 1 behind the special ones.
std::vector<std::uint32_t> masks(Canvas& canvas, const Draw& draw) {
    canvas.device.execute(draw);
    std::vector<std::uint32_t> result(canvas.pixels());
    for (std::size_t i = 0; i < result.size(); ++i)
        for (int s = 0; s < canvas.samples; ++s)
            if (canvas.value(draw.color[1].texture != TextureId::None ? draw.color[1].texture : draw.color[0].texture, i, 1, 0,
                             s) == 2.0f)
                result[i] |= 1u << s;
    return result;
}

Image ramp(std::size_t pixels) {
    Image colors(pixels, glm::vec4(2.0f));
    for (std::size_t i = 0; i < pixels; ++i)
        colors[i].w = i < kAlphas.size()
                          ? kAlphas[i]
                          : static_cast<float>(i - kAlphas.size()) / static_cast<float>(pixels - kAlphas.size() - 1);
    return colors;
}

}  // namespace

TEST_CASE("alpha becomes coverage", "[17.18][msaa]") {
    for (const char* name : {"d3d11", "llvmpipe"}) {
        for (const int samples : {1, 2, 4, 8, 16}) {
            Profile profile = load_profile(name);
            profile.max_samples = 16;
            for (const AlphaToCoverage rule : {AlphaToCoverage::Rounded, AlphaToCoverage::Ramp}) {
                profile.alpha_to_coverage = rule;
                Canvas canvas(profile, 64, 4, samples);
                Draw draw = canvas.everything(image_program(1), 0.5f,
                                              {canvas.image(ramp(canvas.pixels())), canvas.image(Image(canvas.pixels()))});
                draw.color[0] = canvas.target(Format::Rgba32Float);
                draw.output.alpha_to_coverage = true;
                const auto found = masks(canvas, draw);
                const std::uint32_t full = (1u << samples) - 1u;
                for (std::size_t i = 0; i < kAlphas.size(); ++i) CHECK(found[i] == (kAlphas[i] >= 1.0f ? full : 0u));
                std::uint32_t before = 0;
                int steps = 0;
                for (std::size_t i = kAlphas.size(); i < found.size(); ++i) {
                    const float alpha = ramp(canvas.pixels())[i].w;
                    CHECK((found[i] & before) == before);
                    steps += found[i] != before ? 1 : 0;
                    before = found[i];
                    // The profile's rule: round(alpha N) samples, halves up, or those with alpha > s / N.
                    int expected = 0;
                    for (int s = 0; s < samples; ++s) {
                        const auto scaled = static_cast<double>(alpha * static_cast<float>(samples));
                        expected += rule == AlphaToCoverage::Ramp ? scaled > s : scaled >= s + 0.5;
                    }
                    CHECK(std::popcount(found[i]) == expected);
                }
                CHECK(steps == samples);
                CHECK(before == full);
            }
        }
    }
}

TEST_CASE("the mask is ANDed with coverage and sample mask and holds for every target and for depth", "[17.18][17.17][msaa]") {
    Canvas canvas(load_profile("d3d11"), 64, 4, 4);
    Image colors = ramp(canvas.pixels());
    for (std::size_t i = 0; i < canvas.pixels(); ++i) colors.emplace_back(2.0f, 2.0f, 2.0f, 1.0f - colors[i].w);
    Draw draw = canvas.everything(image_program(2), 0.5f, {canvas.image(colors), canvas.image(Image(canvas.pixels()))});
    draw.color[1] = canvas.target(Format::Rgba32Float);  // alpha of the colour that goes nowhere decides
    draw.depth = canvas.target(Format::D32Float);
    canvas.device.execute(ClearDepth{draw.depth, 1.0f});
    draw.output.alpha_to_coverage = true;
    draw.output.sample_mask = 0b1011;
    const auto found = masks(canvas, draw);
    std::size_t partial = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const float alpha = colors[i].w;
        const float limited = alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f;
        const auto set = static_cast<int>(static_cast<double>(limited) * 4.0 + 0.5);
        CHECK(found[i] == (((1u << set) - 1u) & 0b1011u));
        partial += found[i] != 0 && found[i] != 0b1011 ? 1u : 0u;
        for (int s = 0; s < 4; ++s)
            CHECK(canvas.value(draw.depth.texture, i, 0, 0, s) == ((found[i] >> s & 1u) != 0 ? 0.5f : 1.0f));
    }
    CHECK(partial > 50);
}

TEST_CASE("alpha itself reaches the target unchanged, and a shader's own mask turns the rule off", "[17.18][16.9.4][msaa]") {
    Canvas canvas(load_profile("d3d11"), 4, 1, 4);
    Image colors;
    for (const float alpha : {0.0f, 0.25f, 0.75f, 1.0f}) colors.emplace_back(1.0f, 2.0f, 1.0f, alpha);
    const Image control(4, glm::vec4(0.0f, 0.0f, 15.0f, 0.0f));
    for (const bool own_mask : {false, true}) {
        Draw draw = canvas.everything(image_program(1, own_mask ? unsigned{kCoverage} : 0u), 0.5f,
                                      {canvas.image(colors), canvas.image(control)});
        draw.color[0] = canvas.target(Format::Rgba32Float);
        draw.output.alpha_to_coverage = true;
        const auto found = masks(canvas, draw);
        CHECK(found == (own_mask ? std::vector<std::uint32_t>{15, 15, 15, 15} : std::vector<std::uint32_t>{0, 1, 7, 15}));
        CHECK(canvas.value(draw.color[0].texture, 1, 3, 0, 0) == 0.25f);
    }
}

TEST_CASE("where the functor runs per sample each run's alpha answers for its sample", "[17.18][16.9.4][msaa]") {
    // Sample s has alpha s / 4 in slice s: bit s of that mask is set from alpha (s + 0.5) / 4 on.
    Canvas canvas(load_profile("d3d11"), 2, 2, 4);
    for (const float shift : {0.0f, 0.25f}) {
        Image colors;
        for (int s = 0; s < 4; ++s)
            for (int i = 0; i < 4; ++i) colors.emplace_back(2.0f, 2.0f, 2.0f, static_cast<float>(s) / 4.0f + shift);
        Draw draw = canvas.everything(image_program(1, kPerSample), 0.5f, {canvas.image(colors), canvas.image(Image(4))});
        draw.color[0] = canvas.target(Format::Rgba32Float);
        draw.output.alpha_to_coverage = true;
        for (const std::uint32_t mask : masks(canvas, draw)) CHECK(mask == (shift > 0.0f ? 15u : 0u));
    }
}
