// Summed-area variance shadow maps: moments over the rectangle that a pixel covers of the map, of any size and shape.
// [Lauritzen07] 8.5, [Lauritzen08] chapter 3
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
#include "techniques/summed_area.h"

namespace gnomon::techniques {

/// What depths are stored relative to.
enum class DepthCentre {
    Half,  // depth - 1/2, so that sums stay small. [Lauritzen07] 8.5.2
    None,  // depth
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::DepthCentre>{EnumName{techniques::DepthCentre::Half, "half"},
                                                                EnumName{techniques::DepthCentre::None, "none"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// Light pass: moments of a depth in [0, 1] about `centre`.
// DEVIATION([Lauritzen07] 8.5.2): there 1/2 is taken off both moments, which leaves the second one in [-1/2, 1/2]. That of the
// centred depth is in [0, 1/4], and the variance loses less to cancellation.
struct CentredMoments {
    float centre = 0.0f;

    static constexpr auto fields() { return std::tuple{Field{"centre", &CentredMoments::centre}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        const Moments<Real> moments = moments_of_depth(depth - Real(centre));
        return {moments.first, moments.second, Real(0.0f), Real(1.0f)};
    }
};

/// Camera pass: means of the moments over the pixel's rectangle to visibility.
struct SavsmReceiver {
    DepthScale scale{};
    SummedAreaLookup table{};
    CentredMoments moments{};
    float anisotropy = 1.0f;  // limit
    float least_side = 1.0f;  // of the rectangle, texels; at least 1
    float most_side = 16384.0f;
    float min_variance = 0.0f;
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = SavsmReceiver;
        return std::tuple{Field{"scale", &R::scale},
                          Field{"table", &R::table},
                          Field{"moments", &R::moments},
                          Field{"anisotropy", &R::anisotropy},
                          Field{"least_side", &R::least_side},
                          Field{"most_side", &R::most_side},
                          Field{"min_variance", &R::min_variance},
                          Field{"bleed", &R::bleed}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const glm::ivec2 size = f.size(table.table);
        const auto footprint = with_anisotropy_limit(to_texels(pixel_footprint(f, at), size), anisotropy);
        const auto rectangle = bounding_rectangle(footprint, to_texels(at.uv, size), {.least = least_side, .most = most_side});
        const Moments<Real> means = table.mean(f, clamped_to(rectangle, size));
        const Real depth = receiver_depth(f, at.depth, scale) - Real(moments.centre);
        return bleed(chebyshev_upper_bound(means, depth, Real(min_variance)));
    }
};

extern const Technique kSavsm;

}  // namespace gnomon::techniques
