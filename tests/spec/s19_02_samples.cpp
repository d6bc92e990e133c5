// D3D11.3 19.2: sample counts of a profile, its standard sample positions (19.2.4) and its own order or positions.
#include "pipeline/coverage_query.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using Pattern = oracle::SamplePattern;

namespace {

/// Where every sample of pixel (1, 1) lies, found out with vertical and horizontal edges: the largest k / 256 at which a half
/// plane right of (below) it still has the sample.
Pattern measured(const Profile& profile, int samples) {
    Pattern pattern{.count = samples};
    const CoverageTarget target{.width = 4, .height = 4, .samples = samples};
    const auto positions_of = [&](bool along_x, int s) {
        int found = -1;
        for (int k = 0; k <= 256; ++k) {
            const float edge = 1.0f + static_cast<float>(k) / 256.0f;
            const std::array<glm::vec2, 3> right{glm::vec2(edge, -50), glm::vec2(edge + 100, 2), glm::vec2(edge, 54)};
            const std::array<glm::vec2, 3> below{glm::vec2(-50, edge), glm::vec2(54, edge), glm::vec2(2, edge + 100)};
            for (const CoveredPixel& pixel : covered_pixels(along_x ? right : below, target, profile))
                if (pixel.x == 1 && pixel.y == 1 && (pixel.mask >> s & 1u) != 0) found = k;
        }
        return found;
    };
    for (int s = 0; s < samples; ++s) {
        const int x = positions_of(true, s);
        const int y = positions_of(false, s);
        if (x % 16 != 0 || y % 16 != 0) FAIL("sample " << s << " at (" << x << ", " << y << ")/256");
        pattern.positions[static_cast<std::size_t>(s)] = {x / 16, y / 16};
    }
    return pattern;
}

void check_same(const Pattern& expected, const Pattern& got, std::string_view what) {
    for (std::size_t s = 0; s < static_cast<std::size_t>(expected.count); ++s) {
        INFO(what << ", " << expected.count << " samples, sample " << s << ": (" << got.positions[s].first << ", "
                  << got.positions[s].second << ")/16");
        CHECK(got.positions[s] == expected.positions[s]);
    }
}

}  // namespace

TEST_CASE("the standard patterns are where the samples are", "[raster][19.2.4]") {
    for (const int samples : oracle::kSampleCounts)
        check_same(oracle::standard_pattern(samples), measured(load_profile("d3d11"), samples), "d3d11");
}

TEST_CASE("a profile's own order and positions", "[raster][19.2.4]") {
    // NV50 as its driver programs it: the standard positions of 2 and 8 samples in an order of their own.
    const Profile g80 = load_profile("g80");
    check_same({2, {{{4, 4}, {12, 12}}}}, measured(g80, 2), "g80");
    check_same(oracle::standard_pattern(4), measured(g80, 4), "g80");
    check_same({8, {{{1, 7}, {5, 3}, {3, 13}, {7, 11}, {9, 5}, {15, 1}, {11, 15}, {13, 9}}}}, measured(g80, 8), "g80");
    // Positions nobody uses, two of them the same, on borders of the pixel.
    Profile odd;
    odd.sample_positions_4 = {{{0, 0}, {15, 15}, {0, 0}, {8, 3}}};
    const Pattern pattern{4, {{{0, 0}, {15, 15}, {0, 0}, {8, 3}}}};
    check_same(pattern, measured(odd, 4), "own");
    // Draws use them too.
    const oracle::TriangleTarget target{.pattern = pattern};
    Canvas canvas(mark_program(), odd, {.samples = 4});
    for (std::uint64_t index = 0; index < 400; ++index) {
        const auto t = oracle::triangle_case(index, target).triangle;
        oracle::Random random(index);
        std::vector<RasterVertex> vertices;
        oracle::SnappedTriangle snapped;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto placed = oracle::place(random, t[i], target.rect());
            vertices.push_back(vertex_of(placed, static_cast<float>(index)));
            snapped[i] = placed.snapped;
        }
        canvas.execute(canvas.draw_of(vertices));
        const std::string wrong =
            difference(oracle::coverage(snapped, target.rect(), pattern), canvas.masks(static_cast<float>(index)));
        if (!wrong.empty()) FAIL(fmt::format("case {}: {}\n  {}", index, wrong, describe(snapped)));
    }
}

TEST_CASE("more samples than the profile has are refused", "[raster][19.2]") {
    for (const char* name : {"nv40", "g80", "d3d10", "d3d11", "llvmpipe", "swiftshader", "ideal"}) {
        const Profile profile = load_profile(name);
        Device device(profile, 1);
        for (const int samples : oracle::kSampleCounts) {
            INFO(name << ", " << samples << " samples");
            const TextureDesc color{.format = Format::Rgba8Unorm, .width = 4, .height = 4, .samples = samples};
            const TextureDesc depth{.format = Format::D16, .width = 4, .height = 4, .samples = samples};
            const auto query = [&] {
                return covered_pixels({glm::vec2(0), glm::vec2(4, 0), glm::vec2(0, 4)}, {4, 4, samples}, profile);
            };
            if (samples <= profile.max_samples) {
                CHECK_NOTHROW(device.create_texture("c", color));
                CHECK_NOTHROW(device.create_texture("d", depth));
                CHECK(query().size() >= 6);
            } else {
                CHECK_THROWS_WITH(device.create_texture("c", color), Catch::Contains("samples"));
                CHECK_THROWS_WITH(device.create_texture("d", depth), Catch::Contains("samples"));
                CHECK_THROWS_WITH(query(), Catch::Contains("samples"));
            }
        }
        for (const int samples : {-1, 0, 3, 5, 32})
            CHECK_THROWS(
                device.create_texture("c", {.format = Format::Rgba8Unorm, .width = 4, .height = 4, .samples = samples}));
    }
}
