// Convolution shadow maps. [Annen07]; [Lauritzen08] 1.3 and 4.5 compare them with others
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/fourier.h"

#include <array>

namespace gnomon::techniques {

/// Light pass: sines and cosines of depth, two pairs per slice. [Annen07]
template <std::size_t kTargets>
struct CsmEncoding {
    float range = 1.0f;  // what depth 1 becomes

    static constexpr auto fields() { return std::tuple{Field{"range", &CsmEncoding::range}}; }

    template <class Real>
    [[nodiscard]] std::array<Vec4<Real>, kTargets> encode(const Real& depth) const {
        std::array<Vec4<Real>, kTargets> slices;
        for (std::size_t i = 0; i < kTargets; ++i)
            slices[i] = store_two_pairs(1 + 2 * static_cast<int>(i), depth * Real(range));
        return slices;
    }
};

/// Depths d and z up to 1 become range d and range z; visibility is saturate(scale lit(range (d - offset), range z)).
struct CsmReconstruction {
    float range = 1.0f;
    float offset = 0.0f;  // towards the light
    float scale = 2.0f;   // of the whole: no light stays none

    static constexpr auto fields() {
        using R = CsmReconstruction;
        return std::tuple{Field{"range", &R::range}, Field{"offset", &R::offset}, Field{"scale", &R::scale}};
    }
};

/// Series and reconstruction as the parameters of the technique say.
struct CsmSetup {
    FourierSeries series{};
    CsmReconstruction reconstruction{};
};
CsmSetup csm_setup(const ParameterValues& chosen);

/// Camera pass: every slice to visibility. [Annen07]
struct CsmReceiver {
    DepthScale scale{};
    MapLookup map{};
    FourierSeries series{};
    CsmReconstruction reconstruction{};

    static constexpr auto fields() {
        using R = CsmReceiver;
        return std::tuple{Field{"scale", &R::scale}, Field{"map", &R::map}, Field{"series", &R::series},
                          Field{"reconstruction", &R::reconstruction}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Real depth = (receiver_depth(f, at.depth, scale) - Real(reconstruction.offset)) * Real(reconstruction.range);
        Real sum(0.5f);
        for (int k = 1; k <= series.terms; k += 2) {
            const Vec4<Real> texel = map.sample_slice(f, at, Real(static_cast<float>(k / 2)));
            sum = sum + series.term(k, fourier_pair(k, depth), restore_pair(texel.x, texel.y));
            if (k < series.terms) sum = sum + series.term(k + 1, fourier_pair(k + 1, depth), restore_pair(texel.z, texel.w));
        }
        return saturate(sum * Real(reconstruction.scale));
    }
};

extern const Technique kCsm;

}  // namespace gnomon::techniques
