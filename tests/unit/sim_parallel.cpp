#include "sim/parallel.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace gnomon;

namespace {

/// Whether `pieces` pieces of work run at the same time: each waits for the others, up to a limit that only failure reaches.
bool run_together(Workers& workers, int pieces) {
    std::atomic<int> begun{0};
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    workers.for_each(static_cast<std::size_t>(pieces), [&](std::size_t) {
        ++begun;
        while (begun < pieces && std::chrono::steady_clock::now() < limit)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));  // leaves the processors to those that have not begun
    });
    return begun == pieces && std::chrono::steady_clock::now() < limit;
}

}  // namespace

TEST_CASE("workers run on as many threads as they were asked for, whoever else lives", "[parallel]") {
    Workers one(1);
    Workers two(2);
    CHECK(one.threads() == 1);
    CHECK(run_together(two, 2));
    {
        Workers eight(8);  // more than many machines have processors
        CHECK(run_together(eight, 8));
        CHECK(run_together(two, 2));
    }
    CHECK(run_together(two, 2));
}

TEST_CASE("every piece is done once", "[parallel]") {
    for (const int threads : {1, 2, 8}) {
        Workers workers(threads);
        std::vector<std::atomic<int>> done(1000);
        workers.for_each(done.size(), [&](std::size_t i) { ++done[i]; });
        CHECK(std::all_of(done.begin(), done.end(), [](const std::atomic<int>& times) { return times == 1; }));
    }
}

TEST_CASE("what a piece throws reaches the caller", "[parallel]") {
    for (const int threads : {1, 2}) {
        Workers workers(threads);
        CHECK_THROWS_AS(workers.for_each(100,
                                         [](std::size_t i) {
                                             if (i == 50) throw std::runtime_error("piece 50");
                                         }),
                        std::runtime_error);
    }
}
