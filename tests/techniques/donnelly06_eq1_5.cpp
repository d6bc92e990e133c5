// [Donnelly06] equations 1 to 5 and the closed form of section 3.1: with one planar occluder and one planar receiver
// Chebyshev's bound is exactly the unoccluded share of the filter.
#include "scenes/procedural.h"
#include "sim/fixed.h"
#include "techniques/common/moments.h"
#include "techniques/frame.h"
#include "techniques/vsm.h"
#include "tests/oracle/random.h"
#include "tests/techniques/bound_interval.h"
#include "tests/unit/texunit_calls.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/matrix.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

float evaluate(float m1, float m2, float t, float min_variance) {
    return lane(chebyshev_upper_bound(Moments<Float>{Float(m1), Float(m2)}, Float(t), Float(min_variance)), 0);
}

}  // namespace

TEST_CASE("[Donnelly06] eqs. 1 and 2: the moments of one depth", "[donnelly06]") {
    for (const float depth : {0.0f, 0.25f, 0.1f, 1.0f, 0.99999994f}) {
        const auto m = moments_of_depth(Float(depth));
        CHECK(lane(m.first, 0) == depth);
        CHECK(lane(m.second, 0) == depth * depth);
        const auto exact = moments_of_depth(Double(depth));
        CHECK(lane(exact.second, 0) == static_cast<double>(depth) * static_cast<double>(depth));
    }
}

TEST_CASE("[Donnelly06] eqs. 3 and 4: mean and variance", "[donnelly06]") {
    oracle::Random random(1);
    for (int i = 0; i < 10000; ++i) {
        const float m1 = random.unit();
        const float m2 = random.unit();
        const Moments<Float> m{Float(m1), Float(m2)};
        CHECK(lane(mean(m), 0) == m1);
        REQUIRE(lane(variance(m), 0) == m2 - m1 * m1);
        const double exact = static_cast<double>(m2) - static_cast<double>(m1) * static_cast<double>(m1);
        REQUIRE(std::fabs(static_cast<double>(m2 - m1 * m1) - exact) <=
                kUnit * (static_cast<double>(m1 * m1) + std::fabs(exact)) * 1.001);
    }
}

TEST_CASE("[Donnelly06] eq. 5: the one-tailed bound", "[donnelly06]") {
    CHECK(evaluate(0.5f, 0.3125f, 0.75f, 0.0f) == 0.5f);   // sigma^2 = 1/16, t - mu = 1/4
    CHECK(evaluate(0.5f, 0.3125f, 0.5f, 0.0f) == 1.0f);    // t = mu: lit
    CHECK(evaluate(0.5f, 0.3125f, 0.25f, 0.0f) == 1.0f);   // t < mu: lit
    CHECK(evaluate(0.5f, 0.25f, 0.75f, 0.0f) == 0.0f);     // no variance: a step
    CHECK(evaluate(0.5f, 0.25f, 0.75f, 0.0625f) == 0.5f);  // ... unless there is a least one
    CHECK(evaluate(0.5f, 0.2f, 0.75f, 0.0f) == 0.0f);      // negative variance counts as none
    CHECK(evaluate(0.0f, 0.0f, 0.0f, 0.0f) == 1.0f);
    // Falls with t, never leaves [0, 1], and bounds the share of any two-point distribution at or beyond t.
    oracle::Random random(2);
    for (int i = 0; i < 20000; ++i) {
        const double a = static_cast<double>(random.unit());
        const double b = static_cast<double>(random.unit());
        const double share = static_cast<double>(random.unit());
        const double m1 = share * a + (1 - share) * b;
        const double m2 = share * a * a + (1 - share) * b * b;
        const double t = static_cast<double>(random.unit());
        const double later = std::min(1.0, t + 0.1);
        const auto at = [&](double depth) {
            return lane(chebyshev_upper_bound(Moments<Double>{Double(m1), Double(m2)}, Double(depth), Double(0.0)), 0);
        };
        const double p = at(t);
        REQUIRE((p >= 0 && p <= 1));
        REQUIRE(at(later) <= p + 1e-12);
        const double beyond = (a >= t ? share : 0) + (b >= t ? 1 - share : 0);
        if (p < beyond - 1e-9 - 1e-13 / ((t - m1) * (t - m1) + 1e-9))
            FAIL(fmt::format("case {}: P(x >= {:a}) = {:a}, bound {:a}", i, t, beyond, p));
    }
}

