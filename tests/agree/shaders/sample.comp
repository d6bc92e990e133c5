// One sample per invocation. INSTRUCTION is READ, GRADIENT, LOD or GATHER; COMPARE says whether the sampler compares.
#version 450

layout(local_size_x = 64) in;

struct Point {
    vec2 uv;
    vec2 duv_dx;
    vec2 duv_dy;
    float lod;
    float reference;
};
layout(set = 0, binding = 0, std430) readonly buffer Points { Point points[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Samples { vec4 samples[]; };
layout(push_constant) uniform Constants { uint point_count; };

// Timed kernels read all of a point, so that they and READ differ by the sampling alone.
layout(constant_id = 0) const bool kTimed = false;

#if COMPARE
layout(set = 0, binding = 2) uniform sampler2DShadow image;
#else
layout(set = 0, binding = 2) uniform sampler2D image;
#endif

vec4 all_of(Point p) { return vec4(p.uv + p.duv_dx, p.duv_dy + vec2(p.lod, p.reference)); }

vec4 value_at(Point p) {
#if INSTRUCTION == READ
    return vec4(0.0);
#elif INSTRUCTION == GRADIENT && COMPARE
    return vec4(textureGrad(image, vec3(p.uv, p.reference), p.duv_dx, p.duv_dy));
#elif INSTRUCTION == GRADIENT
    return textureGrad(image, p.uv, p.duv_dx, p.duv_dy);
#elif INSTRUCTION == LOD && COMPARE
    return vec4(textureLod(image, vec3(p.uv, p.reference), p.lod));
#elif INSTRUCTION == LOD
    return textureLod(image, p.uv, p.lod);
#elif INSTRUCTION == GATHER && COMPARE
    return textureGather(image, p.uv, p.reference);
#elif INSTRUCTION == GATHER
    return textureGather(image, p.uv, 0);
#endif
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= point_count) return;
    const Point point = points[i];
    const vec4 value = value_at(point);
    samples[i] = kTimed ? value + all_of(point) : value;
}
