// What a file may lack: a camera that sees it, a light that shadows it, a ground to receive the shadow.
#pragma once

#include "scenes/scene.h"

namespace gnomon::scenes {

/// Looks at the box from the front, a little from the right and above, so that its bounding sphere fits a 4:3 image.
Camera automatic_camera(const Bounds& model);

/// A spot from the upper left, 40 degrees from the vertical, whose cone holds the bounding sphere and the shadow below it.
Light automatic_light(const Bounds& model);

/// A spot at `position_ws` that is aimed at the box and holds its bounding sphere, as far as a cone of at most 80 degrees can.
Light spot_at(const glm::dvec3& position_ws, const Bounds& model);

/// A light gray square under the lowest point of the box, six bounding radii to each side. Casts no shadow that matters.
Mesh ground_plane(const Bounds& model);

}  // namespace gnomon::scenes
