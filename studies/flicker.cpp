// Following points through frames, and what their errors come to.
#include "studies/flicker.h"

#include "sim/error.h"
#include "studies/metrics.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::studies {

namespace {

constexpr double kOffPlane = 1.0 / 8;  // pixels

/// Of the depths near 1, whose steps are 2^-24; vertices and planes of z round a few times more.
constexpr double kDepthStep = 0x1p-22;

Unsteadiness summary(std::vector<double>& deviations, double changes, std::uint64_t pairs) {
    Unsteadiness result;
    double sum = 0;
    for (const double deviation : deviations) {
        sum += deviation;
        result.worst = std::max(result.worst, deviation);
    }
    if (!deviations.empty()) result.mean = sum / static_cast<double>(deviations.size());
    result.p95 = percentile(deviations, 95);
    result.p99 = percentile(deviations, 99);
    if (pairs > 0) result.change = changes / static_cast<double>(pairs);
    return result;
}

}  // namespace

void RunningDeviation::add(double value) {
    ++count_;
    const double off = value - mean_;
    mean_ = count_ == 1 ? value : mean_ + off / count_;
    squares_ += off * (value - mean_);
}

double RunningDeviation::deviation() const { return count_ == 0 ? 0.0 : std::sqrt(std::max(squares_, 0.0) / count_); }

std::optional<std::size_t> pixel_showing(const scenes::SurfacePoint& point, const scenes::View& camera,
                                         const FloatImage& depth) {
    // Project the point; pixels count from the top left.
    const glm::dmat4 projection(camera.clip_from_view);
    const glm::dvec4 point_view = glm::dmat4(camera.view_from_world) * glm::dvec4(point.position_ws, 1.0);
    const double distance = -point_view.z;
    if (!(distance >= static_cast<double>(camera.znear) && distance <= static_cast<double>(camera.zfar))) return std::nullopt;
    const double x_px = (0.5 + 0.5 * projection[0][0] * point_view.x / distance) * depth.width;
    const double y_px = (0.5 - 0.5 * projection[1][1] * point_view.y / distance) * depth.height;
    if (!(x_px >= 0 && x_px < depth.width && y_px >= 0 && y_px < depth.height)) return std::nullopt;
    const double x = std::floor(x_px);
    const double y = std::floor(y_px);
    const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.width) + static_cast<std::size_t>(x);

    // Where the pixel's centre meets what was drawn: z/w is projection[3][2] / distance - projection[2][2].
    const auto z = static_cast<double>(depth.values[pixel]);
    if (!(z < 1.0)) return std::nullopt;
    const double drawn = projection[3][2] / (z + projection[2][2]);
    const glm::dvec3 drawn_view((2 * (x + 0.5) / depth.width - 1) / projection[0][0] * drawn,
                                (1 - 2 * (y + 0.5) / depth.height) / projection[1][1] * drawn, -drawn);

    // How far from the plane that may be.
    const double pixel_m = 2 * distance / (projection[1][1] * depth.height);
    const double step_m = distance * distance / std::fabs(projection[3][2]) * kDepthStep;
    const glm::dvec3 normal_view = glm::dmat3(glm::dmat4(camera.view_from_world)) * point.normal_ws;
    const double off_m = std::fabs(glm::dot(drawn_view - glm::dvec3(point_view), normal_view));
    if (!(off_m <= kOffPlane * pixel_m + step_m)) return std::nullopt;
    return pixel;
}

std::vector<glm::ivec2> grid_pixels(int width, int height) {
    std::vector<glm::ivec2> pixels;
    for (int y = kPointSpacing / 2; y < height; y += kPointSpacing)
        for (int x = kPointSpacing / 2; x < width; x += kPointSpacing) pixels.emplace_back(x, y);
    return pixels;
}

FlickerMeter::FlickerMeter(const std::vector<scenes::SurfacePoint>& points) {
    tracks_.reserve(points.size());
    for (const scenes::SurfacePoint& point : points) tracks_.push_back({.point = point});
}

void FlickerMeter::add(const FrameImages& frame) {
    GNOMON_CHECK_EQ(frame.depth.values.size(), frame.visibility.values.size());
    GNOMON_CHECK_EQ(frame.depth.values.size(), frame.truth.visibility.size());
    for (Track& track : tracks_) {
        const auto pixel = pixel_showing(track.point, frame.camera, frame.depth);
        if (!pixel || !is_judged(frame.visibility, frame.truth, *pixel)) continue;
        const auto truth = static_cast<double>(frame.truth.visibility[*pixel]);
        const double error = error_of(frame.visibility.values[*pixel], frame.truth.visibility[*pixel]);
        const std::array<double, kQuantities> now{truth + error, truth, error};
        const bool follows = track.last_frame && *track.last_frame + 1 == frames_;
        pairs_ += follows;
        for (std::size_t i = 0; i < kQuantities; ++i) {
            if (follows) changes_[i] += std::fabs(now[i] - track.last[i]);
            track.over_frames[i].add(now[i]);
        }
        track.last = now;
        track.last_frame = frames_;
    }
    ++frames_;
}

Flicker FlickerMeter::result() const {
    std::array<std::vector<double>, kQuantities> deviations;
    for (const Track& track : tracks_) {
        if (track.over_frames[0].count() < kLeastFrames) continue;
        for (std::size_t i = 0; i < kQuantities; ++i) deviations[i].push_back(track.over_frames[i].deviation());
    }
    return {.points = deviations[0].size(),
            .pairs = pairs_,
            .visibility = summary(deviations[0], changes_[0], pairs_),
            .truth = summary(deviations[1], changes_[1], pairs_),
            .error = summary(deviations[2], changes_[2], pairs_)};
}

}  // namespace gnomon::studies
