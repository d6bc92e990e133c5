// What a frame is made of, and the recording of its passes.
#include "tests/peer/passes.h"

#include "sim/scalar_math.h"

#include <algorithm>
#include <map>
#include <span>

namespace gnomon::peer {
namespace {

// As a pass renders to it.
ImageUse as_target(const Image& image) { return image.format == kDepthFormat ? kDepthTarget : kColorTarget; }

VkRenderingAttachmentInfo cleared(const Image& image, VkClearValue value) {
    VkRenderingAttachmentInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    info.imageView = image.level_0.get();
    info.imageLayout = as_target(image).layout;
    info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = value;
    return info;
}

VkClearValue clear_color(glm::vec4 c) { return {.color = {.float32 = {c.r, c.g, c.b, c.a}}}; }
constexpr VkClearValue kClearDepth{.depthStencil = {1.0f, 0}};

// Viewport and scissor of the whole target, y up in clip space as in D3D11.3 15.6: hence the negative height.
void set_viewport(VkCommandBuffer commands, VkExtent2D size) {
    const auto width = static_cast<float>(size.width);
    const auto height = static_cast<float>(size.height);
    const VkViewport viewport{0, height, width, -height, 0, 1};
    const VkRect2D scissor{{0, 0}, size};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &scissor);
}

void begin_rendering(VkCommandBuffer commands, VkExtent2D size, std::span<const VkRenderingAttachmentInfo> colors,
                     const VkRenderingAttachmentInfo* depth) {
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea = {{0, 0}, size};
    info.layerCount = 1;
    info.colorAttachmentCount = static_cast<std::uint32_t>(colors.size());
    info.pColorAttachments = colors.data();
    info.pDepthAttachment = depth;
    vkCmdBeginRendering(commands, &info);
    set_viewport(commands, size);
}

void draw_scene(VkCommandBuffer commands, const PassInputs& in, VkPipeline pipeline) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    const VkBuffer vertices = in.geometry.vertices.buffer.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices, &offset);
    vkCmdBindIndexBuffer(commands, in.geometry.indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
    std::uint32_t uniform_offset = 0;
    for (const DrawRange& draw : in.geometry.draws) {
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, in.pipelines.scene_layout.get(), 0, 1,
                                &in.sets.scene, 1, &uniform_offset);
        vkCmdDrawIndexed(commands, draw.index_count, 1, draw.first_index, draw.first_vertex, 0);
        uniform_offset += in.uniforms.draw_stride;
    }
}

// Nothing there is as far as can be: the moments of depth 1, which is x = 1 for the warps.
glm::vec4 empty_moments(const TechniqueOptions& technique) {
    if (map_kind(technique.technique) != MapKind::WarpedMoments) return glm::vec4(1);
    const double positive = scalar::exp(static_cast<double>(technique.positive_exponent));
    const double negative = -scalar::exp(-static_cast<double>(technique.negative_exponent));
    return glm::dvec4(positive, positive * positive, negative, negative * negative);
}

// Depth alone, or depth and moments.
void record_light_pass(VkCommandBuffer commands, const PassInputs& in) {
    const Image& map = in.targets.map;
    if (map.format == kDepthFormat) {
        const VkRenderingAttachmentInfo depth = cleared(map, kClearDepth);
        begin_rendering(commands, map.size, {}, &depth);
    } else {
        const std::array colors{cleared(map, clear_color(empty_moments(in.frame.technique)))};
        const VkRenderingAttachmentInfo depth = cleared(in.targets.map_depth, kClearDepth);
        begin_rendering(commands, map.size, colors, &depth);
    }
    draw_scene(commands, in, in.pipelines.caster.get());
    vkCmdEndRendering(commands);
}

struct BlurStep {
    const Image& to;
    VkDescriptorSet from;
    glm::ivec2 step_texels;
};

void record_blur_step(VkCommandBuffer commands, const PassInputs& in, const BlurStep& step) {
    VkRenderingAttachmentInfo color = cleared(step.to, {});
    color.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    begin_rendering(commands, step.to.size, {&color, 1}, nullptr);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, in.pipelines.blur.get());
    const VkPipelineLayout layout = in.pipelines.blur_layout.get();
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &step.from, 0, nullptr);

    BlurConstants constants{.step_texels = step.step_texels};
    const std::vector<float>& kernel = in.frame.technique.blur_kernel;
    std::copy(kernel.begin() + static_cast<std::ptrdiff_t>(kernel.size() / 2), kernel.end(), constants.weights.begin());
    vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(constants), &constants);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
}

// Map to temporary horizontally, and back vertically. The map comes and goes as a colour target.
void record_blur(VkCommandBuffer commands, const PassInputs& in) {
    const Image& map = in.targets.map;
    const Image& temp = in.targets.blur_temp;
    record_transitions(commands, {{map, kColorTarget, kSampled, 0, 1}});
    record_blur_step(commands, in, {temp, in.sets.blur_map, {1, 0}});
    record_transitions(commands, {{temp, kColorTarget, kSampled}, {map, kSampled, kColorTarget, 0, 1}});
    record_blur_step(commands, in, {map, in.sets.blur_temp, {0, 1}});
}

