// Layered variance shadow maps. [Lauritzen08] 4.1
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
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
    Lighting lighting{};
    DepthScale scale{};
    MapLookup map{};
    DepthLayers layers{};
    int blends = 0;  // 1: a transition of the width of the overlap
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = LvsmReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"scale", &R::scale},   Field{"map", &R::map},
                          Field{"layers", &R::layers},     Field{"blends", &R::blends}, Field{"min_variance", &R::min_variance},
                          Field{"bleed", &R::bleed}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Real depth = receiver_depth(f, at.depth, scale);
        const Real layer = layer_of(depth);
        Real bound = bound_in(depth, layer, map.sample_slice(f, at.uv, floor(layer * Real(0.5f))));
        if (blends != 0) bound = blend_near_split(f, at.uv, depth, layer, bound);
        return shade(f, lighting, at.inside, bleed(bound));
    }

private:
    /// How many inner splits lie at or before a depth.
    template <class Real>
    [[nodiscard]] Real layer_of(const Real& depth) const {
        Real layer(0.0f);
        for (std::size_t i = 1; i < static_cast<std::size_t>(layers.count); ++i)
            layer += select(depth >= Real(layers.splits[i]), Real(1.0f), Real(0.0f));
        return layer;
    }

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
    template <class F, class Real = typename F::Real>
    Real blend_near_split(const F& f, const Vec2<Real>& uv, const Real& depth, const Real& layer, const Real& bound) const {
        // The other layer, and its share: a half at the split, nothing at the end of the overlap.
        Real other = layer;
        Real share(0.0f);
        for (int i = 1; i < layers.count; ++i) {
            const Real behind = depth - Real(layers.splits[static_cast<std::size_t>(i)]);
            const Real weight = Real(0.5f) - abs(behind) * Real(0.5f / layers.overlap);
            const Mask near = weight > share;
            share = select(near, weight, share);
            other =
                select(near, select(behind >= Real(0.0f), Real(static_cast<float>(i - 1)), Real(static_cast<float>(i))), other);
        }
        Real result = bound;
        const Gradients<Real> gradients{{f.ddx(uv.x), f.ddx(uv.y)}, {f.ddy(uv.x), f.ddy(uv.y)}};
        const Mask blended = share > Real(0.0f);
        f.branch(blended, [&] {
            const Real beyond = bound_in(depth, other, map.sample_slice(f, uv, floor(other * Real(0.5f)), gradients));
            result = select(blended, bound + (beyond - bound) * share, bound);
        });
        return result;
    }
};

extern const Technique kLvsm;

}  // namespace gnomon::techniques
