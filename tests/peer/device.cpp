// Instances, device listing, device creation, submission.
#include "tests/peer/device.h"

#include "sim/error.h"
#include "tests/peer/result.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

namespace gnomon::peer {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr std::uint64_t kWaitNs = 120'000'000'000;  // a frame that takes two minutes has hung

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto* log = static_cast<ValidationLog*>(user);
    const std::scoped_lock lock(log->mutex);
    log->messages.emplace_back(data->pMessage);
    return VK_FALSE;
}

bool validation_installed() {
    const auto layers = enumerate("listing layers", VkLayerProperties{},
                                  [](auto count, auto data) { return vkEnumerateInstanceLayerProperties(count, data); });
    return std::any_of(layers.begin(), layers.end(),
                       [](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; });
}

std::string version_text(std::uint32_t version) {
    return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version), VK_API_VERSION_PATCH(version));
}

DeviceKind device_kind(VkPhysicalDeviceType type) {
    if (type == VK_PHYSICAL_DEVICE_TYPE_CPU) return DeviceKind::Cpu;
    if (type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU) return DeviceKind::IntegratedGpu;
    if (type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU) return DeviceKind::DiscreteGpu;
    if (type == VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU) return DeviceKind::VirtualGpu;
    return DeviceKind::Other;
}

VkFormatFeatureFlags format_features(VkPhysicalDevice device, VkFormat format) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device, format, &properties);
    return properties.optimalTilingFeatures;
}

bool filters(VkPhysicalDevice device, VkFormat format) {
    return (format_features(device, format) & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
}

// VK_SAMPLER_ADDRESS_MODE_MIRROR_CLAMP_TO_EDGE, optional in Vulkan 1.2.
bool can_mirror_once(VkPhysicalDevice device) {
    VkPhysicalDeviceVulkan12Features features12{};
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    VkPhysicalDeviceFeatures2 features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    features.pNext = &features12;
    vkGetPhysicalDeviceFeatures2(device, &features);
    return features12.samplerMirrorClampToEdge == VK_TRUE;
}

std::optional<std::uint32_t> graphics_queue_family(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i)
        if ((families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0) return i;
    return std::nullopt;
}

// Why this device cannot run the harness; empty when it can.
std::string unusable_because(VkPhysicalDevice device, std::uint32_t api_version) {
    if (api_version < VK_API_VERSION_1_3) return fmt::format("Vulkan {}; 1.3 is needed", version_text(api_version));
    if (!graphics_queue_family(device)) return "no graphics queue";
    return {};
}

DeviceLimits device_limits(VkPhysicalDevice device, const VkPhysicalDeviceLimits& limits) {
    VkPhysicalDeviceFeatures features{};
    vkGetPhysicalDeviceFeatures(device, &features);
    return {
        .sub_pixel_bits = limits.subPixelPrecisionBits,
        .sub_texel_bits = limits.subTexelPrecisionBits,
        .mipmap_bits = limits.mipmapPrecisionBits,
        .max_anisotropy = features.samplerAnisotropy == VK_TRUE ? limits.maxSamplerAnisotropy : 1.0f,
        .filters_rg32f = filters(device, VK_FORMAT_R32G32_SFLOAT),
        .filters_rg16f = filters(device, VK_FORMAT_R16G16_SFLOAT),
        .filters_d32f = filters(device, VK_FORMAT_D32_SFLOAT),
        .color_samples = limits.framebufferColorSampleCounts,
    };
}

PeerDevice describe(VkPhysicalDevice device, std::uint32_t index) {
    // The driver's own name exists since 1.2; an older device is listed by its name alone.
    VkPhysicalDeviceDriverProperties driver{};
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    VkPhysicalDeviceProperties2 properties{};
    properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    vkGetPhysicalDeviceProperties(device, &properties.properties);
    const std::uint32_t api_version = properties.properties.apiVersion;
    if (api_version >= VK_API_VERSION_1_2) {
        properties.pNext = &driver;
        vkGetPhysicalDeviceProperties2(device, &properties);
    }
    return {
        .index = index,
        .name = properties.properties.deviceName,
        .driver = driver.driverName,
        .driver_info = driver.driverInfo,
        .api_version = version_text(api_version),
        .kind = device_kind(properties.properties.deviceType),
        .limits = device_limits(device, properties.properties.limits),
        .unusable = unusable_because(device, api_version),
    };
}

}  // namespace

Instance::Instance(bool validate) {
    const bool with_layer = validate && validation_installed();
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.pApplicationName = "gnomon peer";
    application.apiVersion = VK_API_VERSION_1_3;
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    info.enabledLayerCount = with_layer ? 1 : 0;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = with_layer ? 1 : 0;
    info.ppEnabledExtensionNames = &extension;
    VkInstance created{};
    const VkResult result = vkCreateInstance(&info, nullptr, &created);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw NoDriver("Vulkan: no driver is installed");
    check(result, "creating an instance");
    instance_.reset(created);
    if (with_layer) create_messenger();
}

