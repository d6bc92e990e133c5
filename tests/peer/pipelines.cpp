// Pipeline state: nothing culled, depth test less, no blending; viewport and scissor are set while recording.
#include "tests/peer/pipelines.h"

#include "tests/peer/result.h"

#include <span>
#include <string_view>

namespace gnomon::peer {
namespace {

// What differs between the passes.
struct PipelineOptions {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    ShaderPair shaders;
    std::int32_t constant_0 = 1;  // the fragment shader's specialisation constant 0
    std::span<const VkFormat> color_formats;
    std::uint32_t vertex_attributes = 0;  // of scenes::Vertex, in order
    bool has_depth = false;
    float depth_bias_constant = 0;
    float depth_bias_slope = 0;
};

// The stages, with the modules and constants that they point to.
class Stages {
public:
    Stages(VkDevice device, const ShaderPair& shaders, std::int32_t constant_0)
        : constant_0_(constant_0), vertex_(make_shader(device, shaders.vertex)) {
        add(VK_SHADER_STAGE_VERTEX_BIT, vertex_.get());
        if (shaders.fragment.empty()) return;
        fragment_ = make_shader(device, shaders.fragment);
        add(VK_SHADER_STAGE_FRAGMENT_BIT, fragment_.get());
        stages_[1].pSpecializationInfo = &specialization_;
    }
    Stages(const Stages&) = delete;
    Stages& operator=(const Stages&) = delete;

    void fill(VkGraphicsPipelineCreateInfo& info) const {
        info.stageCount = count_;
        info.pStages = stages_.data();
    }

private:
    void add(VkShaderStageFlagBits stage, VkShaderModule shader) {
        VkPipelineShaderStageCreateInfo& info = stages_[count_++];
        info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        info.stage = stage;
        info.module = shader;
        info.pName = "main";
    }

    std::int32_t constant_0_;
    VkSpecializationMapEntry entry_{0, 0, sizeof(std::int32_t)};
    VkSpecializationInfo specialization_{1, &entry_, sizeof(std::int32_t), &constant_0_};
    OwnedShader vertex_;
    OwnedShader fragment_;
    std::array<VkPipelineShaderStageCreateInfo, 2> stages_{};
    std::uint32_t count_ = 0;
};

// The vertex fetch: scenes::Vertex as it stands.
struct VertexInput {
    VkVertexInputBindingDescription binding{0, sizeof(scenes::Vertex), VK_VERTEX_INPUT_RATE_VERTEX};
    std::array<VkVertexInputAttributeDescription, 2> attributes{{
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(scenes::Vertex, position)},
        {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(scenes::Vertex, normal)},
    }};
    VkPipelineVertexInputStateCreateInfo info{};

