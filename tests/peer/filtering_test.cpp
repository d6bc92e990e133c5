// Filtered moments on every usable device: visibility against the formulas in double precision, anisotropic filtering against
// trilinear, one device against another.
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

constexpr std::uint32_t kWidth = 320;  // of render()
constexpr std::uint32_t kHeight = 240;

// Of visibility, which falls by at most 0.65 in a least deviation: sqrt(1e-5) of the light's range, of which depths read back
// far from the camera are off by up to 2e-5.
constexpr double kTolerance = 0.005;

using Channels = std::array<double, 4>;

// Bilinear, edge texels repeated; what the map lacks is 0.
Channels filtered(const FrameImages& images, const glm::dvec2& uv) {
    const int size = static_cast<int>(images.map_size);
    const glm::dvec2 at = uv * static_cast<double>(size) - 0.5;
    const glm::dvec2 first(std::floor(at.x), std::floor(at.y));
    Channels sum{};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double weight =
                (i == 0 ? first.x + 1 - at.x : at.x - first.x) * (j == 0 ? first.y + 1 - at.y : at.y - first.y);
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

// Whether a pixel and the four around it are one face: there depth is affine in the picture.
bool is_inside_face(const FrameImages& images, std::size_t pixel) {
    const std::size_t column = pixel % images.width;
    const std::size_t row = pixel / images.width;
    if (column == 0 || row == 0 || column + 1 == images.width || row + 1 == images.height) return false;
    const auto bend = [&](std::size_t step) {
        return std::abs(images.depth[pixel - step] - images.depth[pixel] + (images.depth[pixel + step] - images.depth[pixel]));
    };
    return bend(1) < 1e-6f && bend(images.width) < 1e-6f;
}

// Of every pixel, from its depth; nothing where it is background, outside the light's frustum or within a thousandth of its
// border.
std::vector<std::optional<MapPlace>> map_places(const Frame& frame, const FrameImages& images) {
    const auto is_inside = [](double x) { return x > 0.001 && x < 0.999; };
    const glm::dmat4 world_from_clip =
        glm::inverse(glm::dmat4(frame.camera.clip_from_view) * glm::dmat4(frame.camera.view_from_world));
    const glm::dmat4 view_from_world(frame.light.view_from_world);
    const glm::dmat4 clip_from_view(frame.light.clip_from_view);
    const auto znear = static_cast<double>(frame.light.znear);
    const auto zfar = static_cast<double>(frame.light.zfar);
    std::vector<std::optional<MapPlace>> places(images.depth.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (images.visibility[i] == kNoSurface) continue;
        const double x_px = static_cast<double>(i % images.width) + 0.5;
        const double y_px = static_cast<double>(i / images.width) + 0.5;
        const glm::dvec4 world = world_from_clip * glm::dvec4(2 * x_px / images.width - 1, 1 - 2 * y_px / images.height,
                                                              static_cast<double>(images.depth[i]), 1);
        const glm::dvec4 view = view_from_world * (world / world.w);
        const glm::dvec4 clip = clip_from_view * view;
        const MapPlace place{{0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w}, (-view.z - znear) / (zfar - znear)};
        if (is_inside(place.uv.x) && is_inside(place.uv.y) && is_inside(place.depth)) places[i] = place;
    }
    return places;
}

// An image and what it ought to show.
struct Evaluation {
    const FrameImages& images;
    TechniqueOptions technique;
    std::vector<std::optional<MapPlace>> places;

    [[nodiscard]] double visibility(const MapPlace& place) const {
        return visibility_of(filtered(images, place.uv), place.depth, technique);
    }
    [[nodiscard]] double error(std::size_t pixel) const {
        return std::abs(static_cast<double>(images.visibility[pixel]) - visibility(*places[pixel]));
    }
    // Whether a pixel shows what lies within one of the device's sub-pixels of its centre (vertices are snapped to them),
    // looked up within two of its sub-texels (one for the coordinates, one for the weights). Vulkan 1.3 subPixelPrecisionBits,
    // subTexelPrecisionBits.
    [[nodiscard]] bool is_resolved(std::size_t pixel, const DeviceLimits& limits) const;
};

bool Evaluation::is_resolved(std::size_t pixel, const DeviceLimits& limits) const {
    const MapPlace& place = *places[pixel];
    const double sub_pixel = std::ldexp(1.0, -static_cast<int>(limits.sub_pixel_bits));
    const double sub_texel = std::ldexp(1.0 / images.map_size, -static_cast<int>(limits.sub_texel_bits));
    // So many sub-pixels towards a neighbour; none where that is another kind of pixel.
    const auto step = [&](std::size_t neighbour, double sub_pixels) {
        const bool is_known = neighbour < places.size() && places[neighbour];
        const MapPlace& other = is_known ? *places[neighbour] : place;
        const double share = sub_pixels * sub_pixel;
        return MapPlace{share * (other.uv - place.uv), share * (other.depth - place.depth)};
    };
    const auto steps = [&](std::size_t before, std::size_t after) {
        return std::array{step(before, 1), step(before, 0.5), step(pixel, 0), step(after, 0.5), step(after, 1)};
    };
    double least = 1;
    double greatest = 0;
    for (const MapPlace& column : steps(pixel - 1, pixel + 1))
        for (const MapPlace& row : steps(pixel - images.width, pixel + images.width))
            for (int j = -2; j <= 2; ++j)
                for (int i = -2; i <= 2; ++i) {
                    const double v = visibility(
                        {place.uv + column.uv + row.uv + sub_texel * glm::dvec2(i, j), place.depth + column.depth + row.depth});
                    least = std::min(least, v);
                    greatest = std::max(greatest, v);
                }
    const auto actual = static_cast<double>(images.visibility[pixel]);
    return actual >= least - kTolerance && actual <= greatest + kTolerance;
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

// Means of the pixels of a picture eight times as wide and high; kNoSurface where any of them is background.
std::vector<float> supersampled(const Peer& peer, const scenes::Scene& scene, const TechniqueOptions& technique) {
    constexpr std::uint32_t kScale = 8;
    Frame frame = scene_frame(scene, kScale * kWidth, kScale * kHeight);
    frame.technique = technique;
    const FrameImages fine = FrameRenderer(peer, frame).render();
    std::vector<float> means(std::size_t{kWidth} * kHeight);
    for (std::size_t y = 0; y < fine.height; ++y)
        for (std::size_t x = 0; x < fine.width; ++x) {
            float& mean = means[y / kScale * kWidth + x / kScale];
            const float v = fine.visibility[y * fine.width + x];
            mean = v == kNoSurface || mean == kNoSurface ? kNoSurface : mean + v / (kScale * kScale);
        }
    return means;
}

// Over the pixels that are surface in both.
double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    REQUIRE(a.size() == b.size());
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] == kNoSurface || b[i] == kNoSurface) continue;
        sum += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        ++count;
    }
    REQUIRE(count > 1000);
    return sum / count;
}

