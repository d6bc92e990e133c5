// RawPassRenderer: the resources, the pipeline and the commands of one pass.
#include "tests/peer/raw_pass.h"

#include "tests/peer/device.h"
#include "tests/peer/resources.h"
#include "tests/peer/result.h"
#include "tests/peer/shaders.h"

#include <array>
#include <chrono>
#include <span>

namespace gnomon::peer {
namespace {

constexpr VkFormat kRawColor = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkFormat kRawDepth = VK_FORMAT_D32_SFLOAT;
constexpr ImageUse kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                               VK_ACCESS_2_TRANSFER_WRITE_BIT};

RawFragments fragments_of(RawShading shading) {
    switch (shading) {
        case RawShading::DepthOnly: return RawFragments::None;
        case RawShading::Plain: return RawFragments::Plain;
        case RawShading::Bilinear:
        case RawShading::Trilinear: return RawFragments::Textured;
    }
    return RawFragments::None;
}

Image make_texture(const Device& device) {
    const std::uint32_t levels = full_mip_levels(kRawTextureSize);
    Image image = make_image(device, {.format = kRawColor,
                                      .size = {kRawTextureSize, kRawTextureSize},
                                      .levels = levels,
                                      .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    for (std::uint32_t level = 0; level < levels; ++level) {
        const std::vector<std::uint8_t> texels = raw_texels(static_cast<int>(level));
        const Buffer staging = host_buffer(device, std::as_bytes(std::span(texels)), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        device.run(device.record([&](VkCommandBuffer commands) {
            record_transitions(commands, {{image, kDiscarded, kCopyTarget, level, 1}});
            VkBufferImageCopy copy{};
            copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
            copy.imageExtent = {std::uint32_t{kRawTextureSize} >> level, std::uint32_t{kRawTextureSize} >> level, 1};
            vkCmdCopyBufferToImage(commands, staging.buffer.get(), image.image.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                   &copy);
            record_transitions(commands, {{image, kCopyTarget, kSampled, level, 1}});
        }));
    }
    return image;
}

OwnedSampler make_texture_sampler(const Device& device, bool trilinear) {
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    info.magFilter = info.minFilter = VK_FILTER_LINEAR;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    info.maxLod = trilinear ? VK_LOD_CLAMP_NONE : 0.0f;
    VkSampler sampler{};
    check(vkCreateSampler(device.get(), &info, nullptr, &sampler), "creating a sampler");
    return {device.get(), sampler};
}

OwnedSetLayout make_set_layout(const Device& device) {
    const VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT,
                                               nullptr};
    VkDescriptorSetLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = 1;
    info.pBindings = &binding;
    VkDescriptorSetLayout layout{};
    check(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout), "creating a descriptor set layout");
    return {device.get(), layout};
}

OwnedPipelineLayout make_layout(const Device& device, VkDescriptorSetLayout set) {
    const VkPushConstantRange push{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(glm::mat4)};
    VkPipelineLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.setLayoutCount = 1;
    info.pSetLayouts = &set;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &push;
    VkPipelineLayout layout{};
    check(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "creating a pipeline layout");
    return {device.get(), layout};
}

OwnedDescriptorPool make_pool(const Device& device) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = 1;
    info.poolSizeCount = 1;
    info.pPoolSizes = &size;
    VkDescriptorPool pool{};
    check(vkCreateDescriptorPool(device.get(), &info, nullptr, &pool), "creating a descriptor pool");
    return {device.get(), pool};
}

VkDescriptorSet make_set(const Device& device, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                         const VkDescriptorImageInfo& image) {
    VkDescriptorSetAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    info.descriptorPool = pool;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    VkDescriptorSet set{};
    check(vkAllocateDescriptorSets(device.get(), &info, &set), "allocating a descriptor set");
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    vkUpdateDescriptorSets(device.get(), 1, &write, 0, nullptr);
    return set;
}

VkPipelineShaderStageCreateInfo stage_info(VkShaderStageFlagBits stage, VkShaderModule shader) {
    VkPipelineShaderStageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage = stage;
    info.module = shader;
    info.pName = "main";
    return info;
}

OwnedPipeline make_pipeline(const Device& device, VkPipelineLayout layout, const RawPass& pass) {
    const ShaderPair shaders = raw_shaders(fragments_of(pass.shading));
    const OwnedShader vertex = make_shader(device.get(), shaders.vertex);
    OwnedShader fragment;
    std::vector stages{stage_info(VK_SHADER_STAGE_VERTEX_BIT, vertex.get())};
    const bool has_color = !shaders.fragment.empty();
    if (has_color) {
        fragment = make_shader(device.get(), shaders.fragment);
        stages.push_back(stage_info(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get()));
    }

    const VkVertexInputBindingDescription binding{0, sizeof(RawVertex), VK_VERTEX_INPUT_RATE_VERTEX};
    const std::array<VkVertexInputAttributeDescription, 2> attributes{{
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(RawVertex, position)},
        {1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(RawVertex, uv)},
    }};
    VkPipelineVertexInputStateCreateInfo input{};
    input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    input.vertexBindingDescriptionCount = 1;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = has_color ? 2 : 1;
    input.pVertexAttributeDescriptions = attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;

