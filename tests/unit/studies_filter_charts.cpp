// Filter charts against the record of single samples.
#include "studies/filter_charts.h"

#include "texunit/record.h"

#include <catch2/catch.hpp>

#include <set>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

/// As numbers, so that failures print them.
using Codes = std::array<int, 3>;
Codes codes(const Rgb& color) { return {color[0], color[1], color[2]}; }

Codes pixel(const ByteImage& image, int x, int y) {
    const std::size_t first =
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    return {image.values[first], image.values[first + 1], image.values[first + 2]};
}

/// What the arithmetic of a profile keeps of a number.
double taken(double value, const Profile& profile) {
    return profile.arithmetic == Arithmetic::Fp32 ? static_cast<double>(static_cast<float>(value)) : value;
}

/// The sample of one pixel, its derivatives from the corners of its quad that the profile looks at.
SampleRequest request_at(const ChartView& view, int x, int y, const Profile& profile) {
    const int patch = chart_patch(view, x, y);
    const auto at = [&](int px, int py) -> std::array<double, 2> {
        const glm::dvec2 uv = chart_coordinate(view, patch, px, py);
        return {taken(uv.x, profile), taken(uv.y, profile)};
    };
    const int left = x & ~1;
    const int top = y & ~1;
    const bool shared = profile.lod_sharing == LodSharing::Quad;
    const auto difference = [&](const std::array<double, 2>& to, const std::array<double, 2>& from) -> std::array<double, 3> {
        return {taken(to[0] - from[0], profile), taken(to[1] - from[1], profile), 0.0};
    };
    const int row = shared ? top : y;
    const int column = shared ? left : x;
    const auto here = at(x, y);
    return {.coordinate = {here[0], here[1], 0.0},
            .gradient = SampleRequest::Gradient{.dx = difference(at(left + 1, row), at(left, row)),
                                                .dy = difference(at(column, top + 1), at(column, top))}};
}

int texels_of(const SampleRecord& record) {
    std::size_t texels = 0;
    for (const ProbeRecord& probe : record.probes)
        for (const LevelRecord& level : probe.levels) texels += level.taps.size();
    return static_cast<int>(texels);
}

/// SwiftShader walks its probes once per level.
int probes_of(const SampleRecord& record) {
    const int first = record.probes.front().levels.front().level;
    return static_cast<int>(
        std::ranges::count_if(record.probes, [&](const ProbeRecord& probe) { return probe.levels.front().level == first; }));
}

std::uint8_t code_of(double value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5); }

struct Case {
    ChartScene scene;
    ChartFilter filter;
    std::string profile;
    Format format = Format::Rgba8Unorm;
};

/// Compares one pixel in five.
void check_against_records(const Case& c, int width, int height) {
    INFO(name_of(c.scene) << ' ' << c.profile << ' ' << name_of(c.filter) << ' ' << name_of(c.format));
    const Profile profile = load_profile(c.profile);
    Workers workers(1);
    const ChartView view{.scene = c.scene, .width = width, .height = height};
    const Texture texture = chart_texture(c.scene, c.format, profile, workers);
    const Sampler sampler = chart_sampler(c.filter, 16);
    const Chart chart = draw_chart(view, texture, sampler, profile, workers);
    const bool elliptical = is_elliptical(sampler, profile);
    std::set<Codes> lods;
    for (int y = 0; y < height; ++y)
        for (int x = y % 5; x < width; x += 5) {
            INFO("pixel " << x << ',' << y);
            if (chart_patch(view, x, y) == kNoPatch) {
                REQUIRE(pixel(chart.picture, x, y) == codes(kBackground));
                REQUIRE(pixel(chart.lod, x, y) == codes(kBackground));
                REQUIRE(pixel(chart.probes, x, y) == codes(kBackground));
                continue;
            }
            const SampleRecord record = record_sample(texture, sampler, profile, request_at(view, x, y, profile));
            const Rgb color{code_of(record.result[0]), code_of(record.result[1]), code_of(record.result[2])};
            REQUIRE(pixel(chart.picture, x, y) == codes(color));
            REQUIRE(pixel(chart.lod, x, y) == codes(record.magnified ? kMagnified : lod_color(record.clamped_lod)));
            const int step = elliptical ? texel_step(texels_of(record)) : probe_step(probes_of(record));
            REQUIRE(pixel(chart.probes, x, y) == codes(amount_color(step)));
            lods.insert(pixel(chart.lod, x, y));
        }
    CHECK(lods.size() > 5);
}

}  // namespace

