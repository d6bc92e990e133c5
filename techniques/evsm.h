// Exponential variance shadow maps, with the positive warp alone and with both. [Lauritzen08] 4.2
#pragma once

#include "techniques/common/exponential_warp.h"
#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"

namespace gnomon::techniques {

/// Two moments of e^{cx} in the first two components; of -e^{-cx} in the others.
struct EvsmEncoding {
    ExponentialWarp positive{};
    ExponentialWarp negative{};
    int warps = 2;  // 1: the positive one alone

    static constexpr auto fields() {
        using E = EvsmEncoding;
        return std::tuple{Field{"positive", &E::positive}, Field{"negative", &E::negative}, Field{"warps", &E::warps}};
    }

    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        const Moments<Real> p = moments_of_depth(positive(depth).value);
        if (warps == 1) return {p.first, p.second, Real(0.0f), Real(1.0f)};
        const Moments<Real> n = moments_of_depth(negative(depth).value);
        return {p.first, p.second, n.first, n.second};
    }
};

/// The smaller of the bounds of the warps: each bounds the visibility from above. [Lauritzen08] 4.2
struct EvsmReceiver {
    DepthScale scale{};
    MapLookup map{};
    EvsmEncoding warp{};
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = EvsmReceiver;
        return std::tuple{Field{"scale", &R::scale}, Field{"map", &R::map}, Field{"warp", &R::warp},
                          Field{"min_variance", &R::min_variance}, Field{"bleed", &R::bleed}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Vec4<Real> texel = map.sample(f, at);
        const Real depth = receiver_depth(f, at.depth, scale);
        Real bound = warped_upper_bound(Moments<Real>{texel.x, texel.y}, warp.positive(depth), min_variance);
        if (warp.warps == 2)
            bound = min(bound, warped_upper_bound(Moments<Real>{texel.z, texel.w}, warp.negative(depth), min_variance));
        return bleed(bound);
    }
};

extern const Technique kEvsm2;
extern const Technique kEvsm4;

}  // namespace gnomon::techniques
