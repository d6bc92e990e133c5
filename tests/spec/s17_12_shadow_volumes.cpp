// D3D11.3 17.12 at work: stencil shadow volumes count how many volumes hold each visible point, by z-pass and by z-fail, and
// the count equals the analytic one. [Heidmann91] counts faces before the surface, [EverittKilgard02] those behind it.
#include "tests/oracle/random.h"
#include "tests/oracle/samples.h"
#include "tests/unit/output_programs.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using oracle::Random;

namespace {

constexpr int kSize = 48;

/// In pixels and depth.
struct Corner {
    double x, y, z;
};
using Tetrahedron = std::array<Corner, 4>;

double volume(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    const auto minus = [](const Corner& p, const Corner& q) { return Corner{p.x - q.x, p.y - q.y, p.z - q.z}; };
    const Corner u = minus(b, a);
    const Corner v = minus(c, a);
    const Corner w = minus(d, a);
    return u.x * (v.y * w.z - v.z * w.y) - u.y * (v.x * w.z - v.z * w.x) + u.z * (v.x * w.y - v.y * w.x);
}

/// How deep the point lies inside, as the least share of a corner: negative outside.
double depth_inside(const Tetrahedron& t, const Corner& p) {
    const double whole = volume(t[0], t[1], t[2], t[3]);
    return std::min({volume(p, t[1], t[2], t[3]) / whole, volume(t[0], p, t[2], t[3]) / whole,
                     volume(t[0], t[1], p, t[3]) / whole, volume(t[0], t[1], t[2], p) / whole});
}

/// Corners on the grid of 1/16 pixel, so that snapping moves none.
Tetrahedron random_tetrahedron(Random& random, double z_low, double z_high) {
    for (;;) {
        Tetrahedron t;
        for (Corner& corner : t) {
            corner.x = static_cast<double>(random.integer(-4 * 16, (kSize + 4) * 16)) / 16;
            corner.y = static_cast<double>(random.integer(-4 * 16, (kSize + 4) * 16)) / 16;
            corner.z = z_low + (z_high - z_low) * static_cast<double>(random.integer(0, 1024)) / 1024;
        }
        if (std::fabs(volume(t[0], t[1], t[2], t[3])) > 20) return t;
    }
}

/// Its four faces, clockwise on the screen where they look at the viewer.
std::vector<TestVertex> faces_of(const Tetrahedron& t) {
    std::vector<TestVertex> vertices;
    for (std::size_t opposite = 0; opposite < 4; ++opposite) {
        std::array<Corner, 3> face{t[(opposite + 1) % 4], t[(opposite + 2) % 4], t[(opposite + 3) % 4]};
        // Seen from outside a face goes round clockwise; then the fourth corner lies behind it.
        if (volume(face[0], face[1], face[2], t[opposite]) < 0) std::swap(face[1], face[2]);
        for (const Corner& c : face)
            vertices.push_back({static_cast<float>(2 * c.x / kSize - 1), static_cast<float>(1 - 2 * c.y / kSize),
                                static_cast<float>(c.z), 1, 0, 0});
    }
    return vertices;
}

enum class Method { ZPass, ZFail };

struct Scene {
    Canvas canvas;
    TextureId depth;
    TextureId lit;
    std::vector<double> surface = std::vector<double>(kSize * kSize, 1.0);  // visible depth by pixel
    std::vector<Tetrahedron> volumes;

    Scene(int samples, std::uint64_t seed, double z_low, double z_high)
        : canvas(load_profile("d3d11"), kSize, kSize, samples, 2),
          depth(canvas.target(Format::D32FloatS8)),
          lit(canvas.target(Format::R32Float)) {
        Random random(seed);
        canvas.device.execute(ClearDepth{depth, 1.0f});
        for (int i = 0; i < 30; ++i) {
            const int x0 = random.integer(0, kSize - 8);
            const int y0 = random.integer(0, kSize - 8);
            const int x1 = random.integer(x0 + 1, kSize);
            const int y1 = random.integer(y0 + 1, kSize);
            const double z = static_cast<double>(random.integer(1, 63)) / 64;
            Draw draw = canvas.rectangle(
                depth_only_program(),
                {static_cast<float>(x0), static_cast<float>(y0), static_cast<float>(x1), static_cast<float>(y1)},
                static_cast<float>(z));
            draw.depth = depth;
            canvas.device.execute(draw);
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) {
                    double& seen = surface[static_cast<std::size_t>(y * kSize + x)];
                    seen = std::min(seen, z);
                }
        }
        for (int i = 0; i < 6; ++i) volumes.push_back(random_tetrahedron(random, z_low, z_high));
    }

