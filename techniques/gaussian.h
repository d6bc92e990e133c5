// Separable Gaussian blur of a texture: two full-screen passes. [Donnelly06] section 4, step 2
#pragma once

#include "pipeline/device.h"
#include "pipeline/fragment.h"
#include "pipeline/vertex_stage.h"

#include <array>

namespace gnomon::techniques {

inline constexpr int kMaxBlurTaps = 31;

/// Weights of `taps` (odd) samples one texel apart, summing to 1. The papers give no width; sigma = (taps - 1) / 4 puts the
/// outermost tap at two sigma. Entries beyond `taps` are 0.
std::array<float, kMaxBlurTaps> gaussian_weights(int taps);

/// A triangle that covers the target, from clip-space positions.
struct FullScreenVertex {
    template <class Real>
    struct Input {
        Real x, y;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;

    float depth = 0.0f;

    static constexpr auto fields() { return std::tuple{Field{"depth", &FullScreenVertex::depth}}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{Vec4<Real>{v.in.x, v.in.y, Real(depth), Real(1.0f)}, NoVaryings<Real>{}};
    }
};

/// Weighted sum of a row or column of texels, clamped at the edges.
struct GaussianBlur {
    TextureId source = TextureId::None;
    Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    glm::vec2 step{0.0f};  // to the next tap, normalised coordinates
    int taps = 1;          // odd
    std::array<float, kMaxBlurTaps> weights{};

    static constexpr auto fields() {
        using G = GaussianBlur;
        return std::tuple{Field{"source", &G::source}, Field{"sampler", &G::sampler}, Field{"step", &G::step},
                          Field{"taps", &G::taps}, Field{"weights", &G::weights}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real u = f.position.x * Real(1.0f / static_cast<float>(f.size(source).x));
        const Real v = f.position.y * Real(1.0f / static_cast<float>(f.size(source).y));
        Vec4<Real> sum{Real(0.0f), Real(0.0f), Real(0.0f), Real(0.0f)};
        for (int i = 0; i < taps; ++i) {
            const auto offset = static_cast<float>(i - taps / 2);
            const Vec4<Real> texel = f.sample(source, sampler, {u + Real(offset * step.x), v + Real(offset * step.y)});
            const Real weight(weights[static_cast<std::size_t>(i)]);
            sum = {sum.x + texel.x * weight, sum.y + texel.y * weight, sum.z + texel.z * weight, sum.w + texel.w * weight};
        }
        return sum;
    }
};

/// Blurs level 0 of `texture` in place, through `scratch` (same size and format).
class GaussianPass {
public:
    GaussianPass(Device& device, int taps);
    void run(Device& device, TextureId texture, TextureId scratch) const;

private:
    BufferId triangle_;
    int taps_;
    std::array<float, kMaxBlurTaps> weights_;
};

}  // namespace gnomon::techniques
