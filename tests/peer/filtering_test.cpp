// Filtered moments on every usable device: visibility against the formulas in double precision, anisotropic filtering against
// trilinear, one device against another.
#include "sim/error.h"
#include "tests/peer/frame_tests.h"
#include "tests/peer/techniques.h"
#include "tests/peer/test_scenes.h"

#include <catch2/catch.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace gnomon::peer {
namespace {

using Channels = std::array<double, 4>;

// Bilinear, edge texels repeated; what the map lacks is 0.
Channels filtered(const FrameImages& images, const glm::dvec2& uv) {
    const int size = static_cast<int>(images.map_size);
    const glm::dvec2 at = uv * static_cast<double>(size) - 0.5;
    const glm::dvec2 first(std::floor(at.x), std::floor(at.y));
    Channels sum{};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double weight = (i == 0 ? first.x + 1 - at.x : at.x - first.x) * (j == 0 ? first.y + 1 - at.y : at.y - first.y);
            const int x = std::clamp(static_cast<int>(first.x) + i, 0, size - 1);
            const int y = std::clamp(static_cast<int>(first.y) + j, 0, size - 1);
            const std::size_t texel = images.map_channels * static_cast<std::size_t>(y * size + x);
            for (std::size_t channel = 0; channel < images.map_channels; ++channel)
                sum[channel] += weight * static_cast<double>(images.map[texel + channel]);
        }
    return sum;
}

// [Donnelly06] eq. 5, variance by eq. 4.
double chebyshev(double m1, double m2, double t, double min_variance) {
    const double sigma2 = std::max(m2 - m1 * m1, min_variance);
    return t <= m1 ? 1 : sigma2 / (sigma2 + (t - m1) * (t - m1));
}

// The bound of one warp t with the derivative dt/dd = slope.
double warped_bound(double m1, double m2, double t, double slope, const TechniqueOptions& technique) {
    return chebyshev(m1, m2, t, static_cast<double>(technique.min_variance) * slope * slope);
}

double visibility_of(const Channels& m, double depth, const TechniqueOptions& technique) {
    if (technique.technique == Technique::Vsm) return chebyshev(m[0], m[1], depth, static_cast<double>(technique.min_variance));
    // [Lauritzen08] section 4.2.
    const auto c_plus = static_cast<double>(technique.positive_exponent);
    const auto c_minus = static_cast<double>(technique.negative_exponent);
    const double positive = std::exp(c_plus * (2 * depth - 1));
    const double negative = -std::exp(-c_minus * (2 * depth - 1));
    return std::min(warped_bound(m[0], m[1], positive, 2 * c_plus * positive, technique),
                    warped_bound(m[2], m[3], negative, 2 * c_minus * negative, technique));
}

// Where a pixel's surface lies in the light's map.
struct MapPlace {
    glm::dvec2 uv;
    double depth = 0;  // linear
};

// Nothing outside the light's frustum and within a thousandth of its border.
std::optional<MapPlace> map_place(const Frame& frame, const FrameImages& images, std::size_t pixel) {
    const glm::dvec2 px(static_cast<double>(pixel % images.width) + 0.5, static_cast<double>(pixel / images.width) + 0.5);
    const glm::dvec4 ndc(2 * px.x / images.width - 1, 1 - 2 * px.y / images.height, images.depth[pixel], 1);
    const glm::dmat4 clip_from_world = glm::dmat4(frame.camera.clip_from_view) * glm::dmat4(frame.camera.view_from_world);
    const glm::dvec4 world = glm::inverse(clip_from_world) * ndc;

    const glm::dvec4 view = glm::dmat4(frame.light.view_from_world) * (world / world.w);
    const glm::dvec4 clip = glm::dmat4(frame.light.clip_from_view) * view;
    const MapPlace place{{0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w},
                         (-view.z - static_cast<double>(frame.light.znear)) /
                             (static_cast<double>(frame.light.zfar) - static_cast<double>(frame.light.znear))};
    const auto is_inside = [](double x) { return x > 0.001 && x < 0.999; };
    if (!is_inside(place.uv.x) || !is_inside(place.uv.y) || !is_inside(place.depth)) return std::nullopt;
    return place;
}

// How the surfaces of an image are lit, as shares of them.
struct Lit {
    double dark = 0;     // below 0.1
    double partial = 0;  // 0.1..0.9
    double lit = 0;      // above 0.9
};
Lit lit_shares(const FrameImages& images) {
    Lit count;
    for (const float v : images.visibility) {
        if (v == kNoSurface) continue;
        REQUIRE((v >= 0.0f && v <= 1.0f));
        (v < 0.1f ? count.dark : v > 0.9f ? count.lit : count.partial) += 1;
    }
    const double surfaces = count.dark + count.partial + count.lit;
    return {count.dark / surfaces, count.partial / surfaces, count.lit / surfaces};
}


}  // namespace

