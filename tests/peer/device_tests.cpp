// Devices and the session.
#include "tests/peer/device_tests.h"
#include "tests/session.h"

#include <fmt/format.h>

#include <cstdio>

namespace gnomon::peer {

const std::vector<PeerDevice>& usable_devices() {
    static const std::vector<PeerDevice> kDevices = [] {
        std::vector<PeerDevice> devices = list_devices();
        std::erase_if(devices, [](const PeerDevice& device) { return !device.unusable.empty(); });
        return devices;
    }();
    return kDevices;
}

}  // namespace gnomon::peer

int main(int argc, char** argv) {
    gnomon::peer::expose_drivers();
    if (!gnomon::peer::usable_devices().empty()) return gnomon::run_session(argc, argv);

    // Say it where it is seen, run the rest, and let CTest count a skip.
    fmt::print(stderr, "SKIPPED: no usable Vulkan device (install mesa-vulkan-drivers or chromium-common)\n");
    const int failed = gnomon::run_session(argc, argv, "~[device]");
    return failed != 0 ? failed : 4;
}