namespace {

struct Planes {
    float d1, d2;  // occluder, receiver
};

constexpr std::array kPlanes{Planes{0.25f, 0.75f}, Planes{0.1f, 0.9f}, Planes{0.5f, 0.625f}, Planes{0.015625f, 0.984375f},
                             Planes{0.3f, 0.31f},  Planes{0.0f, 1.0f}, Planes{0.7f, 0.73f}};

/// Moments of both planes as the format stores them, a 2x2 texture of three occluded texels and one lit one, or of two columns.
Texture edge_texture(Format format, const Planes& planes, bool half_plane, Narrowing narrowing) {
    const auto code = [&](float x) -> std::uint32_t {
        switch (format_info(format).type) {
            case ComponentType::Float16: return half_from_float(x, narrowing).bits;
            case ComponentType::Unorm16: return unorm_from_float(x, 16);
            default: return std::bit_cast<std::uint32_t>(x);
        }
    };
    std::vector<std::uint32_t> codes;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            const bool lit = x == 1 && (half_plane || y == 1);
            const float d = lit ? planes.d2 : planes.d1;
            codes.push_back(code(d));
            codes.push_back(code(d * d));
        }
    return texture_of(format, 2, 2, codes);
}

/// All 256 x 256 weight pairs.
std::vector<Coordinate> all_weights() {
    std::vector<Coordinate> coordinates;
    for (int v = 0; v < 256; ++v)
        for (int u = 0; u < 256; ++u)
            coordinates.push_back({0.25f + static_cast<float>(u) / 512.0f, 0.25f + static_cast<float>(v) / 512.0f});
    return coordinates;
}

/// Worst |p_max - p| over all weights; fails where the error is more than the storage and fp32 can explain.
double check_closed_form(Format format, const Planes& planes, bool half_plane, double storage_error,
                         double relative_storage_error) {
    const auto coordinates = all_weights();
    const Profile profile;
    const auto moments =
        sample_all(edge_texture(format, planes, half_plane, profile.float_narrowing), Sampler{}, profile, coordinates);
    const double d1 = static_cast<double>(planes.d1);
    const double d2 = static_cast<double>(planes.d2);
    double worst = 0;
    for (int v = 0; v < 256; ++v)
        for (int u = 0; u < 256; ++u) {
            const auto& m = moments[static_cast<std::size_t>(v * 256 + u)];
            const double p = half_plane ? u / 256.0 : u * v / 65536.0;
            const double p_max = static_cast<double>(evaluate(m[0], m[1], planes.d2, 0.0f));
            // Storage errs once per texel; the square itself rounds once; each of two lerps in sequence rounds three times.
            const double largest = std::max(d1, d2);
            const double e1 = storage_error + relative_storage_error * largest + 6 * kUnit * largest;
            const double e2 = storage_error + relative_storage_error * largest * largest + 7 * kUnit * largest * largest;
            const double m1 = p * d2 + (1 - p) * d1;
            const double m2 = p * d2 * d2 + (1 - p) * d1 * d1;
            const Interval allowed = bound_interval(m1, m2, d2, e1, e2, kUnit);
            if (!(p_max >= allowed.low && p_max <= allowed.high))
                FAIL(
                    fmt::format("{} d1 {:a} d2 {:a} weights {} {}: p_max {:a}, p {:a}, allowed [{:a}, {:a}]; moments {:a} {:a}",
                                name_of(format), d1, d2, u, v, p_max, p, allowed.low, allowed.high, m[0], m[1]));
            worst = std::max(worst, std::fabs(p_max - p));
        }
    return worst;
}

}  // namespace

TEST_CASE("[Donnelly06] 3.1: p_max is the unoccluded share, rg32f", "[donnelly06][3.1]") {
    // First order: |error| <= (20 u D^2) / (d2 - d1)^2 + 12 p u D / (d2 - d1) + 4 u; the interval is exact to all orders.
    for (const Planes& planes : kPlanes)
        for (const bool half_plane : {true, false}) {
            const double worst = check_closed_form(Format::Rg32Float, planes, half_plane, 0, 0);
            const double contrast = static_cast<double>(planes.d2 - planes.d1);
            INFO("d1 " << planes.d1 << " d2 " << planes.d2 << " worst " << worst);
            if (half_plane) CHECK(worst <= 2 * (20 * kUnit / (contrast * contrast) + 12 * kUnit / contrast + 4 * kUnit));
        }
}

TEST_CASE("[Donnelly06] 3.1: sixteen-bit maps err by what their storage loses", "[donnelly06][3.1][5.3]") {
    // rg16f toward zero loses up to 2^-10 of a moment, rg16unorm half a step of 65535.
    for (const Planes& planes : kPlanes) {
        const double fp32 = check_closed_form(Format::Rg32Float, planes, true, 0, 0);
        const double unorm = check_closed_form(Format::Rg16Unorm, planes, true, 0.5 / 65535, 0);
        const double fp16 = check_closed_form(Format::Rg16Float, planes, true, 0x1p-24, 0x1p-10);
        INFO("d1 " << planes.d1 << " d2 " << planes.d2 << ": fp32 " << fp32 << " unorm16 " << unorm << " fp16 " << fp16);
        if (planes.d1 == 0.1f) {  // depths that no format holds exactly
            CHECK(fp32 < unorm);
            CHECK(unorm < fp16);
        }
        // fp16 cannot hold a contrast of 0.01 at depth 0.3: section 5.3.
        if (planes.d1 == 0.3f) CHECK(fp16 > 0.1);
    }
}

