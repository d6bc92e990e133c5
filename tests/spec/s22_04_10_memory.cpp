// D3D11.3 22.4.8 to 22.4.13, 22.17.8 to 22.17.16: reads, writes and atomic operations on buffers and images, in bounds and out.
#include "pipeline/compute.h"
#include "tests/oracle/random.h"
#include "tests/unit/compute_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <climits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

/// Every thread copies the word at from[read_at] to to[write_at].
struct CopyWords {
    static constexpr GroupSize kGroupSize{32, 1, 1};

    ReadBuffer<std::int32_t> read_at;
    ReadBuffer<std::int32_t> write_at;
    ReadBuffer<std::int32_t> from;
    RwBuffer<std::int32_t> to;
    int through_shared = 0;  // words of shared memory that stand in for `from`

    static constexpr auto fields() {
        using C = CopyWords;
        return std::tuple{Field{"read_at", &C::read_at}, Field{"write_at", &C::write_at}, Field{"from", &C::from},
                          Field{"to", &C::to}, Field{"through_shared", &C::through_shared}};
    }
    template <class G>
    void operator()(G& g) const {
        const auto shared = g.shared_int(through_shared);
        for (int first = 0; first < through_shared; first += kGroupSize.x) {
            g.threads([&](const auto& t) {
                const Int at = Int(first) + t.index;
                t.store(shared, at, t.load(from, at));  // behind the end: dropped
            });
        }
        g.threads([&](const auto& t) {
            const Int at = t.load(read_at, t.id.x);
            t.store(to, t.load(write_at, t.id.x), through_shared > 0 ? t.load(shared, at) : t.load(from, at));
        });
    }
};

std::int32_t hostile_index(Random& random, int count) {
    switch (random.integer(0, 4)) {
        case 0: return random.integer(-3, 3);
        case 1: return count + random.integer(-2, 2);
        case 2: return static_cast<std::int32_t>(random.bits());
        case 3: return random.chance(2) ? INT_MIN : INT_MAX;
        default: return random.integer(0, count - 1);
    }
}

}  // namespace

TEST_CASE("reads out of bounds give 0, writes out of bounds do nothing",
          "[compute][22.4.10][22.4.11][22.4.12][22.4.13][fuzz]") {
    for (std::uint64_t index = 0; index < 200; ++index) {
        CAPTURE(index);
        Random random(index);
        Device device(load_profile("d3d11"), 1 + static_cast<int>(index % 3));
        const int groups = random.integer(1, 8);
        const auto threads = static_cast<std::size_t>(groups) * 32;
        const int words = random.integer(1, 200);

        // Indices to read are anything; indices to write are each at most once in bounds, for order is nobody's promise.
        std::vector<std::int32_t> read_at(threads);
        std::vector<std::int32_t> write_at(threads);
        std::vector<bool> written(static_cast<std::size_t>(words));
        for (std::size_t i = 0; i < threads; ++i) {
            read_at[i] = hostile_index(random, words);
            write_at[i] = hostile_index(random, words);
            if (write_at[i] < 0 || write_at[i] >= words) continue;
            if (written[static_cast<std::size_t>(write_at[i])])
                write_at[i] = -1;
            else
                written[static_cast<std::size_t>(write_at[i])] = true;
        }
        std::vector<std::int32_t> from(static_cast<std::size_t>(words));
        for (auto& word : from) word = static_cast<std::int32_t>(random.bits() | 1u);
        std::vector<std::int32_t> expected(static_cast<std::size_t>(words), 77);
        // Up to three bytes behind the last word belong to no word.
        std::vector<std::byte> bytes(expected.size() * 4 + index % 4, std::byte{0x4d});
        std::memcpy(bytes.data(), expected.data(), expected.size() * 4);

        std::uint64_t read = 0;
        std::uint64_t stored = 0;
        for (std::size_t i = 0; i < threads; ++i) {
            const bool in = read_at[i] >= 0 && read_at[i] < words;
            const bool out = write_at[i] >= 0 && write_at[i] < words;
            read += in ? 1 : 0;
            stored += out ? 1 : 0;
            if (out) expected[static_cast<std::size_t>(write_at[i])] = in ? from[static_cast<std::size_t>(read_at[i])] : 0;
        }

        const bool shared = index % 2 == 1;
        const BufferId to = device.create_buffer("to", bytes);
        device.enable_counters(true);
        dispatch(device,
                 CopyWords{.read_at = {upload_words(device, read_at)},
                           .write_at = {upload_words(device, write_at)},
                           .from = {upload_words(device, from)},
                           .to = {to},
                           .through_shared = shared ? words : 0},
                 static_cast<std::uint32_t>(groups));
        CHECK(words_of<std::int32_t>(device, to) == expected);
        CHECK(std::equal(bytes.begin() + static_cast<std::ptrdiff_t>(expected.size()) * 4, bytes.end(),
                         device.buffer(to).data.begin() + static_cast<std::ptrdiff_t>(expected.size()) * 4));
        const Counters counters = device.take_counters();
        const std::uint64_t copied = static_cast<std::uint64_t>(groups) * static_cast<std::uint64_t>(words);
        CHECK(counters.bytes_read == 4 * (2 * threads + (shared ? copied : read)));
        CHECK(counters.bytes_written == 4 * stored);
    }
}

