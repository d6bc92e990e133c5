// Layered variance shadow maps. [Lauritzen08] 4.1
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
#include "techniques/common/pixel_footprint.h"
#include "techniques/layers.h"

namespace gnomon::techniques {

/// Two layers per slice: (w, w^2) of one and of the next. [Lauritzen08] 4.1.3
template <std::size_t kSlices>
struct LvsmEncoding {
    DepthLayers layers{};

    static constexpr auto fields() { return std::tuple{Field{"layers", &LvsmEncoding::layers}}; }

    template <class Real>
    [[nodiscard]] std::array<Vec4<Real>, kSlices> encode(const Real& depth) const {
        std::array<Vec4<Real>, kSlices> slices{};
        for (std::size_t slice = 0; slice < kSlices; ++slice) {
            const int layer = 2 * static_cast<int>(slice);
            const Moments<Real> even = moments_of_depth(layers.warp(depth, layer));
            const Moments<Real> odd = moments_of_depth(layers.warp(depth, layer + 1));
            slices[slice] = {even.first, even.second, odd.first, odd.second};
        }
        return slices;
    }
};

/// Samples the one layer that holds the receiver; near a split also its neighbour, and blends. [Lauritzen08] 4.1, 4.1.3
struct LvsmReceiver {
    DepthScale scale{};
    MapLookup map{};
    DepthLayers layers{};
    int blends = 0;  // 1: transitions between layers
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = LvsmReceiver;
        return std::tuple{Field{"scale", &R::scale},
                          Field{"map", &R::map},
                          Field{"layers", &R::layers},
                          Field{"blends", &R::blends},
                          Field{"min_variance", &R::min_variance},
                          Field{"bleed", &R::bleed}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Real depth = receiver_depth(f, at.depth, scale);
        const LayerChoice<Real> chosen = choose_layers(layers, depth);
        Real bound = bound_in(depth, chosen.layer, map.sample_slice(f, at, floor(chosen.layer * Real(0.5f))));
        if (blends != 0) bound = blended(f, at, depth, chosen, bound);
        return bleed(bound);
    }

private:
    /// The bound of a layer from the texel of its slice.
    template <class Real>
    [[nodiscard]] Real bound_in(const Real& depth, const Real& layer, const Vec4<Real>& texel) const {
        Real begin(layers.begin[0]);
        Real inverse(layers.inverse[0]);
        for (int i = 1; i < layers.count; ++i) {
            const Mask here = layer == Real(static_cast<float>(i));
            begin = select(here, Real(layers.begin[static_cast<std::size_t>(i)]), begin);
            inverse = select(here, Real(layers.inverse[static_cast<std::size_t>(i)]), inverse);
        }
        const Mask odd = layer - floor(layer * Real(0.5f)) * Real(2.0f) > Real(0.5f);
        const Moments<Real> moments{select(odd, texel.z, texel.x), select(odd, texel.w, texel.y)};
        return chebyshev_upper_bound(moments, layer_warp(depth, begin, inverse), Real(min_variance));
    }

    /// Within the overlap around a split both layers hold the receiver: from one to the other, linear in depth.
    template <class F, class At, class Real = typename F::Real>
    Real blended(const F& f, const At& at, const Real& depth, const LayerChoice<Real>& chosen, const Real& bound) const {
        Real result = bound;
        const PixelFootprint<Real> footprint = pixel_footprint(f, at);
        const GradientPosition<Real> with_gradients{at.uv, at.depth, at.inside, true, {footprint.dx, footprint.dy}};
        const Mask takes_both = chosen.share > Real(0.0f);
        f.branch(takes_both, [&] {
            const Vec4<Real> texel = map.sample_slice(f, with_gradients, floor(chosen.neighbour * Real(0.5f)));
            const Real beyond = bound_in(depth, chosen.neighbour, texel);
            result = select(takes_both, bound + (beyond - bound) * chosen.share, bound);
        });
        return result;
    }
};

extern const Technique kLvsm;

}  // namespace gnomon::techniques
