// Compute functors under different arithmetic, thread counts and group sizes; what the device refuses; what it counts.
#include "sim/error.h"
#include "tests/oracle/random.h"
#include "tests/unit/compute_calls.h"
#include "texunit/upload.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

/// Something of everything that lanes compute, per word; shared memory carries it once across a barrier.
template <int kThreads>
struct Compute {
    static constexpr GroupSize kGroupSize{kThreads, 1, 1};

    ReadBuffer<float> from;
    RwBuffer<float> to;
    float offset = 0.0f;
    int count = 0;

    static constexpr auto fields() {
        using C = Compute;
        return std::tuple{Field{"from", &C::from}, Field{"to", &C::to}, Field{"offset", &C::offset}, Field{"count", &C::count}};
    }
    template <class G>
    void operator()(G& g) const {
        using Real = typename G::Real;
        const auto kept = g.shared_real(kThreads);
        g.threads([&](const auto& t) {
            const Real x = t.load(from, t.id.x);
            t.store(kept, t.index, (x + Real(offset)) - Real(offset));
        });
        g.threads([&](const auto& t) {
            const Real x = t.load(kept, t.index);
            t.store(to, t.id.x, select(x < Real(0.0f), t.exp2(x), x * Real(0.5f)), t.id.x < Int(count));
        });
    }
};

std::vector<float> hostile_floats(std::size_t count) {
    Random random(3);
    std::vector<float> numbers{
        0.0f, -0.0f, 1e-40f, -1e-40f, 1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
    while (numbers.size() < count) numbers.push_back(random.chance(4) ? random.any_float() : random.in(-8.0f, 8.0f));
    return numbers;
}

template <int kThreads>
std::vector<std::uint32_t> compute(const char* profile, int threads, const std::vector<float>& numbers, float offset) {
    Device device(load_profile(profile), threads);
    const BufferId to = device.create_zeroed_buffer("to", numbers.size() * 4);
    const int count = static_cast<int>(numbers.size());
    dispatch(device, Compute<kThreads>{.from = {upload_words(device, numbers)}, .to = {to}, .offset = offset, .count = count},
             static_cast<std::uint32_t>((count + kThreads - 1) / kThreads));
    return words_of<std::uint32_t>(device, to);
}

}  // namespace

TEST_CASE("results depend neither on threads nor on how work is cut into groups and waves", "[compute][determinism]") {
    const auto numbers = hostile_floats(5000);
    for (const char* profile : {"d3d11", "ideal"}) {
        const auto alone = compute<1>(profile, 1, numbers, 1.0f);  // one lane at work in every wave
        CHECK(alone != compute<1>(profile, 1, numbers, 2.0f));
        for (const int threads : {1, 2, 5}) {
            CHECK(compute<1>(profile, threads, numbers, 1.0f) == alone);
            CHECK(compute<7>(profile, threads, numbers, 1.0f) == alone);
            CHECK(compute<64>(profile, threads, numbers, 1.0f) == alone);
            CHECK(compute<1000>(profile, threads, numbers, 1.0f) == alone);
        }
    }
}

TEST_CASE("the profile's arithmetic reaches through shared memory", "[compute]") {
    const std::vector<float> small{0x1p-30f, 3.0f};
    const auto value = [](std::uint32_t bits) { return std::bit_cast<float>(bits); };
    const auto fp32 = compute<2>("d3d11", 1, small, 1.0f);
    CHECK(value(fp32[0]) == 0.0f);  // 1 + 2^-30 is 1
    CHECK(value(fp32[1]) == 1.5f);
    const auto fp64 = compute<2>("ideal", 1, small, 1.0f);
    CHECK(value(fp64[0]) == 0x1p-31f);
    CHECK(value(fp64[1]) == 1.5f);
}

