// Checks, upload, samplers.
#include "tests/agree/vulkan_texture.h"

#include "tests/agree/names.h"
#include "tests/peer/result.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace gnomon::agree {
namespace {

constexpr peer::ImageUse kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                     VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr peer::ImageUse kSampledByCompute{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                           VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

std::uint32_t u32(int value) { return static_cast<std::uint32_t>(value); }

// Of optimally tiled images. The bits of Vulkan 1.3 hold more than those of 1.0: comparison is among them.
VkFormatFeatureFlags2 format_features(const peer::Device& device, TexelFormat format) {
    VkFormatProperties3 features{};
    features.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_3;
    VkFormatProperties2 properties{};
    properties.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2;
    properties.pNext = &features;
    vkGetPhysicalDeviceFormatProperties2(device.physical(), vk_format(format), &properties);
    return features.optimalTilingFeatures | properties.formatProperties.optimalTilingFeatures;
}

VkFilter vk_filter(Filter filter) { return filter == Filter::Linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST; }

VkSamplerAddressMode vk_address(Address address) {
    switch (address) {
        case Address::Wrap: return VK_SAMPLER_ADDRESS_MODE_REPEAT;
        case Address::Mirror: return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case Address::Clamp: return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        case Address::Border: return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
        case Address::MirrorOnce: return VK_SAMPLER_ADDRESS_MODE_MIRROR_CLAMP_TO_EDGE;
    }
    fail("unknown addressing mode");
}

VkCompareOp vk_compare(Compare compare) {
    switch (compare) {
        case Compare::None:
        case Compare::Never: return VK_COMPARE_OP_NEVER;
        case Compare::Less: return VK_COMPARE_OP_LESS;
        case Compare::Equal: return VK_COMPARE_OP_EQUAL;
        case Compare::LessEqual: return VK_COMPARE_OP_LESS_OR_EQUAL;
        case Compare::Greater: return VK_COMPARE_OP_GREATER;
        case Compare::NotEqual: return VK_COMPARE_OP_NOT_EQUAL;
        case Compare::GreaterEqual: return VK_COMPARE_OP_GREATER_OR_EQUAL;
        case Compare::Always: return VK_COMPARE_OP_ALWAYS;
    }
    fail("unknown comparison");
}

VkBorderColor vk_border(int border) {
    if (border == 2) return VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE;
    return border == 1 ? VK_BORDER_COLOR_FLOAT_OPAQUE_BLACK : VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK;
}

peer::OwnedSampler make_sampler(const peer::Device& device, const SamplerState& sampler) {
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    info.magFilter = vk_filter(sampler.mag);
    info.minFilter = vk_filter(sampler.min);
    info.mipmapMode = sampler.mip == Mip::Linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.addressModeU = vk_address(sampler.address_u);
    info.addressModeV = vk_address(sampler.address_v);
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.mipLodBias = sampler.lod_bias;
    info.anisotropyEnable = sampler.max_anisotropy > 1 ? VK_TRUE : VK_FALSE;
    info.maxAnisotropy = sampler.max_anisotropy;
    info.compareEnable = sampler.compare != Compare::None ? VK_TRUE : VK_FALSE;
    info.compareOp = vk_compare(sampler.compare);
    info.minLod = sampler.min_lod;
    info.maxLod = sampler.max_lod;
    info.borderColor = vk_border(sampler.border);
    VkSampler created{};
    peer::check(vkCreateSampler(device.get(), &info, nullptr, &created), "creating a sampler");
    return {device.get(), created};
}

// All levels in one buffer, one after the other: every level's bytes are a multiple of the texel's, as copies want.
void upload(const peer::Device& device, const Levels& texture, const peer::Image& image) {
    std::vector<std::byte> bytes;
    std::vector<VkBufferImageCopy> copies;
    for (int level = 0; level < static_cast<int>(texture.levels.size()); ++level) {
        const std::vector<std::byte>& source = texture.levels[static_cast<std::size_t>(level)];
        VkBufferImageCopy& copy = copies.emplace_back();
        copy.bufferOffset = bytes.size();
        copy.imageSubresource = {peer::image_aspect(image.format), u32(level), 0, 1};
        copy.imageExtent = {u32(level_size(texture.width, level)), u32(level_size(texture.height, level)), 1};
        bytes.insert(bytes.end(), source.begin(), source.end());
    }
    const peer::Buffer staging = peer::host_buffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(commands, {{image, peer::kDiscarded, kCopyTarget}});
        vkCmdCopyBufferToImage(commands, staging.buffer.get(), image.image.get(), kCopyTarget.layout, u32(int(copies.size())),
                               copies.data());
        peer::record_transitions(commands, {{image, kCopyTarget, kSampledByCompute}});
    }));
}

}  // namespace

