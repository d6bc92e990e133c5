// One direction of a separable symmetric filter over the moments, edge texels repeated, the
// usual sizes written out as in receiver.frag. [Donnelly06] section 4, step 2.
#version 450

layout(set = 0, binding = 0) uniform sampler2D moments_map;
layout(push_constant) uniform BlurConstants {
    ivec2 step_texels;  // (1, 0) or (0, 1)
    float weights[16];  // weights[i] is the weight of the texels i steps away
} blur;

#if CHANNELS == 4
#define MOMENTS vec4
#define CHANNELS_OF(texel) texel
#else
#define MOMENTS vec2
#define CHANNELS_OF(texel) texel.xy
#endif
layout(location = 0) out MOMENTS moments;

#if TAPS == 0
layout(constant_id = 0) const int kRadius = 1;
#endif

void main() {
    const ivec2 texel = ivec2(gl_FragCoord.xy);
    const ivec2 last = textureSize(moments_map, 0) - 1;
    MOMENTS sum = MOMENTS(0.0);
#define FETCH(i) texelFetch(moments_map, clamp(texel + (i) * blur.step_texels, ivec2(0), last), 0)
#define TAP(i) sum += blur.weights[abs(i)] * CHANNELS_OF(FETCH(i));
#if TAPS == 3
    TAP(-1) TAP(0) TAP(1)
#elif TAPS == 5
    TAP(-2) TAP(-1) TAP(0) TAP(1) TAP(2)
#else
    for (int i = -kRadius; i <= kRadius; ++i) TAP(i)
#endif
    moments = sum;
}
