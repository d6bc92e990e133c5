// Matrices are multiplied here, once per draw, in fp32.
#include "tests/peer/uniforms.h"

#include "sim/scalar_math.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace gnomon::peer {
namespace {

bool is_perspective(const scenes::View& view) { return view.clip_from_view[2][3] != 0; }

// The row that gives (-z_view - znear) / (zfar - znear), affine in the object-space position.
glm::vec4 linear_depth_row(const scenes::View& light, const glm::mat4& world_from_object) {
    const glm::mat4 view_from_object = light.view_from_world * world_from_object;
    const glm::vec4 z_row = glm::transpose(view_from_object)[2];
    return (-z_row - glm::vec4(0, 0, 0, light.znear)) * (1.0f / (light.zfar - light.znear));
}

// Clip space to texture space: y turns over, [-w, w] becomes [0, w]. D3D11.3 15.6
const glm::mat4 kTextureFromClip(0.5f, 0.0f, 0.0f, 0.0f,   //
                                 0.0f, -0.5f, 0.0f, 0.0f,  //
                                 0.0f, 0.0f, 1.0f, 0.0f,   //
                                 0.5f, 0.5f, 0.0f, 1.0f);

}  // namespace

DrawBlock draw_block(const Frame& frame, const Draw& draw) {
    const glm::mat3 normals = glm::transpose(glm::inverse(glm::mat3(draw.world_from_object)));
    return {
        .clip_from_object = frame.camera.clip_from_world() * draw.world_from_object,
        .light_clip_from_object = frame.light.clip_from_world() * draw.world_from_object,
        .light_texture_from_object =
            kTextureFromClip * frame.light.clip_from_view * (frame.light.view_from_world * draw.world_from_object),
        .world_from_object = draw.world_from_object,
        .world_from_normal = glm::mat3x4(glm::vec4(normals[0], 0), glm::vec4(normals[1], 0), glm::vec4(normals[2], 0)),
        .light_depth_from_object = linear_depth_row(frame.light, draw.world_from_object),
        .base_color = glm::vec4(draw.base_color, 1),
    };
}

FrameBlock frame_block(const Frame& frame) {
    const TechniqueOptions& technique = frame.technique;
    const glm::dvec2 exponents(technique.positive_exponent, technique.negative_exponent);
    const double deviation = std::sqrt(static_cast<double>(technique.min_variance));
    const bool spot = is_perspective(frame.light);
    return {
        .light_position = spot ? glm::vec4(frame.light.position_ws, 1) : glm::vec4(-frame.light.direction_ws, 0),
        .light_direction = glm::vec4(frame.light.direction_ws, 0),
        .light_color = glm::vec4(frame.lighting.light_color, 1),
        .cone_scale = frame.lighting.cone_scale,
        .cone_offset = frame.lighting.cone_offset,
        .ambient = frame.lighting.ambient,
        .texel = 1.0f / static_cast<float>(technique.map_size),
        .min_variance = technique.min_variance,
        .padding_0 = 0,
        .warp_exponents = glm::vec2(exponents * glm::dvec2(1, -1) * scalar::kLog2E),
        .least_warped = glm::vec2(2.0 * deviation * exponents),
        .padding_1 = {},
    };
}

}  // namespace gnomon::peer
