// Weights and passes of the separable blur. [Donnelly06] section 4, step 2
#include "techniques/common/gaussian.h"

#include "pipeline/program.h"
#include "sim/scalar_math.h"
#include "sim/warn.h"

#include <algorithm>
#include <cmath>

namespace gnomon::techniques {

GaussianKernel gaussian_kernel(double width) {
    GNOMON_CHECK_LE(1.0, width);
    const int taps = 1 + 2 * static_cast<int>(std::ceil(0.5 * (width - 1.0)));
    GNOMON_CHECK_LE(taps, kMaxBlurTaps);
    const double sigma = taps > 1 ? 0.25 * (width - 1.0) : 1.0;
    std::array<double, kMaxBlurTaps> exact{};
    double sum = 0;
    for (int i = 0; i < taps; ++i) {
        const double x = (i - taps / 2) / sigma;
        exact[static_cast<std::size_t>(i)] = scalar::exp(-0.5 * x * x);
        sum += exact[static_cast<std::size_t>(i)];
    }
    GaussianKernel kernel{.taps = taps};
    for (std::size_t i = 0; i < kernel.weights.size(); ++i) kernel.weights[i] = static_cast<float>(exact[i] / sum);
    return kernel;
}

BlurKernels zoomed_kernels(int taps, const glm::dvec2& zoom) {
    const auto kernel = [&](double factor) {
        const double width = 1.0 + (taps - 1) * factor;
        if (width > kMaxBlurTaps)
            warn_once(fmt::format("blur {}: where a split would need more than {} taps per axis its shadows are less soft",
                                  taps, kMaxBlurTaps));
        return gaussian_kernel(std::min(width, static_cast<double>(kMaxBlurTaps)));
    };
    return {kernel(zoom.x), kernel(zoom.y)};
}

void blur(const FullScreen& full_screen, const BlurKernels& kernels, TargetView texture, TextureId scratch,
          const MomentSplit& split) {
    static const Program program = make_program<FullScreenVertex, GaussianBlur>("gaussian-blur");
    GaussianBlur rows{.source = texture.texture,
                      .slice = texture.first_layer,
                      .taps = kernels.rows.taps,
                      .weights = kernels.rows.weights,
                      .split = split};
    const std::array<TargetView, 1> to_scratch{scratch};
    full_screen.run("blur rows", program, rows, to_scratch);
    GaussianBlur columns{
        .source = scratch, .columns = 1, .taps = kernels.columns.taps, .weights = kernels.columns.weights, .split = split};
    const std::array<TargetView, 1> to_texture{texture};
    full_screen.run("blur columns", program, columns, to_texture);
}

}  // namespace gnomon::techniques
