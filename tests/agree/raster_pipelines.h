// The pipelines of shaders/{triangles.vert,whole_target.vert,raster.frag,fetch.comp}, and what they share.
#pragma once

#include "tests/peer/resources.h"

#include <array>
#include <cstdint>

namespace gnomon::agree {

/// Bindings: 0 vertices or colours, 1 what fetch.comp writes, 2 the image that it reads. Push constants: two integers.
struct RasterLayout {
    peer::OwnedSetLayout set;
    peer::OwnedPipelineLayout pipeline;
    peer::OwnedSampler sampler;  // for texelFetch, which uses none of it

    explicit RasterLayout(const peer::Device& device);
};
using RasterConstants = std::array<std::uint32_t, 2>;

/// None: a pass with depth alone. One and the two interpolated kinds draw triangles.vert, Listed draws whole_target.vert.
enum class FragmentSource { None, One, Perspective, Linear, Listed };

struct RasterPipelineOptions {
    FragmentSource source = FragmentSource::One;
    VkFormat color = VK_FORMAT_UNDEFINED;
    VkFormat depth = VK_FORMAT_UNDEFINED;
    int samples = 1;
    std::uint32_t sample_mask = 0xffffffff;
    VkPipelineColorBlendAttachmentState blend{};  // without its write mask
    std::array<float, 4> blend_constant{};
    float depth_bias_constant = 0;
    float depth_bias_slope = 0;
};
peer::OwnedPipeline make_raster_pipeline(const peer::Device& device, const RasterLayout& layout,
                                         const RasterPipelineOptions& options);

enum class FetchKind { Masks, Values };
peer::OwnedPipeline make_fetch_pipeline(const peer::Device& device, const RasterLayout& layout, FetchKind kind, int samples);

/// What a set binds; what is null is not bound.
struct RasterBindings {
    VkBuffer input = VK_NULL_HANDLE;
    VkBuffer output = VK_NULL_HANDLE;
    VkImageView image = VK_NULL_HANDLE;
};
struct RasterSet {
    peer::OwnedDescriptorPool pool;
    VkDescriptorSet set = VK_NULL_HANDLE;
};
RasterSet make_raster_set(const peer::Device& device, const RasterLayout& layout, const RasterBindings& bindings);

}  // namespace gnomon::agree