TEST_CASE("denormals flush in arithmetic as the profile says, NaN is stored as one NaN", "[compute][3.1.3.2]") {
    const std::vector<float> numbers{1e-40f, std::bit_cast<float>(0xffc12345u), -std::numeric_limits<float>::infinity()};
    for (const bool flush : {true, false}) {
        Device device(flush_profile(flush), 1);
        const BufferId to = device.create_zeroed_buffer("to", 12);
        dispatch(device, Compute<3>{.from = {upload_words(device, numbers)}, .to = {to}, .count = 3});
        const auto words = words_of<std::uint32_t>(device, to);
        CHECK(words[0] == (flush ? 0u : std::bit_cast<std::uint32_t>(0.5f * 1e-40f)));
        CHECK(words[1] == 0x7fc00000u);
        CHECK(words[2] == 0u);
    }
}

namespace {

/// A float as it is, with nothing done to it.
struct CopyFloats {
    static constexpr GroupSize kGroupSize{8, 1, 1};
    ReadBuffer<float> from;
    RwBuffer<float> to;

    static constexpr auto fields() { return std::tuple{Field{"from", &CopyFloats::from}, Field{"to", &CopyFloats::to}}; }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(to, t.id.x, t.load(from, t.id.x)); });
    }
};

}  // namespace

TEST_CASE("a float that is only moved keeps its bits, unless it is a NaN", "[compute][3.1.3.2]") {
    Random random(8);
    for (const char* profile : {"d3d11", "ideal"}) {
        std::vector<float> numbers(4096);
        for (float& x : numbers) x = random.chance(3) ? std::bit_cast<float>(random.bits() & 0x807fffffu) : random.any_float();
        Device device(load_profile(profile), 1);
        const BufferId to = device.create_zeroed_buffer("to", numbers.size() * 4);
        dispatch(device, CopyFloats{.from = {upload_words(device, numbers)}, .to = {to}}, 512);
        const auto words = words_of<std::uint32_t>(device, to);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (words[i] != (std::isnan(numbers[i]) ? 0x7fc00000u : std::bit_cast<std::uint32_t>(numbers[i])))
                FAIL(fmt::format("{} {}: {:#x} became {:#x}", profile, i, std::bit_cast<std::uint32_t>(numbers[i]), words[i]));
    }
}

namespace {

/// One colour per texel from a buffer.
struct StoreColors {
    static constexpr GroupSize kGroupSize{4, 4, 1};
    ReadBuffer<float> colors;
    RwImage to;
    int width = 0;

    static constexpr auto fields() {
        using S = StoreColors;
        return std::tuple{Field{"colors", &S::colors}, Field{"to", &S::to}, Field{"width", &S::width}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) {
            const Int first = (t.id.y * Int(width) + t.id.x) * Int(4);
            const Mask inside = t.id.x < Int(width);
            t.store(to, t.id.x, t.id.y,
                    {t.load(colors, first), t.load(colors, first + Int(1)), t.load(colors, first + Int(2)),
                     t.load(colors, first + Int(3))},
                    inside);
        });
    }
};

}  // namespace

TEST_CASE("images are stored as uploads of the same colours are", "[compute][22.4.9]") {
    constexpr int kWidth = 19;
    constexpr int kHeight = 6;
    for (const Narrowing narrowing : {Narrowing::TowardZero, Narrowing::NearestEven}) {
        for (const FormatInfo& format : kFormats) {
            if (format.is_depth || format.is_integer()) continue;
            CAPTURE(format.name);
            Random random(static_cast<std::uint64_t>(format.format));
            Profile profile = flush_profile(true);
            profile.float_narrowing = narrowing;
            std::vector<glm::vec4> colors(kWidth * kHeight);
            for (auto& color : colors)
                for (int c = 0; c < 4; ++c) color[c] = random.chance(6) ? random.any_float() : random.in(-0.25f, 1.25f);
            const TextureDesc desc{.format = format.format, .width = kWidth, .height = kHeight};
            Texture expected(desc);
            const DenormalScope denormals(true);
            set_level_colors(expected, 0, colors, narrowing);
            Device device(profile, 2);
            const TextureId to = device.create_texture("to", desc);
            const BufferId from = device.create_buffer("colors", std::as_bytes(std::span(colors)));
            dispatch(device, StoreColors{.colors = {from}, .to = {to}, .width = kWidth}, 5, 2);
            CHECK(device.texture(to).level_bytes(0) == expected.level_bytes(0));
        }
    }
}

