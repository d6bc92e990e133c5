// A raw pass, vertices: one matrix, and texture coordinates where there is a fragment shader.
#version 450

layout(push_constant) uniform Constants { mat4 clip_from_mesh; };
layout(location = 0) in vec3 position;
#if HAS_UV
layout(location = 1) in vec2 mesh_uv;
layout(location = 0) out vec2 uv;
#endif

void main() {
    gl_Position = clip_from_mesh * vec4(position, 1.0);
#if HAS_UV
    uv = mesh_uv;
#endif
}
