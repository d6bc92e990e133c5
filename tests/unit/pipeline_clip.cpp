// Clipping: what is in sight is drawn once and without cracks, what is not is dropped, and nothing crashes. D3D11.3 15.4
#include "tests/oracle/random.h"
#include "tests/oracle/raster.h"
#include "tests/unit/pipeline_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr int kSize = 64;

/// Where pixel point (x, y) lies in a triangle of clip-space vertices, by homogeneous coordinates: no clipping at all.
/// Solves sum(l_i v_i.xyw) = (ndc_x, ndc_y, 1); the point is inside and in front of the eye where all l_i >= 0.
struct Homogeneous {
    std::array<std::array<long double, 3>, 3> rows;  // edge functions: l_i = dot(rows[i], (ndc_x, ndc_y, 1)) / determinant
    long double determinant;
    std::array<long double, 3> z, w;

    explicit Homogeneous(const std::array<TestVertex, 3>& v) {
        const auto p = [&](std::size_t i) { return std::array<long double, 3>{v[i].x, v[i].y, v[i].w}; };
        const auto cross = [](const std::array<long double, 3>& a, const std::array<long double, 3>& b) {
            return std::array<long double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        };
        rows = {cross(p(1), p(2)), cross(p(2), p(0)), cross(p(0), p(1))};
        determinant = p(0)[0] * rows[0][0] + p(0)[1] * rows[0][1] + p(0)[2] * rows[0][2];
        for (std::size_t i = 0; i < 3; ++i) {
            z[i] = v[i].z;
            w[i] = v[i].w;
        }
    }

    enum class Where { Inside, Outside, Close };

    /// Close: within `margin_px` of an edge of what should be drawn, or of the near or far plane.
    [[nodiscard]] Where at(long double px, long double py, long double margin_px) const {
        const long double x = px / kSize * 2 - 1;
        const long double y = 1 - py / kSize * 2;
        bool inside = true;
        bool close = false;
        long double sum_z = 0;
        long double sum_w = 0;
        long double grad_zx = 0, grad_zy = 0, grad_wx = 0, grad_wy = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const long double l = (rows[i][0] * x + rows[i][1] * y + rows[i][2]) / determinant;
            const long double gx = rows[i][0] / determinant * 2 / kSize;
            const long double gy = rows[i][1] / determinant * 2 / kSize;
            if (l < 0) inside = false;
            if (std::fabs(l) <= std::hypot(gx, gy) * margin_px) close = true;
            sum_z += l * z[i];
            sum_w += l * w[i];
            grad_zx += gx * z[i];
            grad_zy += gy * z[i];
            grad_wx += gx * w[i];
            grad_wy += gy * w[i];
        }
        if (sum_z < 0 || sum_z > sum_w) inside = false;
        if (std::fabs(sum_z) <= std::hypot(grad_zx, grad_zy) * margin_px) close = true;
        if (std::fabs(sum_w - sum_z) <= std::hypot(grad_wx - grad_zx, grad_wy - grad_zy) * margin_px) close = true;
        return close ? Where::Close : inside ? Where::Inside : Where::Outside;
    }
};

std::string describe(std::span<const TestVertex> v) {
    std::string text;
    for (const auto& a : v) text += fmt::format("  ({:a}, {:a}, {:a}, {:a})\n", a.x, a.y, a.z, a.w);
    return text;
}

struct Picture {
    std::vector<float> ids;
    Counters counters;
};

