// The uniform blocks of uniforms.h, member for member (std140).

layout(set = 0, binding = 0, std140) uniform DrawBlock {
    mat4 clip_from_object;
    mat4 light_clip_from_object;
    mat4 light_texture_from_object;  // gives (s, t, z, q): map coordinates s/q, t/q and projective depth z/q
    mat4 world_from_object;
    mat3 world_from_normal;
    vec4 light_depth_from_object;  // dot with (position, 1): linear depth, 0 at the light's znear and 1 at its zfar
    vec4 base_color;
} draw;

layout(set = 0, binding = 1, std140) uniform FrameBlock {
    vec4 light_position;   // world; w 1: a position, w 0: the direction towards the light
    vec4 light_direction;  // world, unit, from the light
    vec4 light_color;
    float cone_scale;  // spot attenuation = saturate(scale * cos(angle) + offset)
    float cone_offset;
    float ambient;
    float texel;  // 1 / map size
    float min_variance;
    vec2 warp_exponents;  // (c+, -c-) log2(e). [Lauritzen08] section 4.2
    vec2 least_warped;    // least deviation of a warp, per its value
} frame;
