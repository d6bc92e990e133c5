// D3D11.3 15.5, 15.16.2, 16.3, 16.4: perspective, linear and flat values at centres and samples against exact barycentrics,
// each within the error of its own arithmetic; z is the same bits in the pixel functor and in the depth buffer.
#include "tests/oracle/interpolation.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Point;
using oracle::Random;
using oracle::Rounded;
using oracle::SnappedTriangle;

namespace {

struct Case {
    std::vector<RasterVertex> vertices;
    // In the order in which the pipeline documents its planes: clockwise, the farthest vertex first.
    SnappedTriangle t;
    std::array<float, 3> z, w, a, b;
    float flat_a = 0;
};

Case random_case(std::uint64_t seed, const oracle::TriangleTarget& target) {
    Random random(seed);
    Case c;
    const auto kind = oracle::kTriangleKinds[seed % 7];  // all that have an area, mostly
    const SnappedTriangle wanted = oracle::random_triangle(random, kind, target);
    std::array<std::size_t, 3> order{0, 1, 2};
    SnappedTriangle t;
    for (std::size_t i = 0; i < 3; ++i) {
        RasterVertex v = vertex_at(wanted[i], target.rect());
        const float w = random.chance(3) ? 1.0f : random.in(0.25f, 8.0f);
        const float z = random.in(0.1f, 0.9f);
        v.clip = {v.clip[0] * w, v.clip[1] * w, z * w, w};
        v.a = random.in(-10.0f, 10.0f);
        v.b = random.chance(4) ? 1e6f : random.unit();
        c.vertices.push_back(v);
        t[i] = {oracle::snap(v.clip[0] / w, 0, target.width, 8), oracle::snap(-(v.clip[1] / w), 0, target.height, 8)};
    }
    if (oracle::turn(t[0], t[1], t[2]) < 0) std::swap(order[1], order[2]);
    std::size_t farthest = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (1.0f / c.vertices[order[i]].clip[3] < 1.0f / c.vertices[order[farthest]].clip[3]) farthest = i;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t from = order[(farthest + i) % 3];
        const RasterVertex& v = c.vertices[from];
        c.t[i] = t[from];
        c.z[i] = v.clip[2] / v.clip[3];
        c.w[i] = v.clip[3];
        c.a[i] = v.a;
        c.b[i] = v.b;
    }
    c.flat_a = c.vertices[0].a;
    return c;
}

/// Far away corners are clipped, which makes other vertices.
bool in_guard_band(const Case& c) {
    return std::ranges::all_of(c.t, [](const Point& p) {
        return std::abs(p.x) < std::int64_t{32760} * 256 && std::abs(p.y) < std::int64_t{32760} * 256;
    });
}

void check(std::string_view what, const Rounded& bound, float got, std::uint64_t seed, const SampleAt& at) {
    if (!bound.allows(got))
        FAIL(fmt::format("{}: seed {}, pixel ({}, {}), sample {}: {:a}, expected {:a} +- {:a}", what, seed, at.x, at.y,
                         at.sample, got, static_cast<double>(bound.value), static_cast<double>(bound.error)));
}

}  // namespace

TEST_CASE("values at pixel centres", "[raster][interpolation][15.16.2][16.4][15.5]") {
    std::uint64_t compared = 0;
    std::uint64_t curved = 0;  // where linear and perspective differ
    for (const int samples : {1, 4}) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(interpolation_program(), Profile{}, {.samples = samples});
        for (std::uint64_t seed = 0; seed < 400; ++seed) {
            const Case c = random_case(seed, target);
            if (!in_guard_band(c)) continue;
            canvas.clear();
            canvas.execute(canvas.draw_of(c.vertices));
            for (const auto& pixel : oracle::covered_pixels(oracle::coverage(c.t, target.rect(), target.pattern))) {
                const SampleAt at{.x = pixel.x, .y = pixel.y, .sample = std::countr_zero(pixel.mask)};
                const Point centre = oracle::pixel_center(pixel.x, pixel.y);
                const float perspective = canvas.value(1, 0, at);
                const float linear = canvas.value(1, 1, at);
                check("perspective a", oracle::perspective_bound(c.t, c.a, c.w, centre), perspective, seed, at);
                check("perspective b", oracle::perspective_bound(c.t, c.b, c.w, centre), canvas.value(2, 0, at), seed, at);
                check("linear a", oracle::linear_bound(c.t, c.a, centre), linear, seed, at);
                check("linear b", oracle::linear_bound(c.t, c.b, centre), canvas.value(2, 1, at), seed, at);
                check("w", oracle::perspective_w_bound(c.t, c.w, centre), canvas.value(0, 3, at), seed, at);
                check("z", oracle::plane_bound(c.t, c.z, centre), canvas.value(0, 2, at), seed, at);
                REQUIRE(canvas.value(1, 2, at) == c.flat_a);
                REQUIRE(canvas.value(0, 0, at) == static_cast<float>(pixel.x) + 0.5f);
                REQUIRE(canvas.value(0, 1, at) == static_cast<float>(pixel.y) + 0.5f);
                ++compared;
                curved += std::fabs(perspective - linear) > 0.5f;
            }
        }
    }
    CHECK(compared > 10000);
    CHECK(curved > 1000);
}

