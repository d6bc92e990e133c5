// A raw pass, fragments: the coordinates themselves, or one texture.
#version 450

#if TEXTURED
layout(set = 0, binding = 0) uniform sampler2D picture;
#endif
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;

void main() {
#if TEXTURED
    color = texture(picture, uv);
#else
    color = vec4(uv, 0.5, 1.0);
#endif
}
