// D3D11.3 18.6: groups and threads of a dispatch, their positions, limits, shared memory and barriers.
#include "sim/error.h"
#include "tests/unit/compute_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <numeric>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Ten words per thread: id, group, position in the group, flat index; at the thread's place in the grid.
template <GroupSize kSize>
struct WritePositions {
    static constexpr GroupSize kGroupSize = kSize;
    static constexpr int kWords = 10;

    RwBuffer<std::int32_t> to;
    int width = 0;   // threads of the grid
    int height = 0;  // threads of the grid

    static constexpr auto fields() {
        using W = WritePositions;
        return std::tuple{Field{"to", &W::to}, Field{"width", &W::width}, Field{"height", &W::height}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) {
            const Int place = (t.id.z * Int(height) + t.id.y) * Int(width) + t.id.x;
            const std::array<Int, kWords> words{t.id.x,      t.id.y,    t.id.z,    Int(g.id.x), Int(g.id.y),
                                                Int(g.id.z), t.local.x, t.local.y, t.local.z,   t.index};
            for (int w = 0; w < kWords; ++w)
                t.store(to, place * Int(kWords) + Int(w), words[static_cast<std::size_t>(w)] + Int(1));
        });
    }
};

template <GroupSize kSize>
void check_positions(int gx, int gy, int gz) {
    using Functor = WritePositions<kSize>;
    Device device(load_profile("d3d11"), 2);
    const int width = gx * kSize.x;
    const int height = gy * kSize.y;
    const int depth = gz * kSize.z;
    const auto threads = static_cast<std::size_t>(width * height * depth);
    const BufferId to = device.create_zeroed_buffer("positions", threads * Functor::kWords * 4);
    device.enable_counters(true);
    dispatch(device, Functor{.to = {to}, .width = width, .height = height}, static_cast<std::uint32_t>(gx),
             static_cast<std::uint32_t>(gy), static_cast<std::uint32_t>(gz));

    std::vector<std::int32_t> expected;
    for (int z = 0; z < depth; ++z)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const int lx = x % kSize.x;
                const int ly = y % kSize.y;
                const int lz = z % kSize.z;
                // vThreadIDInGroupFlattened = z*y*x + y*x + x with the sizes of the group. D3D11.3 18.6.4
                for (const int word :
                     {x, y, z, x / kSize.x, y / kSize.y, z / kSize.z, lx, ly, lz, lz * kSize.y * kSize.x + ly * kSize.x + lx})
                    expected.push_back(word + 1);
            }
    CHECK(words_of<std::int32_t>(device, to) == expected);
    const Counters counters = device.take_counters();
    CHECK(counters.compute_groups == static_cast<std::uint64_t>(gx * gy * gz));
    CHECK(counters.compute_threads == threads);
    CHECK(counters.bytes_written == threads * Functor::kWords * 4);
}

}  // namespace

TEST_CASE("every thread of a grid runs once and knows where it stands",
          "[compute][18.6.3][18.6.4][23.11][23.12][23.13][23.14]") {
    check_positions<GroupSize{10, 8, 3}>(5, 3, 2);  // the example of 18.6.3
    check_positions<GroupSize{1, 1, 1}>(7, 5, 3);
    check_positions<GroupSize{7, 1, 1}>(4, 1, 1);
    check_positions<GroupSize{17, 3, 1}>(2, 2, 1);
    check_positions<GroupSize{64, 1, 1}>(9, 1, 2);
    check_positions<GroupSize{1, 1, 64}>(1, 3, 2);
    check_positions<GroupSize{1024, 1, 1}>(2, 1, 1);
    check_positions<GroupSize{1, 1024, 1}>(1, 2, 1);
    check_positions<GroupSize{16, 8, 8}>(1, 2, 2);
}

