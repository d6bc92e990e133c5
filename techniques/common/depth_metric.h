// What "depth" means in a map of moments: the metric is the same in the light pass and in the camera pass.
// [Lauritzen08] 4.1.3 ("some depth metric"); [Donnelly06] section 4 step 1 (depths scaled to [0, 1])
#pragma once

#include "scenes/view.h"
#include "sim/enum_names.h"
#include "sim/fields.h"
#include "sim/vec.h"

#include <glm/vec3.hpp>

namespace gnomon::techniques {

enum class DepthMetric {
    Plane,        // linear distance from the light's near plane
    Distance,     // Euclidean distance from the light, for a directional light from its near plane
    Perspective,  // z/w of the light's projection
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::DepthMetric>{EnumName{techniques::DepthMetric::Plane, "plane"},
                                                                EnumName{techniques::DepthMetric::Distance, "distance"},
                                                                EnumName{techniques::DepthMetric::Perspective, "perspective"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// The metric under one light; every depth is 0 at the light's near plane and at most 1.
struct DepthScale {
    int perspective = 0;    // 1: z/w
    int euclidean = 0;      // 1: distance; else from the near plane
    glm::vec3 light{0.0f};  // position, world space
    float nearest = 0.0f;   // distance that becomes 0
    float inverse_range = 1.0f;

    static constexpr auto fields() {
        using D = DepthScale;
        return std::tuple{Field{"perspective", &D::perspective}, Field{"euclidean", &D::euclidean}, Field{"light", &D::light},
                          Field{"nearest", &D::nearest}, Field{"inverse_range", &D::inverse_range}};
    }

    /// Distance of a position in world space, scaled.
    template <class Real>
    [[nodiscard]] Real distance(const Vec3<Real>& position_ws) const {
        const Vec3<Real> offset = position_ws - splat<Real>(light);
        return (sqrt(dot(offset, offset)) - Real(nearest)) * Real(inverse_range);
    }
};

/// A light without a position has no distance: Distance is Plane then.
DepthScale make_depth_scale(DepthMetric metric, const scenes::View& light);

/// Depth of a fragment of the light pass.
template <class F>
auto caster_depth(const F& f, const DepthScale& scale) {
    if constexpr (requires { f.in.position_ws; }) {
        return scale.distance(f.in.position_ws);
    } else {
        using Real = typename F::Real;
        return scale.perspective != 0 ? Real(f.position.z) : Real(f.in.depth_ls);
    }
}

/// Depth of a fragment of the camera pass; `projective` is its z/w under the light.
template <class F, class Real = typename F::Real>
Real receiver_depth(const F& f, const Real& projective, const DepthScale& scale) {
    if (scale.euclidean != 0) return scale.distance(f.in.position_ws);
    return scale.perspective != 0 ? projective : Real(f.in.depth_ls);
}

}  // namespace gnomon::techniques
