// Which part of the light's projection a shadow map shows: all of it, or a rectangle that is zoomed in on.
// [PSVSM] steps 2a and 2b
#pragma once

#include "scenes/view.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

namespace gnomon::techniques {

/// A rectangle of the light's projection in texture coordinates: (0, 0) top left, (1, 1) bottom right of all of it. `low` may
/// lie below 0 and `high` above 1: the light's view goes on there, and nothing in it is lit.
struct MapWindow {
    glm::dvec2 low{0.0};
    glm::dvec2 high{1.0};  // > low

    /// How much larger than in the whole projection everything is: the "zoom factors" of [PSVSM] step 2b.
    [[nodiscard]] glm::dvec2 zoom() const { return 1.0 / (high - low); }
    [[nodiscard]] bool is_whole() const { return low == glm::dvec2(0.0) && high == glm::dvec2(1.0); }
    bool operator==(const MapWindow&) const = default;
};

/// A light and the window on it that a map shows. Depths are those of the light: the same in every window.
struct MapView {
    scenes::View light;
    MapWindow window{};
    double relative_size = 1.0;  // texels per side over those of the first of several maps

    /// Texels of this map for one of the first map where that shows all of the light's projection.
    [[nodiscard]] glm::dvec2 texel_zoom() const { return window.zoom() * relative_size; }

    /// The light's clip space, stretched so that the window fills it.
    [[nodiscard]] glm::mat4 clip_from_world() const;
};

}  // namespace gnomon::techniques
