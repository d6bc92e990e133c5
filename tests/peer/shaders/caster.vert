// Light pass, vertices: clip position, and the linear depth where moments are rendered.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "blocks.glsl"

layout(location = 0) in vec3 position_os;
#if MAP == MAP_MOMENTS
layout(location = 0) out float depth_ls;
#endif

void main() {
    const vec4 p = vec4(position_os, 1.0);
    gl_Position = draw.light_clip_from_object * p;
#if MAP == MAP_MOMENTS
    depth_ls = dot(draw.light_depth_from_object, p);
#endif
}
