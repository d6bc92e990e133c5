// Small scenes for this harness's own checks.
#pragma once

#include "scenes/scene.h"

namespace gnomon::peer {

/// A square plate (0 <= x <= 2, -2 <= z <= 0) 1 m over a ground 8 m wide, lit straight from above: the shadow is the same
/// square of the ground, all of it in sight and on one side of both axes, so that a mirrored map shows.
scenes::Scene two_planes();

/// A ground of 2 x 64 x 64 triangles under 12 boxes by 12, all in one mesh: 9,920 triangles, lit by a spot.
scenes::Scene boxes();

}  // namespace gnomon::peer
