// What tests on every usable Vulkan device share: the list of devices, and a main function that says so where there is none.
#pragma once

#include "tests/peer/peer.h"

#include <vector>

namespace gnomon::agree {

/// Listed once per process.
const std::vector<peer::PeerDevice>& usable_devices();

/// Runs Catch's session. With no device it leaves out the cases tagged [device] and returns 4 unless another one fails.
int run_device_tests(int argc, char** argv);

}  // namespace gnomon::agree
