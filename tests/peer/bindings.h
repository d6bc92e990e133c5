// What the shaders are given: uniform buffers, the map and its sampler.
#pragma once

#include "tests/peer/resources.h"

#include <cstdint>
#include <vector>

namespace gnomon::peer {

/// Scene passes: 0 is the draw's block (dynamic offset), 1 the frame's, 2 the map if there is one. Blur passes: 0 is the image
/// to blur.
struct SetLayouts {
    OwnedSetLayout scene;
    OwnedSetLayout blur;
};
SetLayouts make_set_layouts(const Device& device, bool has_map);

/// Two blocks in one host-visible buffer each; draws lie `draw_stride` bytes apart.
struct UniformBuffers {
    Buffer draws;
    Buffer frame;
    std::uint32_t draw_stride = 0;
};
UniformBuffers make_uniform_buffers(const Device& device, const Frame& frame);

/// As the receiver looks its map up: clamped to the edge.
OwnedSampler make_map_sampler(const Device& device, const TechniqueOptions& technique);
/// For texelFetch, which uses none of it.
OwnedSampler make_fetch_sampler(const Device& device);

/// The descriptor sets of one frame, with the pool that owns them.
struct Sets {
    OwnedDescriptorPool pool;
    VkDescriptorSet scene = VK_NULL_HANDLE;
    VkDescriptorSet blur_map = VK_NULL_HANDLE;   // reads the map
    VkDescriptorSet blur_temp = VK_NULL_HANDLE;  // reads the horizontally blurred map
};
Sets make_sets(const Device& device, const SetLayouts& layouts);

void bind_uniforms(const Device& device, VkDescriptorSet scene, const UniformBuffers& uniforms);
void bind_image(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkImageView view, VkSampler sampler);

}  // namespace gnomon::peer
