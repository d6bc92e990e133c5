// Percentage closer filtering over NxN comparisons. [Donnelly06] section 4, alternate methods 3 and 4; [Reeves87]
#pragma once

#include "techniques/common/gaussian.h"
#include "techniques/technique.h"

namespace gnomon::techniques {

enum class PcfWeights { Box, Gaussian };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::PcfWeights>{EnumName{techniques::PcfWeights::Box, "box"},
                                                               EnumName{techniques::PcfWeights::Gaussian, "gaussian"}};
}  // namespace gnomon

namespace gnomon::techniques {

inline constexpr int kMaxPcfTaps = 31;

/// Weights of `taps` comparisons along one axis, which sum to 1.
std::array<float, kMaxPcfTaps> pcf_weights(PcfWeights weights, int taps);

/// taps x taps comparisons around the fragment, one texel apart. Each is a nearest-texel comparison or the texture unit's
/// bilinear one (a nearest or linear sampler).
struct PcfReceiver {
    TextureId map = TextureId::None;
    Sampler sampler{};
    int taps = 1;                              // per axis
    std::array<float, kMaxPcfTaps> weights{};  // per axis; a tap weighs the product of its two

    static constexpr auto fields() {
        using R = PcfReceiver;
        return std::tuple{Field{"map", &R::map}, Field{"sampler", &R::sampler}, Field{"taps", &R::taps},
                          Field{"weights", &R::weights}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& center) const {
        At at = center;
        const Real texel_u(1.0f / static_cast<float>(f.size(map).x));
        const Real texel_v(1.0f / static_cast<float>(f.size(map).y));
        const float first = -0.5f * static_cast<float>(taps - 1);
        Real sum(0.0f);
        for (int y = 0; y < taps; ++y) {
            Real row(0.0f);
            at.uv.y = center.uv.y + Real(first + static_cast<float>(y)) * texel_v;
            for (int x = 0; x < taps; ++x) {
                at.uv.x = center.uv.x + Real(first + static_cast<float>(x)) * texel_u;
                row += compare_sample(f, map, sampler, at) * Real(weights[static_cast<std::size_t>(x)]);
            }
            sum += row * Real(weights[static_cast<std::size_t>(y)]);
        }
        return min(sum, Real(1.0f));  // weights sum to 1 only before rounding
    }
};

extern const Technique kPcf;
extern const Technique kPcfBilinear;

}  // namespace gnomon::techniques
