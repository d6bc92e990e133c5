// Light pass, fragments: depth and squared depth, of the depth itself ([Donnelly06] section 4, step 1) or of its two warps
// ([Lauritzen08] section 4.2).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "blocks.glsl"

layout(location = 0) in float depth_ls;

#if MAP == MAP_WARPED
#include "warp.glsl"
layout(location = 0) out vec4 moments;

void main() {
    const vec2 w = warped_depth(depth_ls);
    moments = vec4(w.x, w.x * w.x, w.y, w.y * w.y);
}
#else
layout(location = 0) out vec2 moments;

void main() { moments = vec2(depth_ls, depth_ls * depth_ls); }
#endif
