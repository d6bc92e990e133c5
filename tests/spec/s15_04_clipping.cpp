// D3D11.3 15.4: clipping creates and loses nothing, whatever w, z and the distance of a vertex; positions that are no numbers
// drop their primitive; without depth clipping depths are clamped; values stay where they were on the triangle.
#include "tests/oracle/interpolation.h"
#include "tests/oracle/meshes.h"
#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::ClippedTriangle;
using oracle::ClipVertex;
using oracle::Random;

namespace {

RasterVertex vertex_of(const ClipVertex& v, float a = 1.0f, float layer = 0.0f) {
    return {.clip = {oracle::clip_float(v.x), oracle::clip_float(v.y), oracle::clip_float(v.z), oracle::clip_float(v.w)},
            .a = a,
            .layer = layer};
}

std::string describe(const std::array<ClipVertex, 3>& t) {
    std::string text;
    for (const ClipVertex& v : t) text += fmt::format("({}, {}, {}, {})/4096 ", v.x, v.y, v.z, v.w);
    return text;
}

/// Adds 1 to every sample covered by triangles that face the kept way.
Draw counting(Draw draw, CullMode culled) {
    draw.raster.cull = culled;
    draw.raster.front_counter_clockwise = false;
    draw.output.blend[0] = {.enable = true, .src = BlendFactor::One, .dst = BlendFactor::One};
    return draw;
}

}  // namespace

TEST_CASE("clipped triangles cover what exact signs say", "[raster][clip][15.4]") {
    constexpr int kLayers = 64;
    for (const bool depth_clip : {true, false})
        for (const int samples : {1, 4}) {
            const auto pattern = oracle::standard_pattern(samples);
            Canvas canvas(mark_program(), Profile{}, {.width = 32, .height = 32, .samples = samples, .layers = kLayers});
            std::array<std::uint64_t, 3> found{};
            for (std::uint64_t batch = 0; batch < 8; ++batch) {
                canvas.clear();
                std::vector<RasterVertex> vertices;
                std::vector<std::array<ClipVertex, 3>> triangles;
                for (std::uint64_t layer = 0; layer < kLayers; ++layer) {
                    const std::uint64_t index = batch * kLayers + layer;
                    Random random(index);
                    triangles.push_back(oracle::random_clip_triangle(random, oracle::kClipKinds[index % 5]));
                    for (const ClipVertex& v : triangles.back())
                        vertices.push_back(vertex_of(v, 1.0f, static_cast<float>(layer)));
                }
                Draw draw = canvas.draw_of(vertices);
                draw.raster.depth_clip = depth_clip;
                canvas.execute(draw);
                for (std::size_t layer = 0; layer < kLayers; ++layer) {
                    const ClippedTriangle exact(triangles[layer], {0, 0, 32, 32},
                                                depth_clip ? oracle::DepthClip::On : oracle::DepthClip::Off);
                    if (exact.edge_on()) continue;
                    const oracle::Masks drawn = canvas.masks(1.0f, static_cast<int>(layer));
                    for (int y = 0; y < 32; ++y)
                        for (int x = 0; x < 32; ++x)
                            for (int s = 0; s < samples; ++s) {
                                const auto where = exact.at(pattern.at(x, y, s), 1);
                                ++found[static_cast<std::size_t>(where)];
                                const bool covered = (drawn.at(x, y) >> s & 1u) != 0;
                                if (where != ClippedTriangle::Where::Close &&
                                    covered != (where == ClippedTriangle::Where::Inside))
                                    FAIL(fmt::format("depth clip {}, {} samples, case {}: sample {} of pixel ({}, {}) {}\n  {}",
                                                     depth_clip, samples, batch * kLayers + layer, s, x, y,
                                                     covered ? "created" : "lost", describe(triangles[layer])));
                            }
                }
            }
            CHECK(found[0] > 20000);                     // inside
            CHECK(found[1] > 20000);                     // outside
            CHECK(found[2] * 20 < found[0] + found[1]);  // close
        }
}

TEST_CASE("closed solids stay closed where planes cut them", "[raster][clip][watertight][15.4]") {
    const int samples = 4;
    const auto pattern = oracle::standard_pattern(samples);
    Canvas front(mark_program(), Profile{}, {.width = 32, .height = 32, .samples = samples});
    Canvas back(mark_program(), Profile{}, {.width = 32, .height = 32, .samples = samples});
    std::uint64_t sure = 0;
    std::uint64_t unsure = 0;
    std::uint64_t open = 0;
    for (std::uint64_t seed = 0; seed < 48; ++seed) {
        Random random(seed);
        const oracle::Solid solid = seed % 2 == 0 ? oracle::sphere(8, 1) : oracle::random_hull(random, 20);
        const oracle::ViewKind kind = oracle::kViewKinds[seed % 4];
        const oracle::ClipMesh mesh = oracle::random_view(random, solid, kind);
        std::vector<RasterVertex> vertices;
        std::vector<ClippedTriangle> exact;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            exact.emplace_back(mesh.triangle(t), oracle::PixelRect{0, 0, 32, 32});
            for (const ClipVertex& v : mesh.triangle(t)) vertices.push_back(vertex_of(v));
        }
        front.clear(0.0f);
        back.clear(0.0f);
        front.execute(counting(front.draw_of(vertices), CullMode::Back));
        back.execute(counting(back.draw_of(vertices), CullMode::Front));
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x)
                for (int s = 0; s < samples; ++s) {
                    const auto count = oracle::signed_count(exact, pattern.at(x, y, s));
                    ++(count.sure ? sure : unsure);
                    open += count.sure && count.count != 0;
                    const SampleAt at{.x = x, .y = y, .sample = s};
                    const float drawn = front.value(0, 0, at) - back.value(0, 0, at);
                    if (count.sure && drawn != static_cast<float>(count.count))
                        FAIL(fmt::format("seed {}: sample {} of pixel ({}, {}): {} more front than back faces, expected {}",
                                         seed, s, x, y, drawn, count.count));
                }
    }
    CHECK(unsure * 50 < sure);
    CHECK(open > 1000);  // the cuts show the inside
}

