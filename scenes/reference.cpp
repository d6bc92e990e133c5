// Ground truth by ray tracing: camera rays, one shadow ray from each hit, averages over pixels.
#include "scenes/reference.h"

#include "scenes/embree_scene.h"
#include "scenes/random.h"
#include "sim/error.h"
#include "sim/parallel.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <mutex>

namespace gnomon::scenes {

namespace {

constexpr int kTile = 16;
constexpr int kLargestImage = 16384;     // D3D11.3 appendix: largest render target
constexpr int kMostAreaSamples = 65536;  // 256 x 256 strata

/// Camera rays: image points to directions whose parameter t is the view-space depth.
class CameraRays {
public:
    CameraRays(const View& camera, int width, int height) : camera_(camera), size_(width, height) {
        const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(camera.view_from_world));
        axes_ = glm::dmat3(world_from_view);
        eye_ = glm::dvec3(world_from_view[3]);
    }

    /// The ray through the image point `at_px`, y down, between the camera's near and far plane.
    [[nodiscard]] Ray through(const glm::dvec2& at_px) const {
        const glm::dmat4 p(camera_.clip_from_view);
        const glm::dvec2 ndc(2 * at_px.x / size_.x - 1, 1 - 2 * at_px.y / size_.y);
        const glm::dvec3 direction_view((ndc.x + p[2][0]) / p[0][0], (ndc.y + p[2][1]) / p[1][1], -1.0);
        return {.origin = eye_,
                .direction = axes_ * direction_view,
                .near_t = static_cast<double>(camera_.znear),
                .far_t = static_cast<double>(camera_.zfar)};
    }

private:
    const View& camera_;
    glm::dvec2 size_;
    glm::dmat3 axes_{1.0};
    glm::dvec3 eye_{0.0};
};

/// The light as the shadow rays see it.
class LightRays {
public:
    explicit LightRays(const View& light)
        : clip_from_world_(glm::dmat4(light.clip_from_view) * glm::dmat4(light.view_from_world)),
          position_(light.position_ws),
          to_light_(-glm::dvec3(light.direction_ws)),
          directional_(light.clip_from_view[2][3] == 0.0f) {}

    [[nodiscard]] bool in_frustum(const glm::dvec3& position_ws) const {
        const glm::dvec4 clip = clip_from_world_ * glm::dvec4(position_ws, 1.0);
        return std::fabs(clip.x) <= clip.w && std::fabs(clip.y) <= clip.w && clip.z >= 0 && clip.z <= clip.w;
    }

    /// Towards the light; its length is the distance to a spot and 1 for a directional light.
    [[nodiscard]] glm::dvec3 to_light(const glm::dvec3& from_ws) const {
        return directional_ ? to_light_ : position_ - from_ws;
    }

    /// From a hit to the light, started off the surface on the side of the light.
    ///
    /// The start is rounded to float (half an ulp of its largest coordinate s: 2^-24 s), and the triangle test subtracts it
    /// from corners of up to the same size and multiplies three times, which moves the plane by some 2^-24 (|corners| +
    /// |distance|) per rounding; about a dozen roundings in all. 32 * 2^-24 times the largest magnitude in play covers them,
    /// and is 10^-5 m at 5 m.
    [[nodiscard]] Ray from(const Hit& hit) const {
        const glm::dvec3 towards = to_light(hit.position_ws);
        double scale = directional_ ? 0.0 : largest(position_);
        for (const glm::dvec3& corner : hit.corners_ws) scale = std::max(scale, largest(corner));
        const double side = glm::dot(hit.geometric_normal_ws, towards) < 0 ? -1.0 : 1.0;
        const glm::dvec3 start = hit.position_ws + hit.geometric_normal_ws * (side * 0x1p-19 * scale);
        return {.origin = start,
                .direction = to_light(start),
                .near_t = 0,
                .far_t = directional_ ? std::numeric_limits<double>::infinity() : 1.0};
    }

private:
    static double largest(const glm::dvec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

    glm::dmat4 clip_from_world_;
    glm::dvec3 position_;
    glm::dvec3 to_light_;
    bool directional_;
};

/// Where the samples of one pixel lie: the centre, or one jittered point in each cell of a square grid.
struct SamplePoints {
    int per_side = 1;
    bool jittered = false;
    std::uint64_t seed = 0;

