// Light pass, fragments: depth and squared depth. [Donnelly06] section 4, step 1.
#version 450

layout(location = 0) in float depth_ls;
layout(location = 0) out vec2 moments;

void main() { moments = vec2(depth_ls, depth_ls * depth_ls); }
