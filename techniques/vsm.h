// Variance shadow maps. [Donnelly06] sections 3 and 4, [Lauritzen08] chapter 3
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
#include "techniques/common/split_moments.h"

namespace gnomon::techniques {

/// Light pass: depth and squared depth. [Donnelly06] section 4, step 1
struct VsmEncoding {
    MomentSplit split{};

    static constexpr auto fields() { return std::tuple{Field{"split", &VsmEncoding::split}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        return split.store(moments_of_depth(depth));
    }
};

/// Camera pass: filtered moments to visibility. [Donnelly06] section 4, step 4
struct VsmReceiver {
    Lighting lighting{};
    DepthScale scale{};
    MapLookup map{};
    MomentSplit split{};
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = VsmReceiver;
        return std::tuple{Field{"lighting", &R::lighting},
                          Field{"scale", &R::scale},
                          Field{"map", &R::map},
                          Field{"split", &R::split},
                          Field{"min_variance", &R::min_variance},
                          Field{"bleed", &R::bleed}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Moments<Real> moments = split.restore(map.sample(f, at.uv));
        const Real depth = receiver_depth(f, at.depth, scale);
        return shade(f, lighting, at.inside, bleed(chebyshev_upper_bound(moments, depth, Real(min_variance))));
    }
};

extern const Technique kVsm;

}  // namespace gnomon::techniques