    [[nodiscard]] glm::dvec2 at(std::uint64_t pixel, int sample) const {
        if (!jittered) return {0.5, 0.5};
        const std::uint64_t hash = hash64(hash64(hash64(seed) ^ pixel) ^ static_cast<std::uint64_t>(sample));
        const glm::dvec2 jitter(unit_interval(hash), unit_interval(hash64(hash)));
        return (glm::dvec2(sample % per_side, sample / per_side) + jitter) / static_cast<double>(per_side);
    }
};

SamplePoints sample_points(const ReferenceOptions& options) {
    switch (options.mode) {
        case ReferenceMode::Center: return {};
        case ReferenceMode::Area: {
            int per_side = 8;
            while (per_side * per_side < options.area_samples && per_side * per_side < kMostAreaSamples) ++per_side;
            if (per_side * per_side != options.area_samples) {
                fail("reference: area_samples is {}, expected a square number from 64 to {}", options.area_samples,
                     kMostAreaSamples);
            }
            return {.per_side = per_side, .jittered = true, .seed = options.seed};
        }
    }
    fail("reference: mode {} is unknown", static_cast<int>(options.mode));
}

}  // namespace

ReferenceImage trace_reference(const Scene& scene, const View& camera, const View& light, int width, int height,
                               const ReferenceOptions& options, const Progress& progress) {
    if (width < 1 || height < 1 || width > kLargestImage || height > kLargestImage) {
        fail("reference: image is {} x {}, expected 1 to {} each way", width, height, kLargestImage);
    }
    const SamplePoints points = sample_points(options);
    const EmbreeScene traced(scene);
    const CameraRays camera_rays(camera, width, height);
    const LightRays light_rays(light);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    ReferenceImage image{.width = width,
                         .height = height,
                         .visibility = std::vector<float>(pixels, 1.0f),
                         .weight = std::vector<float>(pixels, 0.0f)};

    const auto trace_pixel = [&](int x, int y) {
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        const int samples = points.per_side * points.per_side;
        int valid = 0;
        int lit = 0;
        for (int sample = 0; sample < samples; ++sample) {
            const auto hit = traced.nearest(camera_rays.through(glm::dvec2(x, y) + points.at(pixel, sample)));
            if (!hit || !light_rays.in_frustum(hit->position_ws)) continue;
            if (!(glm::dot(hit->normal_ws, light_rays.to_light(hit->position_ws)) > 0)) continue;
            ++valid;
            if (!traced.blocked(light_rays.from(*hit))) ++lit;
        }
        if (valid > 0) image.visibility[pixel] = static_cast<float>(static_cast<double>(lit) / valid);
        image.weight[pixel] = static_cast<float>(static_cast<double>(valid) / samples);
    };

    // Tiles write disjoint pixels; what watches and stops the work is called by one thread at a time.
    const auto tiles_x = static_cast<std::size_t>((width + kTile - 1) / kTile);
    const auto tiles_y = static_cast<std::size_t>((height + kTile - 1) / kTile);
    std::mutex mutex;
    std::size_t done = 0;
    Workers workers(options.threads);
    workers.for_each(tiles_x * tiles_y, [&](std::size_t tile) {
        const int left = static_cast<int>(tile % tiles_x) * kTile;
        const int top = static_cast<int>(tile / tiles_x) * kTile;
        for (int y = top; y < std::min(top + kTile, height); ++y) {
            for (int x = left; x < std::min(left + kTile, width); ++x) trace_pixel(x, y);
        }
        const std::lock_guard lock(mutex);
        progress.step("reference", ++done, tiles_x * tiles_y);
    });
    return image;
}

std::vector<std::optional<SurfacePoint>> trace_points(const Scene& scene, const View& camera, int width, int height,
                                                      std::span<const glm::ivec2> pixels) {
    const EmbreeScene traced(scene);
    const CameraRays camera_rays(camera, width, height);
    std::vector<std::optional<SurfacePoint>> points;
    points.reserve(pixels.size());
    for (const glm::ivec2& pixel : pixels) {
        const auto hit = traced.nearest(camera_rays.through(glm::dvec2(pixel) + 0.5));
        points.emplace_back();
        if (hit) points.back() = SurfacePoint{hit->position_ws, hit->geometric_normal_ws};
    }
    return points;
}

}  // namespace gnomon::scenes
