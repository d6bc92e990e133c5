// Every sample of an image, as it is stored. VALUES: one vec4 per sample, those of a pixel one after the other. Otherwise one
// mask per pixel: bit i is set where sample i is not zero.
#version 450

layout(local_size_x = 64) in;

#if SAMPLES > 1
layout(set = 0, binding = 2) uniform sampler2DMS image;
#else
layout(set = 0, binding = 2) uniform sampler2D image;
#endif
#if VALUES
layout(set = 0, binding = 1, std430) writeonly buffer Fetched { vec4 fetched[]; };
#else
layout(set = 0, binding = 1, std430) writeonly buffer Fetched { uint fetched[]; };
#endif
layout(push_constant) uniform Constants {
    uint row_length;
    uint pixel_count;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= pixel_count) return;
    const ivec2 pixel = ivec2(i % row_length, i / row_length);
    uint mask = 0;
    for (int s = 0; s < SAMPLES; ++s) {
        // The last argument is the sample, or the level.
        const vec4 value = texelFetch(image, pixel, SAMPLES > 1 ? s : 0);
#if VALUES
        fetched[i * SAMPLES + s] = value;
#else
        if (value.x != 0.0) mask |= 1u << s;
#endif
    }
#if !VALUES
    fetched[i] = mask;
#endif
}
