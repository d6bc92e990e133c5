// What tests on every usable Vulkan device share: the list of devices. The library has their main function too: with no device
// it leaves out the cases tagged [device], and says so on stderr and by the exit code 4 unless another case fails.
#pragma once

#include "tests/peer/peer.h"

#include <vector>

namespace gnomon::peer {

/// Listed once per process.
const std::vector<PeerDevice>& usable_devices();

}  // namespace gnomon::peer
