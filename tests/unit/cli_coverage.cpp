// gnomon coverage as scripts meet it: what it prints, against the oracle and by hand, and what it refuses. D3D11.3 3.4.1, 3.4.2
#include "pipeline/coverage_query.h"
#include "tests/oracle/coverage.h"
#include "tests/oracle/random.h"
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

using namespace gnomon;
using namespace gnomon::test;

namespace {

using Corners = std::array<float, 6>;

std::string line_of(const Corners& c, bool hexadecimal) {
    std::string text;
    for (const float value : c) text += hexadecimal ? fmt::format("{:a} ", value) : fmt::format("{} ", value);
    text.back() = '\n';
    return text;
}

/// The profile's grid, nearest even, in 1/256 pixel. D3D11.3 3.2.4.1
std::int64_t snapped(float position, int bits) {
    const double scaled = std::nearbyint(static_cast<double>(position) * (1 << bits));
    return static_cast<std::int64_t>(scaled) * (256 >> bits);
}

template <std::size_t kCount>
oracle::SamplePattern pattern_from(const std::array<SamplePosition, kCount>& positions) {
    oracle::SamplePattern pattern{.count = static_cast<int>(kCount)};
    for (std::size_t i = 0; i < kCount; ++i) pattern.positions[i] = {positions[i].x, positions[i].y};
    return pattern;
}
oracle::SamplePattern pattern_of(const Profile& profile, int samples) {
    switch (samples) {
        case 2: return pattern_from(profile.sample_positions_2);
        case 4: return pattern_from(profile.sample_positions_4);
        case 8: return pattern_from(profile.sample_positions_8);
        case 16: return pattern_from(profile.sample_positions_16);
        default: return {};
    }
}

/// What the command prints for these triangles by the oracle.
std::string expected_text(const std::vector<Corners>& triangles, const oracle::PixelRect& rect, const Profile& profile,
                          int samples) {
    std::string text;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        oracle::SnappedTriangle t;
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = {snapped(triangles[i][2 * k], profile.raster_subpixel_bits),
                    snapped(triangles[i][2 * k + 1], profile.raster_subpixel_bits)};
        for (const auto& pixel : oracle::covered_pixels(oracle::coverage(t, rect, pattern_of(profile, samples))))
            text += fmt::format("{} {} {} {:x}\n", i, pixel.x, pixel.y, pixel.mask);
    }
    return text;
}

/// Small, large, thin and far triangles, some with corners on the grid of samples.
std::vector<Corners> random_triangles(std::uint64_t seed, std::size_t count) {
    oracle::Random random(seed);
    std::vector<Corners> triangles(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float reach = std::array{2.0f, 30.0f, 400.0f, 32000.0f}[i % 4];
        const float x = random.in(-4.0f, 44.0f);
        const float y = random.in(-4.0f, 34.0f);
        for (std::size_t k = 0; k < 6; ++k) {
            float value = (k % 2 == 0 ? x : y) + random.in(-reach, reach);
            if (i % 3 == 0) value = std::nearbyint(value * 16.0f) / 16.0f;
            triangles[i][k] = std::clamp(value, -kMaxPosition, kMaxPosition);
        }
    }
    return triangles;
}

}  // namespace

TEST_CASE("gnomon coverage of a triangle counted by hand", "[cli][coverage][3.4.2]") {
    const TemporaryFolder folder;
    // Corners on pixel corners, the diagonal through centres: left and top centres are in, those on the diagonal are not.
    std::string expected;
    for (int y = 1; y <= 3; ++y)
        for (int x = 1; x + y <= 4; ++x) expected += fmt::format("0 {} {} 1\n", x, y);
    CHECK(gnomon_run(folder, "coverage --size 8x8", "1 1 5 1 1 5\n").out == expected);
    CHECK(gnomon_run(folder, "coverage --size 8x8", "1 1 1 5 5 1\n").out == expected);  // either winding

    // One pixel with four samples at (6, 2), (14, 6), (2, 10), (10, 14) sixteenths: the left half has the first and the third.
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 4", "0.5 -20 0.5 20 -20 0\n").out == "0 0 0 5\n");
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 4", "-64 0.5 0.5 0.5 0.5 64\n").out == "0 0 0 4\n");
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 16", "-9 -9 99 -9 -9 99\n").out == "0 0 0 ffff\n");

    // No area, outside of the target, between all samples: nothing. Triangles are numbered all the same.
    CHECK(gnomon_run(folder, "coverage --size 8x8", "0 0 4 4 8 8\n-9 -9 -1 -9 -1 -1\n1 1 1.4 1 1 1.4\n0 0 2 0 0 2\n").out ==
          "3 0 0 1\n");
    CHECK(gnomon_run(folder, "coverage --size 8x8", "").out.empty());
}

