// Driver discovery and thread limits, through the environment.
#include "tests/peer/environment.h"

#include "sim/error.h"

#include <fmt/ranges.h>
#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace gnomon::peer {
namespace {

namespace fs = std::filesystem;

// Where the loader looks on Linux. Vulkan-Loader docs/LoaderDriverInterface.md, "Driver Discovery on Linux"
constexpr const char* kManifestFolders[] = {
    "/usr/local/etc/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/share/vulkan/icd.d",
};

// Where browsers put the SwiftShader they bring.
constexpr const char* kSwiftShaderManifests[] = {
    "/usr/lib/chromium/vk_swiftshader_icd.json",
    "/usr/lib/chromium-browser/vk_swiftshader_icd.json",
    "/opt/google/chrome/vk_swiftshader_icd.json",
};

bool is_set(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
}

void set(const char* name, const std::string& value) {
    if (::setenv(name, value.c_str(), 1) != 0) fail("cannot set {} in the environment", name);
}

std::vector<std::string> manifests_in(const fs::path& folder) {
    std::vector<std::string> found;
    std::error_code absent;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, absent))
        if (entry.path().extension() == ".json") found.push_back(entry.path().string());
    std::sort(found.begin(), found.end());
    return found;
}

// Keeps the first `count` of the processors that this thread may use.
void limit_processors(int count) {
    cpu_set_t allowed;
    if (::sched_getaffinity(0, sizeof(allowed), &allowed) != 0) fail("cannot read which processors this thread may use");
    cpu_set_t kept;
    CPU_ZERO(&kept);
    int taken = 0;
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE && taken < count; ++cpu)
        if (CPU_ISSET(cpu, &allowed)) {
            CPU_SET(cpu, &kept);
            ++taken;
        }
    if (::sched_setaffinity(0, sizeof(kept), &kept) != 0) fail("cannot hold this thread to {} processors", count);
}

}  // namespace

std::vector<std::string> driver_manifests() {
    std::vector<std::string> found;
    for (const char* folder : kManifestFolders)
        for (std::string& manifest : manifests_in(folder)) found.push_back(std::move(manifest));
    for (const char* manifest : kSwiftShaderManifests) {
        std::error_code absent;
        if (fs::exists(manifest, absent)) found.emplace_back(manifest);
    }
    return found;
}

void expose_drivers() {
    if (is_set("VK_DRIVER_FILES") || is_set("VK_ICD_FILENAMES")) return;
    const std::vector<std::string> manifests = driver_manifests();
    if (manifests.empty()) return;
    const std::string joined = fmt::format("{}", fmt::join(manifests, ":"));
    set("VK_DRIVER_FILES", joined);
    set("VK_ICD_FILENAMES", joined);
}

void limit_threads(int threads) {
    if (threads < 1) fail("{} threads; expected at least one", threads);
    set("LP_NUM_THREADS", std::to_string(threads));
    limit_processors(threads);
}

}  // namespace gnomon::peer