    // y up in clip space as in D3D11.3 15.6: hence the negative height.
    const auto width = static_cast<float>(pass.width);
    const auto height = static_cast<float>(pass.height);
    const VkViewport area{0, height, width, -height, 0, 1};
    const VkRect2D scissor{{0, 0}, {static_cast<std::uint32_t>(pass.width), static_cast<std::uint32_t>(pass.height)}};
    VkPipelineViewportStateCreateInfo viewport{};
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = viewport.scissorCount = 1;
    viewport.pViewports = &area;
    viewport.pScissors = &scissor;
    VkPipelineRasterizationStateCreateInfo raster{};
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = VK_CULL_MODE_NONE;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{};
    samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    samples.rasterizationSamples = static_cast<VkSampleCountFlagBits>(pass.samples);
    VkPipelineDepthStencilStateCreateInfo depth{};
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState written{};
    written.colorWriteMask = 0xf;
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = has_color ? 1 : 0;
    blend.pAttachments = &written;

    VkPipelineRenderingCreateInfo rendering{};
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = has_color ? 1 : 0;
    rendering.pColorAttachmentFormats = &kRawColor;
    rendering.depthAttachmentFormat = kRawDepth;
    VkGraphicsPipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.pNext = &rendering;
    info.stageCount = static_cast<std::uint32_t>(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.layout = layout;
    VkPipeline pipeline{};
    check(vkCreateGraphicsPipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "creating a pipeline");
    return {device.get(), pipeline};
}

VkRenderingAttachmentInfo cleared(const Image& image, VkImageLayout layout, VkClearValue value) {
    VkRenderingAttachmentInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    info.imageView = image.level_0.get();
    info.imageLayout = layout;
    info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = value;
    return info;
}

}  // namespace

// Members are destroyed from the last to the first: the commands before what they refer to.
struct RawPassRenderer::Resources {
    const Device& device;
    RawPass pass;  // without its mesh, once that is uploaded
    std::uint32_t corners;
    Buffer vertices;
    Buffer indices;
    Image depth;
    Image color{};
    Image resolved{};
    Image texture{};
    OwnedSampler sampler{};
    OwnedSetLayout set_layout;
    OwnedPipelineLayout layout;
    OwnedDescriptorPool pool;
    VkDescriptorSet set = VK_NULL_HANDLE;
    OwnedPipeline pipeline;
    Commands commands;

