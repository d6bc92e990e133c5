// Variance shadow maps. [Donnelly06] sections 3 and 4
#pragma once

#include "techniques/moments.h"
#include "techniques/technique.h"

namespace gnomon::techniques {

/// Light pass: depth and squared depth. [Donnelly06] section 4, step 1
struct VsmCaster {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Moments<Real> m = moments_of_depth(f.in.depth_ls);
        return Vec4<Real>{m.first, m.second, Real(0.0f), Real(1.0f)};
    }
};

/// Camera pass: filtered moments to visibility. [Donnelly06] section 4, step 4
struct VsmReceiver {
    Lighting lighting{};
    TextureId map = TextureId::None;
    Sampler sampler{};
    float min_variance = 0.0f;

    static constexpr auto fields() {
        using R = VsmReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"map", &R::map}, Field{"sampler", &R::sampler},
                          Field{"min_variance", &R::min_variance}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Vec4<Real> texel = f.sample(map, sampler, at.uv);  // implicit derivatives come from the quad
        const Real visibility = chebyshev_upper_bound(Moments<Real>{texel.x, texel.y}, f.in.depth_ls, Real(min_variance));
        return shade(f, lighting, at.inside, visibility);
    }
};

extern const Technique kVsm;

}  // namespace gnomon::techniques