namespace {

/// Only some threads of a block of fewer threads than the group has.
struct FewThreads {
    static constexpr GroupSize kGroupSize{50, 1, 1};
    RwBuffer<std::int32_t> to;
    int count = 0;

    static constexpr auto fields() { return std::tuple{Field{"to", &FewThreads::to}, Field{"count", &FewThreads::count}}; }
    template <class G>
    void operator()(G& g) const {
        g.threads(count, [&](const auto& t) { t.store(to, t.id.x, t.index + Int(1), (t.index & Int(1)) == Int(0)); });
    }
};

}  // namespace

TEST_CASE("blocks of fewer threads leave the others alone", "[compute]") {
    for (const int count : {-1, 0, 1, 3, kLanes - 1, kLanes, kLanes + 1, 49, 50, 51, 1000}) {
        Device device(load_profile("d3d11"), 1);
        const BufferId to = device.create_zeroed_buffer("to", 400);
        device.enable_counters(true);
        dispatch(device, FewThreads{.to = {to}, .count = count}, 2);
        std::vector<std::int32_t> expected(100, 0);
        std::uint64_t stores = 0;
        for (int i = 0; i < std::min(count, 50); i += 2) {
            expected[static_cast<std::size_t>(i)] = expected[static_cast<std::size_t>(i) + 50] = i + 1;
            stores += 2;
        }
        CHECK(words_of<std::int32_t>(device, to) == expected);
        const Counters counters = device.take_counters();
        CHECK(counters.compute_groups == 2);
        CHECK(counters.compute_threads == 100);
        CHECK(counters.bytes_written == 4 * stores);
        CHECK(counters.bytes_read == 0);
    }
}

TEST_CASE("nothing is counted unless asked, and image traffic is counted by texel", "[compute][counters]") {
    Device device(load_profile("d3d11"), 2);
    const TextureId to = device.create_texture("to", {.format = Format::Rg16Float, .width = 19, .height = 6});
    const std::vector<float> colors(19 * 6 * 4, 0.5f);
    const StoreColors functor{.colors = {upload_words(device, colors)}, .to = {to}, .width = 19};
    dispatch(device, functor, 5, 2);
    CHECK(device.take_counters() == Counters{});
    device.enable_counters(true);
    dispatch(device, functor, 5, 2);
    const Counters counters = device.take_counters();
    CHECK(counters.bytes_written == 19 * 6 * 4);
    // Threads beyond the right edge read their neighbour row's colours; those beyond the last row read past the end.
    std::uint64_t reads = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 20; ++x)
            for (int c = 0; c < 4; ++c) reads += (y * 19 + x) * 4 + c < 19 * 6 * 4 ? 1 : 0;
    CHECK(counters.bytes_read == 4 * reads);
}

namespace {

struct Everything {
    static constexpr GroupSize kGroupSize{1, 1, 1};
    ReadBuffer<float> a;
    ReadBuffer<std::int32_t> b;
    RwBuffer<float> c;
    ReadImage d;
    RwImage e;
    ReadUintImage f;
    RwUintImage h;

    static constexpr auto fields() {
        using E = Everything;
        return std::tuple{Field{"a", &E::a}, Field{"b", &E::b}, Field{"c", &E::c}, Field{"d", &E::d},
                          Field{"e", &E::e}, Field{"f", &E::f}, Field{"h", &E::h}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(c, Int(0), typename G::Real(1.0f)); });
    }
};

}  // namespace

