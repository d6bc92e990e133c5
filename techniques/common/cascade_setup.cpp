// Splits and windows of a frame. [PSVSM] steps 1, 2a, 2b; [Zhang06]; [Lauritzen10]
#include "techniques/common/cascade_setup.h"

#include "sim/error.h"
#include "sim/scalar_math.h"
#include "techniques/common/gaussian.h"
#include "techniques/common/splits.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::techniques {

namespace {

/// What may be nearer or farther than the centre of any pixel shows, as a share of the distance.
constexpr double kDistanceSlack = 1.0 / 256;

/// Of a depth between 1/2 and 1 in d32f: its half step 2^-25, and those of the transform before it.
constexpr double kDepthError = 0x1p-22;

/// Texels around a window that every filter may reach into: a neighbour, and a pixel of a quad that is in another split.
constexpr double kFilterMargin = 2.0;

/// What margins leave of a map along an axis, and at least half of it.
double margin_share(double texels, int map_size) { return std::max(0.5, 1.0 - 2.0 * texels / map_size); }

bool is_directional(const scenes::View& light) { return light.clip_from_view[2][3] == 0.0f; }

}  // namespace

const std::vector<Parameter>& cascade_parameters() {
    static const std::vector<Parameter> parameters{
        word("splits", SplitPlacement::Practical,
             "what places splits: the camera's planes, the nearest and farthest surface in view, or how many pixels lie where"),
        number("lambda", 0.5, 0, 1, "share of the logarithmic scheme in the distances of splits; the rest is uniform"),
        number("reach", 0, 0, 1e6, "distance from the camera that the last split ends at, metres; 0: the camera's far plane"),
        word("cure", SeamCure::None, "what is done for quads that straddle two splits"),
        word("snap", Switch::Off, "windows of constant size that move by whole texels"),
        number("fade", 0, 0, 0.5, "share of each split over which it fades into the next"),
        number("size-ratio", 1, 0.25, 4, "texels per side of the map of a split over those of the split before it")};
    return parameters;
}

void check_cascades(const TechniqueSettings& settings) {
    if (settings.cascades == 0) return;
    const ParameterValues& chosen = settings.parameters;
    if (chosen.word<Switch>("snap") == Switch::On && chosen.word<SplitPlacement>("splits") != SplitPlacement::Practical)
        fail(
            "--set snap=on: with splits={} the ends of splits move with every frame, and windows change their size; expected "
            "splits=practical",
            name_of(chosen.word<SplitPlacement>("splits")));
}

std::vector<int> map_sizes(const TechniqueSettings& settings) {
    if (settings.cascades == 0) return {settings.map_size};
    const auto ratio = static_cast<double>(settings.parameters.number("size-ratio"));
    std::vector<int> sizes;
    double size = settings.map_size;
    for (int i = 0; i < settings.cascades; ++i) {
        sizes.push_back(static_cast<int>(std::clamp(std::floor(size + 0.5), 1.0, 1.0 * kMaxTextureSize)));
        size *= ratio;
    }
    return sizes;
}

scenes::Hexahedron frustum_slice(const scenes::View& camera, double nearest, double farthest) {
    const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(camera.view_from_world));
    const glm::dmat4 clip(camera.clip_from_view);
    scenes::Hexahedron corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const double distance = (i & 4) != 0 ? farthest : nearest;
        const double x = ((i & 1) != 0 ? distance : -distance) / clip[0][0];
        const double y = ((i & 2) != 0 ? distance : -distance) / clip[1][1];
        corners[i] = glm::dvec3(world_from_view * glm::dvec4(x, y, -distance, 1.0));
    }
    return corners;
}