TEST_CASE("sizes of groups and grids have the limits of the specification", "[compute][18.6.2][18.6.3]") {
    static_assert(is_group_size({1024, 1, 1}) && is_group_size({1, 1024, 1}) && is_group_size({16, 1, 64}));
    static_assert(!is_group_size({1025, 1, 1}) && !is_group_size({1, 1, 65}) && !is_group_size({32, 32, 2}));
    static_assert(!is_group_size({0, 1, 1}) && !is_group_size({1, -1, 1}) && !is_group_size({1, 1, 0}));

    Device device(load_profile("d3d11"), 1);
    using Functor = WritePositions<GroupSize{1, 1, 1}>;
    const BufferId to = device.create_zeroed_buffer("positions", 40);
    const Functor functor{.to = {to}, .width = 0, .height = 0};
    device.enable_counters(true);
    // A zero anywhere: nothing happens. D3D11.3 18.6.2
    for (const auto& [x, y, z] : {std::array{0u, 1u, 1u}, std::array{1u, 0u, 1u}, std::array{65535u, 65535u, 0u}})
        CHECK_NOTHROW(dispatch(device, functor, x, y, z));
    for (const auto& [x, y, z] : {std::array{65536u, 1u, 1u}, std::array{1u, 65536u, 1u}, std::array{0u, 1u, ~0u}})
        CHECK_THROWS_AS(dispatch(device, functor, x, y, z), Error);
    CHECK(device.take_counters() == Counters{});
    CHECK(words_of<std::int32_t>(device, to) == std::vector<std::int32_t>(10, 0));
    dispatch(device, functor, 65535);
    CHECK(device.take_counters().compute_groups == 65535);
}

namespace {

/// Turns the words of every group around through shared memory, and leaves garbage there for the next group.
template <int kThreads>
struct ReverseGroups {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<std::int32_t> from;
    RwBuffer<std::int32_t> to;
    RwBuffer<std::int32_t> found;  // what shared memory held at first

    static constexpr auto fields() {
        using R = ReverseGroups;
        return std::tuple{Field{"from", &R::from}, Field{"to", &R::to}, Field{"found", &R::found}};
    }
    template <class G>
    void operator()(G& g) const {
        const auto words = g.shared_int(kThreads);
        g.threads([&](const auto& t) { t.store(found, t.id.x, t.load(words, t.index)); });
        g.threads([&](const auto& t) { t.store(words, t.index, t.load(from, t.id.x)); });
        g.threads([&](const auto& t) { t.store(to, t.id.x, t.load(words, Int(kThreads - 1) - t.index)); });
        g.threads([&](const auto& t) { t.store(words, t.index, Int(-1)); });
    }
};

template <int kThreads>
void check_reversal() {
    Device device(load_profile("d3d11"), 3);
    std::vector<std::int32_t> words(static_cast<std::size_t>(kThreads) * 37);
    std::iota(words.begin(), words.end(), 1);
    const BufferId from = upload_words(device, words);
    const BufferId to = device.create_zeroed_buffer("to", words.size() * 4);
    const BufferId found = upload_words(device, words);
    dispatch(device, ReverseGroups<kThreads>{.from = {from}, .to = {to}, .found = {found}}, 37);
    for (auto group = words.begin(); group != words.end(); group += kThreads) std::reverse(group, group + kThreads);
    CHECK(words_of<std::int32_t>(device, to) == words);
    CHECK(words_of<std::int32_t>(device, found) == std::vector<std::int32_t>(words.size(), 0));
}

struct AskForShared {
    static constexpr GroupSize kGroupSize{1, 1, 1};
    int first = 0;
    int second = 0;

    static constexpr auto fields() {
        return std::tuple{Field{"first", &AskForShared::first}, Field{"second", &AskForShared::second}};
    }
    template <class G>
    void operator()(G& g) const {
        const auto numbers = g.shared_real(first);
        const auto words = g.shared_int(second);
        g.threads([&](const auto& t) {
            t.store(numbers, Int(first - 1), typename G::Real(1.0f));
            t.store(words, Int(second - 1), Int(1));
        });
    }
};

}  // namespace

TEST_CASE("all threads of a group reach a barrier before one goes on", "[compute][18.6.6][18.6.7]") {
    check_reversal<1>();
    check_reversal<3>();
    check_reversal<kLanes>();
    check_reversal<kLanes + 1>();
    check_reversal<256>();
    check_reversal<1024>();
}

TEST_CASE("a group has 8192 words of shared memory", "[compute][18.6.6][18.6.10]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        Device device(load_profile(profile), 1);
        for (const auto& [first, second] : {std::pair{8192, 0}, std::pair{0, 8192}, std::pair{4095, 4097}, std::pair{1, 8191}})
            CHECK_NOTHROW(dispatch(device, AskForShared{first, second}));
        for (const auto& [first, second] :
             {std::pair{8193, 0}, std::pair{0, 8193}, std::pair{4096, 4097}, std::pair{-1, 1}, std::pair{1, 0x7fffffff}})
            CHECK_THROWS_AS(dispatch(device, AskForShared{first, second}), Error);
    }
}