TEST_CASE("dispatches with bad arguments throw and change nothing", "[compute][errors][18.6.8.1]") {
    Device device(load_profile("d3d11"), 1);
    const BufferId one = device.create_zeroed_buffer("one", 16);
    const BufferId two = device.create_zeroed_buffer("two", 16);
    const TextureId color = device.create_texture(
        "color", {.format = Format::Rgba8Unorm, .width = 4, .height = 4, .levels = 2, .kind = TextureKind::Array, .layers = 2});
    const TextureId codes = device.create_texture("codes", {.format = Format::R32Uint, .width = 4, .height = 4, .levels = 2});
    const TextureId depth = device.create_texture("depth", {.format = Format::D16, .width = 4, .height = 4});
    const Everything good{.a = {one},
                          .b = {one},  // reading by two names is fine
                          .c = {two},
                          .d = {color, 0, 1},
                          .e = {color, 1, 1},  // another level of the same texture
                          .f = {codes, 0, 0},
                          .h = {codes, 1, 0}};
    int seen = 0;
    device.set_observer([&](const Command&) { ++seen; });
    device.enable_counters(true);
    const auto refuses = [&](const Dispatch& bad) {
        CHECK_THROWS_AS(device.execute(bad), Error);
        CHECK(words_of<float>(device, two)[0] == 0.0f);
        CHECK(device.take_counters() == Counters{});
        CHECK(seen == 0);
    };
    const auto with = [&](auto change) {
        Everything bad = good;
        change(bad);
        refuses(make_dispatch(bad));
    };
    with([](Everything& f) { f.a.buffer = BufferId::None; });
    with([](Everything& f) { f.b.buffer = static_cast<BufferId>(9); });
    with([&](Everything& f) { f.a.buffer = two; });
    with([&](Everything& f) { f.c.buffer = one; });
    with([](Everything& f) { f.d.texture = TextureId::None; });
    with([](Everything& f) { f.d.texture = static_cast<TextureId>(9); });
    with([](Everything& f) { f.d.level = 1; });  // which e writes
    with([](Everything& f) { f.d.level = 2; });
    with([](Everything& f) { f.d.level = -1; });
    with([](Everything& f) { f.d.layer = 2; });
    with([](Everything& f) { f.e.layer = -1; });
    with([&](Everything& f) { f.d = {codes, 0, 0}; });
    with([&](Everything& f) { f.e = {codes, 0, 0}; });
    with([&](Everything& f) { f.e = {depth, 0, 0}; });
    with([&](Everything& f) { f.f = {color, 0, 0}; });
    with([&](Everything& f) { f.h = {color, 0, 0}; });
    with([&](Everything& f) { f.h = {depth, 0, 0}; });
    with([](Everything& f) { f.h.level = 0; });  // which f reads
    Dispatch bad = make_dispatch(good);
    bad.program = nullptr;
    refuses(bad);
    bad = make_dispatch(good);
    bad.constants = bad.constants.first(4);
    refuses(bad);
    bad = make_dispatch(good, 65536);
    refuses(bad);

    device.execute(make_dispatch(good));
    CHECK(seen == 1);
    CHECK(words_of<float>(device, two)[0] == 1.0f);
    CHECK(device.take_counters().compute_groups == 1);
    Everything reads_depth = good;
    reads_depth.d = {depth, 0, 0};
    CHECK_NOTHROW(device.execute(make_dispatch(reads_depth)));
}