TEST_CASE("a buffer without words reads as 0 and takes nothing", "[compute][22.4.10][22.4.11]") {
    Device device(load_profile("d3d11"), 1);
    const std::array<std::byte, 3> three{};
    const BufferId from = device.create_buffer("three bytes", three);
    const BufferId to = device.create_zeroed_buffer("none", 0);
    const BufferId at = upload_words(device, std::vector<std::int32_t>(32, 0));
    const BufferId also_at = upload_words(device, std::vector<std::int32_t>(32, 0));
    device.enable_counters(true);
    dispatch(device, CopyWords{.read_at = {at}, .write_at = {also_at}, .from = {from}, .to = {to}});
    CHECK(device.take_counters().bytes_written == 0);
}

namespace {

/// Every operation on its own word of a buffer and of shared memory, by every thread, where `at` says.
struct AtomicAll {
    static constexpr GroupSize kGroupSize{37, 1, 1};
    static constexpr int kOps = 8;

    ReadBuffer<std::int32_t> at;
    ReadBuffer<std::int32_t> operands;
    RwBuffer<std::int32_t> words;  // [at * kOps + op]
    RwBuffer<std::int32_t> sums;   // per group: shared memory's words of atomic_add
    int places = 0;

    static constexpr auto fields() {
        using A = AtomicAll;
        return std::tuple{Field{"at", &A::at}, Field{"operands", &A::operands}, Field{"words", &A::words},
                          Field{"sums", &A::sums}, Field{"places", &A::places}};
    }
    template <class T, class Memory>
    static void all_of(const T& t, const Memory& memory, Int place, Int operand) {
        const auto of = [&](int op) { return select(place >= Int(0), place * Int(kOps) + Int(op), place); };
        t.atomic_add(memory, of(0), operand);
        t.atomic_and(memory, of(1), operand);
        t.atomic_or(memory, of(2), operand);
        t.atomic_xor(memory, of(3), operand);
        t.atomic_min(memory, of(4), operand);
        t.atomic_max(memory, of(5), operand);
        t.atomic_min_unsigned(memory, of(6), operand);
        t.atomic_max_unsigned(memory, of(7), operand);
    }
    template <class G>
    void operator()(G& g) const {
        const auto shared = g.shared_int(places * kOps);
        g.threads([&](const auto& t) {
            const Int place = t.load(at, t.id.x);
            const Int operand = t.load(operands, t.id.x);
            all_of(t, words, place, operand);
            all_of(t, shared, place, operand);
        });
        for (int first = 0; first < places * kOps; first += kGroupSize.x) {
            g.threads([&](const auto& t) {
                const Int word = Int(first) + t.index;
                t.store(sums, Int(g.id.x * places * kOps) + word, t.load(shared, word), word < Int(places * kOps));
            });
        }
    }
};

std::int32_t combined(int op, std::int32_t old, std::int32_t operand) {
    const auto a = static_cast<std::uint32_t>(old);
    const auto b = static_cast<std::uint32_t>(operand);
    switch (op) {
        case 0: return static_cast<std::int32_t>(a + b);
        case 1: return static_cast<std::int32_t>(a & b);
        case 2: return static_cast<std::int32_t>(a | b);
        case 3: return static_cast<std::int32_t>(a ^ b);
        case 4: return std::min(old, operand);
        case 5: return std::max(old, operand);
        case 6: return static_cast<std::int32_t>(std::min(a, b));
        default: return static_cast<std::int32_t>(std::max(a, b));
    }
}

}  // namespace

