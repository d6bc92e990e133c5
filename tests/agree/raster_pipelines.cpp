// Pipelines and bindings. The only file that sees the generated headers of the raster shaders.
#include "tests/agree/raster_pipelines.h"

#include "sim/error.h"
#include "tests/peer/result.h"
#include "tests/peer/shaders.h"

#include <span>

namespace gnomon::agree {
namespace {

#include "agree_shaders/fetch_masks_1.h"
#include "agree_shaders/fetch_masks_4.h"
#include "agree_shaders/fetch_values_1.h"
#include "agree_shaders/fetch_values_4.h"
#include "agree_shaders/raster_linear.h"
#include "agree_shaders/raster_listed.h"
#include "agree_shaders/raster_one.h"
#include "agree_shaders/raster_perspective.h"
#include "agree_shaders/triangles_linear.h"
#include "agree_shaders/triangles_one.h"
#include "agree_shaders/triangles_perspective.h"
#include "agree_shaders/whole_target.h"

using Spirv = std::span<const std::uint32_t>;

Spirv fragment_spirv(FragmentSource source) {
    switch (source) {
        case FragmentSource::None: return {};
        case FragmentSource::One: return k_raster_one;
        case FragmentSource::Perspective: return k_raster_perspective;
        case FragmentSource::Linear: return k_raster_linear;
        case FragmentSource::Listed: return k_raster_listed;
    }
    fail("unknown fragment source");
}

Spirv vertex_spirv(FragmentSource source) {
    switch (source) {
        case FragmentSource::None:
        case FragmentSource::One: return k_triangles_one;
        case FragmentSource::Perspective: return k_triangles_perspective;
        case FragmentSource::Linear: return k_triangles_linear;
        case FragmentSource::Listed: return k_whole_target;
    }
    fail("unknown fragment source");
}

Spirv fetch_spirv(FetchKind kind, int samples) {
    if (kind == FetchKind::Masks) return samples == 1 ? Spirv(k_fetch_masks_1) : Spirv(k_fetch_masks_4);
    return samples == 1 ? Spirv(k_fetch_values_1) : Spirv(k_fetch_values_4);
}

constexpr VkShaderStageFlags kConstantStages = VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;

peer::OwnedSetLayout make_set_layout(const peer::Device& device) {
    const std::array<VkDescriptorSetLayoutBinding, 3> bindings{{
        {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
        {2, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
    }};
    VkDescriptorSetLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = static_cast<std::uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    VkDescriptorSetLayout layout{};
    peer::check(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout), "creating a descriptor set layout");
    return {device.get(), layout};
}

peer::OwnedPipelineLayout make_pipeline_layout(const peer::Device& device, VkDescriptorSetLayout set) {
    const VkPushConstantRange push{kConstantStages, 0, sizeof(RasterConstants)};
    VkPipelineLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.setLayoutCount = 1;
    info.pSetLayouts = &set;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &push;
    VkPipelineLayout layout{};
    peer::check(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "creating a pipeline layout");
    return {device.get(), layout};
}

peer::OwnedSampler make_sampler(const peer::Device& device) {
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    VkSampler sampler{};
    peer::check(vkCreateSampler(device.get(), &info, nullptr, &sampler), "creating a sampler");
    return {device.get(), sampler};
}

VkPipelineShaderStageCreateInfo stage_info(VkShaderStageFlagBits stage, VkShaderModule shader) {
    VkPipelineShaderStageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage = stage;
    info.module = shader;
    info.pName = "main";
    return info;
}

VkPipelineRasterizationStateCreateInfo raster_state(const RasterPipelineOptions& options) {
    VkPipelineRasterizationStateCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    info.polygonMode = VK_POLYGON_MODE_FILL;
    info.cullMode = VK_CULL_MODE_NONE;
    info.lineWidth = 1;
    info.depthBiasEnable = options.depth_bias_constant != 0 || options.depth_bias_slope != 0 ? VK_TRUE : VK_FALSE;
    info.depthBiasConstantFactor = options.depth_bias_constant;
    info.depthBiasSlopeFactor = options.depth_bias_slope;
    return info;
}

VkPipelineDepthStencilStateCreateInfo depth_state(bool has_depth) {
    VkPipelineDepthStencilStateCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    info.depthTestEnable = has_depth ? VK_TRUE : VK_FALSE;
    info.depthWriteEnable = has_depth ? VK_TRUE : VK_FALSE;
    info.depthCompareOp = VK_COMPARE_OP_LESS;
    return info;
}

}  // namespace

RasterLayout::RasterLayout(const peer::Device& device)
    : set(make_set_layout(device)), pipeline(make_pipeline_layout(device, set.get())), sampler(make_sampler(device)) {}

peer::OwnedPipeline make_raster_pipeline(const peer::Device& device, const RasterLayout& layout,
                                         const RasterPipelineOptions& options) {
    const peer::OwnedShader vertex = peer::make_shader(device.get(), vertex_spirv(options.source));
    std::vector<VkPipelineShaderStageCreateInfo> stages{stage_info(VK_SHADER_STAGE_VERTEX_BIT, vertex.get())};
    peer::OwnedShader fragment;
    if (options.source != FragmentSource::None) {
        fragment = peer::make_shader(device.get(), fragment_spirv(options.source));
        stages.push_back(stage_info(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get()));
    }

    VkPipelineVertexInputStateCreateInfo vertex_input{};
    vertex_input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{};
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    const VkPipelineRasterizationStateCreateInfo raster = raster_state(options);
    const VkPipelineDepthStencilStateCreateInfo depth = depth_state(options.depth != VK_FORMAT_UNDEFINED);
    VkPipelineMultisampleStateCreateInfo samples{};
    samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    samples.rasterizationSamples = static_cast<VkSampleCountFlagBits>(options.samples);
    samples.pSampleMask = &options.sample_mask;

    VkPipelineColorBlendAttachmentState attachment = options.blend;
    attachment.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    const std::uint32_t color_count = options.color == VK_FORMAT_UNDEFINED ? 0 : 1;
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = color_count;
    blend.pAttachments = &attachment;
    for (std::size_t i = 0; i < 4; ++i) blend.blendConstants[i] = options.blend_constant[i];

    const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{};
    dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
    dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
    dynamic.pDynamicStates = dynamic_states.data();

    VkPipelineRenderingCreateInfo rendering{};
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = color_count;
    rendering.pColorAttachmentFormats = &options.color;
    rendering.depthAttachmentFormat = options.depth;

    VkGraphicsPipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.pNext = &rendering;
    info.stageCount = static_cast<std::uint32_t>(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &vertex_input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = layout.pipeline.get();
    VkPipeline pipeline{};
    peer::check(vkCreateGraphicsPipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "creating a pipeline");
    return {device.get(), pipeline};
}

peer::OwnedPipeline make_fetch_pipeline(const peer::Device& device, const RasterLayout& layout, FetchKind kind, int samples) {
    const peer::OwnedShader shader = peer::make_shader(device.get(), fetch_spirv(kind, samples));
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage = stage_info(VK_SHADER_STAGE_COMPUTE_BIT, shader.get());
    info.layout = layout.pipeline.get();
    VkPipeline pipeline{};
    peer::check(vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "creating a pipeline");
    return {device.get(), pipeline};
}

RasterSet make_raster_set(const peer::Device& device, const RasterLayout& layout, const RasterBindings& bindings) {
    const std::array<VkDescriptorPoolSize, 2> sizes{{
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1},
    }};
    VkDescriptorPoolCreateInfo pool_info{};
    pool_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool_info.maxSets = 1;
    pool_info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
    pool_info.pPoolSizes = sizes.data();
    VkDescriptorPool pool{};
    peer::check(vkCreateDescriptorPool(device.get(), &pool_info, nullptr, &pool), "creating a descriptor pool");
    RasterSet made{peer::OwnedDescriptorPool(device.get(), pool), VK_NULL_HANDLE};

    const VkDescriptorSetLayout set_layout = layout.set.get();
    VkDescriptorSetAllocateInfo set_info{};
    set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    set_info.descriptorPool = pool;
    set_info.descriptorSetCount = 1;
    set_info.pSetLayouts = &set_layout;
    peer::check(vkAllocateDescriptorSets(device.get(), &set_info, &made.set), "allocating a descriptor set");

    const std::array<VkDescriptorBufferInfo, 2> buffers{{
        {bindings.input, 0, VK_WHOLE_SIZE},
        {bindings.output, 0, VK_WHOLE_SIZE},
    }};
    const VkDescriptorImageInfo image{layout.sampler.get(), bindings.image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    std::vector<VkWriteDescriptorSet> writes;
    const auto write = [&](std::uint32_t binding, VkDescriptorType type) -> VkWriteDescriptorSet& {
        VkWriteDescriptorSet& added = writes.emplace_back();
        added.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        added.dstSet = made.set;
        added.dstBinding = binding;
        added.descriptorCount = 1;
        added.descriptorType = type;
        return added;
    };
    if (bindings.input != VK_NULL_HANDLE) write(0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER).pBufferInfo = &buffers[0];
    if (bindings.output != VK_NULL_HANDLE) write(1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER).pBufferInfo = &buffers[1];
    if (bindings.image != VK_NULL_HANDLE) write(2, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER).pImageInfo = &image;
    vkUpdateDescriptorSets(device.get(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
    return made;
}

}  // namespace gnomon::agree