Picture draw_all(const std::vector<TestVertex>& vertices, const Profile& profile = {}) {
    Device device(profile, 1);
    const TextureId target = device.create_texture("ids", {.format = Format::R32Float, .width = kSize, .height = kSize});
    device.execute(ClearColor{target, glm::vec4(-1.0f)});
    Draw draw = make_draw(id_program(), upload(device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
    draw.color[0] = target;
    device.enable_counters(true);
    device.execute(draw);
    return {floats_of(device.texture(target)), device.take_counters()};
}

std::uint64_t drawn_pixels(const Picture& picture) {
    std::uint64_t count = 0;
    for (const float id : picture.ids) count += id != -1.0f;  // NaN counts: something was written
    return count;
}

/// A vertex seen by a camera with z/w from 0 at distance `near` to 1 at `far`; behind the camera for z_view < 0.
TestVertex seen(float x, float y, float z_view, float id) {
    constexpr float near = 0.5f;
    constexpr float far = 20.0f;
    return {x, y, (z_view - near) * far / (far - near), z_view, id, 0.0f};
}

}  // namespace

TEST_CASE("triangles through the near and far planes are cut where they should be", "[raster][15.4]") {
    // A pixel farther than half a pixel from every edge and plane must agree with homogeneous coordinates: snapping moves
    // vertices by at most 1/512 pixel per axis, clipping in fp32 by less than that here.
    std::uint64_t inside = 0;
    std::uint64_t cut = 0;
    for (std::uint64_t seed = 0; seed < 2500; ++seed) {
        Random random(seed);
        const std::uint64_t mode = seed % 5;
        std::array<TestVertex, 3> v;
        for (auto& vertex : v) {
            const float reach = mode == 4 ? 2000.0f : 8.0f;
            vertex = seen(random.in(-reach, reach), random.in(-reach, reach),
                          mode == 0 ? random.in(0.1f, 25.0f) : random.in(-6.0f, 24.0f), 0.0f);
            if (mode == 3 && random.chance(2)) {  // exactly on the near plane, the far plane, or in the plane of the eye
                const int which = random.integer(0, 2);
                if (which == 0) vertex.z = 0.0f;
                if (which == 1) vertex.z = vertex.w;
                if (which == 2) vertex = seen(vertex.x, vertex.y, 0.0f, 0.0f);
            }
        }
        const Homogeneous exact(v);
        if (!(std::fabs(exact.determinant) > 1e-3L)) continue;
        const Picture picture = draw_all({v.begin(), v.end()});
        cut += picture.counters.primitives_clipped;
        if (picture.counters.samples_covered != drawn_pixels(picture))
            FAIL(fmt::format("seed {}: {} samples covered, {} pixels drawn: one triangle covers a pixel twice\n{}", seed,
                             picture.counters.samples_covered, drawn_pixels(picture), describe(v)));
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const auto where = exact.at(x + 0.5L, y + 0.5L, 0.25L);
                if (where == Homogeneous::Where::Close) continue;
                const bool expected = where == Homogeneous::Where::Inside;
                inside += expected;
                const bool drawn = picture.ids[static_cast<std::size_t>(y * kSize + x)] >= 0;
                if (drawn != expected)
                    FAIL(fmt::format("seed {} mode {} pixel ({}, {}): {}\n{}", seed, mode, x, y,
                                     drawn ? "drawn, but outside" : "missed", describe(v)));
            }
    }
    CHECK(inside > 100000);
    CHECK(cut > 1000);
}

