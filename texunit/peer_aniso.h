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
        const Int last_column = last_step(first_u_, last_u_);
        const Int last_row = last_step(first_v_, last_v_);
        for (int row = 0; any(Int(row) <= last_row); ++row) {
            const Int v = first_v_ + Int(row);
            const Float dv = Float(v) - center_v_;
            Float dq = dv * b_ + step_;
            Float q = ((c_ * dv + b_ * du_) * dv) + start_;
            for (int column = 0; any(Int(column) <= last_column); ++column) {
                const Float weight = weight_of(q, (Int(column) <= last_column) & (Int(row) <= last_row));
                if (any(weight != Float(0.0f))) visit(first_u_ + Int(column), v, weight);
                q = q + dq;
                dq = dq + (a_ + a_);
            }
        }
    }

private:
    static constexpr int kLongest = 1024;
    static Float weight_of(Float q, Mask inside);
    /// Index of the last texel of a box of one axis, -1 where there is none.
    static Int last_step(Int first, Int last) { return select(last < first, Int(-1), min(last - first, Int(kLongest - 1))); }

    Float a_, b_, c_;
    Float center_v_, du_, step_, start_;
    Int first_u_, last_u_, first_v_, last_v_;
};

}  // namespace gnomon