TEST_CASE("pixels of filter charts are the samples that records say", "[charts]") {
    for (const ChartScene scene : {ChartScene::Plane, ChartScene::Tunnel, ChartScene::Angles})
        for (const char* profile : {"d3d11", "d3d10", "nv40", "g80", "llvmpipe", "swiftshader", "ideal"})
            for (const ChartFilter filter :
                 {ChartFilter::Nearest, ChartFilter::Bilinear, ChartFilter::Trilinear, ChartFilter::Aniso})
                check_against_records({.scene = scene, .filter = filter, .profile = profile}, 47, 38);
}

TEST_CASE("filter charts of other formats are the samples that records say", "[charts]") {
    for (const Format format : {Format::Rgba32Float, Format::Rgba16Float, Format::R8Unorm, Format::Rgba8Srgb, Format::D24})
        for (const char* profile : {"nv40", "ideal"})
            check_against_records(
                {.scene = ChartScene::Angles, .filter = ChartFilter::Aniso, .profile = profile, .format = format}, 33, 32);
    Workers workers(1);
    CHECK_THROWS_AS(chart_texture(ChartScene::Plane, Format::R32Uint, load_profile("d3d11"), workers), Error);
}

TEST_CASE("filter charts are the same for any number of threads and of any size", "[charts]") {
    const Profile profile = load_profile("d3d11");
    const Sampler sampler = chart_sampler(ChartFilter::Aniso, 16);
    for (const ChartScene scene : {ChartScene::Plane, ChartScene::Tunnel, ChartScene::Angles})
        for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {5, 7}, {130, 67}}) {
            const ChartView view{.scene = scene, .width = width, .height = height};
            std::vector<Chart> charts;
            for (const int threads : {1, 2}) {
                Workers workers(threads);
                const Texture texture = chart_texture(scene, Format::Rgba8Unorm, profile, workers);
                charts.push_back(draw_chart(view, texture, sampler, profile, workers));
            }
            CHECK(charts[0].picture.values.size() == static_cast<std::size_t>(3 * width * height));
            CHECK(charts[0].picture.values == charts[1].picture.values);
            CHECK(charts[0].lod.values == charts[1].lod.values);
            CHECK(charts[0].probes.values == charts[1].probes.values);
        }
}

TEST_CASE("quads of a chart are never torn by the seam of the tunnel", "[charts]") {
    // Away from the middle the level of detail of neighbours differs little; a torn quad would be at the coarsest level.
    const ChartView view{.scene = ChartScene::Tunnel, .width = 101, .height = 100};
    for (const int x : {0, 48, 49, 50, 51, 100})
        for (const int y : {0, 20, 48, 49, 50, 51, 80}) {
            if (std::abs(x - 50) + std::abs(y - 50) < 4) continue;
            const int patch = chart_patch(view, x, y);
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                CHECK(std::abs(chart_coordinate(view, patch, x + dx, y + dy).x - chart_coordinate(view, patch, x, y).x) < 0.5);
        }
}

TEST_CASE("false colours of charts: what each value becomes", "[charts]") {
    CHECK(codes(lod_color(-3.0)) == codes(kMagnified));
    CHECK(codes(lod_color(0.0)) == codes(kMagnified));
    CHECK(codes(lod_color(0x1p-20)) == codes(kLevelColors[0]));
    for (std::size_t level = 1; level < kLevelColors.size(); ++level)
        CHECK(codes(lod_color(static_cast<double>(level))) == codes(kLevelColors[level]));
    CHECK(codes(lod_color(1000.0)) == codes(kLevelColors.back()));
    CHECK(probe_step(1) == 0);
    CHECK(probe_step(16) == 15);
    const std::array limits{4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
    for (std::size_t step = 0; step < limits.size(); ++step) {
        CHECK(texel_step(limits[step]) == static_cast<int>(step));
        CHECK(texel_step(limits[step] + 1) == static_cast<int>(step) + 1);
    }
    std::set<Rgb> colors;
    for (int step = 0; step < kAmountSteps; ++step) colors.insert(amount_color(step));
    CHECK(colors.size() == kAmountSteps);
}
