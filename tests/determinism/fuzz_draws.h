// Streams of random draws with random state over shared targets: what must give the same bytes everywhere.
#pragma once

#include "sim/counters.h"
#include "sim/profile.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gnomon::testing {

inline constexpr int kDrawsPerStream = 12;

struct FuzzOptions {
    int threads = 1;
    /// Tests stencil with a state that does nothing where a draw has none: this turns the depth hierarchy and the early tests
    /// of discarding functors off, which no picture may show.
    bool idle_stencil = false;
};

struct FuzzResult {
    std::vector<std::byte> bytes;  // of all targets: every level, layer and sample, and stencil
    Counters counters;
};

/// Runs stream number `seed`. All draws are legal in the profile; Error means that the generator and the device disagree.
FuzzResult run_fuzz_stream(const Profile& profile, std::uint64_t seed, const FuzzOptions& options = {});

}  // namespace gnomon::testing