VkFormat vk_format(TexelFormat format) {
    switch (format) {
        case TexelFormat::R32f: return VK_FORMAT_R32_SFLOAT;
        case TexelFormat::Rg32f: return VK_FORMAT_R32G32_SFLOAT;
        case TexelFormat::Rg16f: return VK_FORMAT_R16G16_SFLOAT;
        case TexelFormat::Rgba8: return VK_FORMAT_R8G8B8A8_UNORM;
        case TexelFormat::Rg16Unorm: return VK_FORMAT_R16G16_UNORM;
        case TexelFormat::D32f: return VK_FORMAT_D32_SFLOAT;
    }
    fail("unknown texel format");
}

void check_levels(const Levels& texture) {
    const int width = texture.width;
    const int height = texture.height;
    if (width < 1 || height < 1) fail("a texture of {}x{} texels; expected at least 1x1", width, height);
    const std::size_t count = texture.levels.size();
    if (count < 1 || count > static_cast<std::size_t>(full_levels(width, height)))
        fail("{} levels of a {}x{} texture; expected 1 to {}", count, width, height, full_levels(width, height));
    for (int level = 0; level < static_cast<int>(count); ++level) {
        const std::size_t texels = std::size_t{u32(level_size(width, level))} * u32(level_size(height, level));
        const std::vector<std::byte>& bytes = texture.levels[static_cast<std::size_t>(level)];
        const std::size_t expected = texels * texel_bytes(texture.format);
        if (bytes.size() != expected) fail("level {} has {} bytes; expected {}", level, bytes.size(), expected);
        if (texture.format != TexelFormat::D32f) continue;
        for (std::size_t texel = 0; texel < texels; ++texel) {
            float depth = 0;
            std::memcpy(&depth, bytes.data() + texel * sizeof(depth), sizeof(depth));
            if (!(depth >= 0 && depth <= 1)) fail("level {}, texel {}: depth {}; expected 0 to 1", level, texel, depth);
        }
    }
}

void check_sampler(const SamplerState& sampler) {
    if (!std::isfinite(sampler.lod_bias)) fail("a LOD bias of {}; expected a number", sampler.lod_bias);
    if (!(sampler.min_lod <= sampler.max_lod) || !std::isfinite(sampler.min_lod) || !std::isfinite(sampler.max_lod))
        fail("LOD from {} to {}; expected a range", sampler.min_lod, sampler.max_lod);
    if (!(sampler.max_anisotropy >= 1)) fail("anisotropy {}; expected 1 or more", sampler.max_anisotropy);
    if (sampler.border < 0 || sampler.border > 2) fail("border colour {}; expected 0, 1 or 2", sampler.border);
}

std::string unsupported_because(const peer::Device& device, const Levels& texture, const SamplerState& sampler) {
    const std::string_view format = name_of(texture.format);
    const VkFormatFeatureFlags2 features = format_features(device, texture.format);
    if ((features & VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_BIT) == 0) return fmt::format("{} cannot be sampled", format);
    if ((features & VK_FORMAT_FEATURE_2_TRANSFER_DST_BIT) == 0) return fmt::format("{} cannot be copied to", format);

    // A comparing sampler may be linear whether or not the format's values can be filtered.
    // Vulkan 1.3 VUID-vkCmdDispatch-magFilter-04553, VUID-vkCmdDispatch-mipmapMode-04770, VUID-vkCmdDispatch-None-06479
    const bool compares = sampler.compare != Compare::None;
    const bool linear = sampler.min == Filter::Linear || sampler.mag == Filter::Linear || sampler.mip == Mip::Linear;
    if (compares && (features & VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_DEPTH_COMPARISON_BIT) == 0)
        return fmt::format("{} cannot be compared", format);
    if (!compares && linear && (features & VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_FILTER_LINEAR_BIT) == 0)
        return fmt::format("{} cannot be filtered", format);

    const bool mirrors_once = sampler.address_u == Address::MirrorOnce || sampler.address_v == Address::MirrorOnce;
    if (mirrors_once && !device.mirrors_once()) return "no addressing mode mirror-once";
    const float max_anisotropy = device.description().limits.max_anisotropy;
    if (sampler.max_anisotropy > max_anisotropy)
        return fmt::format("anisotropy goes up to {}, not {}", max_anisotropy, sampler.max_anisotropy);
    const float max_bias = device.limits().maxSamplerLodBias;
    if (std::abs(sampler.lod_bias) > max_bias) return fmt::format("LOD bias goes up to {}, not {}", max_bias, sampler.lod_bias);
    const std::uint32_t max_size = device.limits().maxImageDimension2D;
    if (u32(std::max(texture.width, texture.height)) > max_size) return fmt::format("images go up to {} texels", max_size);
    return {};
}

Texture make_texture(const peer::Device& device, const Levels& levels, const SamplerState& sampler) {
    Texture texture;
    texture.image = peer::make_image(device, {.format = vk_format(levels.format),
                                              .size = {u32(levels.width), u32(levels.height)},
                                              .levels = u32(int(levels.levels.size())),
                                              .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
    upload(device, levels, texture.image);
    texture.sampler = make_sampler(device, sampler);
    texture.view = sampler.mip == Mip::Base ? texture.image.level_0.get() : texture.image.all_levels.get();
    return texture;
}

}  // namespace gnomon::agree
