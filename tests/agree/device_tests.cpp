// Devices and the session.
#define CATCH_CONFIG_RUNNER
#include "tests/agree/device_tests.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cstdio>

namespace gnomon::agree {

const std::vector<peer::PeerDevice>& usable_devices() {
    static const std::vector<peer::PeerDevice> kDevices = [] {
        std::vector<peer::PeerDevice> devices = peer::list_devices();
        std::erase_if(devices, [](const peer::PeerDevice& device) { return !device.unusable.empty(); });
        return devices;
    }();
    return kDevices;
}

int run_device_tests(int argc, char** argv) {
    peer::expose_drivers();
    Catch::Session session;
    if (const int error = session.applyCommandLine(argc, argv); error != 0) return error;
    if (!usable_devices().empty()) return session.run();

    // Say it where it is seen, run the rest, and let CTest count a skip.
    fmt::print(stderr, "SKIPPED: no usable Vulkan device (install mesa-vulkan-drivers or chromium-common)\n");
    session.configData().testsOrTags = {"~[device]"};
    const int failed = session.run();
    return failed != 0 ? failed : 4;
}

}  // namespace gnomon::agree

int main(int argc, char** argv) { return gnomon::agree::run_device_tests(argc, argv); }