TEST_CASE("[Donnelly06] 3.1: exact to 1e-12 under the ideal profile", "[donnelly06][3.1]") {
    // Depths of 12 bits, so that fp32 stores their squares exactly.
    for (const Planes& planes :
         {Planes{0.25f, 0.75f}, Planes{0.015625f, 0.984375f}, Planes{1229.0f / 4096, 3001.0f / 4096}, Planes{0.5f, 0.625f}})
        for (const bool half_plane : {true, false}) {
            const Profile ideal = load_profile("ideal");
            oracle::Random random(3);
            std::vector<Coordinate> coordinates = all_weights();
            for (auto& c : coordinates) c = {random.in(0.25f, 0.75f), random.in(0.25f, 0.75f)};
            const auto moments = sample_all<Double>(edge_texture(Format::Rg32Float, planes, half_plane, ideal.float_narrowing),
                                                    Sampler{}, ideal, coordinates);
            for (std::size_t i = 0; i < coordinates.size(); ++i) {
                const double u = static_cast<double>(coordinates[i].u) * 2 - 0.5;
                const double v = static_cast<double>(coordinates[i].v) * 2 - 0.5;
                const double p = half_plane ? u : u * v;
                const double p_max = lane(chebyshev_upper_bound(Moments<Double>{Double(moments[i][0]), Double(moments[i][1])},
                                                                Double(planes.d2), Double(0.0)),
                                          0);
                if (p < 1 - 0x1p-10 && !(std::fabs(p_max - p) <= 1e-12))
                    FAIL(fmt::format("d1 {:a} d2 {:a} uv ({:a}, {:a}): p_max {:a}, p {:a}", planes.d1, planes.d2,
                                     coordinates[i].u, coordinates[i].v, p_max, p));
            }
        }
}

namespace {

const scenes::ProceduralScene& scene_named(std::string_view name) {
    for (const auto& scene : scenes::procedural_scenes())
        if (scene.name == name) return scene;
    FAIL("no scene " << name);
    return scenes::procedural_scenes().front();
}

}  // namespace

