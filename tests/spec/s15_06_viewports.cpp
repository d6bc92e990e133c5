// D3D11.3 15.6 viewport transform with fractional origins and sizes, 15.7 scissors, 15.8.1 viewport arrays, 15.9 depth range.
#include "tests/oracle/lines.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Masks;
using oracle::Random;

namespace {

/// One axis of 15.6 in fp32, then the nearest grid position, ties to even. `ndc` grows to the right or downwards.
std::int64_t snapped(float ndc, float origin, float size) {
    const float scaled = (ndc + 1.0f) * size * 0.5f;
    const float position = scaled + origin;
    const double steps = static_cast<double>(position) * 256.0;
    double whole = std::floor(steps);
    if (steps - whole > 0.5 || (steps - whole == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return static_cast<std::int64_t>(whole);
}

oracle::SnappedTriangle place_in(const Viewport& v, const std::vector<RasterVertex>& vertices) {
    oracle::SnappedTriangle t;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& clip = vertices[i].clip;
        t[i] = {snapped(clip[0] / clip[3], v.x, v.width), snapped(-(clip[1] / clip[3]), v.y, v.height)};
    }
    return t;
}

/// A triangle of ordinary size in clip space, any w.
std::vector<RasterVertex> random_vertices(Random& random, float a, float viewport = 0, float layer = 0) {
    std::vector<RasterVertex> vertices;
    for (int i = 0; i < 3; ++i) {
        const float w = random.in(0.5f, 4.0f);
        const float x = random.in(-2.0f, 2.0f) * w;
        const float y = random.in(-2.0f, 2.0f) * w;
        vertices.push_back({.clip = {x, y, random.in(0.0f, 1.0f) * w, w}, .a = a, .layer = layer, .viewport = viewport});
    }
    return vertices;
}

/// What shows of a triangle: inside the target, the viewport's implicit scissor and the explicit one.
Masks visible(const Canvas& canvas, const oracle::SnappedTriangle& t, const Viewport& v, const ScissorRect* scissor) {
    oracle::PixelRect rect = oracle::intersection(canvas.rect(), oracle::implicit_scissor(v.x, v.y, v.width, v.height));
    if (scissor != nullptr) rect = oracle::intersection(rect, {scissor->x0, scissor->y0, scissor->x1, scissor->y1});
    Masks masks(canvas.rect());
    if (rect.empty()) return masks;
    const auto pattern = oracle::standard_pattern(canvas.desc().samples);
    for (const auto& pixel : oracle::covered_pixels(oracle::coverage(t, rect, pattern)))
        masks.at(pixel.x, pixel.y) = pixel.mask;
    return masks;
}

Viewport random_viewport(Random& random) {
    Viewport v{.x = random.in(-20.0f, 30.0f), .y = random.in(-20.0f, 30.0f)};
    v.width = random.in(0.01f, 60.0f);
    v.height = random.in(0.01f, 60.0f);
    if (random.chance(4)) v.x = std::floor(v.x);
    if (random.chance(4)) v.y = std::floor(v.y) + 0.5f;
    return v;
}

}  // namespace

TEST_CASE("fractional viewports transform in fp32 and round their edges down", "[raster][15.6][15.7]") {
    std::uint64_t drawn = 0;
    for (const int samples : {1, 4, 16}) {
        Canvas canvas(mark_program(), Profile{}, {.width = 40, .height = 36, .samples = samples});
        for (std::uint64_t seed = 0; seed < 500; ++seed) {
            Random random(seed);
            const auto vertices = random_vertices(random, static_cast<float>(seed));
            const Viewport v = random_viewport(random);
            ScissorRect scissor{random.integer(-10, 30), random.integer(-10, 30), 0, 0};
            scissor.x1 = scissor.x0 + random.integer(0, 40);
            scissor.y1 = scissor.y0 + random.integer(0, 40);
            const bool scissored = random.chance(2);
            Draw draw = canvas.draw_of(vertices);
            draw.viewport = v;
            if (scissored) draw.scissors = {&scissor, 1};
            canvas.execute(draw);
            const Masks expected = visible(canvas, place_in(v, vertices), v, scissored ? &scissor : nullptr);
            drawn += expected.samples();
            const std::string wrong = difference(expected, canvas.masks(static_cast<float>(seed)));
            if (!wrong.empty())
                FAIL(fmt::format("{} samples, seed {}, viewport {:a}x{:a} at ({:a}, {:a}): {}", samples, seed, v.width,
                                 v.height, v.x, v.y, wrong));
        }
    }
    CHECK(drawn > 100000);
}

TEST_CASE("what lies wholly left of or above a fractional edge shows in the pixels that the edge cuts",
          "[raster][15.7][15.4]") {
    // From 2.35 to 2.65 in a viewport from 2.75 on: the centres at 2.5 are inside the implicit scissor, which starts at 2.
    Canvas canvas(mark_program(), Profile{}, {.width = 12, .height = 12});
    for (const bool left : {true, false}) {
        const auto corner = [&](float across, float along) {
            const float edge = across * 0.5f - 1.0f;
            return RasterVertex{.clip = left ? std::array{edge, along, 0.5f, 1.0f} : std::array{along, -edge, 0.5f, 1.0f},
                                .a = 1.0f};
        };
        canvas.clear();
        Draw draw = canvas.draw_of(
            {corner(-0.4f, 3), corner(-0.1f, 3), corner(-0.4f, -3), corner(-0.4f, -3), corner(-0.1f, 3), corner(-0.1f, -3)});
        draw.viewport = {.x = 2.75f, .y = 2.75f, .width = 4.0f, .height = 4.0f};
        canvas.execute(draw);
        const Masks drawn = canvas.masks(1.0f);
        for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 12; ++x) {
                INFO("left " << left << ", pixel (" << x << ", " << y << ")");
                const int across = left ? x : y;
                const int along = left ? y : x;
                CHECK((drawn.at(x, y) != 0) == (across == 2 && along >= 2 && along < 6));
            }
    }
}

