// Allocation is one memory object per resource: a frame has about ten of them.
#include "tests/peer/resources.h"

#include "sim/error.h"
#include "tests/peer/result.h"

#include <bit>
#include <cstring>

namespace gnomon::peer {
namespace {

std::uint32_t memory_type(const Device& device, std::uint32_t allowed_types, VkMemoryPropertyFlags wanted) {
    VkPhysicalDeviceMemoryProperties properties{};
    vkGetPhysicalDeviceMemoryProperties(device.physical(), &properties);
    for (std::uint32_t type = 0; type < properties.memoryTypeCount; ++type) {
        const bool is_allowed = (allowed_types >> type & 1u) != 0;
        if (is_allowed && (properties.memoryTypes[type].propertyFlags & wanted) == wanted) return type;
    }
    fail("device '{}' has no memory with properties {:#x}", device.description().name, wanted);
}

OwnedMemory allocate(const Device& device, const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) {
    VkMemoryAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.allocationSize = needs.size;
    info.memoryTypeIndex = memory_type(device, needs.memoryTypeBits, wanted);
    VkDeviceMemory memory{};
    check(vkAllocateMemory(device.get(), &info, nullptr, &memory), "allocating memory");
    return {device.get(), memory};
}

Buffer make_buffer(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, VkMemoryPropertyFlags wanted) {
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes;
    info.usage = usage;
    VkBuffer handle{};
    check(vkCreateBuffer(device.get(), &info, nullptr, &handle), "creating a buffer");
    Buffer buffer{{}, {device.get(), handle}, bytes};

    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device.get(), handle, &needs);
    buffer.memory = allocate(device, needs, wanted);
    check(vkBindBufferMemory(device.get(), handle, buffer.memory.get(), 0), "binding a buffer");
    return buffer;
}

constexpr VkMemoryPropertyFlags kHostMemory = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

OwnedImageView make_view(const Device& device, const Image& image, std::uint32_t levels) {
    VkImageViewCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    info.image = image.image.get();
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = image.format;
    info.subresourceRange = {image_aspect(image.format), 0, levels, 0, 1};
    VkImageView view{};
    check(vkCreateImageView(device.get(), &info, nullptr, &view), "creating an image view");
    return {device.get(), view};
}

}  // namespace

VkImageAspectFlags image_aspect(VkFormat format) {
    const bool is_depth =
        format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_X8_D24_UNORM_PACK32;
    return is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

std::size_t texel_bytes(VkFormat format) {
    if (format == VK_FORMAT_D16_UNORM) return 2;
    if (format == VK_FORMAT_R32G32B32A32_SFLOAT) return 16;
    const bool is_64_bits =
        format == VK_FORMAT_R32G32_SFLOAT || format == VK_FORMAT_R16G16B16A16_UNORM || format == VK_FORMAT_R16G16B16A16_SFLOAT;
    return is_64_bits ? 8 : 4;
}

std::uint32_t full_mip_levels(std::uint32_t size) { return static_cast<std::uint32_t>(std::bit_width(size)); }

Buffer host_buffer(const Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage) {
    Buffer buffer = make_buffer(device, data.size(), usage, kHostMemory);
    void* mapped = nullptr;
    check(vkMapMemory(device.get(), buffer.memory.get(), 0, VK_WHOLE_SIZE, 0, &mapped), "mapping a buffer");
    std::memcpy(mapped, data.data(), data.size());
    vkUnmapMemory(device.get(), buffer.memory.get());
    return buffer;
}

Buffer device_buffer(const Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage) {
    const Buffer staging = host_buffer(device, data, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    Buffer buffer =
        make_buffer(device, data.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    device.run(device.record([&](VkCommandBuffer commands) {
        const VkBufferCopy whole{0, 0, data.size()};
        vkCmdCopyBuffer(commands, staging.buffer.get(), buffer.buffer.get(), 1, &whole);
    }));
    return buffer;
}

Image make_image(const Device& device, const ImageOptions& options) {
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = options.format;
    info.extent = {options.size.width, options.size.height, 1};
    info.mipLevels = options.levels;
    info.arrayLayers = 1;
    info.samples = options.samples;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = options.usage;
    VkImage handle{};
    check(vkCreateImage(device.get(), &info, nullptr, &handle), "creating an image");
    Image image;
    image.image = OwnedImage(device.get(), handle);
    image.format = options.format;
    image.size = options.size;
    image.levels = options.levels;

    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device.get(), handle, &needs);
    image.memory = allocate(device, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    check(vkBindImageMemory(device.get(), handle, image.memory.get(), 0), "binding an image");
    image.all_levels = make_view(device, image, options.levels);
    image.level_0 = make_view(device, image, 1);
    return image;
}

void record_transitions(VkCommandBuffer commands, std::initializer_list<Transition> transitions) {
    std::vector<VkImageMemoryBarrier2> barriers;
    for (const Transition& t : transitions) {
        if (!t.image.image) continue;
        VkImageMemoryBarrier2& barrier = barriers.emplace_back();
        barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
        barrier.srcStageMask = t.from.stages;
        barrier.srcAccessMask = t.from.access;
        barrier.dstStageMask = t.to.stages;
        barrier.dstAccessMask = t.to.access;
        barrier.oldLayout = t.from.layout;
        barrier.newLayout = t.to.layout;
        barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = t.image.image.get();
        barrier.subresourceRange = {image_aspect(t.image.format), t.first_level, t.level_count, 0, 1};
    }
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.imageMemoryBarrierCount = static_cast<std::uint32_t>(barriers.size());
    dependency.pImageMemoryBarriers = barriers.data();
    vkCmdPipelineBarrier2(commands, &dependency);
}

Buffer readback_buffer(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage) {
    return make_buffer(device, bytes, usage, kHostMemory);
}

std::vector<std::byte> read_buffer(const Device& device, const Buffer& buffer) {
    std::vector<std::byte> data(buffer.bytes);
    void* mapped = nullptr;
    check(vkMapMemory(device.get(), buffer.memory.get(), 0, VK_WHOLE_SIZE, 0, &mapped), "mapping a buffer");
    std::memcpy(data.data(), mapped, data.size());
    vkUnmapMemory(device.get(), buffer.memory.get());
    return data;
}

std::vector<std::byte> read_image(const Device& device, const Image& image, ImageUse last) {
    const std::size_t bytes = texel_bytes(image.format) * image.size.width * image.size.height;
    const Buffer staging = readback_buffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    device.run(device.record([&](VkCommandBuffer commands) {
        record_transitions(commands, {{image, last, kCopySource}});
        VkBufferImageCopy copy{};
        copy.imageSubresource = {image_aspect(image.format), 0, 0, 1};
        copy.imageExtent = {image.size.width, image.size.height, 1};
        vkCmdCopyImageToBuffer(commands, image.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.buffer.get(), 1,
                               &copy);
        record_transitions(commands, {{image, kCopySource, last}});

        // What the device wrote becomes visible to the host.
        VkMemoryBarrier2 to_host{};
        to_host.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
        to_host.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
        to_host.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
        to_host.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
        to_host.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
        VkDependencyInfo dependency{};
        dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
        dependency.memoryBarrierCount = 1;
        dependency.pMemoryBarriers = &to_host;
        vkCmdPipelineBarrier2(commands, &dependency);
    }));

    return read_buffer(device, staging);
}

}  // namespace gnomon::peer