    Resources(const Device& on, const RawPass& of)
        : device(on),
          pass(of),
          corners(static_cast<std::uint32_t>(of.mesh.indices.size())),
          vertices(device_buffer(on, std::as_bytes(std::span(of.mesh.vertices)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT)),
          indices(device_buffer(on, std::as_bytes(std::span(of.mesh.indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT)),
          depth(target(kRawDepth, of.samples, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT)),
          set_layout(make_set_layout(on)),
          layout(make_layout(on, set_layout.get())),
          pool(make_pool(on)),
          pipeline(make_pipeline(on, layout.get(), of)) {
        if (of.shading != RawShading::DepthOnly) color = target(kRawColor, of.samples, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
        if (color.image && of.samples > 1) resolved = target(kRawColor, 1, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
        if (fragments_of(of.shading) == RawFragments::Textured) {
            texture = make_texture(on);
            sampler = make_texture_sampler(on, of.shading == RawShading::Trilinear);
            set = make_set(on, pool.get(), set_layout.get(),
                           {sampler.get(), texture.all_levels.get(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
        }
        commands = device.record([this](VkCommandBuffer into) { record(into); });
        pass.mesh = {};
    }

    [[nodiscard]] Image target(VkFormat format, int samples, VkImageUsageFlags usage) const {
        return make_image(device, {.format = format,
                                   .size = {static_cast<std::uint32_t>(pass.width), static_cast<std::uint32_t>(pass.height)},
                                   .usage = samples == 1 ? usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT : usage,
                                   .samples = static_cast<VkSampleCountFlagBits>(samples)});
    }

    void record(VkCommandBuffer into) const {
        record_transitions(
            into, {{depth, kDiscarded, kDepthTarget}, {color, kDiscarded, kColorTarget}, {resolved, kDiscarded, kColorTarget}});
        const VkRenderingAttachmentInfo depth_info =
            cleared(depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, {.depthStencil = {1.0f, 0}});
        VkRenderingAttachmentInfo color_info = cleared(color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, {});
        if (resolved.image) {
            color_info.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
            color_info.resolveImageView = resolved.level_0.get();
            color_info.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        }
        VkRenderingInfo info{};
        info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
        info.renderArea = {{0, 0}, depth.size};
        info.layerCount = 1;
        info.colorAttachmentCount = color.image ? 1 : 0;
        info.pColorAttachments = &color_info;
        info.pDepthAttachment = &depth_info;
        vkCmdBeginRendering(into, &info);
        vkCmdBindPipeline(into, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
        const VkBuffer buffer = vertices.buffer.get();
        const VkDeviceSize offset = 0;
        vkCmdBindVertexBuffers(into, 0, 1, &buffer, &offset);
        vkCmdBindIndexBuffer(into, indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
        if (set != VK_NULL_HANDLE)
            vkCmdBindDescriptorSets(into, VK_PIPELINE_BIND_POINT_GRAPHICS, layout.get(), 0, 1, &set, 0, nullptr);
        vkCmdPushConstants(into, layout.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(glm::mat4), &pass.mesh.clip_from_mesh);
        vkCmdDrawIndexed(into, corners, 1, 0, 0, 0);
        vkCmdEndRendering(into);
    }
};

RawPassRenderer::RawPassRenderer(const Peer& peer, const RawPass& pass)
    : resources_(std::make_unique<Resources>(*peer.device_, pass)) {
    if (pass.samples > 1 && pass.shading == RawShading::DepthOnly) fail("depth of several samples cannot be read back");
}
RawPassRenderer::~RawPassRenderer() = default;
RawPassRenderer::RawPassRenderer(RawPassRenderer&&) noexcept = default;
RawPassRenderer& RawPassRenderer::operator=(RawPassRenderer&&) noexcept = default;

double RawPassRenderer::time_once() {
    const auto begin = std::chrono::steady_clock::now();
    resources_->device.run(resources_->commands);
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

RawImage RawPassRenderer::render() {
    const Resources& r = *resources_;
    r.device.run(r.commands);
    if (r.resolved.image) return raw_image(r.pass, read_image(r.device, r.resolved, kColorTarget));
    if (r.color.image) return raw_image(r.pass, read_image(r.device, r.color, kColorTarget));
    return raw_image(r.pass, read_image(r.device, r.depth, kDepthTarget));
}

}  // namespace gnomon::peer
