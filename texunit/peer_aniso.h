// Anisotropy as two software GPUs compute it. Mesa 22.3.6 lp_bld_sample.c and lp_bld_sample_soa.c; SwiftShader SamplerCore.cpp
#pragma once

#include "texunit/lod.h"

namespace gnomon {

/// Level of detail from the shorter derivative, which nothing limits; the ellipse is walked later.
/// Mesa 22.3.6 lp_bld_sample.c, lp_build_pmin
LevelOfDetail<Float> llvmpipe_anisotropy(const Gradients<Float>& gradients, int width, int height);

/// Probes along the longer derivative. SwiftShader SamplerCore.cpp, computeLod2D()
LevelOfDetail<Float> swiftshader_anisotropy(const Gradients<Float>& gradients, int width, int height, int max_anisotropy);

/// The texels under llvmpipe's ellipse and their weights. Mesa 22.3.6 lp_bld_sample_soa.c, lp_build_sample_aniso
class LlvmpipeEllipse {
public:
    /// Coordinate and derivatives normalised; `width` and `height` are those of the view's finest level.
    LlvmpipeEllipse(const Vec2<Float>& coordinate, const Vec2<Float>& dx, const Vec2<Float>& dy, int width, int height,
                    Int level);

    /// Calls visit(u, v, weight) for every texel of the box; the weight is 0 outside the ellipse.
    /// DEVIATION(Mesa 22.3.6): a box is cut at 1024 texels a side. The renderer walks on, for hours where a derivative is huge.
    template <class Visit>
    void for_each(const Visit& visit) const {
        Int v = first_v_;
        for (int row = 0; row < kLongest && any(v <= last_v_); ++row) {
            const Float dv = Float(v) - center_v_;
            Float dq = dv * b_ + step_;
            Float q = ((c_ * dv + b_ * du_) * dv) + start_;
            Int u = first_u_;
            for (int column = 0; column < kLongest && any(u <= last_u_); ++column) {
                const Float weight = weight_of(q, (u <= last_u_) & (v <= last_v_));
                if (any(weight != Float(0.0f))) visit(u, v, weight);
                q = q + dq;
                dq = dq + (a_ + a_);
                u = u + Int(1);
            }
            v = v + Int(1);
        }
    }

private:
    static constexpr int kLongest = 1024;
    static Float weight_of(Float q, Mask inside);

    Float a_, b_, c_;
    Float center_v_, du_, step_, start_;
    Int first_u_, last_u_, first_v_, last_v_;
};

}  // namespace gnomon