TEST_CASE("values at samples", "[raster][interpolation][15.16.2][16.4][3.5.4.1]") {
    std::uint64_t compared = 0;
    for (const int samples : {2, 8}) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(sample_program(), Profile{}, {.samples = samples});
        for (std::uint64_t seed = 0; seed < 120; ++seed) {
            const Case c = random_case(seed + 10000, target);
            if (!in_guard_band(c)) continue;
            canvas.clear();
            canvas.execute(canvas.draw_of(c.vertices));
            for (const auto& pixel : oracle::covered_pixels(oracle::coverage(c.t, target.rect(), target.pattern)))
                for (int s = 0; s < samples; ++s) {
                    if ((pixel.mask >> s & 1u) == 0) continue;
                    const SampleAt at{.x = pixel.x, .y = pixel.y, .sample = s};
                    const Point p = target.pattern.at(pixel.x, pixel.y, s);
                    check("sample a", oracle::perspective_bound(c.t, c.a, c.w, p), canvas.value(5, 0, at), seed, at);
                    check("linear sample a", oracle::linear_bound(c.t, c.a, p), canvas.value(5, 1, at), seed, at);
                    check("sample b", oracle::perspective_bound(c.t, c.b, c.w, p), canvas.value(5, 2, at), seed, at);
                    check("w", oracle::perspective_w_bound(c.t, c.w, p), canvas.value(0, 3, at), seed, at);
                    check("z", oracle::plane_bound(c.t, c.z, p), canvas.value(0, 2, at), seed, at);
                    REQUIRE(canvas.value(0, 0, at) == static_cast<float>(p.x) / 256.0f);
                    REQUIRE(canvas.value(0, 1, at) == static_cast<float>(p.y) / 256.0f);
                    ++compared;
                }
        }
    }
    CHECK(compared > 10000);
}

TEST_CASE("values that are equal at all vertices stay what they are", "[raster][interpolation][15.16.2]") {
    const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(4)};
    Canvas canvas(sample_program(), Profile{}, {.samples = 4});
    std::uint64_t compared = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Case c = random_case(seed, target);
        for (RasterVertex& v : c.vertices) {
            v.a = c.vertices[0].a;
            v.b = c.vertices[0].b;
        }
        canvas.clear();
        canvas.execute(canvas.draw_of(c.vertices));
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                for (int s = 0; s < 4; ++s) {
                    const SampleAt at{.x = x, .y = y, .sample = s};
                    if (canvas.value(5, 3, at) == kUntouched) continue;
                    ++compared;
                    for (const auto& [target_index, component] :
                         {std::pair{1u, 0}, {1u, 1}, {1u, 2}, {3u, 0}, {3u, 1}, {5u, 0}, {5u, 1}})
                        REQUIRE(canvas.value(target_index, component, at) == c.vertices[0].a);
                }
    }
    CHECK(compared > 10000);
}

TEST_CASE("z is the same in the pixel functor and in the depth buffer", "[raster][interpolation][15.16.2][15.10]") {
    std::uint64_t compared = 0;
    std::uint64_t differing = 0;  // samples whose depths differ within a pixel
    for (const bool per_sample : {false, true})
        for (const int samples : {1, 4})
            for (const DepthBiasPlace place : {DepthBiasPlace::Vertex, DepthBiasPlace::Fragment})
                for (const bool biased : {false, true}) {
                    if (samples > 1 && !per_sample) continue;  // then depth is at the samples and position.z at the centre
                    Profile profile;
                    profile.depth_bias_place = place;
                    const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
                    Canvas canvas(per_sample ? sample_program() : interpolation_program(), profile,
                                  {.samples = samples, .depth = Format::D32Float});
                    for (std::uint64_t seed = 0; seed < 150; ++seed) {
                        Case c = random_case(seed, target);
                        // Slopes of slivers are steep: hold the depths together, so that none leaves the range.
                        for (RasterVertex& v : c.vertices) v.clip[2] = (0.5f + 0.001f * v.clip[2] / v.clip[3]) * v.clip[3];
                        canvas.clear();
                        Draw draw = canvas.draw_of(c.vertices);
                        draw.depth_state = {.compare = CompareOp::Always};
                        if (biased) {
                            draw.raster.depth_bias = 37;
                            draw.raster.slope_scaled_depth_bias = 1.25f;
                            draw.raster.depth_bias_clamp = 0.25f;
                        }
                        canvas.execute(draw);
                        for (const auto& pixel : oracle::covered_pixels(oracle::coverage(c.t, target.rect(), target.pattern))) {
                            std::uint32_t first = 0;
                            for (int s = 0; s < samples; ++s) {
                                if ((pixel.mask >> s & 1u) == 0) continue;
                                const SampleAt at{.x = pixel.x, .y = pixel.y, .sample = s};
                                const std::uint32_t stored = canvas.depth_code(at);
                                const auto seen = std::bit_cast<std::uint32_t>(canvas.value(0, 2, at));
                                if (stored != seen)
                                    FAIL(fmt::format("seed {}, pixel ({}, {}), sample {}: shader {:a}, buffer {:a}", seed, at.x,
                                                     at.y, s, std::bit_cast<float>(seen), std::bit_cast<float>(stored)));
                                differing += first != 0 && stored != first;
                                first = stored;
                                ++compared;
                            }
                        }
                    }
                }
    CHECK(compared > 20000);
    CHECK(differing > 1000);
}
