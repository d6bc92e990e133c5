// The terminal while long work runs: a line of progress, and Ctrl-C.
#pragma once

#include "sim/progress.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>

namespace gnomon::cli {

/// From now on SIGINT and SIGTERM ask the work to stop instead of ending the process.
void catch_stop_signals();

/// 128 and the number of the signal that came, as shells count: 130 for Ctrl-C.
int stop_exit_code();

/// Shows stage, share and elapsed seconds on one line of stderr, once the work has run for a second and if stderr is a
/// terminal. The line goes when this goes. Also carries the request to stop.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// What work is given; valid as long as this lives.
    [[nodiscard]] Progress progress();
    /// Text for stdout while the work goes on: the line makes room.
    void print(const std::string& text);

private:
    void set(std::string_view stage, std::size_t done, std::size_t total);
    void show_until_closed();
    [[nodiscard]] std::string line() const;

    std::mutex mutex_;
    std::condition_variable closing_;
    bool closed_ = false;
    std::string stage_;
    std::size_t done_ = 0;
    std::size_t total_ = 0;  // 0: unknown
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::thread painter_;  // only on a terminal
};

}  // namespace gnomon::cli