TEST_CASE("every technique by name draws light and shadow", "[peer][device]") {
    const scenes::Scene scene = boxes();
    on_each_device([&scene](const Peer& peer) {
        for (const NamedTechnique& known : named_techniques()) {
            INFO(known.name);
            const Lit shares = lit_shares(render(peer, scene, known.options));
            printf("%s dark %g partial %g lit %g\n", known.name.c_str(), shares.dark, shares.partial, shares.lit);
        }
    });
}

TEST_CASE("visibility is the formulas' of the map's moments", "[peer][device][Lauritzen08]") {
    const TechniqueOptions vsm{.technique = Technique::Vsm, .map_size = 128, .filter = MapFilter::Bilinear};
    TechniqueOptions evsm = vsm;
    evsm.technique = Technique::Evsm4;
    evsm.moment_format = MomentFormat::Rgba32f;
    TechniqueOptions blurred = evsm;
    blurred.blur_kernel = gaussian_kernel(5);
    TechniqueOptions half = evsm;
    half.moment_format = MomentFormat::Rgba16f;
    half.positive_exponent = 5.5f;
    half.min_variance = 1e-4f;
    const scenes::Scene scene = boxes();
    on_each_device([&](const Peer& peer) {
        for (const TechniqueOptions& technique : {vsm, evsm, blurred, half}) {
            Frame frame = scene_frame(scene, 320, 240);
            frame.technique = technique;
            const FrameImages images = FrameRenderer(peer, frame).render();
            int compared = 0;
            double worst = 0, sum = 0; int bad = 0;
            for (std::size_t pixel = 0; pixel < images.visibility.size(); ++pixel) {
                if (images.visibility[pixel] == kNoSurface) continue;
                const std::optional<MapPlace> place = map_place(frame, images, pixel);
                if (!place) continue;
                const double expected = visibility_of(filtered(images, place->uv), place->depth, technique);
                const double error = std::abs(static_cast<double>(images.visibility[pixel]) - expected);
                ++compared; worst = std::max(worst, error); sum += error; bad += error > 0.01;
            }
            printf("compared %d worst %g mean %g bad %d\n", compared, worst, sum / compared, bad);
        }
    });
}

TEST_CASE("anisotropic filtering keeps what trilinear filtering blurs", "[peer][device]") {
    scenes::Scene scene = two_planes();
    on_each_device([&](const Peer& peer) {
        for (int v = 0; v < 2; ++v) {
        scene.camera.world_from_camera = v == 0 ? scenes::looking_at({0, 0.7, 7}, {0, 0.3, 0}) : scenes::looking_at({0, 12, 0}, {0, 0, 0});
        TechniqueOptions t{.technique = Technique::Vsm, .map_size = 512, .filter = MapFilter::Trilinear};
        const FrameImages tri = render(peer, scene, t);
        t.max_anisotropy = 16;
        const FrameImages aniso = render(peer, scene, t);
        t.max_anisotropy = 1;
        Frame fine = scene_frame(scene, 320 * 8, 240 * 8);
        fine.technique = t;
        const FrameImages truth = FrameRenderer(peer, fine).render();
        std::vector<float> down(320 * 240);
        for (std::size_t y = 0; y < 240; ++y) for (std::size_t x = 0; x < 320; ++x) {
            float s = 0; bool none = false;
            for (std::size_t j = 0; j < 8; ++j) for (std::size_t i = 0; i < 8; ++i) { const float q = truth.visibility[(8 * y + j) * 2560 + 8 * x + i]; none |= q < 0; s += q; }
            down[y * 320 + x] = none ? -1 : s / 64;
        }
        double et = 0, ea = 0, d = 0; int n = 0;
        for (std::size_t i = 0; i < down.size(); ++i) { if (down[i] < 0 || tri.visibility[i] < 0 || aniso.visibility[i] < 0) continue; ++n; et += std::abs(down[i] - tri.visibility[i]); ea += std::abs(down[i] - aniso.visibility[i]); d += std::abs(tri.visibility[i] - aniso.visibility[i]); }
        printf("view %d n %d tri err %g aniso err %g diff %g\n", v, n, et / n, ea / n, d / n);
        }
    });
}

}  // namespace gnomon::peer