    explicit VertexInput(std::uint32_t attribute_count) {
        info.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
        info.vertexBindingDescriptionCount = attribute_count > 0 ? 1 : 0;
        info.pVertexBindingDescriptions = &binding;
        info.vertexAttributeDescriptionCount = attribute_count;
        info.pVertexAttributeDescriptions = attributes.data();
    }
    VertexInput(const VertexInput&) = delete;
    VertexInput& operator=(const VertexInput&) = delete;
};

VkPipelineRasterizationStateCreateInfo raster_state(const PipelineOptions& options) {
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

OwnedPipeline make_pipeline(const Device& device, const PipelineOptions& options) {
    const Stages stages(device.get(), options.shaders, options.constant_0);
    const VertexInput vertex_input(options.vertex_attributes);

    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{};
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    const VkPipelineRasterizationStateCreateInfo raster = raster_state(options);
    const VkPipelineDepthStencilStateCreateInfo depth = depth_state(options.has_depth);
    VkPipelineMultisampleStateCreateInfo samples{};
    samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;

    VkPipelineColorBlendAttachmentState written{};
    written.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    const std::vector<VkPipelineColorBlendAttachmentState> attachments(options.color_formats.size(), written);
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = static_cast<std::uint32_t>(attachments.size());
    blend.pAttachments = attachments.data();

    const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{};
    dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
    dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
    dynamic.pDynamicStates = dynamic_states.data();

    VkPipelineRenderingCreateInfo rendering{};
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = static_cast<std::uint32_t>(options.color_formats.size());
    rendering.pColorAttachmentFormats = options.color_formats.data();
    rendering.depthAttachmentFormat = options.has_depth ? kDepthFormat : VK_FORMAT_UNDEFINED;

    VkGraphicsPipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.pNext = &rendering;
    stages.fill(info);
    info.pVertexInputState = &vertex_input.info;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = options.layout;
    VkPipeline pipeline{};
    check(vkCreateGraphicsPipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "creating a pipeline");
    return {device.get(), pipeline};
}

OwnedPipelineLayout make_layout(const Device& device, VkDescriptorSetLayout set, std::uint32_t push_constant_bytes) {
    const VkPushConstantRange push{VK_SHADER_STAGE_FRAGMENT_BIT, 0, push_constant_bytes};
    VkPipelineLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.setLayoutCount = 1;
    info.pSetLayouts = &set;
    info.pushConstantRangeCount = push_constant_bytes > 0 ? 1 : 0;
    info.pPushConstantRanges = &push;
    VkPipelineLayout layout{};
    check(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "creating a pipeline layout");
    return {device.get(), layout};
}

}  // namespace

VkFormat moment_vk_format(MomentFormat format) {
    switch (format) {
        case MomentFormat::Rg32f: return VK_FORMAT_R32G32_SFLOAT;
        case MomentFormat::Rg16f: return VK_FORMAT_R16G16_SFLOAT;
        case MomentFormat::Rg16Unorm: return VK_FORMAT_R16G16_UNORM;
        case MomentFormat::Rgba32f: return VK_FORMAT_R32G32B32A32_SFLOAT;
        case MomentFormat::Rgba16f: return VK_FORMAT_R16G16B16A16_SFLOAT;
    }
    return VK_FORMAT_UNDEFINED;
}

Pipelines make_pipelines(const Device& device, const SetLayouts& layouts, const TechniqueOptions& technique) {
    const MapKind map = map_kind(technique.technique);
    const bool has_moments = map_channels(map) >= 2;
    Pipelines pipelines{.scene_layout = make_layout(device, layouts.scene.get(), 0),
                        .blur_layout = make_layout(device, layouts.blur.get(), sizeof(BlurConstants))};

    constexpr std::array kReceiverFormats{kColorFormat, kVisibilityFormat};
    const std::int32_t taps = technique.technique == Technique::Pcf ? technique.taps : 1;
    const std::int32_t anisotropic = technique.max_anisotropy > 1 ? 1 : 0;
    pipelines.receiver = make_pipeline(device, {.layout = pipelines.scene_layout.get(),
                                                .shaders = receiver_shaders(map, taps),
                                                .constant_0 = has_moments ? anisotropic : taps,
                                                .color_formats = kReceiverFormats,
                                                .vertex_attributes = 2,
                                                .has_depth = true});
    if (map == MapKind::None) return pipelines;

    const std::array moment_format{moment_vk_format(technique.moment_format)};
    const std::span<const VkFormat> map_formats(moment_format.data(), has_moments ? 1u : 0u);
    pipelines.caster = make_pipeline(device, {.layout = pipelines.scene_layout.get(),
                                              .shaders = caster_shaders(map),
                                              .color_formats = map_formats,
                                              .vertex_attributes = 1,
                                              .has_depth = true,
                                              .depth_bias_constant = technique.depth_bias_constant,
                                              .depth_bias_slope = technique.depth_bias_slope});
    const auto blur_taps = static_cast<std::int32_t>(technique.blur_kernel.size());
    if (has_moments && blur_taps > 0)
        pipelines.blur = make_pipeline(device, {.layout = pipelines.blur_layout.get(),
                                                .shaders = blur_shaders(map, blur_taps),
                                                .constant_0 = blur_taps / 2,
                                                .color_formats = map_formats});
    return pipelines;
}

}  // namespace gnomon::peer
