// D3D11.3 3.5.4: with several samples per pixel coverage and depth are per sample, the pixel functor runs once per pixel or,
// where it asks for it, once per sample (3.5.4.1) without changing what does not depend on that (3.5.4.1.1). 17.17: the sample
// mask.
#include "tests/oracle/interpolation.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Masks;
using oracle::Random;
using oracle::SnappedTriangle;

namespace {

struct Case {
    std::vector<RasterVertex> vertices;
    SnappedTriangle t;
};

/// A triangle with random depths and attributes, w a power of two.
Case random_case(std::uint64_t seed, const oracle::TriangleTarget& target, float mark) {
    Random random(seed);
    Case c;
    const auto kind = seed % 3 == 0 ? oracle::TriangleKind::SubPixel : oracle::TriangleKind::Ordinary;
    const SnappedTriangle wanted = oracle::random_triangle(random, kind, target);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto placed = oracle::place(random, wanted[i], target.rect());
        RasterVertex v = vertex_of(placed, mark);
        v.clip[2] = random.in(0.2f, 0.8f) * v.clip[3];
        v.b = random.in(-4.0f, 4.0f);
        c.vertices.push_back(v);
        c.t[i] = placed.snapped;
    }
    return c;
}

}  // namespace

TEST_CASE("samples outside the sample mask are not drawn", "[raster][msaa][3.5.4][16.3.2][17.17]") {
    std::uint64_t drawn = 0;
    for (const int samples : oracle::kSampleCounts) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(identify_program(), Profile{}, {.samples = samples, .depth = Format::D32Float});
        for (std::uint32_t k = 0; k < 64; ++k) {
            // Every mask of up to 4 samples, random ones of more; bits beyond the samples mean nothing.
            Random random(k);
            const std::uint32_t mask = samples <= 4 ? k : random.bits();
            const Case c = random_case(k, target, 1.0f);
            canvas.clear();
            Draw draw = canvas.draw_of(c.vertices);
            draw.output.sample_mask = mask;
            draw.depth_state = {.compare = CompareOp::Less};
            canvas.execute(draw);
            const Masks covered = oracle::coverage(c.t, target.rect(), target.pattern);
            Masks expected(target.rect());
            for (const auto& pixel : oracle::covered_pixels(covered)) expected.at(pixel.x, pixel.y) = pixel.mask & mask;
            drawn += expected.samples();
            const std::string wrong = difference(expected, canvas.masks(1.0f));
            if (!wrong.empty()) FAIL(fmt::format("{} samples, mask {:#x}, seed {}: {}", samples, mask, k, wrong));
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 16; ++x)
                    for (int s = 0; s < samples; ++s) {
                        const SampleAt at{.x = x, .y = y, .sample = s};
                        const bool written = (expected.at(x, y) >> s & 1u) != 0;
                        // The functor sees what is left. D3D11.3 16.3.2
                        const bool depth_written = canvas.depth_code(at) != std::bit_cast<std::uint32_t>(1.0f);
                        const bool seen = canvas.value(1, 1, at) == static_cast<float>(expected.at(x, y));
                        if (depth_written != written || (written && !seen))
                            FAIL(
                                fmt::format("{} samples, mask {:#x}, pixel ({}, {}), sample {}: depth written {}, coverage {}, "
                                            "expected {:#x}",
                                            samples, mask, x, y, s, depth_written, canvas.value(1, 1, at), expected.at(x, y)));
                    }
        }
    }
    CHECK(drawn > 10000);
}

TEST_CASE("every sample has the depth of its own position", "[raster][msaa][3.5.4][15.16.2]") {
    for (const int samples : {2, 4, 8, 16}) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas canvas(mark_program(), Profile{}, {.samples = samples, .depth = Format::D32Float});
        std::uint64_t compared = 0;
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            Case c = random_case(seed, target, 1.0f);
            // Equal w: vertex 0 stays the origin of the plane.
            for (RasterVertex& v : c.vertices) {
                const float w = v.clip[3];
                for (float& component : v.clip) component /= w;
            }
            canvas.clear();
            Draw draw = canvas.draw_of(c.vertices);
            draw.depth_state = {.compare = CompareOp::Always};
            canvas.execute(draw);
            const std::array<float, 3> z{c.vertices[0].clip[2], c.vertices[1].clip[2], c.vertices[2].clip[2]};
            for (const auto& pixel : oracle::covered_pixels(oracle::coverage(c.t, target.rect(), target.pattern)))
                for (int s = 0; s < samples; ++s) {
                    const float stored = std::bit_cast<float>(canvas.depth_code({.x = pixel.x, .y = pixel.y, .sample = s}));
                    if ((pixel.mask >> s & 1u) == 0) {
                        REQUIRE(stored == 1.0f);
                        continue;
                    }
                    ++compared;
                    const auto bound = oracle::plane_bound(c.t, z, target.pattern.at(pixel.x, pixel.y, s));
                    if (!bound.allows(stored))
                        FAIL(fmt::format("{} samples, seed {}, pixel ({}, {}), sample {}: {:a}, expected {} +- {}", samples,
                                         seed, pixel.x, pixel.y, s, stored, static_cast<double>(bound.value),
                                         static_cast<double>(bound.error)));
                }
        }
        CHECK(compared > 1000);
    }
}

