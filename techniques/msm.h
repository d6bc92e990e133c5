// Moment shadow maps with four power moments. [Peters15]
#pragma once

#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
#include "techniques/power_moments.h"

namespace gnomon::techniques {

enum class MomentBound {
    Hamburger,  // over all distributions with the moments. [Peters15] 4.1
    Hausdorff,  // over those whose depths are in [0, 1]. [Peters15] (Hausdorff 4MSM)
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::MomentBound>{EnumName{techniques::MomentBound::Hamburger, "hamburger"},
                                                                EnumName{techniques::MomentBound::Hausdorff, "hausdorff"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// How four components hold the moments.
struct PowerMomentStorage {
    int is_quantised = 0;  // 1: through the transform for fixed point. [Peters15] (optimised quantisation)

    static constexpr auto fields() { return std::tuple{Field{"is_quantised", &PowerMomentStorage::is_quantised}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> store(const PowerMoments<Real>& b) const {
        if (is_quantised != 0) return quantised(b);
        return {b.first, b.second, b.third, b.fourth};
    }
    template <class Real>
    [[nodiscard]] PowerMoments<Real> restore(const Vec4<Real>& texel) const {
        if (is_quantised != 0) return dequantised(texel);
        return {texel.x, texel.y, texel.z, texel.w};
    }
};

/// Light pass: the first four powers of depth. [Peters15]
struct MsmEncoding {
    PowerMomentStorage storage{};

    static constexpr auto fields() { return std::tuple{Field{"storage", &MsmEncoding::storage}}; }

    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        return storage.store(power_moments_of_depth(depth));
    }
};

/// Camera pass: filtered moments to visibility. [Peters15] 4.1
struct MsmReceiver {
    DepthScale scale{};
    MapLookup map{};
    PowerMomentStorage storage{};
    float moment_bias = 0.0f;
    float depth_offset = 0.0f;  // taken off the depth of receivers
    int within_unit = 0;        // 1: MomentBound::Hausdorff
    BleedReduction bleed{};

    static constexpr auto fields() {
        using R = MsmReceiver;
        return std::tuple{Field{"scale", &R::scale},
                          Field{"map", &R::map},
                          Field{"storage", &R::storage},
                          Field{"moment_bias", &R::moment_bias},
                          Field{"depth_offset", &R::depth_offset},
                          Field{"within_unit", &R::within_unit},
                          Field{"bleed", &R::bleed}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const PowerMoments<Real> moments = biased(storage.restore(map.sample(f, at)), Real(moment_bias));
        const Real depth = receiver_depth(f, at.depth, scale) - Real(depth_offset);
        return bleed(within_unit != 0 ? hausdorff_upper_bound(moments, depth) : hamburger_upper_bound(moments, depth));
    }
};

/// What the parameter moment-bias 0 stands for: 3e-6 of 32-bit floats and 3e-5 of the optimised 16 bits, as [MJP] has them
/// after [Peters15]; of halves, whose moments err by 2^-10, five times that, where noise is gone from flat ground.
float standard_moment_bias(Format format);

extern const Technique kMsm;

}  // namespace gnomon::techniques