    void count(Method method, bool depth_clip) {
        canvas.device.execute(ClearStencil{depth, 0});
        std::vector<TestVertex> vertices;
        for (const Tetrahedron& t : volumes)
            for (const TestVertex& v : faces_of(t)) vertices.push_back(v);
        Draw draw =
            make_draw(depth_only_program(), upload(canvas.device, vertices), 0, static_cast<std::uint32_t>(vertices.size()));
        draw.depth = depth;
        draw.depth_state.write = false;
        draw.raster.front_counter_clockwise = false;
        draw.raster.depth_clip = depth_clip;
        draw.stencil.test = true;
        if (method == Method::ZPass) {
            draw.stencil.front.pass = StencilOp::Increment;
            draw.stencil.back.pass = StencilOp::Decrement;
        } else {
            draw.stencil.back.depth_fail = StencilOp::Increment;
            draw.stencil.front.depth_fail = StencilOp::Decrement;
        }
        canvas.device.execute(draw);

        // Light where no volume holds the surface.
        canvas.device.execute(ClearColor{lit, glm::vec4(0.0f)});
        Draw light = canvas.everything(id_program(), 0.0f);
        light.vertices = upload(canvas.device, canvas.corners({0, 0, kSize, kSize}, 0.0f, 1.0f));
        light.pixel_constants = pixel_constants(id_program());
        light.color[0] = lit;
        light.depth = depth;
        light.depth_state.test = false;
        light.stencil.test = true;
        light.stencil.front.compare = light.stencil.back.compare = CompareOp::Equal;
        canvas.device.execute(light);
    }

    struct Findings {
        int shadowed = 0;
        int close = 0;  // on the border of a volume, to the last bits of depth: not judged
        int wrong = 0;
        int most = 0;  // volumes around one point
        std::string first_wrong;
    };
    [[nodiscard]] Findings compare() const {
        const oracle::SamplePattern pattern = oracle::standard_pattern(canvas.samples);
        Findings found;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                for (int s = 0; s < canvas.samples; ++s) {
                    const auto pixel = static_cast<std::size_t>(y * kSize + x);
                    const oracle::Point at = pattern.at(x, y, s);
                    const Corner point{static_cast<double>(at.x) / 256, static_cast<double>(at.y) / 256, surface[pixel]};
                    int expected = 0;
                    bool close = false;
                    for (const Tetrahedron& t : volumes) {
                        const double inside = depth_inside(t, point);
                        close = close || std::fabs(inside) < 1e-5;
                        expected += inside > 0 ? 1 : 0;
                    }
                    found.close += close ? 1 : 0;
                    if (close) continue;
                    found.shadowed += expected > 0 ? 1 : 0;
                    found.most = std::max(found.most, expected);
                    const int stencil = canvas.stencil(depth, pixel, 0, s);
                    const float light = canvas.value(lit, pixel, 0, 0, s);
                    if (stencil == expected && light == (expected == 0 ? 1.0f : 0.0f)) continue;
                    if (found.wrong++ == 0)
                        found.first_wrong = fmt::format("pixel ({}, {}) sample {}: stencil {}, light {}, expected {} volumes",
                                                        x, y, s, stencil, light, expected);
                }
            }
        }
        return found;
    }
};

}  // namespace

TEST_CASE("shadow volumes before the viewer count right by z-pass and by z-fail", "[17.12][stencil][shadow-volumes]") {
    for (const int samples : {1, 4}) {
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            Scene scene(samples, seed, 0.02, 0.98);
            for (const Method method : {Method::ZPass, Method::ZFail}) {
                scene.count(method, true);
                const auto found = scene.compare();
                INFO("seed " << seed << ", samples " << samples << ": " << found.first_wrong);
                CHECK(found.wrong == 0);
                CHECK(found.close < 5 * samples);
                CHECK(found.shadowed > 50 * samples);
                CHECK(found.most >= 2);
            }
        }
    }
}

TEST_CASE("volumes around the viewer count right by z-fail only, and beyond the far plane with depth clamp",
          "[17.12][15.4][stencil][shadow-volumes]") {
    int wrong_by_pass = 0;
    int wrong_without_clamp = 0;
    for (std::uint64_t seed = 20; seed < 26; ++seed) {
        Scene scene(1, seed, -1.0, 2.0);
        scene.count(Method::ZFail, false);
        const auto found = scene.compare();
        INFO("seed " << seed << ": " << found.first_wrong);
        CHECK(found.wrong == 0);
        CHECK(found.shadowed > 100);
        scene.count(Method::ZPass, true);
        wrong_by_pass += scene.compare().wrong;
        scene.count(Method::ZFail, true);
        wrong_without_clamp += scene.compare().wrong;
    }
    CHECK(wrong_by_pass > 100);
    CHECK(wrong_without_clamp > 100);
}