TEST_CASE("neighbours cut by the near plane or the guard band leave no crack", "[raster][15.4]") {
    // A big quad of two triangles, or a fan of several: every pixel well inside the union is covered exactly once.
    std::uint64_t checked = 0;
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
        Random random(seed + 77000);
        const bool guard = seed % 2 == 1;
        const float reach = guard ? 5000.0f : 30.0f;
        const int rim = 4 + static_cast<int>(seed % 5);
        // A fan in a plane: planar so that depth is no obstacle. The plane passes near the eye and is seen at an angle.
        const float tilt_x = random.in(-1.0f, 1.0f) / reach * 5.0f;
        const float tilt_y = random.in(-1.0f, 1.0f) / reach * 5.0f;
        const float distance = random.in(1.0f, 12.0f);
        const auto on_plane = [&](float x, float y, float id) { return seen(x, y, distance + tilt_x * x + tilt_y * y, id); };
        const float hub_x = random.in(-2.0f, 2.0f);
        const float hub_y = random.in(-2.0f, 2.0f);
        std::vector<TestVertex> vertices;
        std::vector<std::pair<float, float>> corners;
        for (int k = 0; k < rim; ++k) {
            const double angle = (k + 0.6 * static_cast<double>(random.unit())) * 2 * 3.14159265358979 / rim;
            const float radius = reach * random.in(0.5f, 1.0f);
            corners.emplace_back(static_cast<float>(std::cos(angle)) * radius, static_cast<float>(std::sin(angle)) * radius);
        }
        for (int k = 0; k < rim; ++k) {
            const auto [ax, ay] = corners[static_cast<std::size_t>(k)];
            const auto [bx, by] = corners[static_cast<std::size_t>((k + 1) % rim)];
            const auto id = static_cast<float>(k);
            std::array<TestVertex, 3> t{on_plane(hub_x, hub_y, id), on_plane(ax, ay, id), on_plane(bx, by, id)};
            std::rotate(t.begin(), t.begin() + random.integer(0, 2), t.end());
            if (random.chance(2)) std::swap(t[0], t[2]);
            vertices.insert(vertices.end(), t.begin(), t.end());
        }
        // Count per pixel: draw the triangles one by one.
        std::vector<int> times(kSize * kSize, 0);
        for (int k = 0; k < rim; ++k) {
            const Picture alone = draw_all({vertices.begin() + 3 * k, vertices.begin() + 3 * k + 3});
            if (alone.counters.samples_covered != drawn_pixels(alone))
                FAIL(fmt::format("seed {}: triangle {} covers a pixel twice\n{}", seed, k,
                                 describe(std::span(vertices).subspan(static_cast<std::size_t>(3 * k), 3))));
            for (std::size_t i = 0; i < times.size(); ++i) times[i] += alone.ids[i] != -1.0f;
        }
        // The union's inside: inside some triangle, or close only to inner edges. Inner edges start at the hub, so a pixel is
        // in the union when the whole cross of points around it lies in triangles.
        std::vector<Homogeneous> exact;
        for (int k = 0; k < rim; ++k)
            exact.emplace_back(std::array<TestVertex, 3>{vertices[static_cast<std::size_t>(3 * k)],
                                                         vertices[static_cast<std::size_t>(3 * k + 1)],
                                                         vertices[static_cast<std::size_t>(3 * k + 2)]});
        const auto in_union = [&](long double x, long double y) {
            for (const auto& e : exact)
                if (e.at(x, y, 0) == Homogeneous::Where::Inside) return true;
            return false;
        };
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const int n = times[static_cast<std::size_t>(y * kSize + x)];
                if (n > 1) FAIL(fmt::format("seed {} pixel ({}, {}): covered {} times\n{}", seed, x, y, n, describe(vertices)));
                if (n == 1) continue;
                bool all = true;
                for (const long double dx : {-0.3L, 0.0L, 0.3L})
                    for (const long double dy : {-0.3L, 0.0L, 0.3L}) all = all && in_union(x + 0.5L + dx, y + 0.5L + dy);
                if (all) FAIL(fmt::format("seed {} pixel ({}, {}): a crack\n{}", seed, x, y, describe(vertices)));
            }
        for (const int n : times) checked += static_cast<std::uint64_t>(n);
    }
    CHECK(checked > 100000);
}

TEST_CASE("positions that are no numbers drop the triangle", "[raster][15.4]") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, -nan, inf, -inf})
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 4; ++axis) {
                // The good triangle covers everything.
                std::vector<TestVertex> v{{-1, 1, 0.5f, 1, 3, 0}, {3, 1, 0.5f, 1, 3, 0}, {-1, -3, 0.5f, 1, 3, 0}};
                REQUIRE(drawn_pixels(draw_all(v)) == kSize * kSize);
                TestVertex& vertex = v[static_cast<std::size_t>(corner)];
                (axis == 0 ? vertex.x : axis == 1 ? vertex.y : axis == 2 ? vertex.z : vertex.w) = bad;
                const Picture picture = draw_all(v);
                INFO("corner " << corner << " axis " << axis << " value " << bad);
                CHECK(drawn_pixels(picture) == 0);
                CHECK(picture.counters.primitives_culled == 1);
            }
}