TEST_CASE("atomic operations reach every word once per thread and leave what is out of bounds",
          "[compute][22.17.8][22.17.9][22.17.10][22.17.12][22.17.13][22.17.14][22.17.15][22.17.16][fuzz]") {
    constexpr int kPlaces = 5;
    constexpr int kOps = AtomicAll::kOps;
    for (const int threads : {1, 2, 5}) {
        Random random(9);
        Device device(load_profile("d3d11"), threads);
        constexpr int kGroups = 50;
        const std::size_t count = kGroups * 37;
        std::vector<std::int32_t> at(count);
        std::vector<std::int32_t> operands(count);
        std::vector<std::int32_t> words(kPlaces * kOps);
        for (auto& word : words) word = static_cast<std::int32_t>(random.bits());
        auto expected = words;
        std::vector<std::int32_t> sums(std::size_t{kGroups} * kPlaces * kOps, 0);
        for (std::size_t i = 0; i < count; ++i) {
            at[i] = random.integer(-1, kPlaces);
            if (random.chance(10)) at[i] = -INT_MAX;
            operands[i] = static_cast<std::int32_t>(random.bits());
            if (at[i] < 0 || at[i] >= kPlaces) continue;
            for (int op = 0; op < kOps; ++op) {
                const std::size_t word = static_cast<std::size_t>(at[i] * kOps + op);
                expected[word] = combined(op, expected[word], operands[i]);
                auto& own = sums[i / 37 * kPlaces * kOps + word];
                own = combined(op, own, operands[i]);
            }
        }
        const BufferId word_buffer = upload_words(device, words);
        const BufferId sum_buffer = device.create_zeroed_buffer("sums", sums.size() * 4);
        dispatch(device,
                 AtomicAll{.at = {upload_words(device, at)},
                           .operands = {upload_words(device, operands)},
                           .words = {word_buffer},
                           .sums = {sum_buffer},
                           .places = kPlaces},
                 kGroups);
        CHECK(words_of<std::int32_t>(device, word_buffer) == expected);
        CHECK(words_of<std::int32_t>(device, sum_buffer) == sums);
    }
}

namespace {

/// Copies texel (x, y) of one level to texel (x + shift, y + shift) of another.
struct ShiftImage {
    static constexpr GroupSize kGroupSize{5, 3, 1};
    ReadImage from;
    RwImage to;
    int shift = 0;

    static constexpr auto fields() {
        using S = ShiftImage;
        return std::tuple{Field{"from", &S::from}, Field{"to", &S::to}, Field{"shift", &S::shift}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(to, t.id.x + Int(shift), t.id.y + Int(shift), t.load(from, t.id.x, t.id.y)); });
    }
};
struct ShiftUintImage {
    static constexpr GroupSize kGroupSize{5, 3, 1};
    ReadUintImage from;
    RwUintImage to;
    int shift = 0;

    static constexpr auto fields() {
        using S = ShiftUintImage;
        return std::tuple{Field{"from", &S::from}, Field{"to", &S::to}, Field{"shift", &S::shift}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(to, t.id.x + Int(shift), t.id.y + Int(shift), t.load(from, t.id.x, t.id.y)); });
    }
};

}  // namespace

