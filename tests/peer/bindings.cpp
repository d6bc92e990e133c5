// Descriptor sets and samplers.
#include "tests/peer/bindings.h"

#include "tests/peer/result.h"
#include "tests/peer/uniforms.h"

#include <array>
#include <cstring>

namespace gnomon::peer {
namespace {

constexpr VkShaderStageFlags kBothStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

OwnedSetLayout make_set_layout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings) {
    VkDescriptorSetLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = static_cast<std::uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    VkDescriptorSetLayout layout{};
    check(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout), "creating a descriptor set layout");
    return {device.get(), layout};
}

VkDescriptorSet allocate_set(const Device& device, VkDescriptorPool pool, VkDescriptorSetLayout layout) {
    VkDescriptorSetAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    info.descriptorPool = pool;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    VkDescriptorSet set{};
    check(vkAllocateDescriptorSets(device.get(), &info, &set), "allocating a descriptor set");
    return set;
}

OwnedSampler make_sampler(const Device& device, const VkSamplerCreateInfo& info) {
    VkSampler sampler{};
    check(vkCreateSampler(device.get(), &info, nullptr, &sampler), "creating a sampler");
    return {device.get(), sampler};
}

void bind_buffer(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkDescriptorType type,
                 const VkDescriptorBufferInfo& buffer) {
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = type;
    write.pBufferInfo = &buffer;
    vkUpdateDescriptorSets(device.get(), 1, &write, 0, nullptr);
}

}  // namespace

SetLayouts make_set_layouts(const Device& device, bool has_map) {
    // A binding that is never written is legal but ends lavapipe 22.3, so without a map there is none.
    const std::array<VkDescriptorSetLayoutBinding, 3> scene{{
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1, kBothStages, nullptr},
        {1, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, kBothStages, nullptr},
        {2, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
    }};
    const std::array<VkDescriptorSetLayoutBinding, 1> blur{{
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
    }};
    return {make_set_layout(device, std::span(scene).first(has_map ? 3 : 2)), make_set_layout(device, blur)};
}

UniformBuffers make_uniform_buffers(const Device& device, const Frame& frame) {
    // Dynamic offsets are multiples of the device's alignment, a power of two.
    const std::size_t alignment = static_cast<std::size_t>(device.limits().minUniformBufferOffsetAlignment);
    const std::size_t stride = (sizeof(DrawBlock) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> draws(stride * frame.draws.size());
    for (std::size_t i = 0; i < frame.draws.size(); ++i) {
        const DrawBlock block = draw_block(frame, frame.draws[i]);
        std::memcpy(draws.data() + i * stride, &block, sizeof(block));
    }
    const FrameBlock block = frame_block(frame);
    return {
        .draws = host_buffer(device, draws, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT),
        .frame = host_buffer(device, std::as_bytes(std::span(&block, 1)), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT),
        .draw_stride = static_cast<std::uint32_t>(stride),
    };
}

OwnedSampler make_map_sampler(const Device& device, const TechniqueOptions& technique) {
    const bool compares = map_kind(technique.technique) == MapKind::Depth;
    const bool linear = technique.filter != MapFilter::Nearest && technique.technique != Technique::ShadowMap;
    const VkFilter filter = linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    info.magFilter = filter;
    info.minFilter = filter;
    info.mipmapMode = technique.filter == MapFilter::Trilinear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.maxLod = technique.filter == MapFilter::Trilinear ? VK_LOD_CLAMP_NONE : 0.0f;
    info.addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.compareEnable = compares ? VK_TRUE : VK_FALSE;
    info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;

    check_anisotropy(device.description(), technique.max_anisotropy);
    info.anisotropyEnable = technique.max_anisotropy > 1 ? VK_TRUE : VK_FALSE;
    info.maxAnisotropy = technique.max_anisotropy;
    return make_sampler(device, info);
}

OwnedSampler make_fetch_sampler(const Device& device) {
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    return make_sampler(device, info);
}

Sets make_sets(const Device& device, const SetLayouts& layouts) {
    const std::array<VkDescriptorPoolSize, 3> sizes{{
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1},
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3},
    }};
    VkDescriptorPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = 3;
    info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
    info.pPoolSizes = sizes.data();
    VkDescriptorPool pool{};
    check(vkCreateDescriptorPool(device.get(), &info, nullptr, &pool), "creating a descriptor pool");
    return {
        .pool = OwnedDescriptorPool(device.get(), pool),
        .scene = allocate_set(device, pool, layouts.scene.get()),
        .blur_map = allocate_set(device, pool, layouts.blur.get()),
        .blur_temp = allocate_set(device, pool, layouts.blur.get()),
    };
}

void bind_uniforms(const Device& device, VkDescriptorSet scene, const UniformBuffers& uniforms) {
    bind_buffer(device, scene, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC,
                {uniforms.draws.buffer.get(), 0, sizeof(DrawBlock)});
    bind_buffer(device, scene, 1, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, {uniforms.frame.buffer.get(), 0, sizeof(FrameBlock)});
}

void bind_image(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkImageView view, VkSampler sampler) {
    const VkDescriptorImageInfo image{sampler, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    vkUpdateDescriptorSets(device.get(), 1, &write, 0, nullptr);
}

}  // namespace gnomon::peer