TEST_CASE("gnomon coverage agrees with exact arithmetic for every profile and sample count", "[cli][coverage][3.4.2][19.2.4]") {
    const TemporaryFolder folder;
    const oracle::PixelRect rect{0, 0, 40, 30};
    const std::vector<Corners> triangles = random_triangles(4, 240);
    std::string input;
    for (const Corners& corners : triangles) input += line_of(corners, true);
    std::size_t lines = 0;
    for (const Profile& profile : profile_presets()) {
        for (const int samples : oracle::kSampleCounts) {
            const Outcome run = gnomon_run(
                folder, fmt::format("coverage --size 40x30 --samples {} --profile {}", samples, profile.name), input);
            INFO("seed 4, profile " << profile.name << ", samples " << samples << ": " << run.err);
            if (samples > profile.max_samples) {
                CHECK(run.code == 2);
                continue;
            }
            CHECK(run.code == 0);
            // Renderers may have a rule of their own; the others have the specification's.
            if (profile.name == "llvmpipe" || profile.name == "swiftshader") {
                std::string library;
                for (std::size_t i = 0; i < triangles.size(); ++i) {
                    const Corners& c = triangles[i];
                    for (const CoveredPixel& pixel :
                         covered_pixels({{{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}}}, {40, 30, samples}, profile))
                        library += fmt::format("{} {} {} {:x}\n", i, pixel.x, pixel.y, pixel.mask);
                }
                CHECK(run.out == library);
            } else {
                CHECK(run.out == expected_text(triangles, rect, profile, samples));
            }
            lines += static_cast<std::size_t>(std::ranges::count(run.out, '\n'));
        }
    }
    CHECK(lines > 100'000);  // they cover something
}

TEST_CASE("gnomon coverage reads decimal and hexadecimal numbers, comments, blank lines and a profile file",
          "[cli][coverage]") {
    const TemporaryFolder folder;
    const std::string plain = gnomon_run(folder, "coverage --size 16x16 --samples 8", "1.5 1.25 9.75 2 3 9\n0 0 7 0 0 7\n").out;
    CHECK(plain.size() > 100);
    const std::string same =
        "# triangles\n\n  0x1.8p+0 1.25 975e-2\t0X2 3.0 +9 # the first\r\n   # nothing here\n0 -0 0x7 0x0p0 0 7";
    CHECK(gnomon_run(folder, "coverage --size 16x16 --samples 8", same).out == plain);

    // Four bits snap 0.53125 (8.5 sixteenths) to the even neighbour, 0.5, so that a column of centres comes in.
    std::ofstream(folder.path() / "four.json") << R"({"raster_subpixel_bits": 4})";
    const std::string edge = "0.53125 -9 9 -9 0.53125 99\n";
    CHECK(gnomon_run(folder, "coverage --size 1x2", edge).out.empty());
    CHECK(gnomon_run(folder, "coverage --size 1x2 --profile four.json", edge).out == "0 0 0 1\n0 0 1 1\n");
    // And one of my own sample order.
    std::ofstream(folder.path() / "order.json") << R"({"sample_positions_2": [[4, 4], [12, 12]]})";
    const std::string corner = "-1 -1 1 -1 -1 1\n";
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 2", "-1 -1 1.9 -1 -1 1.9\n").out == "0 0 0 2\n");
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 2 --profile order.json", "-1 -1 1.9 -1 -1 1.9\n").out ==
          "0 0 0 1\n");
    CHECK(gnomon_run(folder, "coverage --size 1x1 --samples 2", corner).out.empty());
}

TEST_CASE("no sample on a shared edge is printed twice or not at all", "[cli][coverage][3.4.2]") {
    const TemporaryFolder folder;
    // Fans around a random centre that tile a square larger than the target.
    std::string input;
    constexpr int kFans = 12;
    constexpr int kRim = 16;
    for (int fan = 0; fan < kFans; ++fan) {
        oracle::Random random(static_cast<std::uint64_t>(fan));
        const float x = std::nearbyint(random.in(2.0f, 22.0f) * 16.0f) / 16.0f;
        const float y = fan % 2 == 0 ? std::nearbyint(random.in(2.0f, 22.0f) * 2.0f) / 2.0f : random.in(2.0f, 22.0f);
        std::vector<std::pair<float, float>> rim;
        for (int i = 0; i < kRim; ++i) {
            const float t = -1.0f + 26.0f * static_cast<float>(i % 4) / 4.0f;
            switch (i / 4) {
                case 0: rim.emplace_back(t, -1.0f); break;
                case 1: rim.emplace_back(25.0f, t); break;
                case 2: rim.emplace_back(24.0f - t, 25.0f); break;
                default: rim.emplace_back(-1.0f, 24.0f - t); break;
            }
        }
        for (std::size_t i = 0; i < kRim; ++i) {
            const auto [ax, ay] = rim[i];
            const auto [bx, by] = rim[(i + 1) % kRim];
            input += line_of({x, y, ax, ay, bx, by}, fan % 2 == 1);
        }
    }
    for (const int samples : oracle::kSampleCounts) {
        const Outcome run = gnomon_run(folder, fmt::format("coverage --size 24x24 --samples {}", samples), input);
        REQUIRE(run.code == 0);
        std::map<std::tuple<int, int, int>, std::uint32_t> masks;  // by fan, x, y
        std::istringstream out(run.out);
        int triangle = 0, x = 0, y = 0;
        std::uint32_t mask = 0;
        int twice = 0;
        while (out >> std::dec >> triangle >> x >> y >> std::hex >> mask) {
            std::uint32_t& all = masks[{triangle / kRim, x, y}];
            twice += (all & mask) != 0 ? 1 : 0;
            all |= mask;
        }
        INFO("samples " << samples);
        CHECK(twice == 0);
        CHECK(masks.size() == kFans * 24 * 24);
        const std::uint32_t whole = (1u << samples) - 1u;
        CHECK(std::ranges::all_of(masks, [&](const auto& entry) { return entry.second == whole; }));
    }
}

