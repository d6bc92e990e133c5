// Several shadow maps, one for each split of the view frustum: which of them a fragment reads, and where.
// [PSVSM] steps 3 and 4
#pragma once

#include "sim/fields.h"
#include "techniques/common/receiver.h"
#include "techniques/common/seam_cures.h"

#include <array>

namespace gnomon::techniques {

inline constexpr int kMaxCascades = 8;

/// Splits and windows as constants of the camera pass.
struct Cascades {
    int count = 1;                              // 1 to kMaxCascades
    int cure = 0;                               // SeamCure
    int fades = 0;                              // 1: each split fades into the next
    float reach = 3.0e38f;                      // camera-space distance from which on everything is lit
    std::array<float, kMaxCascades> end{};      // camera-space distance where a split ends, ascending
    std::array<float, kMaxCascades> fade{};     // 1 / the distance over which it fades into the next, up to its end
    std::array<float, kMaxCascades> scale_u{};  // coordinates in the map of a split: those under the light, scaled, then moved
    std::array<float, kMaxCascades> scale_v{};
    std::array<float, kMaxCascades> offset_u{};
    std::array<float, kMaxCascades> offset_v{};

    static constexpr auto fields() {
        using C = Cascades;
        return std::tuple{Field{"count", &C::count},      Field{"cure", &C::cure},       Field{"fades", &C::fades},
                          Field{"reach", &C::reach},      Field{"end", &C::end},         Field{"fade", &C::fade},
                          Field{"scale_u", &C::scale_u},  Field{"scale_v", &C::scale_v}, Field{"offset_u", &C::offset_u},
                          Field{"offset_v", &C::offset_v}};
    }

    [[nodiscard]] bool is(SeamCure which) const { return cure == static_cast<int>(which); }

    /// Value `split` (whole numbers, lane by lane) of a table.
    template <class Real>
    [[nodiscard]] Real at_split(const std::array<float, kMaxCascades>& table, const Real& split) const {
        Real value(table[0]);
        for (int i = 1; i < count; ++i)
            value = select(split == Real(static_cast<float>(i)), Real(table[static_cast<std::size_t>(i)]), value);
        return value;
    }

    /// The split that holds a camera-space distance; beyond the last one, the last. [PSVSM] step 3
    template <class Real>
    [[nodiscard]] Real split_of(const Real& distance) const {
        Real split(0.0f);
        for (int i = 0; i + 1 < count; ++i)
            split = select(distance >= Real(end[static_cast<std::size_t>(i)]), Real(static_cast<float>(i + 1)), split);
        return split;
    }

    /// The split that a lane reads, after the cure. `own`: split_of its distance.
    template <class F, class Real = typename F::Real>
    Real chosen_split(const F& f, const Real& own) const {
        const Real last(static_cast<float>(count - 1));
        if (is(SeamCure::QuadMin)) return min(quad_min_split(f, own), last);
        if (is(SeamCure::QuadMax)) return min(quad_max_split(f, own), last);
        if (is(SeamCure::QuadBroadcast)) return f.template quad_read<0>(own);
        return own;
    }

    /// Coordinates in the map of `split`. [PSVSM] step 4
    template <class Real>
    [[nodiscard]] Vec2<Real> coordinates(const Vec2<Real>& uv, const Real& split) const {
        return {uv.x * at_split(scale_u, split) + at_split(offset_u, split),
                uv.y * at_split(scale_v, split) + at_split(offset_v, split)};
    }
    /// ... of the same split in all lanes.
    template <class Real>
    [[nodiscard]] Vec2<Real> coordinates_in(const Vec2<Real>& uv, int split) const {
        const auto i = static_cast<std::size_t>(split);
        return {uv.x * Real(scale_u[i]) + Real(offset_u[i]), uv.y * Real(scale_v[i]) + Real(offset_v[i])};
    }

    /// Where a fragment falls in the map of the split that each lane reads, with derivatives as the cure has them. `at` is
    /// under the light's own projection.
    template <class F, class Real = typename F::Real>
    GradientPosition<Real> position(const F& f, const MapPosition<Real>& at, const Real& split) const {
        GradientPosition<Real> position{coordinates(at.uv, split), at.depth, at.inside};
        if (is(SeamCure::ExplicitGradients)) {
            position.has_gradients = true;
            position.gradients = explicit_gradients(f, at.uv, split);
        }
        if (is(SeamCure::DerivativeOfPosition)) {
            const Gradients<Real> whole = projected_gradients(f);
            const Real u = at_split(scale_u, split);
            const Real v = at_split(scale_v, split);
            position.has_gradients = true;
            position.gradients = {{whole.dx.x * u, whole.dx.y * v}, {whole.dy.x * u, whole.dy.y * v}};
        }
        return position;
    }

    /// Visibility by the maps of all splits: `visibility_in(i, position)` reads map i.
    template <class F, class VisibilityIn, class Real = typename F::Real>
    Real visibility(const F& f, const MapPosition<Real>& at, const VisibilityIn& visibility_in) const {
        const Real distance = f.position.w;
        const Real split = chosen_split(f, split_of(distance));
        Real result = look_up(f, at, split, visibility_in);
        if (fades != 0) {
            // Up to the end of the split from 0 to 1, where the next one goes on.
            const Real to_end = (at_split(end, split) - distance) * at_split(fade, split);
            const Real share = select(split < Real(static_cast<float>(count - 1)), saturate(Real(1.0f) - to_end), Real(0.0f));
            f.branch(f.quad_any(share > Real(0.0f)), [&] {
                const Real next = min(split + Real(1.0f), Real(static_cast<float>(count - 1)));
                const Real beyond = look_up(f, at, next, visibility_in);
                result = select(share > Real(0.0f), result + (beyond - result) * share, result);
            });
        }
        return select(distance < Real(reach), result, Real(1.0f));
    }

private:
    /// Derivatives of the coordinates in every map, of which each lane takes those of its own.
    template <class F, class Real = typename F::Real>
    Gradients<Real> explicit_gradients(const F& f, const Vec2<Real>& uv, const Real& split) const {
        Gradients<Real> chosen{};
        for (int i = 0; i < count; ++i) {
            const Vec2<Real> in_map = coordinates_in(uv, i);
            const Gradients<Real> own{{f.ddx(in_map.x), f.ddx(in_map.y)}, {f.ddy(in_map.x), f.ddy(in_map.y)}};
            const Mask here = split == Real(static_cast<float>(i));
            const auto take = [&](const Real& yes, const Real& no) { return select(here, yes, no); };
            chosen = {{take(own.dx.x, chosen.dx.x), take(own.dx.y, chosen.dx.y)},
                      {take(own.dy.x, chosen.dy.x), take(own.dy.y, chosen.dy.y)}};
        }
        return chosen;
    }

    /// Every lane by the map of its `split`.
    template <class F, class VisibilityIn, class Real = typename F::Real>
    Real look_up(const F& f, const MapPosition<Real>& at, const Real& split, const VisibilityIn& visibility_in) const {
        Real result(1.0f);
        if (is(SeamCure::SampleAll)) {
            for (int i = 0; i < count; ++i) {
                const GradientPosition<Real> in_map{coordinates_in(at.uv, i), at.depth, at.inside};
                result = select(split == Real(static_cast<float>(i)), visibility_in(i, in_map), result);
            }
            return result;
        }
        const GradientPosition<Real> in_map = position(f, at, split);
        for (int i = 0; i < count; ++i) {
            const Mask here = split == Real(static_cast<float>(i));
            f.branch(here, [&] { result = select(here, visibility_in(i, in_map), result); });
        }
        return result;
    }
};

}  // namespace gnomon::techniques
