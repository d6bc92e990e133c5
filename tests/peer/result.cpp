// Names of the results that the calls made here can return. Vulkan 1.3 3.8.1 (Return Codes)
#include "tests/peer/result.h"

#include "sim/error.h"

namespace gnomon::peer {

std::string_view result_name(VkResult result) {
#define GNOMON_NAME(code) \
    if (result == code) return #code
    GNOMON_NAME(VK_SUCCESS);
    GNOMON_NAME(VK_NOT_READY);
    GNOMON_NAME(VK_TIMEOUT);
    GNOMON_NAME(VK_INCOMPLETE);
    GNOMON_NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
    GNOMON_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
    GNOMON_NAME(VK_ERROR_INITIALIZATION_FAILED);
    GNOMON_NAME(VK_ERROR_DEVICE_LOST);
    GNOMON_NAME(VK_ERROR_MEMORY_MAP_FAILED);
    GNOMON_NAME(VK_ERROR_LAYER_NOT_PRESENT);
    GNOMON_NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
    GNOMON_NAME(VK_ERROR_FEATURE_NOT_PRESENT);
    GNOMON_NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
    GNOMON_NAME(VK_ERROR_TOO_MANY_OBJECTS);
    GNOMON_NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
    GNOMON_NAME(VK_ERROR_FRAGMENTED_POOL);
    GNOMON_NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
    GNOMON_NAME(VK_ERROR_INVALID_SHADER_NV);
    GNOMON_NAME(VK_ERROR_UNKNOWN);
#undef GNOMON_NAME
    return "";
}

void check(VkResult result, const char* what) {
    if (result == VK_SUCCESS) return;
    const std::string_view name = result_name(result);
    if (name.empty()) fail("Vulkan: {}: VkResult {}", what, static_cast<int>(result));
    fail("Vulkan: {}: {}", what, name);
}

}  // namespace gnomon::peer
