#include "techniques/common/light_space.h"

namespace gnomon::techniques {

LightSpace make_light_space(const scenes::View& light, const glm::mat4& world_from_object) {
    // Clip space to texture space: y turns over, [-w, w] becomes [0, w].
    const glm::mat4 texture_from_clip(0.5f, 0.0f, 0.0f, 0.0f,   //
                                      0.0f, -0.5f, 0.0f, 0.0f,  //
                                      0.0f, 0.0f, 1.0f, 0.0f,   //
                                      0.5f, 0.5f, 0.0f, 1.0f);
    const glm::mat4 view_from_object = light.view_from_world * world_from_object;

    // Linear depth: minus the third row of the view transform, scaled to [0, 1] between the planes.
    const float scale = 1.0f / (light.zfar - light.znear);
    LightSpace space;
    space.texture_from_object = texture_from_clip * light.clip_from_view * view_from_object;
    space.depth_from_object = {-view_from_object[0][2] * scale, -view_from_object[1][2] * scale,
                               -view_from_object[2][2] * scale, (-view_from_object[3][2] - light.znear) * scale};
    return space;
}

}  // namespace gnomon::techniques
