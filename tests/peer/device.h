// One Vulkan instance and one device with one queue.
#pragma once

#include "sim/error.h"
#include "tests/peer/owned.h"
#include "tests/peer/peer.h"

#include <vulkan/vulkan.h>

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace gnomon::peer {

struct DestroyInstance {
    void operator()(VkInstance instance) const { vkDestroyInstance(instance, nullptr); }
};
struct DestroyDevice {
    void operator()(VkDevice device) const { vkDestroyDevice(device, nullptr); }
};

/// No Vulkan driver is installed.
class NoDriver : public Error {
public:
    using Error::Error;
};

/// What the validation layer said; filled from any thread.
struct ValidationLog {
    std::mutex mutex;
    std::vector<std::string> messages;
};

/// A Vulkan 1.3 instance, with the validation layer where it is asked for and installed. Throws NoDriver.
class Instance {
public:
    explicit Instance(bool validate);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    [[nodiscard]] bool validates() const { return messenger_ != VK_NULL_HANDLE; }
    [[nodiscard]] std::vector<VkPhysicalDevice> physical_devices() const;
    [[nodiscard]] std::vector<std::string> messages() const;

private:
    void create_messenger();

    std::unique_ptr<ValidationLog> log_ = std::make_unique<ValidationLog>();
    std::unique_ptr<VkInstance_T, DestroyInstance> instance_;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

/// A recorded command buffer with the pool that owns it; may be submitted many times, one at a time.
struct Commands {
    OwnedCommandPool pool;
    VkCommandBuffer buffer = VK_NULL_HANDLE;
};

/// A logical device and its first graphics queue.
class Device {
public:
    Device(const PeerDevice& description, const PeerOptions& options);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    [[nodiscard]] VkDevice get() const { return device_.get(); }
    [[nodiscard]] VkPhysicalDevice physical() const { return physical_; }
    [[nodiscard]] const Instance& instance() const { return instance_; }
    [[nodiscard]] const VkPhysicalDeviceLimits& limits() const { return limits_; }
    [[nodiscard]] const PeerDevice& description() const { return description_; }
    /// Samplers may use VK_SAMPLER_ADDRESS_MODE_MIRROR_CLAMP_TO_EDGE.
    [[nodiscard]] bool mirrors_once() const { return mirrors_once_; }

    /// Throws Error unless optimally tiled images of this format have all of these features.
    void require_format(VkFormat format, VkFormatFeatureFlags features, const char* what) const;

    [[nodiscard]] Commands record(const std::function<void(VkCommandBuffer)>& record_into) const;
    /// Submits and waits until the device is done.
    void run(const Commands& commands) const;

private:
    void create_device();

    PeerDevice description_;
    Instance instance_;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkPhysicalDeviceLimits limits_{};
    bool mirrors_once_ = false;
    std::uint32_t queue_family_ = 0;
    std::unique_ptr<VkDevice_T, DestroyDevice> device_;
    VkQueue queue_ = VK_NULL_HANDLE;
    OwnedFence done_;
};

}  // namespace gnomon::peer
