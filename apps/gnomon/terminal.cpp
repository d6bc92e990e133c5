#include "terminal.h"

#include <fmt/format.h>

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace gnomon::cli {

namespace {

std::atomic<bool> stop_asked{false};
std::atomic<int> stop_signal{SIGINT};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr std::chrono::milliseconds kPatience{1000};  // before the first line
constexpr std::chrono::milliseconds kRepaint{200};

}  // namespace

void catch_stop_signals() {
    struct sigaction action{};
    action.sa_handler = [](int number) {
        stop_signal.store(number, std::memory_order_relaxed);
        stop_asked.store(true, std::memory_order_relaxed);
    };
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);  // asked twice, it stops at once
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

int stop_exit_code() { return 128 + stop_signal.load(std::memory_order_relaxed); }

ProgressLine::ProgressLine() {
    if (::isatty(STDERR_FILENO) == 1) painter_ = std::thread([this] { show_until_closed(); });
}

ProgressLine::~ProgressLine() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    closing_.notify_all();
    if (painter_.joinable()) painter_.join();
}

Progress ProgressLine::progress() {
    Progress progress{.report = {}, .stop = &stop_asked};
    if (painter_.joinable())
        progress.report = [this](std::string_view stage, std::size_t done, std::size_t total) { set(stage, done, total); };
    return progress;
}

void ProgressLine::print(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (painter_.joinable()) std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
}

void ProgressLine::set(std::string_view stage, std::size_t done, std::size_t total) {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    done_ = done;
    total_ = total;
}

std::string ProgressLine::line() const {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    constexpr std::size_t kWidth = 30;
    if (total_ == 0) return fmt::format("{:<22} {:>30}        {:4.0f} s", stage_, "", elapsed.count());
    const std::size_t filled = std::min(kWidth, kWidth * done_ / total_);
    return fmt::format("{:<22} {}{} {:3} %  {:4.0f} s", stage_, std::string(filled, '#'), std::string(kWidth - filled, '.'),
                       100 * done_ / total_, elapsed.count());
}

void ProgressLine::show_until_closed() {
    std::unique_lock lock(mutex_);
    if (closing_.wait_for(lock, kPatience, [this] { return closed_; })) return;
    do {
        const std::string text = fmt::format("\r\033[K{}", line());
        std::fwrite(text.data(), 1, text.size(), stderr);
        std::fflush(stderr);
    } while (!closing_.wait_for(lock, kRepaint, [this] { return closed_; }));
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
}

}  // namespace gnomon::cli
