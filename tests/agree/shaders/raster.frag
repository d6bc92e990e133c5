// What a fragment writes: SOURCE is ONE, PERSPECTIVE, LINEAR (the attribute) or LISTED (a colour from a list, by pixel).
#version 450

layout(location = 0) out vec4 written;

#if SOURCE == PERSPECTIVE
layout(location = 0) in vec4 color;
#elif SOURCE == LINEAR
layout(location = 0) noperspective in vec4 color;
#elif SOURCE == LISTED
layout(set = 0, binding = 0, std430) readonly buffer Colors { vec4 colors[]; };
layout(push_constant) uniform Constants {
    uint row_length;  // pixels
    uint first;       // colour of pixel (0, 0)
};
#endif

void main() {
#if SOURCE == ONE
    written = vec4(1.0);
#elif SOURCE == PERSPECTIVE || SOURCE == LINEAR
    written = color;
#elif SOURCE == LISTED
    const uvec2 pixel = uvec2(gl_FragCoord.xy);
    written = colors[first + pixel.y * row_length + pixel.x];
#endif
}
