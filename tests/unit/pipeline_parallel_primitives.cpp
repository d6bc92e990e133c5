// Reduction, scan, compaction, unique and radix sort against the standard library's algorithms, exactly where integers are
// concerned and within the stated bound for sums of floats.
#include "pipeline/parallel_primitives.h"
#include "sim/error.h"
#include "tests/oracle/random.h"
#include "tests/unit/compute_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr std::array kAllOps{CombineOp::Sum, CombineOp::Min, CombineOp::Max};

/// Around every boundary: lanes, threads, tiles of scan and sort, powers of two; then a few at random.
std::vector<int> interesting_sizes() {
    std::vector<int> sizes{0, 1, 2, 3};
    for (const int edge : {kLanes, 32, 64, 256, 1024, kTileWords, 8192, 1 << 14, 5 * kTileWords, 1 << 17})
        for (const int size : {edge - 1, edge, edge + 1}) sizes.push_back(size);
    Random random(1);
    for (int i = 0; i < 6; ++i) sizes.push_back(random.integer(4, 300'000));
    sizes.push_back(1'000'000);
    return sizes;
}

enum class Content { Random, Equal, Sorted, Reversed, Few };
constexpr std::array kContents{Content::Random, Content::Equal, Content::Sorted, Content::Reversed, Content::Few};

/// Words of any type by their bits.
template <class Word>
std::vector<Word> make_words(Content content, int count, Random& random) {
    std::vector<Word> words(static_cast<std::size_t>(count));
    const std::uint32_t same = random.bits();
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto place = static_cast<std::uint32_t>(i);
        std::uint32_t bits = 0;
        switch (content) {
            case Content::Random: bits = random.bits(); break;
            case Content::Equal: bits = same; break;
            case Content::Sorted: bits = place * 4099u; break;
            case Content::Reversed: bits = (static_cast<std::uint32_t>(count) - place) * 4099u; break;
            case Content::Few: bits = random.bits() & 0xc0000003u; break;
        }
        words[i] = std::bit_cast<Word>(bits);
    }
    return words;
}

/// What the header says of empty input.
template <class Word>
Word neutral(CombineOp op) {
    using Limits = std::numeric_limits<Word>;
    switch (op) {
        case CombineOp::Sum: return Word{};
        case CombineOp::Min: return Limits::has_infinity ? Limits::infinity() : Limits::max();
        case CombineOp::Max: return Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
    }
    __builtin_unreachable();
}

template <class Word>
Word combine(CombineOp op, Word a, Word b) {
    switch (op) {
        case CombineOp::Sum: return static_cast<Word>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
        case CombineOp::Min: return std::min(a, b);
        case CombineOp::Max: return std::max(a, b);
    }
    __builtin_unreachable();
}

template <class Word>
void check_integers(std::uint64_t seed) {
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    for (const int count : interesting_sizes()) {
        for (const Content content : kContents) {
            if (count > 20'000 && content != Content::Random) continue;
            Random random(seed++);
            const auto words = make_words<Word>(content, count, random);
            const auto size = words.size();
            const BufferId from = upload_words(device, words);
            const BufferId to = upload_words(device, std::vector<Word>(size + 2, Word{123}));
            for (const CombineOp op : kAllOps) {
                CAPTURE(count, content, op);
                const auto step = [op](Word a, Word b) { return combine(op, a, b); };
                CHECK(primitives.reduce<Word>(from, count, op) ==
                      std::accumulate(words.begin(), words.end(), neutral<Word>(op), step));

                std::vector<Word> expected(size + 2, Word{123});
                std::inclusive_scan(words.begin(), words.end(), expected.begin(), step);
                primitives.inclusive_scan<Word>(from, to, count, op);
                CHECK(words_of<Word>(device, to) == expected);
                std::exclusive_scan(words.begin(), words.end(), expected.begin(), neutral<Word>(op), step);
                primitives.exclusive_scan<Word>(from, to, count, op);
                CHECK(words_of<Word>(device, to) == expected);
            }
            CHECK(words_of<Word>(device, from) == words);
        }
    }
}

}  // namespace

TEST_CASE("reductions and scans of integers are those of the standard library", "[compute][primitives]") {
    check_integers<std::uint32_t>(100);
    check_integers<std::int32_t>(200);
}

TEST_CASE("sums of floats keep to the stated bound", "[compute][primitives]") {
    const auto bound = [](int additions) { return additions * 0x1p-24 / (1 - additions * 0x1p-24); };
    std::uint64_t seed = 0;
    for (const int count : interesting_sizes()) {
        CAPTURE(count);
        Random random(seed++);
        std::vector<float> words(static_cast<std::size_t>(count));
        const bool cancels = count % 2 == 0;
        for (float& word : words) word = random.in(cancels ? -1.0f : 0.0f, 1.0f) * (random.chance(20) ? 1e6f : 1.0f);
        const int levels = count > kTileWords ? 2 : 1;
        Device device(load_profile("d3d11"), 2);
        ParallelPrimitives primitives(device);
        const BufferId from = upload_words(device, words);
        const BufferId to = device.create_zeroed_buffer("to", words.size() * 4);
        const BufferId before = device.create_zeroed_buffer("before", words.size() * 4);
        primitives.inclusive_scan<float>(from, to, count, CombineOp::Sum);
        primitives.exclusive_scan<float>(from, before, count, CombineOp::Sum);
        const auto inclusive = words_of<float>(device, to);
        const auto exclusive = words_of<float>(device, before);

        double sum = 0;
        double magnitude = 0;
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (!(std::fabs(exclusive[i] - sum) <= bound(40 * levels) * magnitude)) FAIL("exclusive " << i);
            sum += static_cast<double>(words[i]);
            magnitude += std::fabs(static_cast<double>(words[i]));
            if (!(std::fabs(inclusive[i] - sum) <= bound(40 * levels) * magnitude)) FAIL("inclusive " << i);
        }
        CHECK(std::fabs(primitives.reduce<float>(from, count, CombineOp::Sum) - sum) <= bound(24 * levels) * magnitude);
    }
}