TEST_CASE("positions that are no numbers drop their primitive, and only theirs", "[raster][clip][15.4]") {
    struct Kind {
        Topology topology;
        FillMode fill;
        std::size_t corners;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const std::array<RasterVertex, 3> good{RasterVertex{.clip = {-0.9f, 0.9f, 0.5f, 1}},
                                           RasterVertex{.clip = {0.9f, 0.8f, 0.5f, 1}},
                                           RasterVertex{.clip = {-0.9f, -0.9f, 0.5f, 1}}};
    Canvas canvas(mark_program(), Profile{}, {});
    for (const Kind& kind :
         {Kind{Topology::TriangleList, FillMode::Solid, 3}, Kind{Topology::TriangleList, FillMode::Wireframe, 3},
          Kind{Topology::LineList, FillMode::Solid, 2}, Kind{Topology::PointList, FillMode::Solid, 1}})
        for (std::size_t place = 0; place < 32 * kind.corners; ++place) {
            // Which corner, which component of it, with or without depth clipping, and what it is.
            const std::size_t corner = place / 32;
            const std::size_t component = place % 4;
            const float bad = std::array{nan, -nan, inf, -inf}[place / 4 % 4];
            // The bad primitive, then a good one.
            std::vector<RasterVertex> vertices;
            for (const float mark : {1.0f, 2.0f})
                for (std::size_t i = 0; i < kind.corners; ++i) {
                    vertices.push_back(good[i]);
                    vertices.back().a = mark;
                }
            vertices[corner].clip[component] = bad;
            canvas.clear();
            Draw draw = canvas.draw_of(vertices);
            draw.topology = kind.topology;
            draw.raster.fill = kind.fill;
            draw.raster.depth_clip = place / 16 % 2 == 0;
            canvas.device().enable_counters(true);
            canvas.execute(draw);
            INFO(gnomon::name_of(kind.topology) << " corner " << corner << " component " << component << " is " << bad);
            REQUIRE(canvas.masks(1.0f).samples() == 0);
            REQUIRE(canvas.masks(2.0f).samples() > 0);
            REQUIRE(canvas.device().take_counters().primitives_culled == 1);
        }
}

TEST_CASE("nothing is drawn of what lies behind the eye", "[raster][clip][15.4]") {
    Canvas canvas(mark_program(), Profile{}, {});
    for (const float w : {0.0f, -0.0f, -1.0f, -1e30f, -0x1p-126f})
        for (const bool depth_clip : {true, false})
            for (const Topology topology : {Topology::TriangleList, Topology::LineStrip, Topology::PointList}) {
                canvas.clear();
                Draw draw = canvas.draw_of({{.clip = {-1, 1, 0, w}, .a = 1.0f},
                                            {.clip = {3, 1, 0, w}, .a = 1.0f},
                                            {.clip = {-1, -3, 0, w}, .a = 1.0f}});
                draw.topology = topology;
                draw.raster.depth_clip = depth_clip;
                canvas.execute(draw);
                INFO("w " << w << ", depth clip " << depth_clip << ", " << gnomon::name_of(topology));
                CHECK(canvas.masks(1.0f).samples() == 0);
            }
}

TEST_CASE("vertices as far as 1e30 leave a half plane where it was", "[raster][clip][15.4][15.16.1]") {
    // The edge from (0, -far) to (0, far) is the vertical line through the middle of the target, the third vertex far right.
    Canvas canvas(mark_program(), Profile{}, {});
    for (const float far : {2.0f, 1e3f, 1e6f, 1e10f, 1e20f, 1e30f}) {
        canvas.clear();
        canvas.execute(canvas.draw_of({{.clip = {0, far, 0.5f, 1}, .a = 1.0f},
                                       {.clip = {2 * far, 0, 0.5f, 1}, .a = 1.0f},
                                       {.clip = {0, -far, 0.5f, 1}, .a = 1.0f}}));
        const oracle::Masks drawn = canvas.masks(1.0f);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                // At far 2 the corners' edges pass outside.
                INFO("far " << far << ", pixel (" << x << ", " << y << ")");
                REQUIRE(drawn.at(x, y) == (x >= 8 ? 1u : 0u));
            }
    }
    // All of it beyond one side: nothing.
    canvas.clear();
    canvas.execute(canvas.draw_of({{.clip = {1e30f, 1e30f, 0.5f, 1}, .a = 1.0f},
                                   {.clip = {2e30f, 0, 0.5f, 1}, .a = 1.0f},
                                   {.clip = {1e30f, -1e30f, 0.5f, 1}, .a = 1.0f}}));
    CHECK(canvas.masks(1.0f).samples() == 0);
}

