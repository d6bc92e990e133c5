// What a pixel functor of the laboratory hands over: a SeamPixel, as three targets of four floats.
#pragma once

#include "pipeline/device.h"
#include "pipeline/fragment.h"
#include "studies/seams/seam.h"

#include <array>
#include <span>

namespace gnomon::studies {

inline constexpr std::size_t kProbeTargets = 3;

/// A SeamPixel in lanes.
template <class Real>
struct SeamLanes {
    Real own;
    Real used;
    SampledLevel<Real> sampled;  // FragmentContext::lod of the sample as it was taken
    Real smooth_lod;             // SeamPixel
    Real exact_lod;
    Mask outside;
    Real value;
};

template <class F, class Real = typename F::Real>
std::array<Vec4<Real>, kProbeTargets> probe_colors(const F& f, const SeamLanes<Real>& lanes) {
    const Real zero(0.0f);
    const Mask differs = (f.template quad_read<0>(lanes.used) != lanes.used);
    const Real flags = select(f.quad_any(differs), Real(static_cast<float>(SeamPixel::kDisagrees)), zero) +
                       select(lanes.outside, Real(static_cast<float>(SeamPixel::kOutside)), zero);
    const Real quad = (f.template quad_read<0>(lanes.own) + f.template quad_read<1>(lanes.own) * Real(16.0f)) +
                      (f.template quad_read<2>(lanes.own) * Real(256.0f) + f.template quad_read<3>(lanes.own) * Real(4096.0f));
    return {Vec4<Real>{lanes.own, lanes.used, lanes.sampled.unclamped, lanes.smooth_lod},
            Vec4<Real>{lanes.exact_lod, lanes.sampled.clamped, Real(lanes.sampled.probes), flags},
            Vec4<Real>{lanes.value, quad, zero, zero}};
}

/// Derivative instructions of the shader.
template <class F, class Real = typename F::Real>
Gradients<Real> shader_gradients(const F& f, const Real& u, const Real& v) {
    return {{f.ddx(u), f.ddx(v)}, {f.ddy(u), f.ddy(v)}};
}
/// Of coordinates scaled by so much along u and v, or along both.
template <class Real>
Gradients<Real> scaled(const Gradients<Real>& gradients, const Vec2<Real>& by) {
    return {{gradients.dx.x * by.x, gradients.dx.y * by.y}, {gradients.dy.x * by.x, gradients.dy.y * by.y}};
}
template <class Real>
Gradients<Real> scaled(const Gradients<Real>& gradients, const Real& by) {
    return scaled(gradients, Vec2<Real>{by, by});
}

/// Targets for probe_colors and for a derivative report.
class ProbeTargets {
public:
    ProbeTargets(Device& device, int width, int height);

    [[nodiscard]] std::span<const TargetView> colors() const { return colors_; }
    [[nodiscard]] TextureId derivatives() const { return derivatives_; }

    /// What was drawn into them. Pixels whose first target holds -1 were not.
    [[nodiscard]] SeamImage read() const;

private:
    Device& device_;
    std::array<TargetView, kProbeTargets> colors_;
    TextureId derivatives_;
};

}  // namespace gnomon::studies
