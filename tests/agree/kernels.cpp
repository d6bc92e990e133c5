// Pipelines, bindings, dispatch. The only file that sees the generated headers.
#include "tests/agree/kernels.h"

#include "sim/error.h"
#include "tests/peer/result.h"
#include "tests/peer/shaders.h"

#include <algorithm>
#include <cstring>

namespace gnomon::agree {
namespace {

#include "agree_shaders/gather.h"
#include "agree_shaders/gather_compare.h"
#include "agree_shaders/gradient.h"
#include "agree_shaders/gradient_compare.h"
#include "agree_shaders/lod.h"
#include "agree_shaders/lod_compare.h"
#include "agree_shaders/read.h"

constexpr std::uint32_t kLocalSize = 64;  // of sample.comp

static_assert(sizeof(Point) == 32 && sizeof(Sample) == 16);  // as sample.comp has them, std430

std::span<const std::uint32_t> kernel_spirv(Kernel kernel) {
    switch (kernel) {
        case Kernel::Read: return k_read;
        case Kernel::Gradient: return k_gradient;
        case Kernel::Lod: return k_lod;
        case Kernel::Gather: return k_gather;
        case Kernel::GradientCompare: return k_gradient_compare;
        case Kernel::LodCompare: return k_lod_compare;
        case Kernel::GatherCompare: return k_gather_compare;
    }
    fail("unknown kernel");
}

peer::OwnedSetLayout make_set_layout(const peer::Device& device) {
    const std::array<VkDescriptorSetLayoutBinding, 3> bindings{{
        {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
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

peer::OwnedPipelineLayout make_layout(const peer::Device& device, VkDescriptorSetLayout set) {
    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(std::uint32_t)};
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

peer::OwnedPipeline make_pipeline(const peer::Device& device, VkPipelineLayout layout, Kernel kernel, Purpose purpose) {
    const peer::OwnedShader shader = peer::make_shader(device.get(), kernel_spirv(kernel));
    const VkBool32 timed = purpose == Purpose::Timed ? VK_TRUE : VK_FALSE;
    const VkSpecializationMapEntry entry{0, 0, sizeof(timed)};
    const VkSpecializationInfo constants{1, &entry, sizeof(timed), &timed};
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = shader.get();
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &constants;
    info.layout = layout;
    VkPipeline pipeline{};
    peer::check(vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "creating a pipeline");
    return {device.get(), pipeline};
}

struct Scope {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};

void record_barrier(VkCommandBuffer commands, Scope from, Scope to) {
    VkMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    barrier.srcStageMask = from.stages;
    barrier.srcAccessMask = from.access;
    barrier.dstStageMask = to.stages;
    barrier.dstAccessMask = to.access;
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
}

constexpr Scope kCopied{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr Scope kComputed{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr Scope kCompute{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                         VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr Scope kCopy{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr Scope kHost{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};

}  // namespace

Kernel sampling_kernel(Instruction instruction, bool compares) {
    switch (instruction) {
        case Instruction::Gradient: return compares ? Kernel::GradientCompare : Kernel::Gradient;
        case Instruction::Lod: return compares ? Kernel::LodCompare : Kernel::Lod;
        case Instruction::Gather: return compares ? Kernel::GatherCompare : Kernel::Gather;
    }
    fail("unknown instruction");
}

Kernels::Kernels(const peer::Device& device)
    : device_(&device), set_layout_(make_set_layout(device)), layout_(make_layout(device, set_layout_.get())) {}

VkPipeline Kernels::pipeline(Kernel kernel, Purpose purpose) {
    const std::size_t index = static_cast<std::size_t>(purpose) * kKernelCount + static_cast<std::size_t>(kernel);
    peer::OwnedPipeline& pipeline = pipelines_[index];
    if (!pipeline) pipeline = make_pipeline(*device_, layout(), kernel, purpose);
    return pipeline.get();
}

Dispatch::Dispatch(Kernels& kernels, VkPipeline pipeline, const Texture& texture, std::span<const Point> points)
    : device_(&kernels.device()),
      points_(peer::device_buffer(*device_, std::as_bytes(points), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)) {
    // What no invocation writes stays NaN.
    const std::vector<std::byte> unwritten(points.size() * sizeof(Sample), std::byte{0xff});
    samples_ = peer::device_buffer(*device_, unwritten, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    bind(texture, kernels.set_layout());

    const auto count = static_cast<std::uint32_t>(points.size());
    commands_ = device_->record([&](VkCommandBuffer commands) {
        record_barrier(commands, kCopied, kCompute);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernels.layout(), 0, 1, &set_, 0, nullptr);
        vkCmdPushConstants(commands, kernels.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(count), &count);
        vkCmdDispatch(commands, (count + kLocalSize - 1) / kLocalSize, 1, 1);
    });
}

void Dispatch::bind(const Texture& texture, VkDescriptorSetLayout layout) {
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
    peer::check(vkCreateDescriptorPool(device_->get(), &pool_info, nullptr, &pool), "creating a descriptor pool");
    pool_ = peer::OwnedDescriptorPool(device_->get(), pool);

    VkDescriptorSetAllocateInfo set_info{};
    set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    set_info.descriptorPool = pool;
    set_info.descriptorSetCount = 1;
    set_info.pSetLayouts = &layout;
    peer::check(vkAllocateDescriptorSets(device_->get(), &set_info, &set_), "allocating a descriptor set");

    const std::array<VkDescriptorBufferInfo, 2> buffers{{
        {points_.buffer.get(), 0, points_.bytes},
        {samples_.buffer.get(), 0, samples_.bytes},
    }};
    const VkDescriptorImageInfo image{texture.sampler.get(), texture.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    std::array<VkWriteDescriptorSet, 2> writes{};
    for (VkWriteDescriptorSet& write : writes) {
        write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        write.dstSet = set_;
    }
    writes[0].descriptorCount = static_cast<std::uint32_t>(buffers.size());
    writes[0].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[0].pBufferInfo = buffers.data();
    writes[1].dstBinding = 2;
    writes[1].descriptorCount = 1;
    writes[1].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    writes[1].pImageInfo = &image;
    vkUpdateDescriptorSets(device_->get(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

std::vector<Sample> Dispatch::samples() const {
    const std::vector<std::byte> zeros(samples_.bytes);
    const peer::Buffer staging = peer::host_buffer(*device_, zeros, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    device_->run(device_->record([&](VkCommandBuffer commands) {
        record_barrier(commands, kComputed, kCopy);
        const VkBufferCopy whole{0, 0, samples_.bytes};
        vkCmdCopyBuffer(commands, samples_.buffer.get(), staging.buffer.get(), 1, &whole);
        record_barrier(commands, kCopied, kHost);
    }));

    std::vector<Sample> samples(samples_.bytes / sizeof(Sample));
    void* mapped = nullptr;
    peer::check(vkMapMemory(device_->get(), staging.memory.get(), 0, VK_WHOLE_SIZE, 0, &mapped), "mapping a buffer");
    std::memcpy(samples.data(), mapped, samples.size() * sizeof(Sample));
    vkUnmapMemory(device_->get(), staging.memory.get());
    return samples;
}

}  // namespace gnomon::agree
