// Camera pass, fragments: lit colour (gamma 2) and visibility. As techniques/receiver.h, shadow_map.h, pcf.h and vsm.h; four
// moments by [Lauritzen08] section 4.2.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "blocks.glsl"

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;

layout(location = 0) out vec4 color;
layout(location = 1) out float visibility;

#if MAP != MAP_NONE
layout(location = 2) in vec4 light;

// Map coordinates and projective depth.
vec3 map_position() { return light.xyz * (1.0 / light.w); }

bool is_inside(vec3 at) {
    return light.w > 0.0 && all(greaterThanEqual(at, vec3(0.0))) && all(lessThanEqual(at, vec3(1.0)));
}
#endif

#if MAP == MAP_DEPTH
// Mean of N x N comparisons one texel apart; the sampler decides whether each is a nearest or a bilinear one. The level is
// implicit although there is but one: llvmpipe pays half as much again for an explicit one.
layout(set = 0, binding = 2) uniform sampler2DShadow shadow_map;

// SwiftShader does not unroll loops and loses a third by them, so the usual sizes are written out.
#if TAPS == 0
layout(constant_id = 0) const int kTaps = 1;
#else
const int kTaps = TAPS;
#endif

float map_visibility(vec3 at) {
    float lit = 0.0;
#define TAP(i, j) lit += texture(shadow_map, vec3(at.xy + vec2(i, j) * frame.texel, at.z));
#define ROW_3(j) TAP(-1, j) TAP(0, j) TAP(1, j)
#define ROW_5(j) TAP(-2, j) ROW_3(j) TAP(2, j)
#if TAPS == 1
    TAP(0, 0)
#elif TAPS == 3
    ROW_3(-1) ROW_3(0) ROW_3(1)
#elif TAPS == 5
    ROW_5(-2) ROW_5(-1) ROW_5(0) ROW_5(1) ROW_5(2)
#else
    const float first = -0.5 * float(kTaps - 1);
    for (int row = 0; row < kTaps; ++row)
        for (int column = 0; column < kTaps; ++column) TAP(first + column, first + row)
#endif
    return lit * (1.0 / float(kTaps * kTaps));
}
#elif MAP == MAP_MOMENTS || MAP == MAP_WARPED
layout(location = 3) in float depth_ls;

layout(constant_id = 0) const int kAnisotropic = 0;
layout(set = 0, binding = 2) uniform sampler2D moments_map;

// [Donnelly06] eq. 5, variance by eq. 4.
float chebyshev_upper_bound(vec2 moments, float t, float min_variance) {
    const float sigma2 = max(moments.y - moments.x * moments.x, min_variance);
    const float d = t - moments.x;
    const float bound = sigma2 / max(sigma2 + d * d, 1.17549435e-38);  // the smallest normal number
    return t <= moments.x ? 1.0 : bound;
}

#if MAP == MAP_WARPED
#include "warp.glsl"

// The tighter of both warps' bounds. [Lauritzen08] section 4.2. A warp's derivative makes of a deviation of depth one of the
// warp: d/dd e^{c(2d - 1)} = 2c e^{c(2d - 1)}.
float moments_visibility(vec4 moments) {
    const vec2 t = warped_depth(depth_ls);
    const vec2 deviation = frame.least_warped * t;
    const vec2 min_variance = deviation * deviation;
    return min(chebyshev_upper_bound(moments.xy, t.x, min_variance.x), chebyshev_upper_bound(moments.zw, t.y, min_variance.y));
}
#else
float moments_visibility(vec4 moments) { return chebyshev_upper_bound(moments.xy, depth_ls, frame.min_variance); }
#endif

// llvmpipe's anisotropic filter walks over every texel of a footprint: minutes near the plane of the light, and in the scene
// `car` two thirds of the frame for fragments that lie outside the map and are lit in any case. They read its border instead,
// from a sixteenth of a map away, so that quads across the border keep their footprint.
const float kMargin = 1.0 / 16.0;
vec2 bounded_uv(vec3 at) { return light.w > 0.0 ? clamp(at.xy, -kMargin, 1.0 + kMargin) : vec2(-kMargin); }

float map_visibility(vec3 at) {
    return moments_visibility(texture(moments_map, kAnisotropic != 0 ? bounded_uv(at) : at.xy));
}
#endif

void main() {
#if MAP == MAP_NONE
    visibility = 1.0;
#else
    // Outside the light's frustum nothing is known to be in shadow. The lookup stands outside the branch, for its derivatives.
    const vec3 at = map_position();
    const float in_map = map_visibility(at);
    visibility = is_inside(at) ? in_map : 1.0;
#endif

    // n.l and the spot's cone.
    const vec3 to_light = normalize(frame.light_position.xyz - position_ws * frame.light_position.w);
    const float cos_normal = max(dot(normalize(normal_ws), to_light), 0.0);
    const float cos_axis = -dot(to_light, frame.light_direction.xyz);
    const float cone = clamp(cos_axis * frame.cone_scale + frame.cone_offset, 0.0, 1.0);
    const vec3 light_rgb = frame.ambient + cos_normal * cone * visibility * frame.light_color.rgb;
    color = vec4(sqrt(clamp(draw.base_color.rgb * light_rgb, 0.0, 1.0)), 1.0);
}
