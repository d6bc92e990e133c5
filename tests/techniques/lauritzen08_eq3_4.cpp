// [Lauritzen08] equations 3.1 to 3.4: moments, their bound, and the tail of it that lets light through: a half plane A over a
// plane B over a plane C, where A's edge shows on C although B shadows all of it.
#include "scenes/shapes.h"
#include "scenes/view.h"
#include "techniques/common/moments.h"
#include "techniques/frame.h"
#include "tests/oracle/random.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <cstring>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

/// p(dy) of the middle of A's edge. [Lauritzen08] eq. 3.4
double light_bleeding(double dx, double dy) { return 0.25 * dx * dx / (0.5 * dx * dx + dx * dy + dy * dy); }

/// The same where A covers a share `alpha` of the filter: sigma^2 = alpha (1 - alpha) dx^2, mu = b - alpha dx (4.1.2).
double light_bleeding(double dx, double dy, double alpha) {
    const double sigma2 = alpha * (1 - alpha) * dx * dx;
    const double behind = dy + alpha * dx;
    return sigma2 == 0 ? 0 : sigma2 / (sigma2 + behind * behind);
}

double bound(double m1, double m2, double t) {
    return lane(chebyshev_upper_bound(Moments<Double>{Double(m1), Double(m2)}, Double(t), Double(0.0)), 0);
}

}  // namespace

TEST_CASE("[Lauritzen08] eqs. 3.1 to 3.3: moments of many depths, mean, variance and bound", "[lauritzen08][3.1]") {
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        oracle::Random random(seed);
        const int count = 1 + static_cast<int>(random.unit() * 15.0f);
        std::vector<double> depths;
        double m1 = 0;
        double m2 = 0;
        for (int i = 0; i < count; ++i) {
            const auto depth = static_cast<double>(random.unit());
            const auto m = moments_of_depth(Double(depth));
            depths.push_back(depth);
            m1 += lane(m.first, 0) / count;
            m2 += lane(m.second, 0) / count;
        }
        double spread = 0;  // the variance as it is defined
        for (const double depth : depths) spread += (depth - m1) * (depth - m1) / count;
        const Moments<Double> m{Double(m1), Double(m2)};
        CHECK(lane(mean(m), 0) == m1);
        REQUIRE(std::fabs(lane(variance(m), 0) - spread) < 1e-14);
        for (int i = 0; i < 8; ++i) {
            const auto t = static_cast<double>(random.unit());
            const auto beyond = std::ranges::count_if(depths, [&](double depth) { return depth >= t; });
            const double share = static_cast<double>(beyond) / count;
            // Rounding of the moments, 1e-15, weighs most where the variance is small: |dp/dsigma^2| <= 1 / (t - mu)^2.
            if (bound(m1, m2, t) < share - 1e-9 - 1e-14 / ((t - m1) * (t - m1) + 1e-12))
                FAIL(fmt::format("seed {}: P(x >= {:a}) = {:a}, bound {:a}", seed, t, share, bound(m1, m2, t)));
        }
    }
}

TEST_CASE("[Lauritzen08] eq. 3.4: the tail of the bound falls like 1 / dy^2", "[lauritzen08][3.4]") {
    for (const double dx : {0.01, 0.05, 0.1, 0.3, 0.5})
        for (const double dy : {0.001, 0.01, 0.05, 0.1, 0.3}) {
            const double a = 0.1;
            const double b = a + dx;
            const double c = b + dy;
            INFO("dx " << dx << " dy " << dy);
            // Moments of half a filter at a and half at b; the receiver is at c.
            CHECK(std::fabs(bound((a + b) / 2, (a * a + b * b) / 2, c) - light_bleeding(dx, dy)) < 1e-11);
            CHECK(std::fabs(light_bleeding(dx, dy, 0.5) - light_bleeding(dx, dy)) < 1e-14);
            CHECK(std::fabs(bound((a + b) / 2, (a * a + b * b) / 2, b) - 0.5) < 1e-11);  // on B it is right
        }
    // O(1 / dy^2): p dy^2 tends to dx^2 / 4 from below.
    double before = 0;
    for (const double dy : {1.0, 10.0, 100.0, 1000.0}) {
        const double scaled = light_bleeding(0.5, dy) * dy * dy;
        CHECK(scaled > before);
        CHECK(scaled < 0.0625);
        before = scaled;
    }
    CHECK(before > 0.0624);
}