// What is compared below, all with bilinear filtering.
std::vector<TechniqueOptions> moment_techniques() {
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
    return {vsm, evsm, blurred, half};
}

}  // namespace

TEST_CASE("every technique by name draws light and shadow", "[peer][device]") {
    const scenes::Scene scene = boxes();
    on_each_device([&scene](const Peer& peer) {
        for (const NamedTechnique& known : named_techniques()) {
            INFO(known.name);
            const Lit shares = lit_shares(render(peer, scene, known.options));
            if (known.options.technique == Technique::None) {
                CHECK(shares.lit == 1);
                continue;
            }
            CHECK(shares.dark > 0.1);
            CHECK(shares.lit > 0.5);
            CHECK((shares.partial > 0.02) == (known.options.technique != Technique::ShadowMap));
        }
    });
}

TEST_CASE("visibility is the formulas' of the map's moments", "[peer][device][Donnelly06][Lauritzen08]") {
    const scenes::Scene scene = boxes();
    on_each_device([&](const Peer& peer) {
        for (const TechniqueOptions& technique : moment_techniques()) {
            INFO(format_traits(technique.moment_format).name << ", blur of " << technique.blur_kernel.size());
            Frame frame = scene_frame(scene, kWidth, kHeight);
            frame.technique = technique;
            const FrameImages images = FrameRenderer(peer, frame).render();
            const Evaluation evaluation{images, technique, map_places(frame, images)};
            int compared = 0;
            double sum = 0;
            for (std::size_t pixel = 0; pixel < evaluation.places.size(); ++pixel) {
                if (!evaluation.places[pixel] || !is_inside_face(images, pixel)) continue;
                const double error = evaluation.error(pixel);
                sum += error;
                ++compared;
                if (error <= kTolerance || evaluation.is_resolved(pixel, peer.description().limits)) continue;
                INFO("pixel " << pixel % kWidth << ' ' << pixel / kWidth << " shows " << images.visibility[pixel]);
                FAIL_CHECK("expected " << evaluation.visibility(*evaluation.places[pixel]));
            }
            CHECK(compared > 30'000);
            CHECK(sum / compared < 1e-3);
        }
    });
}

TEST_CASE("anisotropic filtering keeps what trilinear filtering blurs", "[peer][device]") {
    // Along the ground a pixel is many texels long and few wide; seen from the light it is as long as wide.
    scenes::Scene grazing = two_planes();
    grazing.camera.world_from_camera = scenes::looking_at({0, 0.7, 7}, {0, 0.3, 0});
    scenes::Scene straight = two_planes();
    straight.camera.world_from_camera = scenes::looking_at({0, 12, 0}, {0, 0, 0});
    on_each_device([&](const Peer& peer) {
        for (const char* name : {"vsm-rg32f-16x", "vsm-rg16f-16x", "evsm4-rgba32f-16x", "evsm4-rgba16f-16x"}) {
            INFO(name);
            const TechniqueOptions& anisotropic = technique_named(name);
            TechniqueOptions trilinear = anisotropic;
            trilinear.max_anisotropy = 1;
            const std::vector<float> exact = supersampled(peer, grazing, trilinear);
            const std::vector<float> blurred = render(peer, grazing, trilinear).visibility;
            const std::vector<float> kept = render(peer, grazing, anisotropic).visibility;
            CHECK(mean_difference(exact, kept) < 0.6 * mean_difference(exact, blurred));
            const double along_the_light =
                mean_difference(render(peer, straight, trilinear).visibility, render(peer, straight, anisotropic).visibility);
            CHECK(along_the_light < 0.2 * mean_difference(kept, blurred));
        }
    });
}

TEST_CASE("devices agree on exponential moments", "[peer][device]") {
    const scenes::Scene scene = boxes();
    for (const char* name : {"evsm4-rgba32f-trilinear", "evsm4-rgba16f-trilinear", "evsm4-rgba32f-trilinear-blur-3x3"}) {
        INFO(name);
        const std::vector<float> first = render(Peer(usable_devices().front()), scene, technique_named(name)).visibility;
        on_each_device([&](const Peer& peer) {
            CHECK(mean_difference(first, render(peer, scene, technique_named(name)).visibility) < 0.005);
        });
    }
}

}  // namespace gnomon::peer
