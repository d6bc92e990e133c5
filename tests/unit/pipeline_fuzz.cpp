// Random streams of draws: the number of threads, the depth hierarchy and early tests never show.
#include "tests/determinism/fuzz_draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr std::uint64_t kStreams = 50;

/// Where two runs differ first; -1: nowhere.
std::ptrdiff_t first_difference(const FuzzResult& a, const FuzzResult& b) {
    const auto [at, other] = std::mismatch(a.bytes.begin(), a.bytes.end(), b.bytes.begin(), b.bytes.end());
    return at == a.bytes.end() && other == b.bytes.end() ? -1 : at - a.bytes.begin();
}

}  // namespace

TEST_CASE("random streams of draws give the same bytes and counts for any number of threads", "[fuzz][determinism]") {
    static_assert(kStreams * kDrawsPerStream >= 500);
    const Profile profile = load_profile("d3d11");
    Counters total;
    for (std::uint64_t seed = 0; seed < kStreams; ++seed) {
        const FuzzResult one = run_fuzz_stream(profile, seed, {.threads = 1});
        for (const int threads : {2, 5}) {
            const FuzzResult many = run_fuzz_stream(profile, seed, {.threads = threads});
            INFO(fmt::format("run_fuzz_stream(load_profile(\"d3d11\"), {}), {} threads, byte {}", seed, threads,
                             first_difference(one, many)));
            CHECK(one.bytes == many.bytes);
            CHECK(one.counters == many.counters);
        }
        total += one.counters;
    }
    // The streams reach every stage.
    for_each_field(total, [](std::string_view name, std::uint64_t count) {
        if (name == "samples_resolved" || name.starts_with("compute")) return;
        INFO(name);
        CHECK(count > 100);
    });
}

TEST_CASE("a stencil test that does nothing changes no picture of a random stream", "[fuzz][depth][16.12]") {
    for (const char* name : {"d3d11", "ideal", "llvmpipe", "nv40", "g80"}) {
        const Profile profile = load_profile(name);
        std::uint64_t rejected = 0;
        for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
            const FuzzResult plain = run_fuzz_stream(profile, seed);
            const FuzzResult idle = run_fuzz_stream(profile, seed, {.idle_stencil = true});
            INFO(fmt::format("run_fuzz_stream(load_profile(\"{}\"), {}), byte {}", name, seed, first_difference(plain, idle)));
            CHECK(plain.bytes == idle.bytes);
            rejected += plain.counters.blocks_rejected;
            CHECK(idle.counters.blocks_rejected <= plain.counters.blocks_rejected);
            CHECK(idle.counters.samples_covered == plain.counters.samples_covered);
            CHECK(idle.counters.quads_covered == plain.counters.quads_covered);
            CHECK(idle.counters.samples_passed == plain.counters.samples_passed);
        }
        CHECK(rejected > 0);
    }
}