namespace {

constexpr int kMap = 64;
constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kSide = 4.0;  // half the planes' sides

/// Heights of A and B; C is the ground. The light looks straight down; the camera looks at C from under B.
scenes::Scene three_planes(double height_a, double height_b) {
    scenes::Scene scene;
    scene.name = "three planes";
    const auto add = [&](std::string name, double from_x, double height) {
        scenes::Mesh mesh{.name = std::move(name), .vertices = {}, .indices = {}};
        scenes::append(mesh, scenes::grid({from_x, height, kSide}, {kSide - from_x, 0, 0}, {0, 0, -2 * kSide}, 1, 1),
                       scenes::kFlat);
        scene.instances.push_back({.mesh = static_cast<std::uint32_t>(scene.meshes.size())});
        scene.meshes.push_back(std::move(mesh));
    };
    add("C", -kSide, 0.0);
    add("B", -kSide, height_b);
    add("A", 0.03, height_a);  // the edge lies between the middles of two texels
    scene.camera.world_from_camera = scenes::looking_at({0.0, 0.6 * height_b, 0.9 * height_b}, {0.0, 0.0, 0.0});
    scene.camera.yfov_rad = 0.7f;
    scene.camera.znear = 0.01f;
    scene.camera.zfar = 50.0f;
    scene.light.kind = scenes::LightKind::Directional;
    scene.light.world_from_light = scenes::looking_at({0, 10, 0}, {0, 0, 0});
    return scene;
}

struct Tail {
    int pixels = 0;
    double largest = 0;  // visibility
    double worst = 0;    // error against eq. 3.4
};

/// Renders vsm and compares every pixel of C under A's edge with eq. 3.4 at its share of A.
Tail measure_tail(double height_a, double height_b, const std::string& profile) {
    const scenes::Scene scene = three_planes(height_a, height_b);
    Device device(load_profile(profile), 2);
    const Technique& vsm = find_technique("vsm");
    const TechniqueRequest request{.map_size = kMap, .filter = MapFilter::Bilinear, .set = {{"min-variance", "0"}}};
    Frame frame(device, scene,
                {.width = kWidth, .height = kHeight, .technique = vsm, .settings = resolve_settings(vsm, request)});
    PassTimer timer(device);
    frame.render(timer);
    const auto bytes = device.texture(frame.visibility()).level_bytes(0);
    std::vector<float> visibility(bytes.size() / 4);
    std::memcpy(visibility.data(), bytes.data(), bytes.size());

    const glm::dmat4 world_from_clip =
        glm::inverse(glm::dmat4(frame.camera().clip_from_view) * glm::dmat4(frame.camera().view_from_world));
    const glm::dmat4 light_clip = glm::dmat4(frame.light().clip_from_view) * glm::dmat4(frame.light().view_from_world);
    const auto on_ground = [&](double x, double y) {
        const glm::dvec4 near = world_from_clip * glm::dvec4(x, y, 0, 1);
        const glm::dvec4 far = world_from_clip * glm::dvec4(x, y, 1, 1);
        const glm::dvec3 p(near / near.w);
        const glm::dvec3 q(far / far.w);
        return p + (q - p) * ((0.0 - p.y) / (q.y - p.y));
    };
    const auto texel_x = [&](double x) {  // where a point lies in the map, texel centres at whole numbers
        return ((light_clip * glm::dvec4(x, 0, 0, 1)).x * 0.5 + 0.5) * kMap - 0.5;
    };
    // The first column of texels whose middles lie under A.
    const double edge = std::ceil(texel_x(0.03));
    const double range = static_cast<double>(frame.light().zfar);
    const double dx = (height_a - height_b) / range;
    const double dy = height_b / range;

    Tail tail;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float seen = visibility[static_cast<std::size_t>(y * kWidth + x)];
            const glm::dvec3 ground = on_ground((x + 0.5) / kWidth * 2 - 1, 1 - (y + 0.5) / kHeight * 2);
            if (seen == Frame::kNoSurface || std::fabs(ground.z) > 0.8 * kSide) continue;
            const double alpha = texel_x(ground.x) - (edge - 1);  // share of the texel under A: 0 before, 1 behind the pair
            if (alpha <= 0.01 || alpha >= 0.99) continue;
            // Weights round to 1/256 (half a step), vertices snap to 1/256 pixel while their attributes stay, so everything
            // moves by up to 1/512 pixel; matrices are fp32 under any profile.
            const double per_pixel =
                std::fabs(texel_x(on_ground((x + 1.5) / kWidth * 2 - 1, 1 - (y + 0.5) / kHeight * 2).x) - texel_x(ground.x)) +
                std::fabs(texel_x(on_ground((x + 0.5) / kWidth * 2 - 1, 1 - (y + 1.5) / kHeight * 2).x) - texel_x(ground.x));
            const double e_alpha = (profile == "ideal" ? 0.0 : 1.0 / 512) + per_pixel / 512 + kMap * 0x1p-20;
            double low = 1;
            double high = 0;
            for (int i = -8; i <= 8; ++i) {
                const double p = light_bleeding(dx, dy, std::clamp(alpha + e_alpha * i / 8, 0.0, 1.0));
                low = std::min(low, p);
                high = std::max(high, p);
            }
            // Moments of depths up to 1 come out of storage, filter and subtraction with about 2^-21; dp/dsigma^2 <= 1 / d^2.
            const double e_moments = 0x1p-21 / ((dy + alpha * dx) * (dy + alpha * dx));
            const auto got = static_cast<double>(seen);
            const double expected = light_bleeding(dx, dy, alpha);
            const double error = std::fabs(got - expected);
            if (!(got >= low - e_moments && got <= high + e_moments))
                FAIL(fmt::format(
                    "{} heights {} {} pixel ({}, {}) alpha {}: visibility {:a}, eq. 3.4 {:a}, between {:a} and {:a}", profile,
                    height_a, height_b, x, y, alpha, seen, expected, low, high));
            ++tail.pixels;
            tail.largest = std::max(tail.largest, static_cast<double>(seen));
            tail.worst = std::max(tail.worst, error);
        }
    return tail;
}

}  // namespace

TEST_CASE("[Lauritzen08] eq. 3.4: three planes on the machine leak as it says", "[lauritzen08][3.4]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        double before = 1;
        for (const auto& [a, b] :
             {std::pair{8.0, 0.5}, std::pair{4.0, 0.5}, std::pair{4.0, 1.0}, std::pair{4.0, 2.0}, std::pair{4.0, 3.0}}) {
            const Tail tail = measure_tail(a, b, profile);
            INFO(profile << " heights " << a << " " << b << ": " << tail.pixels << " pixels, up to " << tail.largest
                         << ", worst " << tail.worst);
            CHECK(tail.pixels > 300);
            CHECK(tail.largest < before);  // the ratio of dx to dy falls from case to case
            before = tail.largest;
            CHECK(tail.worst > 0);
        }
        CHECK(before < 0.05);
    }
    CHECK(measure_tail(8.0, 0.5, "d3d11").largest > 0.5);  // nearly as if B were not there
}