TEST_CASE("gnomon coverage refuses bad input in one line and prints nothing", "[cli][coverage][errors]") {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "bad.json") << R"({"raster_subpixel_bits": 9})";
    std::ofstream(folder.path() / "pair.json") << R"({"sample_positions_2": [[4, 4]]})";
    std::ofstream(folder.path() / "far.json") << R"({"sample_positions_2": [[4, 4], [16, 0]]})";
    const std::string ok = "0 0 4 0 0 4\n";
    const std::vector<std::tuple<std::string, std::string, std::string>> cases{
        {"coverage", ok, "--size"},
        {"coverage --size", ok, "--size"},
        {"coverage --size 8", ok, "--size 8"},
        {"coverage --size 0x8", ok, "--size 0x8"},
        {"coverage --size 8x-8", ok, "--size 8x-8"},
        {"coverage --size 8x8x8", ok, "--size 8x8x8"},
        {"coverage --size 16385x1", ok, "--size 16385x1"},
        {"coverage --size 8x8 --samples 0", ok, "--samples 0"},
        {"coverage --size 8x8 --samples 3", ok, "--samples 3"},
        {"coverage --size 8x8 --samples 32", ok, "--samples 32"},
        {"coverage --size 8x8 --samples four", ok, "--samples four"},
        {"coverage --size 8x8 --samples 8 --profile llvmpipe", ok, "at most 4"},
        {"coverage --size 8x8 --profile nobody", ok, "nobody"},
        {"coverage --size 8x8 --profile bad.json", ok, "raster_subpixel_bits"},
        {"coverage --size 8x8 --profile pair.json", ok, "sample_positions_2"},
        {"coverage --size 8x8 --profile far.json", ok, "sample_positions_2"},
        {"coverage --size 8x8 --threads 2", ok, "--threads"},
        {"coverage --size 8x8 more", ok, "more"},
        {"coverage --size 8x8", "0 0 4 0 0\n", "stdin line 1: 5 numbers"},
        {"coverage --size 8x8", ok + "\n0 0 4 0 0 4 4\n", "stdin line 3: 7 numbers"},
        {"coverage --size 8x8", ok + "0 0 4 zero 0 4\n", "stdin line 2: 'zero'"},
        {"coverage --size 8x8", "0 0 4 0 0 4x\n", "'4x'"},
        {"coverage --size 8x8", "0,0 4,0 0,4 1 1 1\n", "'0,0'"},
        {"coverage --size 8x8", "0 0 nan 0 0 4\n", "nan"},
        {"coverage --size 8x8", "0 0 inf 0 0 4\n", "inf"},
        {"coverage --size 8x8", "0 0 1e39 0 0 4\n", "1e39"},
        {"coverage --size 8x8", "0 0 32767.01 0 0 4\n", "32767"},
        {"coverage --size 8x8", "0 0 -40000 0 0 4\n", "-40000"},
        {"coverage --size 8x8", "0 0 0x 0 0 4\n", "'0x'"},
    };
    for (const auto& [arguments, input, needle] : cases) {
        const Outcome run = gnomon_run(folder, arguments, input);
        INFO("gnomon " << arguments << " < " << input << " : " << run.err);
        CHECK(run.code == 2);
        CHECK(run.out.empty());
        CHECK(run.err.starts_with("gnomon: "));
        CHECK(std::ranges::count(run.err, '\n') == 1);
        CHECK(run.err.find(needle) != std::string::npos);
    }
    CHECK(gnomon_run(folder, "coverage --size 8x8", "0 0 32767 0 0 -32767\n").code == 0);
}

TEST_CASE("visiting covered pixels gives rows in order, whatever the triangle's size", "[coverage][3.4.2]") {
    const Profile profile;
    const std::array<glm::vec2, 3> corners{{{3.25f, -20.0f}, {700.5f, 130.0f}, {10.0f, 640.75f}}};
    std::vector<CoveredPixel> all;
    std::size_t largest = 0;
    visit_covered_pixels(corners, {600, 600, 4}, profile, [&](std::span<const CoveredPixel> pixels) {
        REQUIRE(!pixels.empty());
        all.insert(all.end(), pixels.begin(), pixels.end());
        largest = std::max(largest, pixels.size());
    });
    CHECK(all == covered_pixels(corners, {600, 600, 4}, profile));
    CHECK(std::ranges::is_sorted(all, {}, [](const CoveredPixel& pixel) { return std::pair(pixel.y, pixel.x); }));
    CHECK(all.size() > 100'000);
    CHECK(largest <= 600 * 64);
}
