// Clip-space positions as they are given, with an attribute where the fragment shader takes one: SOURCE as in raster.frag.
#version 450

struct Vertex {
    vec4 clip;
    vec4 color;
};
layout(set = 0, binding = 0, std430) readonly buffer Vertices { Vertex vertices[]; };

#if SOURCE == PERSPECTIVE
layout(location = 0) out vec4 color;
#elif SOURCE == LINEAR
layout(location = 0) noperspective out vec4 color;
#endif

void main() {
    gl_Position = vertices[gl_VertexIndex].clip;
#if SOURCE == PERSPECTIVE || SOURCE == LINEAR
    color = vertices[gl_VertexIndex].color;
#endif
}
