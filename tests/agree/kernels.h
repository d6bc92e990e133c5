// The compute shaders of shaders/sample.comp, and one dispatch of them over a set of points.
#pragma once

#include "tests/agree/vulkan_texture.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::agree {

/// Read samples nothing; it is for timing.
enum class Kernel { Read, Gradient, Lod, Gather, GradientCompare, LodCompare, GatherCompare };
inline constexpr std::size_t kKernelCount = 7;

/// Samples gives the bits. Timed adds a value derived from the whole point to each.
enum class Purpose { Samples, Timed };
inline constexpr std::size_t kPurposeCount = 2;

Kernel sampling_kernel(Instruction instruction, bool compares);

/// The pipelines, each made when it is first asked for, and what they share. The device must outlive it.
class Kernels {
public:
    explicit Kernels(const peer::Device& device);

    [[nodiscard]] const peer::Device& device() const { return *device_; }
    [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
    [[nodiscard]] VkPipelineLayout layout() const { return layout_.get(); }
    VkPipeline pipeline(Kernel kernel, Purpose purpose);

private:
    const peer::Device* device_;
    peer::OwnedSetLayout set_layout_;
    peer::OwnedPipelineLayout layout_;
    std::array<peer::OwnedPipeline, kPurposeCount * kKernelCount> pipelines_;
};

/// One dispatch of a pipeline over points, recorded; may be run many times. Kernels and texture must outlive it.
class Dispatch {
public:
    Dispatch(Kernels& kernels, VkPipeline pipeline, const Texture& texture, std::span<const Point> points);

    void run() const { device_->run(commands_); }
    /// Of the last run.
    [[nodiscard]] std::vector<Sample> samples() const;

private:
    void bind(const Texture& texture, VkDescriptorSetLayout layout);

    // Destroyed from the last to the first: the commands before what they refer to.
    const peer::Device* device_;
    peer::Buffer points_;
    peer::Buffer samples_;
    peer::OwnedDescriptorPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    peer::Commands commands_;
};

}  // namespace gnomon::agree
