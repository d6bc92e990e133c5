// Convolution shadow maps. [Annen07]; [Lauritzen08] 1.3 and 4.5 compare them with others
#pragma once

#include "techniques/filtered_map.h"
#include "techniques/fourier.h"

namespace gnomon::techniques {

/// Light pass: sines and cosines of depth, two pairs per slice. [Annen07]
template <int kTargets>
struct CsmEncoding {
    static constexpr auto fields() { return std::tuple{}; }

    template <class Real>
    [[nodiscard]] std::array<Vec4<Real>, kTargets> encode(const Real& depth) const {
        std::array<Vec4<Real>, kTargets> slices;
        for (int slice = 0; slice < kTargets; ++slice)
            slices[static_cast<std::size_t>(slice)] = store_two_pairs(1 + 2 * slice, depth);
        return slices;
    }
};

/// How the sum becomes visibility: saturate(scale sum(d - offset)).
struct CsmReconstruction {
    float offset = 0.0f;  // of depth, towards the light
    float scale = 2.0f;   // of the whole: 0 stays 0

    static constexpr auto fields() {
        using R = CsmReconstruction;
        return std::tuple{Field{"offset", &R::offset}, Field{"scale", &R::scale}};
    }
};

/// `sharpness` is relative to the scale that makes a surface in its own light (z = d) come out lit: 1 / sum(offset), which is 2
/// without an offset.
CsmReconstruction csm_reconstruction(const FourierSeries& series, float offset, float sharpness);

/// Camera pass: every slice to visibility. [Annen07]
struct CsmReceiver {
    Lighting lighting{};
    DepthScale scale{};
    MapLookup map{};
    FourierSeries series{};
    CsmReconstruction reconstruction{};

    static constexpr auto fields() {
        using R = CsmReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"scale", &R::scale}, Field{"map", &R::map},
                          Field{"series", &R::series}, Field{"reconstruction", &R::reconstruction}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Real depth = receiver_depth(f, at.depth, scale) - Real(reconstruction.offset);
        Real sum(0.5f);
        for (int k = 1; k <= series.terms; k += 2) {
            const Vec4<Real> texel = map.sample_slice(f, at.uv, Real(static_cast<float>(k / 2)));
            sum = sum + series.term(k, fourier_pair(k, depth), restore_pair(texel.x, texel.y));
            if (k < series.terms) sum = sum + series.term(k + 1, fourier_pair(k + 1, depth), restore_pair(texel.z, texel.w));
        }
        return shade(f, lighting, at.inside, saturate(sum * Real(reconstruction.scale)));
    }
};

extern const Technique kCsm;

}  // namespace gnomon::techniques
