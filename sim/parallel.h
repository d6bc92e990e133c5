// The only door to oneTBB. Work is cut into indexed pieces that write disjoint memory, so the result cannot depend on the
// number of threads or on the order in which pieces run.
#pragma once

#include "sim/error.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <optional>

namespace gnomon {

inline constexpr int kMaxThreads = 256;

/// A set of worker threads. `threads` = 0 takes as many as there are processors; 1 runs everything on the caller. Throws Error
/// for less than 0 and more than kMaxThreads.
class Workers {
public:
    explicit Workers(int threads = 0) : arena_(checked(threads) > 0 ? threads : tbb::task_arena::automatic) {
        // The smallest limit of a process holds for everyone in it, so only those ask who want more threads than processors.
        if (threads > tbb::info::default_concurrency())
            limit_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    }

    [[nodiscard]] int threads() { return arena_.max_concurrency(); }

    /// Calls body(i) once for every i in [0, count), in any order, on any of the threads. The first exception thrown by a
    /// body stops the rest and is rethrown here.
    template <class Body>
    void for_each(std::size_t count, const Body& body) {
        if (count == 0) return;
        if (count == 1 || threads() == 1) {
            for (std::size_t i = 0; i < count; ++i) body(i);
            return;
        }
        arena_.execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, count, 1),
                [&](const tbb::blocked_range<std::size_t>& range) {
                    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                },
                tbb::simple_partitioner{});
        });
    }

private:
    static int checked(int threads) {
        if (threads < 0 || threads > kMaxThreads)
            fail("{} threads: expected 0 (as many as there are processors) to {}", threads, kMaxThreads);
        return threads;
    }

    std::optional<tbb::global_control> limit_;
    tbb::task_arena arena_;
};

}  // namespace gnomon