MapWindow bounding_window(const scenes::Hexahedron& slice, const scenes::View& light) {
    const glm::dmat4 clip_from_world(light.clip_from_world());
    const std::vector<glm::dvec3> lit = scenes::intersection(slice, scenes::frustum(clip_from_world));
    glm::dvec2 low(1.0);
    glm::dvec2 high(0.0);
    for (const glm::dvec3& point : lit) {
        const glm::dvec4 clip = clip_from_world * glm::dvec4(point, 1.0);
        const glm::dvec2 uv(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        low = glm::min(low, glm::clamp(uv, 0.0, 1.0));
        high = glm::max(high, glm::clamp(uv, 0.0, 1.0));
    }
    if (!(low.x < high.x && low.y < high.y)) return {};
    return {low, high};
}

MapWindow with_margin(const MapWindow& window, double texels, int map_size) {
    const glm::dvec2 middle = 0.5 * (window.low + window.high);
    const glm::dvec2 half = 0.5 * (window.high - window.low) / margin_share(texels, map_size);
    return {middle - half, middle + half};
}

MapWindow snapped_window(const MapWindow& window, const std::optional<glm::dvec2>& sphere_diameter, int map_size) {
    GNOMON_CHECK_LT(2, map_size);
    MapWindow snapped;
    for (int axis = 0; axis < 2; ++axis) {
        // Moving by up to a texel must not uncover the edge.
        const double quarter_octaves = std::ceil(4.0 * scalar::log2(window.high[axis] - window.low[axis]) - 1e-9);
        double side = sphere_diameter ? (*sphere_diameter)[axis] : scalar::exp2(0.25 * quarter_octaves);
        side *= map_size / (map_size - 2.0);
        if (side >= 1.0) continue;  // all of the light's projection, which does not move
        const double texel = side / map_size;
        const double middle = 0.5 * (window.low[axis] + window.high[axis]);
        snapped.low[axis] = std::floor((middle - 0.5 * side) / texel) * texel;
        snapped.high[axis] = snapped.low[axis] + side;
    }
    return snapped;
}

std::optional<glm::dvec2> sphere_diameter(const scenes::View& camera, const scenes::View& light, double nearest,
                                          double farthest) {
    if (!is_directional(light)) return std::nullopt;
    // The sphere through the corners of both ends, or around the far end where the slice is flat. Its middle is on the view
    // axis.
    const double x = 1.0 / static_cast<double>(camera.clip_from_view[0][0]);
    const double y = 1.0 / static_cast<double>(camera.clip_from_view[1][1]);
    const double spread = x * x + y * y;  // squared distance from the axis over squared distance from the eye
    const double middle = std::min(farthest, 0.5 * (nearest + farthest) * (1.0 + spread));
    const double beyond = farthest - middle;
    const double radius = std::sqrt(beyond * beyond + farthest * farthest * spread);
    const glm::dmat4 clip(light.clip_from_view);
    return radius * glm::dvec2(clip[0][0], clip[1][1]);  // clip space is 2 wide, texture space 1
}

CascadeSetup::CascadeSetup(Device& device, const TechniqueSettings& settings)
    : settings_(settings), sizes_(map_sizes(settings)), windows_(sizes_.size()) {
    const ParameterValues& chosen = settings.parameters;
    constants_.count = settings.cascades;
    constants_.cure = static_cast<int>(chosen.word<SeamCure>("cure"));
    constants_.fades = chosen.number("fade") > 0.0f ? 1 : 0;
    if (chosen.number("reach") > 0.0f) constants_.reach = chosen.number("reach");
    if (chosen.word<SplitPlacement>("splits") != SplitPlacement::Practical) depths_.emplace(device);
}

std::vector<double> CascadeSetup::distances(const FrameView& frame, PassTimer& timer) {
    const ParameterValues& chosen = settings_.parameters;
    const auto lambda = static_cast<double>(chosen.number("lambda"));
    const auto camera_near = static_cast<double>(frame.camera.znear);
    const auto camera_far = static_cast<double>(frame.camera.zfar);
    const double least = camera_near * (1.0 + kDistanceSlack);  // that splits may end at
    const double limit = std::min(std::max(static_cast<double>(constants_.reach), least), camera_far);
    const auto placement = chosen.word<SplitPlacement>("splits");
    if (placement == SplitPlacement::Practical) return practical_splits(camera_near, limit, settings_.cascades, lambda);

    DistanceHistogram seen;
    timer.pass("distances", [&] { seen = depths_->measure(frame.scene, frame.camera, frame.width, frame.height); });
    if (seen.bins.empty()) return practical_splits(camera_near, limit, settings_.cascades, lambda);
    // Of a depth near 1, whose last bits come from a few roundings, the distance is uncertain by its square over the near
    // plane.
    const double uncertain = seen.farthest * seen.farthest * (1.0 / camera_near - 1.0 / camera_far) * kDepthError;
    const double farthest = std::min(std::max(seen.farthest * (1.0 + kDistanceSlack) + uncertain, least), limit);
    const double nearest = std::max(camera_near, std::min(seen.nearest, farthest) * (1.0 - kDistanceSlack));
    if (placement == SplitPlacement::MinMax) return practical_splits(nearest, farthest, settings_.cascades, lambda);

    // What lies beyond the reach does not count.
    const double bins_per_octave = kDistanceBins / scalar::log2(camera_far / camera_near);
    for (std::size_t bin = 0; bin < seen.bins.size(); ++bin)
        if (static_cast<double>(bin) > scalar::log2(limit / camera_near) * bins_per_octave) seen.bins[bin] = 0;
    if (std::ranges::all_of(seen.bins, [](std::uint32_t pixels) { return pixels == 0; }))
        return practical_splits(camera_near, limit, settings_.cascades, lambda);
    std::vector<double> splits = histogram_splits(seen.bins, camera_near, camera_far, settings_.cascades);
    splits.front() = std::min(splits.front(), nearest);
    splits.back() = std::max(splits.back(), farthest);
    return splits;
}

double CascadeSetup::margin(std::size_t cascade, const glm::dvec2& zoom) const {
    // Half of a blur's kernel, which grows with the zoom; half of a filter of so many taps; half of the longest footprint whose
    // shorter side is a texel.
    const ParameterValues& chosen = settings_.parameters;
    const double largest = std::max(zoom.x, zoom.y) * relative_size(cascade);
    const double blur = std::min(0.5 * kMaxBlurTaps, 0.5 * (chosen.value_of("blur").value_or(1.0) - 1.0) * largest);
    const double taps = 0.5 * (chosen.value_of("taps").value_or(1.0) - 1.0);
    const double footprint = 0.5 * (settings_.anisotropy - 1);
    return kFilterMargin + blur + taps + footprint;
}

MapWindow CascadeSetup::window_of(const FrameView& frame, std::size_t cascade, double nearest, double farthest) const {
    const int map_size = sizes_[cascade];
    const MapWindow tight = bounding_window(frustum_slice(frame.camera, nearest, farthest), frame.light);
    const bool snaps = settings_.parameters.word<Switch>("snap") == Switch::On && map_size > 2;
    if (!snaps) return with_margin(tight, margin(cascade, tight.zoom()), map_size);

    // A window that keeps its size keeps its margin.
    std::optional<glm::dvec2> around = sphere_diameter(frame.camera, frame.light, nearest, farthest);
    const double texels = margin(cascade, around ? 1.0 / *around : tight.zoom());
    if (around) *around /= margin_share(texels, map_size);
    return snapped_window(with_margin(tight, texels, map_size), around, map_size);
}

void CascadeSetup::update(const FrameView& frame, PassTimer& timer) {
    const std::vector<double> splits = distances(frame, timer);
    const auto fade = static_cast<double>(settings_.parameters.number("fade"));
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
        // A fade reads the next split before it begins; quads that take one split for all their lanes reach over the ends a
        // little too, which the margin is for.
        const double before = i > 0 ? fade * (splits[i] - splits[i - 1]) : 0.0;
        windows_[i] = window_of(frame, i, splits[i] - before, splits[i + 1]);
        const glm::dvec2 zoom = windows_[i].zoom();
        constants_.end[i] = static_cast<float>(splits[i + 1]);
        constants_.fade[i] = fade > 0 ? static_cast<float>(1.0 / (fade * (splits[i + 1] - splits[i]))) : 0.0f;
        constants_.scale_u[i] = static_cast<float>(zoom.x);
        constants_.scale_v[i] = static_cast<float>(zoom.y);
        constants_.offset_u[i] = static_cast<float>(-windows_[i].low.x * zoom.x);
        constants_.offset_v[i] = static_cast<float>(-windows_[i].low.y * zoom.y);
    }
}

}  // namespace gnomon::techniques
