// Percentage closer filtering over the projected extent of a pixel: the yardstick among shadow-map methods. [Lauritzen08] 2.3
#pragma once

#include "techniques/common/pixel_footprint.h"
#include "techniques/technique.h"

namespace gnomon::techniques {

/// Comparisons over the parallelogram that the pixel covers of the map, in the middle of as many equal cells as it is texels
/// long each way. "By then taking many samples over the entire filter region and comparing each sampled depth to the reference
/// depth, compute the percentage of samples that pass." [Lauritzen08] 2.3
struct PcfFootprintReceiver {
    TextureId map = TextureId::None;
    Sampler sampler{};
    float anisotropy = 16.0f;  // longer side over the shorter at most
    float least_width = 1.0f;  // texels; soft edges by clamping the size of the filter from below. [Lauritzen08] 2.3
    float density = 1.0f;      // comparisons per texel of length
    int most_taps = 64;        // per side
    int follows_plane = 0;     // 1: compares with the depth of the receiver's plane under each sample, else with the pixel's

    static constexpr auto fields() {
        using R = PcfFootprintReceiver;
        return std::tuple{Field{"map", &R::map},
                          Field{"sampler", &R::sampler},
                          Field{"anisotropy", &R::anisotropy},
                          Field{"least_width", &R::least_width},
                          Field{"density", &R::density},
                          Field{"most_taps", &R::most_taps},
                          Field{"follows_plane", &R::follows_plane}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Vec2<Real> depth_step =
            follows_plane != 0 ? Vec2<Real>{f.ddx(at.depth), f.ddy(at.depth)} : Vec2<Real>{Real(0.0f), Real(0.0f)};
        const PixelFootprint<Real> wide = with_least_width(
            with_anisotropy_limit(to_texels(pixel_footprint(f, at), f.size(map)), anisotropy), Real(least_width));
        return integrate(f, at, wide, depth_step);
    }

private:
    /// The mean over the cells of a footprint, in texels.
    template <class F, class At, class Real = typename F::Real>
    Real integrate(const F& f, const At& at, const PixelFootprint<Real>& footprint, const Vec2<Real>& depth_step) const {
        const glm::ivec2 size = f.size(map);
        const Vec2<Real> texel{Real(1.0f / static_cast<float>(size.x)), Real(1.0f / static_cast<float>(size.y))};
        const Int count_x = cells(footprint.dx);
        const Int count_y = cells(footprint.dy);
        const Real step_x = Real(1.0f) / Real(count_x);
        const Real step_y = Real(1.0f) / Real(count_y);
        Real sum(0.0f);
        for (Int j(0); any(j < count_y); j += Int(1)) {
            const Real b = (Real(j) + Real(0.5f)) * step_y - Real(0.5f);
            for (Int i(0); any((i < count_x) & (j < count_y)); i += Int(1)) {
                const Real a = (Real(i) + Real(0.5f)) * step_x - Real(0.5f);
                const Mask counts = (i < count_x) & (j < count_y);
                f.branch(counts, [&] {
                    const Vec2<Real> uv{at.uv.x + (a * footprint.dx.x + b * footprint.dy.x) * texel.x,
                                        at.uv.y + (a * footprint.dx.y + b * footprint.dy.y) * texel.y};
                    const Real reference = at.depth + (a * depth_step.x + b * depth_step.y);
                    sum += select(counts, f.sample_compare(map, sampler, uv, reference), Real(0.0f));
                });
            }
        }
        return min(sum * (step_x * step_y), Real(1.0f));
    }

    /// How many cells a side is cut into: 1 to most_taps.
    template <class Real>
    [[nodiscard]] Int cells(const Vec2<Real>& side) const {
        const Real wanted = sqrt(dot(side, side)) * Real(density);
        const Real limited = clamp_to_numbers(wanted, Real(1.0f), Real(static_cast<float>(most_taps)));
        return Int(0) - bounded_truncate_to_int(floor(Real(0.0f) - limited));  // rounded up
    }
};

extern const Technique kPcfFootprint;

}  // namespace gnomon::techniques
