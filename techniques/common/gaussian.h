// Separable Gaussian blur of a texture: two full-screen passes. [Donnelly06] section 4, step 2
#pragma once

#include "techniques/common/full_screen.h"
#include "techniques/common/split_moments.h"

#include <array>

namespace gnomon::techniques {

inline constexpr int kMaxBlurTaps = 63;

/// Weights of `taps` samples one texel apart that sum to 1; entries beyond them are 0.
struct GaussianKernel {
    int taps = 1;  // odd, up to kMaxBlurTaps
    std::array<float, kMaxBlurTaps> weights{1.0f};
};

/// The papers give no width; sigma = (width - 1) / 4 puts the outermost tap of an odd `width` at two sigma. A width in between,
/// as where a kernel is scaled with the resolution of its map, takes as many taps as the next odd one. `width` >= 1.
GaussianKernel gaussian_kernel(double width);

/// One along the rows and one along the columns.
struct BlurKernels {
    GaussianKernel rows;
    GaussianKernel columns;
};

/// Kernels of `taps` texels where the zoom is 1 whose standard deviation grows with the zoom (> 0), as [PSVSM] step 2d scales
/// them: width 1 + (taps - 1) zoom texels. Wider than kMaxBlurTaps they are cut, with a warning.
BlurKernels zoomed_kernels(int taps, const glm::dvec2& zoom);

/// Weighted sum of a row or column of texels of one slice, clamped at the edges.
struct GaussianBlur {
    TextureId source = TextureId::None;
    int slice = 0;
    int columns = 0;  // 1: sums along a column of texels, else along a row
    int taps = 1;     // odd
    std::array<float, kMaxBlurTaps> weights{};
    MomentSplit
        split{};  // of moments in two parts: the sum is put together and split anew, for coarse parts are no longer whole

    static constexpr auto fields() {
        using G = GaussianBlur;
        return std::tuple{Field{"source", &G::source}, Field{"slice", &G::slice},     Field{"columns", &G::columns},
                          Field{"taps", &G::taps},     Field{"weights", &G::weights}, Field{"split", &G::split}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const glm::ivec2 last = f.size(source) - 1;
        Vec4<Real> sum{Real(0.0f), Real(0.0f), Real(0.0f), Real(0.0f)};
        for (int i = 0; i < taps; ++i) {
            const Int offset(i - taps / 2);
            const Int x = columns != 0 ? at.x : clamp(at.x + offset, Int(0), Int(last.x));
            const Int y = columns != 0 ? clamp(at.y + offset, Int(0), Int(last.y)) : at.y;
            const Vec4<Real> texel = f.load(source, x, y, {.level = 0, .layer = slice});
            const Real weight(weights[static_cast<std::size_t>(i)]);
            sum = {sum.x + texel.x * weight, sum.y + texel.y * weight, sum.z + texel.z * weight, sum.w + texel.w * weight};
        }
        return split.factor != 0.0f ? split.store(split.restore(sum)) : sum;
    }
};

/// Blurs level 0 of one slice of `texture` in place, through `scratch` (same size and format, one slice).
void blur(const FullScreen& full_screen, const BlurKernels& kernels, TargetView texture, TextureId scratch,
          const MomentSplit& split = {});

}  // namespace gnomon::techniques
