// From normalised device coordinates to the screen: viewport, implicit and explicit scissor, guard band.
// D3D11.3 15.6, 15.7, 3.4.1
#pragma once

#include "pipeline/clip.h"
#include "pipeline/state.h"
#include "pipeline/tiling.h"
#include "sim/profile_choices.h"

#include <cmath>

namespace gnomon {

/// One viewport with everything that follows from it.
struct ViewportTransform {
    Viewport viewport;  // with its size filled in
    PixelRect visible;  // pixels of the target inside the viewport and the scissor
    GuardBand<double> guard;
};

/// The guard band that keeps positions inside the signed 16.8 range. D3D11.3 3.4.1, 15.4
inline GuardBand<double> guard_band(const Viewport& viewport) {
    // Stay one pixel inside +-32767 so that rounding cannot leave the range.
    constexpr double kReach = 32766;
    const double half_width = 0.5 * static_cast<double>(viewport.width);
    const double half_height = 0.5 * static_cast<double>(viewport.height);
    const double centre_x = static_cast<double>(viewport.x) + half_width;
    const double centre_y = static_cast<double>(viewport.y) + half_height;
    // Edges of a viewport on whole pixels are exact, others a pixel more than they need be, whatever the transform rounds.
    const auto cut = [](float edge) {
        const double rest = static_cast<double>(edge) - std::floor(static_cast<double>(edge));
        return rest > 0 ? rest + 1 : 0.0;
    };
    return {.left = (kReach + centre_x) / half_width,
            .right = (kReach - centre_x) / half_width,
            .bottom = (kReach - centre_y) / half_height,
            .top = (kReach + centre_y) / half_height,
            .seen_left = 1 + cut(viewport.x) / half_width,
            .seen_top = 1 + cut(viewport.y) / half_height};
}

/// No guard band: what leaves the viewport is clipped.
inline constexpr GuardBand<double> kNoGuardBand{.left = 1, .right = 1, .bottom = 1, .top = 1};

/// `scissor` may be null. The edges of the viewport round down to whole pixels. D3D11.3 15.7
inline ViewportTransform make_viewport_transform(Viewport viewport, const ScissorRect* scissor, int width, int height,
                                                 Clipping clipping = Clipping::GuardBand) {
    if (viewport.width == 0.0f) {
        viewport.width = static_cast<float>(width);
        viewport.height = static_cast<float>(height);
    }
    const auto floored = [](float a, float b) {
        return static_cast<int>(std::floor(static_cast<double>(a) + static_cast<double>(b)));
    };
    PixelRect visible{floored(viewport.x, 0.0f), floored(viewport.y, 0.0f), floored(viewport.x, viewport.width),
                      floored(viewport.y, viewport.height)};
    visible = intersect(visible, {0, 0, width, height});
    if (scissor != nullptr) visible = intersect(visible, {scissor->x0, scissor->y0, scissor->x1, scissor->y1});
    return {viewport, visible, clipping == Clipping::GuardBand ? guard_band(viewport) : kNoGuardBand};
}

}  // namespace gnomon
