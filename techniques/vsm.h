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
    DepthScale scale{};
    MapLookup map{};
    MomentSplit split{};
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = VsmReceiver;
        return std::tuple{Field{"scale", &R::scale}, Field{"map", &R::map}, Field{"split", &R::split},
                          Field{"min_variance", &R::min_variance}, Field{"bleed", &R::bleed}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Moments<Real> moments = split.restore(map.sample(f, at));
        const Real depth = receiver_depth(f, at.depth, scale);
        return bleed(chebyshev_upper_bound(moments, depth, Real(min_variance)));
    }
};

extern const Technique kVsm;
extern const Technique kPsvsm;  // kVsm with a map for each of four splits. [PSVSM]

}  // namespace gnomon::techniques
