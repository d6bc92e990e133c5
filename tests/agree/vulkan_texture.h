// Textures and samplers as Vulkan objects.
#pragma once

#include "tests/agree/sampling.h"
#include "tests/peer/resources.h"

namespace gnomon::agree {

VkFormat vk_format(TexelFormat format);

/// Throws Error unless sizes, number of levels, their bytes and the depths are what Levels says.
void check_levels(const Levels& texture);
/// Throws Error on values that no device could take.
void check_sampler(const SamplerState& sampler);

/// As SamplingPeer::unsupported_because.
std::string unsupported_because(const peer::Device& device, const Levels& texture, const SamplerState& sampler);

/// A sampled image with its sampler, ready for compute shaders.
struct Texture {
    peer::Image image;
    peer::OwnedSampler sampler;
    VkImageView view = VK_NULL_HANDLE;  // one of the image's
};
Texture make_texture(const peer::Device& device, const Levels& levels, const SamplerState& sampler);

}  // namespace gnomon::agree
