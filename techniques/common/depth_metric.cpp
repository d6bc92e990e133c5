// The depth metrics under one light. [Lauritzen08] 4.1.3
#include "techniques/common/depth_metric.h"

#include <cmath>

namespace gnomon::techniques {

DepthScale make_depth_scale(DepthMetric metric, const scenes::View& light) {
    DepthScale scale{.perspective = metric == DepthMetric::Perspective ? 1 : 0, .light = light.position_ws};
    const bool has_position = light.clip_from_view[3][3] == 0.0f;
    if (metric != DepthMetric::Distance || !has_position) return scale;

    // The farthest point of the frustum is a corner of the far plane.
    const double x = 1.0 / static_cast<double>(light.clip_from_view[0][0]);
    const double y = 1.0 / static_cast<double>(light.clip_from_view[1][1]);
    const double farthest = static_cast<double>(light.zfar) * std::sqrt(1.0 + x * x + y * y);
    scale.euclidean = 1;
    scale.nearest = light.znear;
    scale.inverse_range = static_cast<float>(1.0 / (farthest - static_cast<double>(light.znear)));
    return scale;
}

}  // namespace gnomon::techniques