TEST_CASE("viewports as large as the range, far outside and of no pixel", "[raster][15.6][15.7]") {
    Canvas canvas(mark_program(), Profile{}, {.width = 40, .height = 36});
    const std::array<Viewport, 9> viewports{Viewport{-32768, -32768, 65535, 65535},
                                            Viewport{0, 0, 32767, 32767},
                                            Viewport{-32768, 0, 32768, 36},
                                            Viewport{-32768, -32768, 32800, 32790.5f},
                                            Viewport{100, 100, 50, 50},
                                            Viewport{-60, -60, 50, 50},
                                            Viewport{39, 35, 32000, 32000},
                                            Viewport{10.2f, 10.2f, 0.5f, 20},
                                            Viewport{10.9f, 10.2f, 0.2f, 20}};
    std::uint64_t drawn = 0;
    for (std::size_t i = 0; i < viewports.size(); ++i)
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            Random random(seed + 100 * i);
            const Viewport& v = viewports[i];
            // Inside the viewport, so that large ones stay inside the guard band too.
            auto vertices = random_vertices(random, static_cast<float>(seed + 1));
            for (RasterVertex& vertex : vertices) {
                vertex.clip[0] *= 0.49f;
                vertex.clip[1] *= 0.49f;
            }
            canvas.clear();
            Draw draw = canvas.draw_of(vertices);
            draw.viewport = v;
            canvas.execute(draw);
            const Masks expected = visible(canvas, place_in(v, vertices), v, nullptr);
            drawn += expected.samples();
            const std::string wrong = difference(expected, canvas.masks(static_cast<float>(seed + 1)));
            if (!wrong.empty()) FAIL(fmt::format("viewport {}, seed {}: {}", i, seed, wrong));
        }
    CHECK(drawn > 1000);
}

