// Named passes of a frame: how long each took and what it counted.
#pragma once

#include "pipeline/device.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::techniques {

struct PassRecord {
    std::string name;
    double milliseconds = 0;
    Counters counters;                     // zero unless the device counts
    std::vector<ResourceTraffic> traffic;  // bytes by resource; empty unless the device counts
};

class PassTimer {
public:
    explicit PassTimer(Device& device) : device_(device) {}

    /// Runs one pass and records it.
    template <class Body>
    void pass(std::string name, const Body& body) {
        const auto begin = std::chrono::steady_clock::now();
        body();
        const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
        const Tally tally = device_.take_tally();
        records_.push_back({std::move(name), elapsed.count(), tally.counters, device_.traffic(tally)});
    }

    [[nodiscard]] const std::vector<PassRecord>& records() const { return records_; }

private:
    Device& device_;
    std::vector<PassRecord> records_;
};

}  // namespace gnomon::techniques
