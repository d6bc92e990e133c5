// Camera pass, vertices: clip position, world position and normal, place in the light's map. As techniques/receiver.h.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "blocks.glsl"

layout(location = 0) in vec3 position_os;
layout(location = 1) in vec3 normal_os;

layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;
#if MAP != MAP_NONE
layout(location = 2) out vec4 light;  // (s, t, z, q)
#endif
#if MAP == MAP_MOMENTS
layout(location = 3) out float depth_ls;
#endif

void main() {
    const vec4 p = vec4(position_os, 1.0);
    gl_Position = draw.clip_from_object * p;
    position_ws = (draw.world_from_object * p).xyz;
    normal_ws = draw.world_from_normal * normal_os;
#if MAP != MAP_NONE
    light = draw.light_texture_from_object * p;
#endif
#if MAP == MAP_MOMENTS
    depth_ls = dot(draw.light_depth_from_object, p);
#endif
}