TEST_CASE("buffers are written in part, and only inside", "[compute][errors]") {
    Device device(load_profile("d3d11"), 1);
    const std::array<std::byte, 3> data{std::byte{1}, std::byte{2}, std::byte{3}};
    const BufferId id = device.create_zeroed_buffer("zeros", 5);
    CHECK(device.buffer(id).data == std::vector<std::byte>(5));
    device.execute(WriteBuffer{id, 1, data});
    const std::vector<std::byte> expected{std::byte{0}, std::byte{1}, std::byte{2}, std::byte{3}, std::byte{0}};
    CHECK(device.buffer(id).data == expected);
    CHECK_NOTHROW(device.execute(WriteBuffer{id, 5, {}}));
    for (const std::size_t offset : {std::size_t{3}, std::size_t{5}, std::size_t{6}, ~std::size_t{0}, ~std::size_t{0} - 2})
        CHECK_THROWS_AS(device.execute(WriteBuffer{id, offset, data}), Error);
    CHECK_THROWS_AS(device.execute(WriteBuffer{id, 6, {}}), Error);
    CHECK_THROWS_AS(device.execute(WriteBuffer{BufferId::None, 0, data}), Error);
    CHECK_THROWS_AS(device.execute(WriteBuffer{static_cast<BufferId>(7), 0, data}), Error);
    CHECK(device.buffer(id).data == expected);

    // Data and zeros behind it; fewer bytes than data or more than a buffer may have are refused.
    const auto next = static_cast<BufferId>(2);
    CHECK_THROWS_AS(device.execute(CreateBuffer{next, "small", data, 2}), Error);
    CHECK_THROWS_AS(device.execute(CreateBuffer{next, "large", data, kMaxBufferBytes + 1}), Error);
    device.execute(CreateBuffer{next, "padded", data, 6});
    const std::vector<std::byte> padded{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{0}, std::byte{0}, std::byte{0}};
    CHECK(device.buffer(next).data == padded);
}

TEST_CASE("a dispatch stops when asked", "[compute]") {
    Device device(load_profile("d3d11"), 2);
    const std::atomic<bool> stop = true;
    const BufferId to = device.create_zeroed_buffer("to", 400);
    device.set_stop(&stop);
    CHECK_THROWS_AS(dispatch(device, FewThreads{.to = {to}, .count = 50}, 65535), Stopped);
    device.set_stop(nullptr);
    CHECK_NOTHROW(dispatch(device, FewThreads{.to = {to}, .count = 50}));
}

namespace {

/// Two threads per group; each touches the words that constants say, in one or in two blocks.
struct TouchWords {
    static constexpr GroupSize kGroupSize{2, 1, 1};
    enum Way { kNothing, kRead, kWrite, kAtomic };

    RwBuffer<std::int32_t> words;
    RwImage image;
    int first_way = kNothing;   // of thread 0 of every group
    int second_way = kNothing;  // of thread 1 of every group
    int first_word = 0;
    int second_word = 0;
    int per_group = 0;  // words from one group to the next
    int barrier = 0;    // 1: thread 1 comes after it
    int memory = 0;     // 0: the buffer, 1: shared memory, 2: texels of the image

    static constexpr auto fields() {
        using T = TouchWords;
        return std::tuple{
            Field{"words", &T::words},           Field{"image", &T::image},           Field{"first_way", &T::first_way},
            Field{"second_way", &T::second_way}, Field{"first_word", &T::first_word}, Field{"second_word", &T::second_word},
            Field{"per_group", &T::per_group},   Field{"barrier", &T::barrier},       Field{"memory", &T::memory}};
    }
    template <class T, class Shared>
    void touch(const T& t, const Shared& shared, int way, Int word, Mask who) const {
        using Real = typename T::Real;
        if (memory == 2) {
            if (way == kRead) (void)t.load(image, word, Int(0), who);
            if (way == kWrite) t.store(image, word, Int(0), {Real(1.0f), Real(1.0f), Real(1.0f), Real(1.0f)}, who);
        } else if (memory == 1) {
            if (way == kRead) (void)t.load(shared, word, who);
            if (way == kWrite) t.store(shared, word, Int(1), who);
            if (way == kAtomic) t.atomic_add(shared, word, Int(1), who);
        } else {
            if (way == kRead) (void)t.load(words, word, who);
            if (way == kWrite) t.store(words, word, Int(1), who);
            if (way == kAtomic) t.atomic_add(words, word, Int(1), who);
        }
    }
    template <class G>
    void operator()(G& g) const {
        const auto shared = g.shared_int(16);
        const Int base(g.id.x * per_group);
        g.threads([&](const auto& t) {
            touch(t, shared, first_way, base + Int(first_word), t.index == Int(0));
            if (barrier == 0) touch(t, shared, second_way, base + Int(second_word), t.index == Int(1));
        });
        if (barrier == 0) return;
        g.threads([&](const auto& t) { touch(t, shared, second_way, base + Int(second_word), t.index == Int(1)); });
    }
};

}  // namespace

