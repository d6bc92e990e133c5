// How long work tells its caller how far it is, and hears that it should stop.
#pragma once

#include "sim/error.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <string_view>

namespace gnomon {

/// Both members may be empty: then nobody watches and nobody stops.
struct Progress {
    std::function<void(std::string_view stage, std::size_t done, std::size_t total)> report;
    const std::atomic<bool>* stop = nullptr;

    /// Reports `done` of `total` and throws Stopped when the user asked for it.
    void step(std::string_view stage, std::size_t done, std::size_t total) const {
        if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Stopped();
        if (report) report(stage, done, total);
    }
};

}  // namespace gnomon
