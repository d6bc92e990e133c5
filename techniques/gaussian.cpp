#include "techniques/gaussian.h"

#include "pipeline/program.h"
#include "sim/scalar_math.h"

namespace gnomon::techniques {

std::array<float, kMaxBlurTaps> gaussian_weights(int taps) {
    std::array<double, kMaxBlurTaps> exact{};
    const double sigma = taps > 1 ? 0.25 * (taps - 1) : 1.0;
    double sum = 0;
    for (int i = 0; i < taps; ++i) {
        const double x = (i - taps / 2) / sigma;
        exact[static_cast<std::size_t>(i)] = scalar::exp(-0.5 * x * x);
        sum += exact[static_cast<std::size_t>(i)];
    }
    std::array<float, kMaxBlurTaps> weights{};
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = static_cast<float>(exact[i] / sum);
    return weights;
}

GaussianPass::GaussianPass(Device& device, int taps) : taps_(taps), weights_(gaussian_weights(taps)) {
    constexpr std::array<float, 6> kCorners{-1.0f, 1.0f, 3.0f, 1.0f, -1.0f, -3.0f};
    triangle_ = device.create_buffer("full screen", std::as_bytes(std::span(kCorners)));
}

void GaussianPass::run(Device& device, TextureId texture, TextureId scratch) const {
    static const Program program = make_program<FullScreenVertex, GaussianBlur>("gaussian-blur");
    const glm::vec2 texel{1.0f / static_cast<float>(device.texture(texture).width(0)),
                          1.0f / static_cast<float>(device.texture(texture).height(0))};
    const auto blur = [&](std::string_view label, TextureId from, TextureId to, glm::vec2 step) {
        const FullScreenVertex vertex;
        const GaussianBlur pixel{.source = from, .step = step, .taps = taps_, .weights = weights_};
        Draw draw{.label = label,
                  .program = &program,
                  .vertex_constants = constants_of(vertex),
                  .pixel_constants = constants_of(pixel),
                  .vertices = triangle_,
                  .count = 3};
        draw.color[0] = to;
        device.execute(draw);
    };
    blur("blur rows", texture, scratch, {texel.x, 0.0f});
    blur("blur columns", scratch, texture, {0.0f, texel.y});
}

}  // namespace gnomon::techniques
