// Percentage closer filtering: the mean of many depth comparisons. [Donnelly06] section 4, alternate methods 2 to 4; [Reeves87]
#pragma once

#include "techniques/technique.h"

namespace gnomon::techniques {

/// taps x taps comparisons around the fragment, one texel apart, with equal weights. Each is a nearest-texel comparison or the
/// texture unit's bilinear one (a nearest or linear sampler); one bilinear tap is what hardware calls PCF.
struct PcfReceiver {
    Lighting lighting{};
    TextureId map = TextureId::None;
    Sampler sampler{};
    int taps = 1;  // per axis

    static constexpr auto fields() {
        using R = PcfReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"map", &R::map}, Field{"sampler", &R::sampler},
                          Field{"taps", &R::taps}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Real texel_u(1.0f / static_cast<float>(f.size(map).x));
        const Real texel_v(1.0f / static_cast<float>(f.size(map).y));
        const float first = -0.5f * static_cast<float>(taps - 1);
        Real sum(0.0f);
        for (int y = 0; y < taps; ++y) {
            for (int x = 0; x < taps; ++x) {
                const Real u = at.uv.x + Real(first + static_cast<float>(x)) * texel_u;
                const Real v = at.uv.y + Real(first + static_cast<float>(y)) * texel_v;
                sum += f.sample_compare(map, sampler, {u, v}, at.depth);
            }
        }
        return shade(f, lighting, at.inside, sum * Real(1.0f / static_cast<float>(taps * taps)));
    }
};

extern const Technique kPcf;

}  // namespace gnomon::techniques
