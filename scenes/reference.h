// Ground truth by ray tracing (Embree): which share of a pixel's surface sees the light.
#pragma once

#include "scenes/scene.h"
#include "scenes/view.h"
#include "sim/progress.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::scenes {

enum class ReferenceMode {
    Center,  // one camera ray through each pixel centre, one shadow ray from its hit
    Area,    // a stratified grid of camera rays over the pixel footprint, one shadow ray each
};

struct ReferenceOptions {
    ReferenceMode mode = ReferenceMode::Center;
    int area_samples = 64;   // rays per pixel in Area: a square number >= 64
    std::uint64_t seed = 1;  // jitter inside the strata: a hash of (seed, pixel, sample), so independent of threads
    int threads = 0;         // 0: all processors
};

/// Row-major, top row first, width * height values each.
struct ReferenceImage {
    int width = 0;
    int height = 0;
    std::vector<float> visibility;  // [0, 1]: mean over the pixel's valid samples; 1 where there is none
    std::vector<float> weight;      // [0, 1]: share of samples that are valid: the camera ray hits a surface inside the light's
                                    // frustum (a spot's square one counts, not its cone) whose interpolated normal faces
                                    // the light: dot(normal, to_light) > 0
};

/// Traces `scene` from `camera` (pixel centres at +0.5) against `light`; triangles have two sides. Same bytes for any thread
/// count. Throws Error when width, height or area_samples is out of range or Embree refuses the scene, Stopped through
/// `progress`.
ReferenceImage trace_reference(const Scene& scene, const View& camera, const View& light, int width, int height,
                               const ReferenceOptions& options, const Progress& progress = {});

/// A point of a surface.
struct SurfacePoint {
    glm::dvec3 position_ws{0.0};
    glm::dvec3 normal_ws{0.0};  // of the triangle, not interpolated; unit length, on either side
};

/// What the camera sees at the centres of pixels (x from the left, y from the top), one after the other; nothing where a ray
/// meets nothing. Throws Error when Embree refuses the scene.
std::vector<std::optional<SurfacePoint>> trace_points(const Scene& scene, const View& camera, int width, int height,
                                                      std::span<const glm::ivec2> pixels);

}  // namespace gnomon::scenes
