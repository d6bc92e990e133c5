// The built-in scenes, one file each; scenes/procedural.h lists them.
#pragma once

#include "scenes/scene.h"

namespace gnomon::scenes {

Scene make_planes();
Scene make_car();
Scene make_fence();
Scene make_bench();
Scene make_windmill();
Scene make_overlap();
Scene make_city();

}  // namespace gnomon::scenes
