// Buffers, images, memory, and the moves between them and the host.
#pragma once

#include "tests/peer/device.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace gnomon::peer {

/// A buffer with its memory.
struct Buffer {
    OwnedMemory memory;  // declared first: outlives what is bound to it
    OwnedBuffer buffer;
    VkDeviceSize bytes = 0;
};

/// A 2D image with its memory, a view of all levels for sampling and one of level 0 for rendering.
struct Image {
    OwnedMemory memory;
    OwnedImage image;
    OwnedImageView all_levels;
    OwnedImageView level_0;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D size{};
    std::uint32_t levels = 1;
};

struct ImageOptions {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D size{};
    std::uint32_t levels = 1;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

/// One way an image is used: what must wait, what must be made visible, and the layout for it.
struct ImageUse {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
    VkAccessFlags2 access = VK_ACCESS_2_NONE;
};
inline constexpr ImageUse kDiscarded{};  // what was there does not matter; the queue was idle
inline constexpr ImageUse kColorTarget{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                       VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                       VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT};
inline constexpr ImageUse kDepthTarget{
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse kSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
inline constexpr ImageUse kBlitSource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_BLIT_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr ImageUse kBlitTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_BLIT_BIT,
                                      VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr ImageUse kCopySource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT};

/// Depth or colour, by the format.
VkImageAspectFlags image_aspect(VkFormat format);

/// Levels of a full mip chain.
std::uint32_t full_mip_levels(std::uint32_t size);

/// A host-visible buffer that holds `data`.
Buffer host_buffer(const Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage);

/// A buffer in the device's own memory that holds `data`, copied there.
Buffer device_buffer(const Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage);

Image make_image(const Device& device, const ImageOptions& options);

/// Makes levels [first_level, first_level + level_count) of an image ready for `to` once `from` is done.
struct Transition {
    const Image& image;
    ImageUse from;
    ImageUse to;
    std::uint32_t first_level = 0;
    std::uint32_t level_count = VK_REMAINING_MIP_LEVELS;
};
/// All of them by one barrier, for llvmpipe drains its pipeline at each; images that do not exist are left out.
void record_transitions(VkCommandBuffer commands, std::initializer_list<Transition> transitions);

/// The bytes of a texel as copies to and from buffers have it, of the formats that are rendered to here.
std::size_t texel_bytes(VkFormat format);

/// A buffer with nothing in it, for the device to write and the host to read.
Buffer readback_buffer(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage);
/// What is in a host-visible buffer.
std::vector<std::byte> read_buffer(const Device& device, const Buffer& buffer);

/// Level 0 as tightly packed rows of texels; `last` is the image's last use, which it returns to.
std::vector<std::byte> read_image(const Device& device, const Image& image, ImageUse last);

}  // namespace gnomon::peer