TEST_CASE("texels survive a read and a write in every format, and nothing else is touched",
          "[compute][22.4.8][22.4.9][5.3.9.5]") {
    // 13 x 7 texels at level 1; threads cover 20 x 9, of which those outside read the defaults and write nothing.
    constexpr int kWidth = 13;
    constexpr int kHeight = 7;
    constexpr int kShift = 2;
    for (const char* profile : {"d3d11", "ideal"}) {
        for (const FormatInfo& format : kFormats) {
            if (format.is_depth) continue;
            CAPTURE(format.name, profile);
            Random random(static_cast<std::uint64_t>(format.format));
            Device device(load_profile(profile), 2);
            const TextureDesc desc{.format = format.format,
                                   .width = 2 * kWidth,
                                   .height = 2 * kHeight,
                                   .levels = 3,
                                   .kind = TextureKind::Array,
                                   .layers = 3};
            const TextureId from = device.create_texture("from", desc);
            const TextureId to = device.create_texture("to", desc);
            const auto texel_bytes = static_cast<std::size_t>(format.bytes_per_texel);
            std::vector<std::byte> bytes(kWidth * kHeight * texel_bytes);
            for (std::byte& byte : bytes) {
                // Positive numbers below NaN, so that every code but one per SNORM stands for itself.
                byte = static_cast<std::byte>(random.bits() & 0x3bu);
            }
            device.execute(WriteTexture{from, 1, bytes});

            if (format.is_integer()) {
                dispatch(device, ShiftUintImage{.from = {from, 1, 0}, .to = {to, 1, 2}, .shift = kShift}, 4, 3);
            } else {
                dispatch(device, ShiftImage{.from = {from, 1, 0}, .to = {to, 1, 2}, .shift = kShift}, 4, 3);
            }
            std::vector<std::byte> expected(bytes.size());
            for (int y = 0; y + kShift < kHeight; ++y)
                std::memcpy(expected.data() + static_cast<std::size_t>((y + kShift) * kWidth + kShift) * texel_bytes,
                            bytes.data() + static_cast<std::size_t>(y * kWidth) * texel_bytes, (kWidth - kShift) * texel_bytes);
            const Texture& written = device.texture(to);
            CHECK(written.level_bytes(1, 2) == expected);
            for (int layer = 0; layer < 3; ++layer)
                for (int level = 0; level < 3; ++level) {
                    if (level == 1 && layer == 2) continue;
                    const auto untouched = written.level_bytes(level, layer);
                    CHECK(std::ranges::all_of(untouched, [](std::byte b) { return b == std::byte{0}; }));
                }
            CHECK(device.texture(from).level_bytes(1, 0) == bytes);
        }
    }
}

namespace {

/// Texels at hostile places to words of a buffer.
struct ReadTexels {
    static constexpr GroupSize kGroupSize{64, 1, 1};
    ReadImage from;
    ReadBuffer<std::int32_t> at;  // x, y
    RwBuffer<float> to;           // four components

    static constexpr auto fields() {
        using R = ReadTexels;
        return std::tuple{Field{"from", &R::from}, Field{"at", &R::at}, Field{"to", &R::to}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) {
            const Int thread = t.id.x;
            const auto color = t.load(from, t.load(at, thread * Int(2)), t.load(at, thread * Int(2) + Int(1)));
            t.store(to, thread * Int(4), color.x);
            t.store(to, thread * Int(4) + Int(1), color.y);
            t.store(to, thread * Int(4) + Int(2), color.z);
            t.store(to, thread * Int(4) + Int(3), color.w);
        });
    }
};

}  // namespace

TEST_CASE("texels out of bounds are 0 with the defaults of missing components", "[compute][22.4.8][fuzz]") {
    for (const Format format : {Format::R32Float, Format::Rg16Float, Format::R11G11B10Float, Format::Rgba8Unorm, Format::D16}) {
        CAPTURE(name_of(format));
        Random random(4);
        Device device(load_profile("d3d11"), 2);
        const FormatInfo& info = format_info(format);
        const TextureId from = device.create_texture("from", {.format = format, .width = 6, .height = 4});
        std::vector<std::byte> bytes(24 * static_cast<std::size_t>(info.bytes_per_texel));
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits() & 0x3bu);
        if (info.is_depth)
            for (std::size_t i = 0; i < bytes.size(); ++i)
                if (i % 4 >= 2) bytes[i] = std::byte{0};
        device.execute(WriteTexture{from, 0, bytes});

        // Every texel through the same functor, from a place known to be inside.
        constexpr std::size_t kReads = 512;
        std::vector<std::int32_t> at;
        for (std::size_t i = 0; i < kReads; ++i) {
            const bool known = i < 24;
            at.push_back(known ? static_cast<std::int32_t>(i % 6) : hostile_index(random, 6));
            at.push_back(known ? static_cast<std::int32_t>(i / 6) : hostile_index(random, 4));
        }
        const BufferId to = device.create_zeroed_buffer("to", kReads * 16);
        dispatch(device, ReadTexels{.from = {from}, .at = {upload_words(device, at)}, .to = {to}}, kReads / 64);
        const auto colors = words_of<std::array<float, 4>>(device, to);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < kReads; ++i) {
            const std::int32_t x = at[2 * i];
            const std::int32_t y = at[2 * i + 1];
            std::array<float, 4> expected{0.0f, 0.0f, 0.0f, info.components == 4 ? 0.0f : 1.0f};
            if (x >= 0 && x < 6 && y >= 0 && y < 4) {
                expected = colors[static_cast<std::size_t>(y * 6 + x)];
                ++inside;
            }
            CHECK(colors[i] == expected);
        }
        CHECK(inside > 50);
        CHECK(inside < kReads - 50);
    }
}
