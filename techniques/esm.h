// Exponential shadow maps. [Salvi08], [Annen08]; [Lauritzen08] 4.2 says where they fail
#pragma once

#include "techniques/common/exponential_warp.h"
#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"

namespace gnomon::techniques {

/// e^{cz} of a depth z in [0, 1].
struct EsmEncoding {
    float exponent2 = 0.0f;  // c / ln(2)

    static constexpr auto fields() { return std::tuple{Field{"exponent2", &EsmEncoding::exponent2}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        return {exp2(depth * Real(exponent2)), Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

/// Visibility of a receiver at depth d: the mean of e^{c(z - d)} over the depths z of the filter, limited to 1. By Markov's
/// inequality an upper bound on the share with z >= d. [Salvi08], [Annen08]
template <class Real>
Real exponential_visibility(const Real& filtered, const Real& depth, const EsmEncoding& encoding) {
    return min(filtered / encoding.encode(depth).x, Real(1.0f));
}

struct EsmReceiver {
    DepthScale scale{};
    MapLookup map{};
    EsmEncoding warp{};
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = EsmReceiver;
        return std::tuple{Field{"scale", &R::scale}, Field{"map", &R::map}, Field{"warp", &R::warp}, Field{"bleed", &R::bleed}};
    }

    template <class F, class At>
    auto visibility(const F& f, const At& at) const {
        return bleed(exponential_visibility(map.sample(f, at).x, receiver_depth(f, at.depth, scale), warp));
    }
};

extern const Technique kEsm;

}  // namespace gnomon::techniques
