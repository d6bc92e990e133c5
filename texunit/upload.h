// Colours of the host to texels, through the format's own conversion. D3D11.3 3.2
#pragma once

#include "sim/half.h"
#include "texunit/texture.h"

#include <glm/vec4.hpp>

#include <span>

namespace gnomon {

/// Replaces one level of a layer; `colors` has its texels, rows top first. Components the format lacks are dropped; depth
/// formats take red. Throws Error where the number of colours is not the number of texels.
void set_level_colors(Texture& texture, int level, std::span<const glm::vec4> colors, Narrowing narrowing, int layer = 0);

}  // namespace gnomon
