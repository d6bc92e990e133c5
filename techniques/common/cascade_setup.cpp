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

/// Texels around a window that filters may reach into beside the blur's: a bilinear neighbour and anisotropy's probes at a
/// pixel's size, which is about a texel where a split is chosen well.
constexpr double kFilterMargin = 2.0;

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
    // The window takes what the margins leave of the map, and at least half of it.
    const double share = std::max(0.5, 1.0 - 2.0 * texels / map_size);
    const glm::dvec2 middle = 0.5 * (window.low + window.high);
    const glm::dvec2 half = 0.5 * (window.high - window.low) / share;
    return {middle - half, middle + half};
}

MapWindow snapped_window(const MapWindow& window, double sphere_diameter, int map_size) {
    GNOMON_CHECK_LT(2, map_size);
    MapWindow snapped;
    for (int axis = 0; axis < 2; ++axis) {
        // Moving by up to a texel must not uncover the edge.
        double side = sphere_diameter;
        if (side == 0.0) {
            const double quarter_octaves = 4.0 * scalar::log2(window.high[axis] - window.low[axis]);
            side = scalar::exp2(0.25 * std::ceil(quarter_octaves - 1e-9));
        }
        side *= map_size / (map_size - 2.0);
        if (side >= 1.0) continue;  // all of the light's projection, which does not move
        const double texel = side / map_size;
        const double middle = 0.5 * (window.low[axis] + window.high[axis]);
        snapped.low[axis] = std::floor((middle - 0.5 * side) / texel) * texel;
        snapped.high[axis] = snapped.low[axis] + side;
    }
    return snapped;
}

double sphere_diameter(const scenes::View& camera, const scenes::View& light, double nearest, double farthest) {
    if (!is_directional(light)) return 0.0;
    // The sphere through the corners of both ends, or around the far end where the slice is flat. Its middle is on the view
    // axis.
    const double x = 1.0 / static_cast<double>(camera.clip_from_view[0][0]);
    const double y = 1.0 / static_cast<double>(camera.clip_from_view[1][1]);
    const double spread = x * x + y * y;  // squared distance from the axis over squared distance from the eye
    const double middle = std::min(farthest, 0.5 * (nearest + farthest) * (1.0 + spread));
    const double beyond = farthest - middle;
    const double radius = std::sqrt(beyond * beyond + farthest * farthest * spread);
    const double scale =
        std::max(static_cast<double>(light.clip_from_view[0][0]), static_cast<double>(light.clip_from_view[1][1]));
    return radius * scale;  // clip space is 2 wide, texture space 1
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
    const double limit = std::clamp(static_cast<double>(constants_.reach), camera_near * (1.0 + kDistanceSlack), camera_far);
    const auto placement = chosen.word<SplitPlacement>("splits");
    if (placement == SplitPlacement::Practical) return practical_splits(camera_near, limit, settings_.cascades, lambda);

    DistanceHistogram seen;
    timer.pass("distances", [&] { seen = depths_->measure(frame.scene, frame.camera, frame.width, frame.height); });
    if (seen.bins.empty()) return practical_splits(camera_near, limit, settings_.cascades, lambda);
    const double nearest = std::max(seen.nearest * (1.0 - kDistanceSlack), camera_near);
    const double farthest = std::clamp(seen.farthest * (1.0 + kDistanceSlack), nearest * (1.0 + kDistanceSlack), limit);
    if (placement == SplitPlacement::MinMax || nearest >= farthest)
        return practical_splits(std::min(nearest, farthest / (1.0 + kDistanceSlack)), farthest, settings_.cascades, lambda);
    std::vector<double> splits = histogram_splits(seen.bins, camera_near, camera_far, settings_.cascades);
    splits.front() = std::min(splits.front(), nearest);
    splits.back() = std::max(splits.back(), farthest);
    return splits;
}

MapWindow CascadeSetup::window_of(const FrameView& frame, double nearest, double farthest, int map_size) const {
    const MapWindow tight = bounding_window(frustum_slice(frame.camera, nearest, farthest), frame.light);

    // The kernel of the blur grows with the zoom.
    double margin = kFilterMargin;
    for (const auto& [parameter, value, is_set] : settings_.parameters.entries())
        if (parameter.name == "blur") {
            const glm::dvec2 zoom = tight.zoom();
            margin += std::min(0.5 * kMaxBlurTaps, 0.5 * (value - 1.0) * std::max(zoom.x, zoom.y));
        }
    const MapWindow window = with_margin(tight, margin, map_size);
    const bool snaps = settings_.parameters.word<Switch>("snap") == Switch::On && map_size > 2;
    if (!snaps) return window;
    const double around = sphere_diameter(frame.camera, frame.light, nearest, farthest);
    const double share = std::max(0.5, 1.0 - 2.0 * margin / map_size);
    return snapped_window(window, around / share, map_size);
}

void CascadeSetup::update(const FrameView& frame, PassTimer& timer) {
    const std::vector<double> splits = distances(frame, timer);
    const auto fade = static_cast<double>(settings_.parameters.number("fade"));
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
        // A fade reads the next split before it begins; quads that take one split for all their lanes reach over the ends a
        // little too, which the margin is for.
        const double before = i > 0 ? fade * (splits[i] - splits[i - 1]) : 0.0;
        windows_[i] = window_of(frame, splits[i] - before, splits[i + 1], sizes_[i]);
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
