// Vulkan results as errors.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string_view>
#include <vector>

namespace gnomon::peer {

/// "VK_ERROR_DEVICE_LOST"; empty for a result unknown here.
std::string_view result_name(VkResult result);

/// Throws Error `<what>: <result>` unless the result is VK_SUCCESS.
void check(VkResult result, const char* what);

/// The two calls that every Vulkan list takes: `list(&count, nullptr)`, then `list(&count, data)`.
template <class T, class List>
std::vector<T> enumerate(const char* what, T prototype, List list) {
    std::uint32_t count = 0;
    check(list(&count, nullptr), what);
    std::vector<T> items(count, prototype);
    if (count > 0) check(list(&count, items.data()), what);
    items.resize(count);
    return items;
}

}  // namespace gnomon::peer