TEST_CASE("races are found wherever they are, and nothing else is", "[compute][races][7.14.2]") {
    Device device(load_profile("d3d11"), 2);
    device.set_race_check(true);
    const BufferId words = device.create_zeroed_buffer("words", 64);
    const TextureId image = device.create_texture("image", {.format = Format::R8Unorm, .width = 16, .height = 1});
    int found = 0;
    for (const int memory : {0, 1, 2}) {
        for (int first = 0; first < 4; ++first) {
            for (int second = 0; second < 4; ++second) {
                for (const int same : {0, 1})
                    for (const int barrier : {0, 1})
                        for (const int apart : {0, 1}) {
                            if (memory == 2 && (first == 3 || second == 3)) continue;
                            CAPTURE(memory, first, second, same, barrier, apart);
                            const TouchWords functor{.words = {words},
                                                     .image = {image},
                                                     .first_way = first,
                                                     .second_way = second,
                                                     .first_word = 3,
                                                     .second_word = same == 1 ? 3 : 4,
                                                     .per_group = apart == 1 ? 5 : 0,
                                                     .barrier = barrier,
                                                     .memory = memory};
                            // Two ways to touch one word clash unless one is nothing, or both only read or both are atomic.
                            const auto clash = [](int a, int b) { return a != 0 && b != 0 && (a != b || a == 2); };
                            const bool in_group = same == 1 && barrier == 0 && clash(first, second);
                            const bool between_groups =
                                memory != 1 && apart == 0 &&
                                (clash(first, first) || clash(second, second) || (same == 1 && clash(first, second)));
                            if (in_group || between_groups) {
                                CHECK_THROWS_AS(dispatch(device, functor, 2), Error);
                                ++found;
                            } else {
                                CHECK_NOTHROW(dispatch(device, functor, 2));
                            }
                        }
            }
        }
    }
    CHECK(found > 50);
    // Without the check nobody looks.
    device.set_race_check(false);
    CHECK_NOTHROW(dispatch(device, TouchWords{.words = {words}, .image = {image}, .first_way = 2}, 1));
}

namespace {

/// The example of docs/architecture.md.
struct SumPerGroup {
    static constexpr GroupSize kGroupSize{64, 1, 1};
    ReadBuffer<float> values;
    RwBuffer<float> sums;
    static constexpr auto fields() {
        return std::tuple{Field{"values", &SumPerGroup::values}, Field{"sums", &SumPerGroup::sums}};
    }

    template <class G>
    void operator()(G& g) const {
        const auto partial = g.shared_real(64);
        g.threads([&](const auto& t) { t.store(partial, t.index, t.load(values, t.id.x)); });
        for (int half = 32; half > 0; half /= 2)
            g.threads(half, [&](const auto& t) {
                t.store(partial, t.index, t.load(partial, t.index) + t.load(partial, t.index + Int(half)));
            });
        g.threads(1, [&](const auto& t) { t.store(sums, Int(g.id.x), t.load(partial, Int(0))); });
    }
};

}  // namespace

TEST_CASE("the example of the documentation sums per group", "[compute]") {
    Device device(load_profile("d3d11"), 2);
    device.set_race_check(true);
    std::vector<float> values(640);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    const BufferId sums = device.create_zeroed_buffer("sums", 40);
    dispatch(device, SumPerGroup{.values = {upload_words(device, values)}, .sums = {sums}}, 10);
    const auto found = words_of<float>(device, sums);
    for (int group = 0; group < 10; ++group)
        CHECK(found[static_cast<std::size_t>(group)] == static_cast<float>(64 * (64 * group) + 63 * 64 / 2));
}
