// Passes over a target, and every sample of an image.
#include "tests/agree/raster_machine.h"

#include "tests/peer/result.h"

namespace gnomon::agree {
namespace {

constexpr std::uint32_t kLocalSize = 64;  // of fetch.comp

constexpr peer::ImageUse kFetched{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

void begin_rendering(VkCommandBuffer commands, VkExtent2D size, const Attachments& attachments) {
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea.extent = size;
    info.layerCount = 1;
    info.colorAttachmentCount = attachments.color != nullptr ? 1 : 0;
    info.pColorAttachments = attachments.color;
    info.pDepthAttachment = attachments.depth;
    vkCmdBeginRendering(commands, &info);
}

Viewport whole(VkExtent2D size) { return {0, 0, static_cast<int>(size.width), static_cast<int>(size.height)}; }

void record_to_host(VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

VkRenderingAttachmentInfo attachment(const peer::Image& image, VkAttachmentLoadOp load, VkClearValue clear) {
    VkRenderingAttachmentInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    info.imageView = image.level_0.get();
    info.imageLayout = peer::image_aspect(image.format) == VK_IMAGE_ASPECT_DEPTH_BIT ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL
                                                                                     : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    info.loadOp = load;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = clear;
    return info;
}

void set_viewport(VkCommandBuffer commands, const Viewport& viewport, int inset) {
    const VkViewport mapped{static_cast<float>(viewport.x),
                            static_cast<float>(viewport.y),
                            static_cast<float>(viewport.width),
                            static_cast<float>(viewport.height),
                            0,
                            1};
    const VkRect2D scissor{{viewport.x + inset, viewport.y + inset},
                           {u32(viewport.width - 2 * inset), u32(viewport.height - 2 * inset)}};
    vkCmdSetViewport(commands, 0, 1, &mapped);
    vkCmdSetScissor(commands, 0, 1, &scissor);
}

RasterPeer::Machine::Machine(const peer::PeerDevice& description, const peer::PeerOptions& options)
    : device(description, options), layout(device) {}

bool RasterPeer::Machine::has_format(VkFormat format, int samples, VkFormatFeatureFlags features,
                                     VkImageUsageFlags usage) const {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
    if ((properties.optimalTilingFeatures & features) != features) return false;
    VkImageFormatProperties image{};
    const VkResult result = vkGetPhysicalDeviceImageFormatProperties(device.physical(), format, VK_IMAGE_TYPE_2D,
                                                                     VK_IMAGE_TILING_OPTIMAL, usage, 0, &image);
    return result == VK_SUCCESS && (image.sampleCounts & u32(samples)) != 0;
}

void RasterPeer::Machine::record_pass(VkCommandBuffer commands, const RasterPass& pass,
                                      const std::function<void()>& draw) const {
    begin_rendering(commands, pass.target.size, pass.attachments);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout.pipeline.get(), 0, 1, &pass.set, 0, nullptr);
    set_viewport(commands, whole(pass.target.size));
    draw();
    vkCmdEndRendering(commands);
}

void RasterPeer::Machine::push(VkCommandBuffer commands, const RasterConstants& constants) const {
    vkCmdPushConstants(commands, layout.pipeline.get(), VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT, 0,
                       sizeof(constants), &constants);
}

std::vector<std::byte> RasterPeer::Machine::fetch(const peer::Image& image, peer::ImageUse last, FetchKind kind,
                                                  int samples) const {
    const std::uint32_t pixels = image.size.width * image.size.height;
    const std::size_t bytes = std::size_t{pixels} * (kind == FetchKind::Masks ? 4 : 16 * u32(samples));
    const peer::Buffer fetched = peer::readback_buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const RasterSet set = make_raster_set(device, layout, {.output = fetched.buffer.get(), .image = image.level_0.get()});
    const peer::OwnedPipeline pipeline = make_fetch_pipeline(device, layout, kind, samples);
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(commands, {{image, last, kFetched}});
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout.pipeline.get(), 0, 1, &set.set, 0, nullptr);
        push(commands, {image.size.width, pixels});
        vkCmdDispatch(commands, (pixels + kLocalSize - 1) / kLocalSize, 1, 1);
        record_to_host(commands);
    }));
    return peer::read_buffer(device, fetched);
}

}  // namespace gnomon::agree
