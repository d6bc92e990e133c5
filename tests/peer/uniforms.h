// The uniform blocks of shaders/blocks.glsl, std140, and how they come from a frame.
#pragma once

#include "tests/peer/frame.h"

#include <glm/mat3x4.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>

namespace gnomon::peer {

struct DrawBlock {
    glm::mat4 clip_from_object;
    glm::mat4 light_clip_from_object;
    glm::mat4 light_texture_from_object;
    glm::mat4 world_from_object;
    glm::mat3x4 world_from_normal;  // mat3: each column padded to four floats
    glm::vec4 light_depth_from_object;
    glm::vec4 base_color;
};
static_assert(sizeof(DrawBlock) == 336 && offsetof(DrawBlock, light_depth_from_object) == 304);

struct FrameBlock {
    glm::vec4 light_position;
    glm::vec4 light_direction;
    glm::vec4 light_color;
    float cone_scale;
    float cone_offset;
    float ambient;
    float texel;
    float min_variance;
    float padding_0;
    glm::vec2 warp_exponents;
    glm::vec2 least_warped;
    glm::vec2 padding_1;
};
static_assert(sizeof(FrameBlock) == 96 && offsetof(FrameBlock, warp_exponents) == 72);

DrawBlock draw_block(const Frame& frame, const Draw& draw);
FrameBlock frame_block(const Frame& frame);

}  // namespace gnomon::peer