TEST_CASE("without depth clipping depths are clamped to the viewport's range", "[raster][clip][15.4][17.10]") {
    Canvas canvas(mark_program(), Profile{}, {.depth = Format::D32Float});
    for (const float z : {-5.0f, -0.25f, 0.5f, 1.5f, 100.0f})
        for (const bool depth_clip : {true, false}) {
            canvas.clear();
            Draw draw = canvas.draw_of(
                {{.clip = {-1, 1, z, 1}, .a = 1.0f}, {.clip = {3, 1, z, 1}, .a = 1.0f}, {.clip = {-1, -3, z, 1}, .a = 1.0f}});
            draw.raster.depth_clip = depth_clip;
            draw.depth_state = {.compare = CompareOp::Always};
            draw.viewport = {.width = 16, .height = 16, .min_depth = 0.25f, .max_depth = 0.75f};
            canvas.execute(draw);
            const bool drawn = !depth_clip || (z >= 0 && z <= 1);
            INFO("z " << z << ", depth clip " << depth_clip);
            CHECK(canvas.masks(1.0f).samples() == (drawn ? 256u : 0u));
            const float expected = drawn ? std::clamp(0.25f + z * 0.5f, 0.25f, 0.75f) : 1.0f;
            CHECK(std::bit_cast<float>(canvas.depth_code({.x = 7, .y = 7})) == expected);
        }
}

TEST_CASE("flat, linear and perspective values go through clipping", "[raster][clip][15.4][15.16.2]") {
    // w runs from 1 to 4, z from -1/2 to 1: the near plane cuts. Values must be those of the whole triangle, to the accuracy of
    // a clipped vertex, which is snapped: half a grid step moves a value by what its slope says.
    std::uint64_t compared = 0;
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        Random random(seed);
        Canvas canvas(interpolation_program(), Profile{}, {});
        // On the grid after division, so that snapping moves nothing but what clipping makes.
        oracle::SnappedTriangle t;
        std::array<float, 3> w;
        std::array<float, 3> a;
        std::vector<RasterVertex> vertices;
        const auto inside = static_cast<std::size_t>(random.integer(0, 2));
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int64_t x = random.between(-1024, 5120);
            const std::int64_t y = random.between(-1024, 5120);
            t[i] = {x, y};
            w[i] = std::ldexp(1.0f, random.integer(0, 2));
            a[i] = static_cast<float>(random.integer(-100, 100));
            RasterVertex v = vertex_at(t[i], canvas.rect(), a[i]);
            for (float& c : v.clip) c *= w[i];
            v.clip[2] = i == inside ? 0.5f * w[i] : -0.5f * w[i];
            v.b = a[i];
            vertices.push_back(v);
        }
        canvas.execute(canvas.draw_of(vertices));
        if (oracle::turn(t[0], t[1], t[2]) == 0) continue;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const SampleAt at{.x = x, .y = y};
                if (canvas.value(0, 3, at) == kUntouched) continue;
                const auto value = [&](std::int64_t dx, std::int64_t dy, bool linear) {
                    const oracle::Point centre = oracle::pixel_center(x, y);
                    const auto b = oracle::barycentric(t, {centre.x + dx, centre.y + dy});
                    return linear ? oracle::linear(b, a) : oracle::perspective(b, a, w);
                };
                const long double area = std::fabs(static_cast<long double>(oracle::turn(t[0], t[1], t[2])));
                if (area < 256 * 256 * 16) continue;  // slivers: a grid step turns their planes
                for (const bool linear : {false, true}) {
                    const long double expected = value(0, 0, linear);
                    long double slope = 0;
                    for (const auto& [dx, dy] : {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}})
                        slope = std::max(slope, std::fabs(value(dx, dy, linear) - expected));
                    // The cut corners lie on this plane up to half a step each; far corners enlarge that.
                    const long double allowed = 16 * slope + 1e-3L;
                    const float got = canvas.value(1, linear ? 1 : 0, at);
                    ++compared;
                    if (std::fabs(static_cast<long double>(got) - expected) > allowed)
                        FAIL(fmt::format("seed {}, pixel ({}, {}), {}: {:a}, expected {} +- {}", seed, x, y,
                                         linear ? "linear" : "perspective", got, static_cast<double>(expected),
                                         static_cast<double>(allowed)));
                }
                INFO("seed " << seed << ", pixel (" << x << ", " << y << ")");
                REQUIRE(canvas.value(1, 2, at) == a[0]);  // flat: of the first vertex, clipped away or not
            }
    }
    CHECK(compared > 2000);
}
