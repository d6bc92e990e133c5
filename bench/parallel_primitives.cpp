// Reduction, scan, sort, compaction and unique beside the same done by the standard library on one thread and by oneTBB on as
// many threads, in turns, so that the noise of a shared machine hits all alike.
#include "pipeline/parallel_primitives.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/parallel_scan.h>
#include <oneapi/tbb/parallel_sort.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <numeric>

using namespace gnomon;

namespace {

using Words = std::vector<std::uint32_t>;

struct Contender {
    std::string name;
    std::function<void()> prepare;  // not timed
    std::function<void()> run;
    std::vector<double> times{};  // ms
};

Words random_words(int count) {
    Words words(static_cast<std::size_t>(count));
    std::uint32_t state = 1;
    for (std::uint32_t& word : words) {
        state = state * 1664525u + 1013904223u;
        word = state ^ state >> 15;
    }
    return words;
}

void compare(const std::string& name, std::vector<Contender> contenders, int count, int rounds) {
    for (int round = -1; round < rounds; ++round) {
        for (Contender& contender : contenders) {
            contender.prepare();
            const auto begin = std::chrono::steady_clock::now();
            contender.run();
            const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
            if (round >= 0) contender.times.push_back(elapsed.count());
        }
    }
    double own = 0;
    for (Contender& contender : contenders) {
        std::ranges::sort(contender.times);
        const double median = contender.times[contender.times.size() / 2];
        if (own == 0) own = median;
        fmt::print("{:<20} {:<8} {:8.3f} {:8.2f} {:8.2f}\n", name, contender.name, median, median * 1e6 / count, own / median);
    }
}

using Range = tbb::blocked_range<std::size_t>;

template <class Word>
void compare_sums(Device& device, const Words& words, const std::string& name, int rounds) {
    ParallelPrimitives primitives(device);
    const int count = static_cast<int>(words.size());
    std::vector<Word> values(words.size());
    for (std::size_t i = 0; i < words.size(); ++i) values[i] = static_cast<Word>(words[i] >> 8);
    std::vector<Word> out(words.size());
    const BufferId from = device.create_buffer("values", std::as_bytes(std::span(values)));
    const BufferId to = device.create_zeroed_buffer("out", words.size() * 4);
    const auto nothing = [] {};
    volatile Word result{};  // so that nobody is optimised away

    compare("reduce " + name,
            {{"Gnomon", nothing, [&] { result = primitives.reduce<Word>(from, count, CombineOp::Sum); }},
             {"std", nothing, [&] { result = std::accumulate(values.begin(), values.end(), Word{}); }},
             {"TBB", nothing,
              [&] {
                  result = tbb::parallel_reduce(
                      Range(0, values.size()), Word{},
                      [&](const Range& r, Word sum) {
                          for (std::size_t i = r.begin(); i != r.end(); ++i) sum += values[i];
                          return sum;
                      },
                      std::plus<>{});
              }}},
            count, rounds);
    out[0] = result;
    compare("inclusive scan " + name,
            {{"Gnomon", nothing, [&] { primitives.inclusive_scan<Word>(from, to, count, CombineOp::Sum); }},
             {"std", nothing, [&] { std::inclusive_scan(values.begin(), values.end(), out.begin()); }},
             {"TBB", nothing,
              [&] {
                  tbb::parallel_scan(
                      Range(0, values.size()), Word{},
                      [&](const Range& r, Word sum, bool is_final) {
                          for (std::size_t i = r.begin(); i != r.end(); ++i) {
                              sum += values[i];
                              if (is_final) out[i] = sum;
                          }
                          return sum;
                      },
                      std::plus<>{});
              }}},
            count, rounds);
}

void compare_orders(Device& device, const Words& words, int rounds) {
    ParallelPrimitives primitives(device);
    const int count = static_cast<int>(words.size());
    const auto bytes = std::as_bytes(std::span(words));
    const BufferId keys = device.create_buffer("keys", bytes);
    const BufferId values = device.create_buffer("values", bytes);
    const BufferId to = device.create_zeroed_buffer("out", bytes.size());
    Words copy;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const auto upload = [&] { device.execute(WriteBuffer{keys, 0, bytes}); };
    const auto copy_words = [&] { copy = words; };
    const auto copy_pairs = [&] {
        pairs.clear();
        for (const std::uint32_t word : words) pairs.emplace_back(word, word);
    };
    const auto by_key = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto nothing = [] {};

    compare("sort u32",
            {{"Gnomon", upload, [&] { primitives.radix_sort<std::uint32_t>(keys, count); }},
             {"std", copy_words, [&] { std::ranges::sort(copy); }},
             {"TBB", copy_words, [&] { tbb::parallel_sort(copy.begin(), copy.end()); }}},
            count, rounds);
    compare("sort u32 pairs",
            {{"Gnomon", upload, [&] { primitives.radix_sort<std::uint32_t>(keys, values, count); }},
             {"std", copy_pairs, [&] { std::ranges::sort(pairs, by_key); }},
             {"TBB", copy_pairs, [&] { tbb::parallel_sort(pairs.begin(), pairs.end(), by_key); }}},
            count, rounds);

    Words flags(words.size());
    for (std::size_t i = 0; i < words.size(); ++i) flags[i] = words[i] >> 31;
    const BufferId flag_buffer = device.create_buffer("flags", std::as_bytes(std::span(flags)));
    const auto flagged = [&] {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < words.size(); ++i) {
            copy[kept] = words[i];
            kept += flags[i];
        }
    };
    compare("compact",
            {{"Gnomon", nothing, [&] { primitives.compact(values, flag_buffer, to, count); }},
             {"std", [&] { copy.assign(words.size() + 1, 0); }, flagged}},
            count, rounds);

    Words sorted = words;
    for (std::uint32_t& word : sorted) word >>= 13;
    std::ranges::sort(sorted);
    const BufferId sorted_buffer = device.create_buffer("sorted", std::as_bytes(std::span(sorted)));
    compare("unique",
            {{"Gnomon", nothing, [&] { primitives.unique(sorted_buffer, to, count); }},
             {"std", [&] { copy.resize(words.size()); }, [&] { std::ranges::unique_copy(sorted, copy.begin()); }}},
            count, rounds);
}

}  // namespace

int main(int argc, char** argv) {
    int count = 1 << 20;
    int threads = 2;
    int rounds = 15;
    CLI::App app("Data-parallel primitives beside the standard library and oneTBB.");
    app.add_option("--count", count, "words")->capture_default_str()->check(CLI::Range(1, 1 << 26));
    app.add_option("--threads", threads, "threads of Gnomon and oneTBB")->capture_default_str()->check(CLI::Range(1, 256));
    app.add_option("--rounds", rounds, "turns each contender gets")->capture_default_str()->check(CLI::Range(1, 1000));
    CLI11_PARSE(app, argc, argv);

    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Device device(profile_presets().front(), threads);
    const Words words = random_words(count);
    fmt::print("{} words, {} threads, Gnomon with {} lanes; std is on one thread\n\n", count, threads, kLanes);
    fmt::print("{:<20} {:<8} {:>8} {:>8} {:>8}\n", "primitive", "who", "ms", "ns/word", "Gnomon/");
    compare_sums<std::uint32_t>(device, words, "u32", rounds);
    compare_sums<float>(device, words, "float", rounds);
    compare_orders(device, words, rounds);
    fmt::print("\nmedians; the last column is Gnomon's time over the contender's, so below 1 Gnomon is faster\n");
    return 0;
}
