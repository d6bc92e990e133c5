// The graphics pipelines of the three passes: caster, blur, receiver.
#pragma once

#include "tests/peer/bindings.h"
#include "tests/peer/shaders.h"

#include <glm/vec2.hpp>

#include <array>

namespace gnomon::peer {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_UNORM;
inline constexpr VkFormat kVisibilityFormat = VK_FORMAT_R32_SFLOAT;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

VkFormat moment_vk_format(MomentFormat format);

/// The push constants of blur.frag.
struct BlurConstants {
    glm::ivec2 step_texels{0};
    std::array<float, 16> weights{};  // weights[i] is the weight of the texels i steps away
};
static_assert(sizeof(BlurConstants) == 72);

struct Pipelines {
    OwnedPipelineLayout scene_layout;
    OwnedPipelineLayout blur_layout;
    OwnedPipeline caster{};  // none without a map
    OwnedPipeline blur{};    // none without a blur
    OwnedPipeline receiver{};
};
Pipelines make_pipelines(const Device& device, const SetLayouts& layouts, const TechniqueOptions& technique);

}  // namespace gnomon::peer