TEST_CASE("the provoking vertex chooses one of up to 16 viewports, each with its scissor", "[raster][15.8.1][15.15][15.7]") {
    for (const ProvokingVertex provoking : {ProvokingVertex::First, ProvokingVertex::Last}) {
        Canvas canvas(identify_program(), Profile{}, {.width = 40, .height = 36, .layers = 3});
        Random random(7);
        std::vector<Viewport> viewports;
        std::vector<ScissorRect> scissors;
        for (int i = 0; i < kMaxViewports; ++i) {
            Viewport v = random_viewport(random);
            v.width += 20.0f;
            v.height += 20.0f;
            viewports.push_back(v);
            scissors.push_back({i, i / 2, 25 + i, 36 - i});
        }
        std::uint64_t drawn = 0;
        for (int count : {1, 5, 16})
            for (int index = -2; index < 20; ++index)
                for (const int layer : {-1, 0, 2, 3}) {
                    auto vertices = random_vertices(random, 1.0f, 1.0f, 1.0f);
                    const std::size_t lead = provoking == ProvokingVertex::First ? 0 : 2;
                    vertices[lead].viewport = static_cast<float>(index);
                    vertices[lead].layer = static_cast<float>(layer);
                    canvas.clear();
                    Draw draw = canvas.draw_of(vertices);
                    draw.raster.provoking = provoking;
                    draw.viewports = std::span(viewports).first(static_cast<std::size_t>(count));
                    draw.scissors = std::span(scissors).first(static_cast<std::size_t>(count));
                    canvas.execute(draw);
                    // What is out of range counts as 0.
                    const std::size_t chosen = index >= 0 && index < count ? static_cast<std::size_t>(index) : 0;
                    const int slice = layer >= 0 && layer < 3 ? layer : 0;
                    const Viewport& v = viewports[chosen];
                    const Masks expected = visible(canvas, place_in(v, vertices), v, &scissors[chosen]);
                    drawn += expected.samples();
                    for (int l = 0; l < 3; ++l) {
                        const std::string wrong =
                            difference(l == slice ? expected : Masks(canvas.rect()), canvas.masks(1.0f, l));
                        if (!wrong.empty())
                            FAIL(fmt::format("{} viewports, index {}, layer {} of {}: {}", count, index, l, layer, wrong));
                    }
                    for (const auto& pixel : oracle::covered_pixels(expected)) {
                        REQUIRE(canvas.value(1, 2, {pixel.x, pixel.y, 0, slice}) == static_cast<float>(slice));
                        REQUIRE(canvas.value(1, 3, {pixel.x, pixel.y, 0, slice}) == static_cast<float>(chosen));
                    }
                }
        CHECK(drawn > 10000);
    }
}

TEST_CASE("depth goes to the viewport's range in fp32", "[raster][15.6][15.9]") {
    Canvas canvas(interpolation_program(), Profile{}, {.width = 8, .height = 8, .depth = Format::D32Float});
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        const float low = random.chance(4) ? 0.0f : random.unit();
        const float high = low + (1.0f - low) * random.unit();
        const float z = random.chance(8) ? 1.0f : random.unit();
        const float w = std::ldexp(1.0f, random.integer(-2, 2));
        canvas.clear();
        Draw draw =
            canvas.draw_of({{.clip = {-w, w, z * w, w}}, {.clip = {3 * w, w, z * w, w}}, {.clip = {-w, -3 * w, z * w, w}}});
        draw.viewport = {.width = 8, .height = 8, .min_depth = low, .max_depth = high};
        draw.depth_state = {.compare = CompareOp::Always};
        canvas.execute(draw);
        const float range = high - low;
        const float scaled = z * range;
        const float expected = std::min(low + scaled, high);
        const float stored = std::bit_cast<float>(canvas.depth_code({.x = 3, .y = 3}));
        INFO(fmt::format("seed {}: z {:a} in [{:a}, {:a}]: stored {:a}, expected {:a}", seed, z, low, high, stored, expected));
        REQUIRE(stored == expected);
    }
}