Instance::~Instance() {
    if (messenger_ == VK_NULL_HANDLE) return;
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_.get(), "vkDestroyDebugUtilsMessengerEXT"));
    if (destroy != nullptr) destroy(instance_.get(), messenger_, nullptr);
}

void Instance::create_messenger() {
    VkDebugUtilsMessengerCreateInfoEXT info{};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = log_.get();
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_.get(), "vkCreateDebugUtilsMessengerEXT"));
    if (create == nullptr) fail("Vulkan: vkCreateDebugUtilsMessengerEXT is missing");
    check(create(instance_.get(), &info, nullptr, &messenger_), "creating a debug messenger");
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
    return enumerate("listing devices", VkPhysicalDevice{},
                     [this](auto count, auto data) { return vkEnumeratePhysicalDevices(instance_.get(), count, data); });
}

std::vector<std::string> Instance::messages() const {
    const std::scoped_lock lock(log_->mutex);
    return log_->messages;
}

std::string_view kind_name(DeviceKind kind) {
    switch (kind) {
        case DeviceKind::Cpu: return "cpu";
        case DeviceKind::IntegratedGpu: return "integrated gpu";
        case DeviceKind::DiscreteGpu: return "discrete gpu";
        case DeviceKind::VirtualGpu: return "virtual gpu";
        case DeviceKind::Other: return "other";
    }
    return "other";
}

std::vector<PeerDevice> list_devices() try {
    const Instance instance(false);
    std::vector<PeerDevice> devices;
    for (VkPhysicalDevice device : instance.physical_devices())
        devices.push_back(describe(device, static_cast<std::uint32_t>(devices.size())));
    return devices;
} catch (const NoDriver&) {
    return {};
}

Device::Device(const PeerDevice& description, const PeerOptions& options)
    : description_(description), instance_(options.validate) {
    const std::vector<VkPhysicalDevice> devices = instance_.physical_devices();
    if (description.index >= devices.size() || describe(devices[description.index], description.index) != description)
        fail("device {} '{}' is not there any more", description.index, description.name);
    if (!description.unusable.empty()) fail("device '{}' cannot be used: {}", description.name, description.unusable);
    physical_ = devices[description.index];

    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical_, &properties);
    limits_ = properties.limits;

    queue_family_ = graphics_queue_family(physical_).value();
    mirrors_once_ = can_mirror_once(physical_);
    create_device();
    vkGetDeviceQueue(get(), queue_family_, 0, &queue_);

    VkFenceCreateInfo fence{};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    VkFence created{};
    check(vkCreateFence(get(), &fence, nullptr, &created), "creating a fence");
    done_ = OwnedFence(get(), created);
}

void Device::create_device() {
    VkPhysicalDeviceVulkan12Features features12{};
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features12.samplerMirrorClampToEdge = mirrors_once_ ? VK_TRUE : VK_FALSE;
    VkPhysicalDeviceVulkan13Features features13{};
    features13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    features13.pNext = &features12;
    features13.dynamicRendering = VK_TRUE;
    features13.synchronization2 = VK_TRUE;
    VkPhysicalDeviceFeatures2 features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    features.pNext = &features13;
    features.features.samplerAnisotropy = description_.limits.max_anisotropy > 1 ? VK_TRUE : VK_FALSE;

    const float priority = 1;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = queue_family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    VkDevice created{};
    check(vkCreateDevice(physical_, &info, nullptr, &created), "creating a device");
    device_.reset(created);
}

void Device::require_format(VkFormat format, VkFormatFeatureFlags features, const char* what) const {
    if ((format_features(physical_, format) & features) != features)
        fail("device '{}' cannot use its {} as this technique needs", description_.name, what);
}

Commands Device::record(const std::function<void(VkCommandBuffer)>& record_into) const {
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = queue_family_;
    VkCommandPool created{};
    check(vkCreateCommandPool(get(), &pool, nullptr, &created), "creating a command pool");
    Commands commands{OwnedCommandPool(get(), created), VK_NULL_HANDLE};

    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = created;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(get(), &allocate, &commands.buffer), "allocating a command buffer");

    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    check(vkBeginCommandBuffer(commands.buffer, &begin), "beginning a command buffer");
    record_into(commands.buffer);
    check(vkEndCommandBuffer(commands.buffer), "ending a command buffer");
    return commands;
}

void Device::run(const Commands& commands) const {
    const VkFence done = done_.get();
    VkSubmitInfo submit{};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands.buffer;
    check(vkQueueSubmit(queue_, 1, &submit, done), "submitting");
    check(vkWaitForFences(get(), 1, &done, VK_TRUE, kWaitNs), "waiting for the device");
    check(vkResetFences(get(), 1, &done), "resetting a fence");
}

}  // namespace gnomon::peer