// Each level from the one above it by a linear blit. Level 0 comes as a colour target; all levels leave sampled.
void record_mips(VkCommandBuffer commands, const Image& map) {
    const auto extent = [&map](std::uint32_t level) {
        return VkOffset3D{std::max(static_cast<std::int32_t>(map.size.width >> level), 1),
                          std::max(static_cast<std::int32_t>(map.size.height >> level), 1), 1};
    };
    record_transitions(commands, {{map, kColorTarget, kBlitSource, 0, 1}, {map, kDiscarded, kBlitTarget, 1, map.levels - 1}});
    for (std::uint32_t level = 1; level < map.levels; ++level) {
        VkImageBlit blit{};
        blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1};
        blit.srcOffsets[1] = extent(level - 1);
        blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
        blit.dstOffsets[1] = extent(level);
        vkCmdBlitImage(commands, map.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, map.image.get(),
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
        record_transitions(commands, {{map, kBlitTarget, kBlitSource, level, 1}});
    }
    record_transitions(commands, {{map, kBlitSource, kSampled}});
}

void record_map(VkCommandBuffer commands, const PassInputs& in) {
    const Image& map = in.targets.map;
    record_light_pass(commands, in);
    if (in.pipelines.blur) record_blur(commands, in);
    if (map.levels > 1)
        record_mips(commands, map);
    else
        record_transitions(commands, {{map, as_target(map), kSampled}});
}

void record_camera_pass(VkCommandBuffer commands, const PassInputs& in) {
    const Targets& targets = in.targets;
    const std::array colors{cleared(targets.color, clear_color(in.frame.background)),
                            cleared(targets.visibility, clear_color(glm::vec4(kNoSurface)))};
    const VkRenderingAttachmentInfo depth = cleared(targets.depth, kClearDepth);
    begin_rendering(commands, targets.color.size, colors, &depth);
    draw_scene(commands, in, in.pipelines.receiver.get());
    vkCmdEndRendering(commands);
}

void require_moment_format(const Device& device, const TechniqueOptions& technique) {
    VkFormatFeatureFlags features = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT;
    if (technique.filter != MapFilter::Nearest) features |= VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    if (technique.filter == MapFilter::Trilinear) features |= VK_FORMAT_FEATURE_BLIT_SRC_BIT | VK_FORMAT_FEATURE_BLIT_DST_BIT;
    device.require_format(moment_vk_format(technique.moment_format), features, "moment format");
}

// The map, and what goes with it.
void add_map_targets(const Device& device, const TechniqueOptions& technique, Targets& targets) {
    const VkExtent2D size{technique.map_size, technique.map_size};
    if (map_kind(technique.technique) == MapKind::Depth) {
        // A comparing sampler may be linear whether or not the format's values can be filtered.
        // Vulkan 1.3 VUID-vkCmdDraw-magFilter-04553
        device.require_format(kDepthFormat,
                              VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT, "d32f map");
        targets.map = make_image(device, {.format = kDepthFormat,
                                          .size = size,
                                          .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                                   VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
        return;
    }
    require_moment_format(device, technique);
    const VkFormat format = moment_vk_format(technique.moment_format);
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    targets.map =
        make_image(device, {.format = format,
                            .size = size,
                            .levels = technique.filter == MapFilter::Trilinear ? full_mip_levels(technique.map_size) : 1,
                            .usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    targets.map_depth =
        make_image(device, {.format = kDepthFormat, .size = size, .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
    if (!technique.blur_kernel.empty())
        targets.blur_temp = make_image(device, {.format = format, .size = size, .usage = usage});
}

}  // namespace

Geometry make_geometry(const Device& device, const Frame& frame) {
    // Meshes one after the other, each once however many draws share it.
    std::vector<scenes::Vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::map<const scenes::Mesh*, DrawRange> placed;
    Geometry geometry;
    for (const Draw& draw : frame.draws) {
        const scenes::Mesh& mesh = *draw.mesh;
        const DrawRange next{static_cast<std::uint32_t>(mesh.indices.size()), static_cast<std::uint32_t>(indices.size()),
                             static_cast<std::int32_t>(vertices.size())};
        const auto [place, is_new] = placed.emplace(&mesh, next);
        if (is_new) {
            vertices.insert(vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
            indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        }
        geometry.draws.push_back(place->second);
    }
    geometry.vertices = device_buffer(device, std::as_bytes(std::span(vertices)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    geometry.indices = device_buffer(device, std::as_bytes(std::span(indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    return geometry;
}

Targets make_targets(const Device& device, const Frame& frame) {
    const VkExtent2D size{frame.width, frame.height};
    const VkImageUsageFlags read_back = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const VkImageUsageFlags color_usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | read_back;
    const VkImageUsageFlags depth_usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | read_back;
    Targets targets;
    targets.color = make_image(device, {.format = kColorFormat, .size = size, .usage = color_usage});
    targets.visibility = make_image(device, {.format = kVisibilityFormat, .size = size, .usage = color_usage});
    targets.depth = make_image(device, {.format = kDepthFormat, .size = size, .usage = depth_usage});
    if (map_kind(frame.technique.technique) != MapKind::None) add_map_targets(device, frame.technique, targets);
    return targets;
}

void record_frame(VkCommandBuffer commands, const PassInputs& in) {
    // Images keep nothing from frame to frame: all start out discarded.
    const Targets& targets = in.targets;
    record_transitions(commands, {{targets.color, kDiscarded, kColorTarget},
                                  {targets.visibility, kDiscarded, kColorTarget},
                                  {targets.depth, kDiscarded, kDepthTarget},
                                  {targets.map, kDiscarded, as_target(targets.map), 0, 1},
                                  {targets.map_depth, kDiscarded, kDepthTarget},
                                  {targets.blur_temp, kDiscarded, kColorTarget}});
    if (in.pipelines.caster) record_map(commands, in);
    record_camera_pass(commands, in);
}

}  // namespace gnomon::peer