TEST_CASE("any bits as positions do not crash", "[raster][15.4]") {
    const std::array<float, 14> special{0.0f,   -0.0f,  1.0f,      -1.0f,     1e30f,    -1e30f,   3e38f,
                                        -3e38f, 1e-30f, 0x1p-149f, 0x1p-126f, 32766.0f, 32768.0f, 1e6f};
    std::uint64_t drawn = 0;
    for (const std::string profile : {"d3d11", "ideal"}) {
        for (std::uint64_t seed = 0; seed < 20000; ++seed) {
            Random random(seed);
            std::vector<TestVertex> v(3);
            for (auto& vertex : v) {
                const auto pick = [&] {
                    switch (random.integer(0, 3)) {
                        case 0: return random.any_float();
                        case 1: return special[static_cast<std::size_t>(random.integer(0, 13))];
                        case 2: return std::ldexp(random.in(-1.0f, 1.0f), random.integer(-40, 40));
                        default: return random.in(-2.0f, 2.0f);
                    }
                };
                vertex = {pick(), pick(), pick(), pick(), 1.0f, 0.0f};
            }
            drawn += drawn_pixels(draw_all(v, load_profile(profile)));
        }
    }
    CHECK(drawn > 10000);
}

TEST_CASE("one triangle covers no pixel twice, however it is clipped", "[raster][15.4]") {
    // The pieces of a clipped triangle must not overlap, also where snapping turns slivers over.
    std::uint64_t drawn = 0;
    std::uint64_t doubled = 0;
    std::string worst;
    std::uint64_t clipped = 0;
    for (std::uint64_t seed = 0; seed < 60000; ++seed) {
        Random random(seed);
        std::vector<TestVertex> v(3);
        for (auto& vertex : v) {
            const auto pick = [&] { return std::ldexp(random.in(-1.0f, 1.0f), random.integer(-6, 12)); };
            vertex = {pick(), pick(), pick(), pick(), 1.0f, 0.0f};
        }
        const Picture picture = draw_all(v);
        drawn += drawn_pixels(picture);
        clipped += picture.counters.primitives_clipped;
        doubled += picture.counters.samples_covered - drawn_pixels(picture);
        if (picture.counters.samples_covered != drawn_pixels(picture))
            worst = fmt::format("seed {}: {} samples covered, {} pixels drawn\n{}", seed, picture.counters.samples_covered,
                                drawn_pixels(picture), describe(v));
    }
    INFO(doubled << " of " << drawn << " pixels drawn twice, last in " << worst);
    CHECK(doubled == 0);
    CHECK(drawn > 100000);
    CHECK(clipped > 1000);
}

TEST_CASE("far-away vertices in front of the camera still cover what they cover", "[raster][15.4]") {
    // w = 1 and z inside: only the guard band cuts. The triangle's visible part is a half-plane or everything.
    for (const float far : {1e5f, 1e8f, 1e20f, 1e30f, 1e37f}) {
        const Picture all =
            draw_all({{-far, -far, 0.5f, 1, 1, 0}, {far * 2, -far, 0.5f, 1, 1, 0}, {-far, far * 2, 0.5f, 1, 1, 0}});
        INFO("far " << far << ": " << drawn_pixels(all) << " pixels");
        CHECK(drawn_pixels(all) == kSize * kSize);
        // Left half: the edge x = 0 runs between pixels 31 and 32.
        const Picture half = draw_all({{0, -far, 0.5f, 1, 1, 0}, {0, far, 0.5f, 1, 1, 0}, {-far, 0, 0.5f, 1, 1, 0}});
        CHECK(drawn_pixels(half) == kSize * kSize / 2);
    }
}
