// Depth cut into layers, each with a linear warp of its own. [Lauritzen08] 4.1
#pragma once

#include "sim/fields.h"
#include "sim/lanes.h"
#include "sim/math.h"
#include "techniques/common/moments.h"

#include <array>
#include <span>
#include <vector>

namespace gnomon::techniques {

inline constexpr int kMaxDepthLayers = 16;

/// 0 before c, 1 from there on: the perfect warp for a receiver at depth c. [Lauritzen08] eq. 4.1
template <class Real>
Real step_warp(const Real& depth, const Real& c) {
    return select(depth < c, Real(0.0f), Real(1.0f));
}

/// 0 up to p, 1 from q on, linear between; `inverse` is 1 / (q - p). [Lauritzen08] eq. 4.2
template <class Real>
Real layer_warp(const Real& depth, const Real& p, const Real& inverse) {
    return saturate((depth - p) * inverse);
}

/// The layers of a map, as constants of its shaders. Depths are in [0, 1].
struct DepthLayers {
    int count = 1;                                    // 1 to kMaxDepthLayers
    std::array<float, kMaxDepthLayers + 1> splits{};  // s_0 = 0, ..., s_count = 1, ascending
    std::array<float, kMaxDepthLayers> begin{};       // p_i
    std::array<float, kMaxDepthLayers> inverse{};     // 1 / (q_i - p_i)
    std::array<float, kMaxDepthLayers> fade{};        // [i]: how fast the transition at s_i goes, 1 / its whole width

    static constexpr auto fields() {
        using D = DepthLayers;
        return std::tuple{Field{"count", &D::count}, Field{"splits", &D::splits}, Field{"begin", &D::begin},
                          Field{"inverse", &D::inverse}, Field{"fade", &D::fade}};
    }

    /// The warped depth in layer `i`, the same for all lanes.
    template <class Real>
    [[nodiscard]] Real warp(const Real& depth, int i) const {
        const auto layer = static_cast<std::size_t>(i);
        return layer_warp(depth, Real(begin[layer]), Real(inverse[layer]));
    }
};

/// The layer that holds a depth, its neighbour where a transition takes both, and the neighbour's share: a half at the split, 0
/// where the transition ends. Visibility v[layer] + (v[neighbour] - v[layer]) share is continuous in depth.
template <class Real>
struct LayerChoice {
    Real layer;
    Real neighbour;  // the layer itself where there is no transition
    Real share;      // [0, 1/2]
};
template <class Real>
LayerChoice<Real> choose_layers(const DepthLayers& layers, const Real& depth) {
    LayerChoice<Real> choice{Real(0.0f), Real(0.0f), Real(0.0f)};
    for (int i = 1; i < layers.count; ++i) {
        const auto split = static_cast<std::size_t>(i);
        const Real behind = depth - Real(layers.splits[split]);
        const Mask is_behind = behind >= Real(0.0f);
        choice.layer += select(is_behind, Real(1.0f), Real(0.0f));
        const Real share = Real(0.5f) - abs(behind) * Real(layers.fade[split]);
        const Mask near = share > choice.share;  // of one split at most: transitions do not meet
        choice.share = select(near, share, choice.share);
        choice.neighbour =
            select(near, select(is_behind, Real(static_cast<float>(i - 1)), Real(static_cast<float>(i))), choice.neighbour);
    }
    choice.neighbour = select(choice.share > Real(0.0f), choice.neighbour, choice.layer);
    return choice;
}

/// Layers between the inner splits s_1 ... s_{N-1}, ascending in [0, 1], each widened by `overlap` (delta, [Lauritzen08] 4.1.1)
/// where it has a neighbour. Transitions are as wide as the overlap, but none reaches past the middle of a layer, where that of
/// the next split may begin.
DepthLayers make_layers(std::span<const double> inner_splits, double overlap);

/// Inner splits of `count` layers of one size.
std::vector<double> uniform_splits(int count);

}  // namespace gnomon::techniques
