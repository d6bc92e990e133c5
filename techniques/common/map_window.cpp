// Zooming in on a rectangle of the light's projection. [PSVSM] step 2b
#include "techniques/common/map_window.h"

namespace gnomon::techniques {

glm::mat4 MapView::clip_from_world() const {
    if (window.is_whole()) return light.clip_from_world();

    // In clip space x goes right from -1 and y up from -1; the window's middle moves to 0, its sides to -w and w.
    const glm::dvec2 zoom = window.zoom();
    const glm::dvec2 middle(window.low.x + window.high.x - 1.0, 1.0 - window.low.y - window.high.y);
    glm::dmat4 stretch(1.0);
    stretch[0][0] = zoom.x;
    stretch[1][1] = zoom.y;
    stretch[3][0] = -middle.x * zoom.x;
    stretch[3][1] = -middle.y * zoom.y;

    // Offsets are of x/w and y/w, so they come in times w.
    return glm::mat4(stretch * (glm::dmat4(light.clip_from_view) * glm::dmat4(light.view_from_world)));
}

}  // namespace gnomon::techniques
