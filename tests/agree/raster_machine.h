// One device's passes: what rastering.cpp (triangles) and raster_outputs.cpp (the output merger) share.
#pragma once

#include "tests/agree/raster_pipelines.h"
#include "tests/agree/rastering.h"

#include <functional>

namespace gnomon::agree {

inline constexpr int kMaxSize = 4096;  // of a target, within what every device allows. Vulkan 1.3 "Required Limits"

inline std::uint32_t u32(int value) { return static_cast<std::uint32_t>(value); }

VkRenderingAttachmentInfo attachment(const peer::Image& image, VkAttachmentLoadOp load, VkClearValue clear);

/// With a scissor that is `inset` pixels smaller on each side.
void set_viewport(VkCommandBuffer commands, const Viewport& viewport, int inset = 0);

struct Attachments {
    const VkRenderingAttachmentInfo* color = nullptr;
    const VkRenderingAttachmentInfo* depth = nullptr;
};
struct RasterPass {
    const peer::Image& target;
    Attachments attachments;
    VkDescriptorSet set;
};

struct RasterPeer::Machine {
    peer::Device device;
    RasterLayout layout;

    Machine(const peer::PeerDevice& description, const peer::PeerOptions& options);

    [[nodiscard]] bool has_format(VkFormat format, int samples, VkFormatFeatureFlags features, VkImageUsageFlags usage) const;

    /// What `draw` records, within one pass over all of the target.
    void record_pass(VkCommandBuffer commands, const RasterPass& pass, const std::function<void()>& draw) const;
    void push(VkCommandBuffer commands, const RasterConstants& constants) const;

    /// Every sample of an image that was used as `last`.
    [[nodiscard]] std::vector<std::byte> fetch(const peer::Image& image, peer::ImageUse last, FetchKind kind,
                                               int samples) const;
};

}  // namespace gnomon::agree