TEST_CASE("[Donnelly06] 3.1: the rendered penumbra of `planes` is the bilinear coverage", "[donnelly06][3.1]") {
    constexpr int kWidth = 320;
    constexpr int kHeight = 240;
    constexpr int kMap = 128;
    for (const auto& [profile, format] : {std::pair{"d3d11", Format::Rg32Float}, std::pair{"d3d11", Format::Rg16Unorm},
                                          std::pair{"ideal", Format::Rg32Float}}) {
        const scenes::Scene scene = scene_named("planes").make();
        Device device(load_profile(profile), 2);
        const Technique& vsm = find_technique("vsm");
        TechniqueRequest request{
            .map_size = kMap, .format = format, .filter = MapFilter::Bilinear, .set = {{"min-variance", "0"}}};
        Frame frame(device, scene,
                    {.width = kWidth, .height = kHeight, .technique = vsm, .settings = resolve_settings(vsm, request)});
        PassTimer timer(device);
        frame.render(timer);
        const auto bytes = device.texture(frame.visibility()).level_bytes(0);
        std::vector<float> visibility(bytes.size() / 4);
        std::memcpy(visibility.data(), bytes.data(), bytes.size());

        // Geometry, in double from the scene's own vertices: the occluder's edge runs from vertex 1 to vertex 2.
        const scenes::Mesh& occluder = scene.meshes[1];
        const glm::dvec3 edge_a(occluder.vertices[1].position);
        const glm::dvec3 edge_b(occluder.vertices[2].position);
        const double height = edge_a.y;
        // Signed distance of a point in the occluder's plane from the edge; negative under the occluder.
        const auto from_edge = [&](const glm::dvec3& p) {
            const double dx = edge_b.x - edge_a.x;
            const double dz = edge_b.z - edge_a.z;
            return (dx * (p.z - edge_a.z) - dz * (p.x - edge_a.x)) / std::hypot(dx, dz);
        };
        const double sign = from_edge(glm::dvec3(occluder.vertices[0].position)) < 0 ? 1.0 : -1.0;
        const glm::dmat4 camera_from_clip =
            glm::inverse(glm::dmat4(frame.camera().clip_from_view) * glm::dmat4(frame.camera().view_from_world));
        const glm::dmat4 light_clip = glm::dmat4(frame.light().clip_from_view) * glm::dmat4(frame.light().view_from_world);
        const glm::dmat4 light_from_clip = glm::inverse(light_clip);
        const auto on_height = [](const glm::dmat4& world_from_clip, double x, double y, double plane) {
            glm::dvec4 a = world_from_clip * glm::dvec4(x, y, 0, 1);
            glm::dvec4 b = world_from_clip * glm::dvec4(x, y, 1, 1);
            const glm::dvec3 p(a / a.w);
            const glm::dvec3 q(b / b.w);
            return p + (q - p) * ((plane - p.y) / (q.y - p.y));
        };

        int penumbra = 0;
        int umbra = 0;
        double worst = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float seen = visibility[static_cast<std::size_t>(y * kWidth + x)];
                if (seen == Frame::kNoSurface) continue;
                const double nx = (x + 0.5) / kWidth * 2 - 1;
                const double ny = 1 - (y + 0.5) / kHeight * 2;
                const glm::dvec3 over = on_height(camera_from_clip, nx, ny, height);
                if (sign * from_edge(over) < 0.05) continue;  // the occluder hides the receiver, or nearly
                const glm::dvec3 ground = on_height(camera_from_clip, nx, ny, 0.0);
                if (std::fabs(ground.x) > 5.9 || std::fabs(ground.z) > 5.9) continue;
                const auto map_texels = [&](double ndc_x, double ndc_y) {
                    const glm::dvec4 clip = light_clip * glm::dvec4(on_height(camera_from_clip, ndc_x, ndc_y, 0.0), 1);
                    return glm::dvec2((clip.x / clip.w * 0.5 + 0.5) * kMap - 0.5, (0.5 - clip.y / clip.w * 0.5) * kMap - 0.5);
                };
                const auto [s, t] = std::pair{map_texels(nx, ny).x, map_texels(nx, ny).y};
                const glm::dvec2 per_x = map_texels(nx + 2.0 / kWidth, ny) - map_texels(nx, ny);
                const glm::dvec2 per_y = map_texels(nx, ny - 2.0 / kHeight) - map_texels(nx, ny);
                const double per_pixel = std::fabs(per_x.x) + std::fabs(per_x.y) + std::fabs(per_y.x) + std::fabs(per_y.y);
                if (!(s > 1 && t > 1 && s < kMap - 2 && t < kMap - 2)) continue;
                const double fs = s - std::floor(s);
                const double ft = t - std::floor(t);
                double p = 0;
                bool ambiguous = false;
                for (int j = 0; j < 2; ++j)
                    for (int i = 0; i < 2; ++i) {
                        const double cx = (std::floor(s) + i + 0.5) / kMap * 2 - 1;
                        const double cy = 1 - (std::floor(t) + j + 0.5) / kMap * 2;
                        const double distance = sign * from_edge(on_height(light_from_clip, cx, cy, height));
                        if (std::fabs(distance) < 1e-3) ambiguous = true;  // a texel is 0.025 wide up there
                        if (distance > 0) p += (i == 1 ? fs : 1 - fs) * (j == 1 ? ft : 1 - ft);
                    }
                if (ambiguous) continue;
                // Weights round to 1/256 per axis (half a step each, full contrast); vertices snap to 1/256 pixel while
                // their attributes stay, so that everything moves by up to 1/512 pixel; matrices are fp32 under any profile;
                // and sixteen bits lose a few steps of 65535 over contrast^2, which is nearly 1 here.
                const bool ideal = profile == std::string("ideal");
                const double tolerance = (ideal ? 0.0 : 2.0 / 512) + per_pixel / 512 + kMap * 0x1p-20 + 1e-5 +
                                         (format == Format::Rg16Unorm ? 1e-4 : 0);
                // Towards p = 1 the bound divides by (1 - p) contrast^2, which sixteen bits cannot resolve.
                if (p > 0 && p < (format == Format::Rg16Unorm ? 1 - 1.0 / 64 : 1 - 1e-6)) {
                    ++penumbra;
                    worst = std::max(worst, std::fabs(static_cast<double>(seen) - p));
                    if (!(std::fabs(static_cast<double>(seen) - p) <= tolerance))
                        FAIL(fmt::format("{} {} pixel ({}, {}): visibility {:a}, coverage {:a}, texel ({}, {})", profile,
                                         name_of(format), x, y, seen, p, s, t));
                } else if (p == 0) {
                    ++umbra;
                    if (!(static_cast<double>(seen) <= tolerance))
                        FAIL(fmt::format("{} {} pixel ({}, {}): {:a} in the umbra", profile, name_of(format), x, y, seen));
                }
            }
        INFO(profile << " " << name_of(format) << ": " << penumbra << " pixels, worst " << worst);
        CHECK(penumbra > 300);
        CHECK(umbra > 1000);
        CHECK(worst > 0);
        if (profile == std::string("d3d11")) CHECK(worst > 1.0 / 4096);  // the 8-bit weights show
    }
}