namespace {

/// The tree that the header states, spelt out.
float stated_sum(std::vector<float> words) {
    do {
        std::vector<float> sums;
        for (std::size_t tile = 0; tile < words.size(); tile += kTileWords) {
            std::array<float, 256> running{};
            for (std::size_t i = tile; i < std::min(words.size(), tile + kTileWords); ++i) running[i % 256] += words[i];
            for (std::size_t half = 128; half > 0; half /= 2)
                for (std::size_t i = 0; i < half; ++i) running[i] += running[i + half];
            sums.push_back(running[0]);
        }
        words = sums;
    } while (words.size() > 1);
    return words[0];
}

}  // namespace

TEST_CASE("sums of floats follow the stated tree, to the bit", "[compute][primitives]") {
    for (const int count : {1, 2, 255, 256, 257, 4095, 4096, 4097, 100'000, 1 << 20}) {
        Random random(static_cast<std::uint64_t>(count));
        std::vector<float> words(static_cast<std::size_t>(count));
        for (float& word : words) word = random.in(-1.0f, 1.0f);
        Device device(load_profile("d3d11"), 2);
        ParallelPrimitives primitives(device);
        CHECK(primitives.reduce<float>(upload_words(device, words), count, CombineOp::Sum) == stated_sum(words));
    }
}

TEST_CASE("more than two levels of tiles", "[compute][primitives]") {
    const int count = (1 << 24) + 4099;
    std::vector<std::uint32_t> words(static_cast<std::size_t>(count));
    std::uint32_t state = 1;
    for (auto& word : words) word = state = state * 1664525u + 1013904223u;
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    const BufferId from = upload_words(device, words);
    const BufferId to = device.create_zeroed_buffer("to", words.size() * 4);
    primitives.inclusive_scan<std::uint32_t>(from, to, count, CombineOp::Sum);
    std::inclusive_scan(words.begin(), words.end(), words.begin());
    CHECK(primitives.reduce<std::uint32_t>(from, count, CombineOp::Sum) == words.back());
    CHECK(words_of<std::uint32_t>(device, to) == words);
}

TEST_CASE("minima and maxima of floats leave NaN out", "[compute][primitives]") {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    Random random(5);
    for (const int count : {1, 2, 300, 5000}) {
        for (const int one_in : {1, 2, 50, 100'000}) {
            std::vector<float> words(static_cast<std::size_t>(count));
            for (float& word : words) word = random.chance(one_in) ? kNan : random.in(-5.0f, 5.0f);
            if (one_in == 50) words[words.size() / 2] = -kInfinity;
            float least = kInfinity;
            float most = -kInfinity;
            std::vector<float> minima;
            for (const float word : words) {
                if (word < least) least = word;
                if (word > most) most = word;
                minima.push_back(least);
            }
            Device device(load_profile("d3d11"), 1);
            ParallelPrimitives primitives(device);
            const BufferId from = upload_words(device, words);
            const BufferId to = device.create_zeroed_buffer("to", words.size() * 4);
            CHECK(primitives.reduce<float>(from, count, CombineOp::Min) == least);
            CHECK(primitives.reduce<float>(from, count, CombineOp::Max) == most);
            primitives.inclusive_scan<float>(from, to, count, CombineOp::Min);
            CHECK(words_of<float>(device, to) == minima);
        }
    }
}

TEST_CASE("compaction keeps what is flagged, in order", "[compute][primitives]") {
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    for (const int count : interesting_sizes()) {
        for (const int one_in : {1, 2, 1000}) {
            CAPTURE(count, one_in);
            Random random(static_cast<std::uint64_t>(count));
            const auto words = make_words<std::uint32_t>(Content::Random, count, random);
            std::vector<std::uint32_t> flags(words.size());
            std::vector<std::uint32_t> expected;
            for (std::size_t i = 0; i < words.size(); ++i) {
                flags[i] = random.chance(one_in) ? random.bits() | 0x80000000u : 0u;
                if (flags[i] != 0) expected.push_back(words[i]);
            }
            const BufferId from = upload_words(device, words);
            const BufferId to = upload_words(device, std::vector<std::uint32_t>(words.size(), 7u));
            const auto kept = static_cast<std::size_t>(primitives.compact(from, upload_words(device, flags), to, count));
            CHECK(kept == expected.size());
            CHECK(words_of<std::uint32_t>(device, to, kept) == expected);
            expected.resize(words.size(), 7u);
            CHECK(words_of<std::uint32_t>(device, to) == expected);
        }
    }
}

TEST_CASE("what a compaction's buffer cannot hold is dropped and still counted", "[compute][primitives]") {
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    std::vector<std::uint32_t> words(10'000);
    std::iota(words.begin(), words.end(), 1u);
    const BufferId to = device.create_zeroed_buffer("to", 400);
    CHECK(primitives.compact(upload_words(device, words), upload_words(device, words), to, 10'000) == 10'000);
    words.resize(100);
    CHECK(words_of<std::uint32_t>(device, to) == words);
}

namespace {

/// Order of keys as the header states it.
bool before(std::uint32_t a, std::uint32_t b) { return a < b; }
bool before(std::int32_t a, std::int32_t b) { return a < b; }
bool before(float a, float b) {
    const auto rank = [](float x) {
        const auto bits = std::bit_cast<std::int32_t>(x);
        return bits < 0 ? std::int64_t{-1} - (bits & 0x7fffffff) : std::int64_t{bits};
    };
    return rank(a) < rank(b);
}

template <class Word>
void check_sorts(std::uint64_t seed) {
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    for (const int count : interesting_sizes()) {
        for (const Content content : kContents) {
            if (count > 20'000 && content != Content::Random) continue;
            CAPTURE(count, content);
            Random random(seed++);
            auto keys = make_words<Word>(content, count, random);
            // Words behind the first `count` stay where they are.
            std::vector<std::pair<Word, std::uint32_t>> pairs;
            for (const Word key : keys) pairs.emplace_back(key, static_cast<std::uint32_t>(pairs.size()));
            keys.push_back(Word{});
            const BufferId key_buffer = upload_words(device, keys);
            primitives.radix_sort<Word>(key_buffer, count);
            // Ties by place: stable.
            std::ranges::sort(pairs, [](const auto& a, const auto& b) {
                return before(a.first, b.first) || (!before(b.first, a.first) && a.second < b.second);
            });
            std::vector<std::uint32_t> expected_keys;
            std::vector<std::uint32_t> expected_values;
            for (const auto& [key, place] : pairs) {
                expected_keys.push_back(std::bit_cast<std::uint32_t>(key));
                expected_values.push_back(place);
            }
            expected_keys.push_back(0);
            CHECK(words_of<std::uint32_t>(device, key_buffer) == expected_keys);

            device.execute(WriteBuffer{key_buffer, 0, std::as_bytes(std::span(keys))});
            std::vector<std::uint32_t> values(static_cast<std::size_t>(count));
            std::iota(values.begin(), values.end(), 0u);
            const BufferId value_buffer = upload_words(device, values);
            primitives.radix_sort<Word>(key_buffer, value_buffer, count);
            CHECK(words_of<std::uint32_t>(device, key_buffer) == expected_keys);
            CHECK(words_of<std::uint32_t>(device, value_buffer) == expected_values);  // equal keys keep their order
        }
    }
}

}  // namespace

TEST_CASE("sorts are stable and ordered", "[compute][primitives]") {
    check_sorts<std::uint32_t>(1000);
    check_sorts<std::int32_t>(2000);
    check_sorts<float>(3000);
}

TEST_CASE("special floats sort in total order", "[compute][primitives]") {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<float> ordered{std::bit_cast<float>(0xffffffffu),
                                     std::bit_cast<float>(0xffc00000u),
                                     -kInfinity,
                                     -3e38f,
                                     -1.0f,
                                     -1e-40f,
                                     -0.0f,
                                     0.0f,
                                     1e-40f,
                                     1.0f,
                                     3e38f,
                                     kInfinity,
                                     std::bit_cast<float>(0x7f800001u),
                                     std::bit_cast<float>(0x7fc00000u)};
    std::vector<float> shuffled = ordered;
    Random random(2);
    for (std::size_t i = shuffled.size(); i > 1; --i)
        std::swap(shuffled[i - 1], shuffled[static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(i) - 1))]);
    Device device(load_profile("d3d11"), 1);
    ParallelPrimitives primitives(device);
    const BufferId keys = upload_words(device, shuffled);
    primitives.radix_sort<float>(keys, static_cast<int>(shuffled.size()));
    const auto bytes = std::as_bytes(std::span(ordered));
    CHECK(device.buffer(keys).data == std::vector<std::byte>(bytes.begin(), bytes.end()));
}

TEST_CASE("unique keeps one of each run", "[compute][primitives]") {
    Device device(load_profile("d3d11"), 2);
    ParallelPrimitives primitives(device);
    for (const int count : interesting_sizes()) {
        for (const std::uint32_t range : {1u, 2u, 100u, 0xffffffffu}) {
            CAPTURE(count, range);
            Random random(static_cast<std::uint64_t>(count));
            std::vector<std::uint32_t> words(static_cast<std::size_t>(count));
            for (auto& word : words) word = random.bits() % range;
            std::ranges::sort(words);
            const BufferId from = upload_words(device, words);
            const BufferId to = device.create_zeroed_buffer("to", words.size() * 4);
            const auto kept = static_cast<std::size_t>(primitives.unique(from, to, count));
            words.erase(std::unique(words.begin(), words.end()), words.end());
            CHECK(kept == words.size());
            CHECK(words_of<std::uint32_t>(device, to, kept) == words);
        }
    }
}

TEST_CASE("the number of threads changes no byte and no count", "[compute][primitives][determinism]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        std::vector<std::byte> reference;
        std::vector<Counters> counts;
        for (const int threads : {1, 2, 5}) {
            Random random(6);
            constexpr int kCount = 50'000;
            std::vector<float> words(kCount);
            for (float& word : words) word = random.chance(50) ? random.any_float() : random.in(-1.0f, 1.0f);
            for (float& word : words)
                if (std::isnan(word)) word = 0.0f;
            Device device(load_profile(profile), threads);
            device.enable_counters(true);
            ParallelPrimitives primitives(device);
            const BufferId keys = upload_words(device, words);
            const BufferId sums = device.create_zeroed_buffer("sums", kCount * 4);
            primitives.inclusive_scan<float>(keys, sums, kCount, CombineOp::Sum);
            const float total = primitives.reduce<float>(keys, kCount, CombineOp::Sum);
            primitives.radix_sort<float>(keys, kCount);
            std::vector<std::byte> bytes = device.buffer(sums).data;
            bytes.insert(bytes.end(), device.buffer(keys).data.begin(), device.buffer(keys).data.end());
            for (const std::byte byte : std::as_bytes(std::span(&total, 1))) bytes.push_back(byte);
            if (reference.empty()) reference = bytes;
            CHECK(bytes == reference);
            counts.push_back(device.take_counters());
            CHECK(counts.back() == counts.front());
            CHECK(counts.back().compute_groups > 0);
        }
    }
}

TEST_CASE("primitives refuse what they cannot do, and change nothing", "[compute][primitives][errors]") {
    Device device(load_profile("d3d11"), 1);
    ParallelPrimitives primitives(device);
    const std::vector<std::uint32_t> words{3, 1, 2};
    const BufferId a = upload_words(device, words);
    const BufferId b = upload_words(device, words);
    const BufferId c = upload_words(device, words);
    const auto none = static_cast<BufferId>(99);
    int seen = 0;
    device.set_observer([&](const Command&) { ++seen; });
    using U = std::uint32_t;
    for (const int count : {-1, 4, kMaxPrimitiveWords + 1}) {
        CHECK_THROWS_AS(primitives.reduce<U>(a, count, CombineOp::Sum), Error);
        CHECK_THROWS_AS(primitives.inclusive_scan<U>(a, b, count, CombineOp::Sum), Error);
        CHECK_THROWS_AS(primitives.exclusive_scan<U>(a, b, count, CombineOp::Sum), Error);
        CHECK_THROWS_AS(primitives.radix_sort<U>(a, count), Error);
        CHECK_THROWS_AS(primitives.radix_sort<U>(a, b, count), Error);
        CHECK_THROWS_AS(primitives.compact(a, b, c, count), Error);
        CHECK_THROWS_AS(primitives.unique(a, b, count), Error);
    }
    CHECK_THROWS_AS(primitives.reduce<U>(none, 0, CombineOp::Sum), Error);
    CHECK_THROWS_AS(primitives.inclusive_scan<U>(a, a, 3, CombineOp::Sum), Error);
    CHECK_THROWS_AS(primitives.radix_sort<U>(a, a, 3), Error);
    CHECK_THROWS_AS(primitives.compact(a, a, b, 3), Error);
    CHECK_THROWS_AS(primitives.compact(a, b, b, 3), Error);
    CHECK_THROWS_AS(primitives.compact(a, b, none, 3), Error);
    CHECK_THROWS_AS(primitives.unique(a, a, 3), Error);
    CHECK_THROWS_AS(primitives.unique(a, BufferId::None, 3), Error);
    CHECK(seen == 0);
    CHECK(words_of<U>(device, a) == words);
    CHECK(primitives.reduce<U>(a, 3, CombineOp::Sum) == 6u);
    CHECK(seen > 0);  // chains of dispatches are seen
}

TEST_CASE("primitives have no races", "[compute][primitives][races]") {
    Device device(load_profile("d3d11"), 2);
    device.set_race_check(true);
    ParallelPrimitives primitives(device);
    constexpr int kCount = 2 * 8192 + 77;
    Random random(7);
    const BufferId keys = upload_words(device, make_words<std::uint32_t>(Content::Random, kCount, random));
    const BufferId values = upload_words(device, make_words<std::uint32_t>(Content::Few, kCount, random));
    const BufferId to = device.create_zeroed_buffer("to", kCount * 4);
    CHECK_NOTHROW(primitives.reduce<std::uint32_t>(keys, kCount, CombineOp::Sum));
    CHECK_NOTHROW(primitives.exclusive_scan<float>(keys, to, kCount, CombineOp::Max));
    CHECK_NOTHROW(primitives.radix_sort<std::int32_t>(keys, values, kCount));
    CHECK_NOTHROW(primitives.compact(keys, values, to, kCount));
    CHECK_NOTHROW(primitives.unique(keys, to, kCount));
}
