// Named passes of a frame: how long each took and what it counted.
#pragma once

#include "pipeline/device.h"

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
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
    /// `after` is called behind every pass with its name; its time does not count.
    explicit PassTimer(Device& device, std::function<void(std::string_view)> after = {})
        : device_(device), after_(std::move(after)) {}

    /// Runs one pass and records it.
    template <class Body>
    void pass(std::string name, const Body& body) {
        const auto begin = std::chrono::steady_clock::now();
        body();
        const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
        const Tally tally = device_.take_tally();
        records_.push_back({std::move(name), elapsed.count(), tally.counters, device_.traffic(tally)});
        if (after_) after_(records_.back().name);
    }

    [[nodiscard]] const std::vector<PassRecord>& records() const { return records_; }

private:
    Device& device_;
    std::function<void(std::string_view)> after_;
    std::vector<PassRecord> records_;
};

}  // namespace gnomon::techniques