TEST_CASE("where two triangles cross, each sample shows the nearer one", "[raster][msaa][3.5.4][17.9]") {
    const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(8)};
    std::uint64_t mixed = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        std::array<Case, 2> cases{random_case(3 * seed + 1, target, 1.0f), random_case(3 * seed + 2, target, 2.0f)};
        const CanvasDesc desc{.samples = 8, .depth = Format::D32Float};
        Canvas first(mark_program(), Profile{}, desc);
        Canvas second(mark_program(), Profile{}, desc);
        Canvas both(mark_program(), Profile{}, desc);
        const auto draw = [](Canvas& canvas, const Case& c) {
            Draw command = canvas.draw_of(c.vertices);
            command.depth_state = {.compare = CompareOp::Less};
            canvas.execute(command);
        };
        draw(first, cases[0]);
        draw(second, cases[1]);
        draw(both, cases[0]);
        draw(both, cases[1]);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                int ones = 0;
                int twos = 0;
                for (int s = 0; s < 8; ++s) {
                    const SampleAt at{.x = x, .y = y, .sample = s};
                    const bool one = first.value(0, 0, at) == 1.0f;
                    const bool two = second.value(0, 0, at) == 2.0f && second.depth_code(at) < first.depth_code(at);
                    const float expected = two ? 2.0f : one ? 1.0f : kUntouched;
                    ones += expected == 1.0f;
                    twos += expected == 2.0f;
                    INFO("seed " << seed << ", pixel (" << x << ", " << y << "), sample " << s);
                    REQUIRE(both.value(0, 0, at) == expected);
                }
                mixed += ones > 0 && twos > 0;
            }
    }
    CHECK(mixed > 50);
}

TEST_CASE("one run per pixel, or one per sample", "[raster][msaa][3.5.4.1][3.5.4.1.1]") {
    for (const int samples : {2, 4, 16}) {
        const oracle::TriangleTarget target{.pattern = oracle::standard_pattern(samples)};
        Canvas by_pixel(interpolation_program(), Profile{}, {.samples = samples});
        Canvas by_sample(sample_program(), Profile{}, {.samples = samples});
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            const Case c = random_case(seed, target, 1.0f);
            const auto run = [&](Canvas& canvas) {
                canvas.clear();
                canvas.device().enable_counters(true);
                canvas.execute(canvas.draw_of(c.vertices));
                return canvas.device().take_counters();
            };
            const Counters pixel_counts = run(by_pixel);
            const Counters sample_counts = run(by_sample);
            const auto covered = oracle::coverage(c.t, target.rect(), target.pattern);
            const auto pixels = oracle::covered_pixels(covered);
            INFO(samples << " samples, seed " << seed);
            REQUIRE(pixel_counts.lanes_shaded == pixels.size());
            REQUIRE(sample_counts.lanes_shaded == covered.samples());
            REQUIRE(pixel_counts.samples_covered == covered.samples());
            for (const auto& pixel : pixels) {
                const SampleAt lowest{.x = pixel.x, .y = pixel.y, .sample = std::countr_zero(pixel.mask)};
                for (int s = 0; s < samples; ++s) {
                    if ((pixel.mask >> s & 1u) == 0) continue;
                    const SampleAt at{.x = pixel.x, .y = pixel.y, .sample = s};
                    REQUIRE(by_sample.value(5, 3, at) == static_cast<float>(s));
                    for (std::size_t t = 0; t < 5; ++t)
                        for (int component = 0; component < 4; ++component) {
                            const float here = by_pixel.value(t, component, at);
                            REQUIRE(here == by_pixel.value(t, component, lowest));
                            // Invariance: all but the position, which belongs to the run, is as it was. D3D11.3 3.5.4.1.1
                            if (t > 0 && !(t == 1 && component == 3)) REQUIRE(here == by_sample.value(t, component, at));
                        }
                }
            }
        }
    }
}
