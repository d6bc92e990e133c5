// How steady a point is, by hand: the formula, and which pixel shows a point.
#include "scenes/view.h"
#include "studies/flicker.h"
#include "techniques/frame.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

constexpr int kWidth = 16;
constexpr int kHeight = 8;
constexpr std::size_t kPixels = kWidth * kHeight;

/// From the origin along -z.
scenes::View camera() { return scenes::camera_view({.yfov_rad = 1.0f, .znear = 0.5f, .zfar = 100.0f}, 2.0f); }

/// Through the centre of a pixel, 1 deep.
glm::dvec3 ray(const scenes::View& view, double x, double y) {
    const glm::dmat4 projection(view.clip_from_view);
    return {(2 * (x + 0.5) / kWidth - 1) / projection[0][0], (1 - 2 * (y + 0.5) / kHeight) / projection[1][1], -1.0};
}

/// What the machine leaves of the plane through `point`.
FloatImage depth_of(const scenes::View& view, const scenes::SurfacePoint& point) {
    const glm::dmat4 projection(view.clip_from_view);
    FloatImage depth{kWidth, kHeight, std::vector<float>(kPixels, 1.0f)};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double distance = glm::dot(point.position_ws, point.normal_ws) / glm::dot(ray(view, x, y), point.normal_ws);
            const double z = projection[3][2] / distance - projection[2][2];
            if (distance > 0 && z < 1) depth.values[static_cast<std::size_t>(y * kWidth + x)] = static_cast<float>(z);
        }
    return depth;
}

scenes::SurfacePoint facing(const scenes::View& view, double x, double y, double distance) {
    return {ray(view, x, y) * distance, {0, 0, 1}};
}

}  // namespace

TEST_CASE("a running deviation is the root of the mean squared difference from the mean", "[studies]") {
    RunningDeviation none;
    CHECK(none.deviation() == 0.0);
    RunningDeviation two;
    two.add(0.25);
    CHECK(two.deviation() == 0.0);
    two.add(0.75);
    CHECK(two.deviation() == 0.25);
    RunningDeviation four;
    for (const double value : {1.0, 2.0, 3.0, 4.0}) four.add(value);
    CHECK(four.count() == 4);
    CHECK(four.deviation() == Approx(std::sqrt(1.25)).epsilon(1e-14));
    RunningDeviation same;  // a tenth is no binary number: sums of it round
    for (int i = 0; i < 7; ++i) same.add(0.1);
    CHECK(same.deviation() == 0.0);
}

TEST_CASE("points lie on a grid of eight pixels", "[studies]") {
    const std::vector<glm::ivec2> pixels = grid_pixels(21, 13);
    CHECK(pixels == std::vector<glm::ivec2>{{4, 4}, {12, 4}, {20, 4}, {4, 12}, {12, 12}, {20, 12}});
    CHECK(grid_pixels(4, 100).empty());
}

TEST_CASE("a pixel shows a point where its depth lies in the plane of the point", "[studies]") {
    const scenes::View view = camera();
    const scenes::SurfacePoint point = facing(view, 5.3, 2.1, 10);
    const FloatImage wall = depth_of(view, point);
    CHECK(pixel_showing(point, view, wall) == 2u * kWidth + 5u);

    // A pixel spans 2 tan(0.5) 10 / 8 = 1.3658 m there, an eighth of it 0.1707 m.
    for (const double off : {0.16, -0.16})
        CHECK(pixel_showing({point.position_ws + glm::dvec3(0, 0, off), {0, 0, 1}}, view, wall));
    for (const double off : {0.19, -0.19})
        CHECK(!pixel_showing({point.position_ws + glm::dvec3(0, 0, off), {0, 0, 1}}, view, wall));

    // A slanted surface: the pixel's centre is 0.3 pixels off, and meets it a metre or more from where the point is.
    const scenes::SurfacePoint slanted{point.position_ws, glm::normalize(glm::dvec3(1, 0, 0.35))};
    const FloatImage slope = depth_of(view, slanted);
    const glm::dmat4 projection(view.clip_from_view);
    const double met = projection[3][2] / (static_cast<double>(slope.values[2 * kWidth + 5]) + projection[2][2]);
    CHECK(std::fabs(met - 10) > 0.5);
    CHECK(pixel_showing(slanted, view, slope) == 2u * kWidth + 5u);
    CHECK(!pixel_showing(slanted, view, wall));

    // Behind another surface, on nothing, outside of the image, behind the camera, past the far plane.
    CHECK(!pixel_showing(point, view, depth_of(view, facing(view, 0, 0, 9))));
    CHECK(!pixel_showing(point, view, {kWidth, kHeight, std::vector<float>(kPixels, 1.0f)}));
    for (const auto& [x, y] : {std::pair{-0.6, 2.0}, std::pair{15.6, 2.0}, std::pair{5.0, -0.6}, std::pair{5.0, 7.6}})
        CHECK(!pixel_showing(facing(view, x, y, 10), view, wall));
    CHECK(pixel_showing(facing(view, -0.4, -0.4, 10), view, wall) == 0u);
    CHECK(!pixel_showing({-point.position_ws, {0, 0, 1}}, view, wall));
    CHECK(!pixel_showing(facing(view, 5, 2, 101), view, wall));
}

TEST_CASE("flicker of four points over four frames by hand", "[studies]") {
    const scenes::View view = camera();
    const std::vector<scenes::SurfacePoint> points{facing(view, 1, 1, 10), facing(view, 2, 1, 10), facing(view, 3, 1, 10),
                                                   facing(view, 4, 1, 10)};
    const FloatImage depth = depth_of(view, points[0]);
    constexpr float kNone = techniques::Frame::kNoSurface;
    // Frames across, points down. The third point is not judged in the second frame, the last one in two of the frames.
    const std::array<std::array<float, 4>, 4> seen{
        {{0.0f, 0.5f, 1.0f, 1.0f}, {0.25f, 0.25f, 0.25f, 0.25f}, {1.0f, kNone, 0.5f, 0.0f}, {1.0f, kNone, kNone, 0.0f}}};
    const std::array<std::array<float, 4>, 4> truths{{{0, 0, 1, 1}, {0, 0, 0, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}}};
    FlickerMeter meter(points);
    for (std::size_t t = 0; t < 4; ++t) {
        FloatImage visibility{kWidth, kHeight, std::vector<float>(kPixels, 1.0f)};
        scenes::ReferenceImage truth{kWidth, kHeight, std::vector<float>(kPixels, 1.0f), std::vector<float>(kPixels, 1.0f)};
        for (std::size_t p = 0; p < 4; ++p) {
            visibility.values[kWidth + 1 + p] = seen[p][t];
            truth.visibility[kWidth + 1 + p] = truths[p][t];
        }
        meter.add({view, depth, visibility, truth});
        if (t < 2) CHECK(meter.result().points == 0);
    }
    const Flicker flicker = meter.result();
    CHECK(flicker.points == 3);
    CHECK(flicker.pairs == 3 + 3 + 1);

    // First point: visibility 0, .5, 1, 1; truth 0, 0, 1, 1; error 0, .5, 0, 0. Third: 1, .5, 0; 1, 1, 0; 0, -.5, 0.
    const double v1 = std::sqrt((0.625 * 0.625 + 0.125 * 0.125 + 2 * 0.375 * 0.375) / 4);
    const double v3 = std::sqrt(0.5 / 3);
    const double e1 = std::sqrt((0.375 * 0.375 + 3 * 0.125 * 0.125) / 4);
    const double e3 = std::sqrt(1.0 / 18);
    CHECK(flicker.visibility.mean == Approx((v1 + 0 + v3) / 3).epsilon(1e-14));
    CHECK(flicker.visibility.worst == Approx(std::max(v1, v3)).epsilon(1e-14));
    CHECK(flicker.visibility.p95 == flicker.visibility.worst);
    CHECK(flicker.truth.mean == Approx((0.5 + 0 + std::sqrt(2.0 / 9)) / 3).epsilon(1e-14));
    CHECK(flicker.truth.worst == 0.5);
    CHECK(flicker.error.mean == Approx((e1 + 0 + e3) / 3).epsilon(1e-14));

    // From frame to frame: .5 + .5 + 0, nothing, and .5 between the last two frames of the third point.
    CHECK(flicker.visibility.change == Approx(1.5 / 7).epsilon(1e-14));
    CHECK(flicker.truth.change == Approx(2.0 / 7).epsilon(1e-14));
    CHECK(flicker.error.change == Approx(1.5 / 7).epsilon(1e-14));
}

TEST_CASE("flicker: percentiles are nearest ranks over the points", "[studies]") {
    const scenes::View view = camera();
    std::vector<scenes::SurfacePoint> points;
    for (int i = 0; i < 100; ++i) points.push_back(facing(view, i % kWidth, i / kWidth, 10));
    const FloatImage depth = depth_of(view, points[0]);
    FlickerMeter meter(points);
    for (int t = 0; t < 4; ++t) {
        // Point i swings by i / 256 about the middle.
        FloatImage visibility{kWidth, kHeight, std::vector<float>(kPixels, 0.5f)};
        for (int i = 0; i < 100; ++i)
            visibility.values[static_cast<std::size_t>(i)] =
                0.5f + (t % 2 == 0 ? 1.0f : -1.0f) * static_cast<float>(i) / 256.0f;
        const scenes::ReferenceImage truth{kWidth, kHeight, std::vector<float>(kPixels, 0.0f),
                                           std::vector<float>(kPixels, 1.0f)};
        meter.add({view, depth, visibility, truth});
    }
    const Flicker flicker = meter.result();
    CHECK(flicker.points == 100);
    CHECK(flicker.error.p95 == Approx(94.0 / 256).epsilon(1e-14));
    CHECK(flicker.error.p99 == Approx(98.0 / 256).epsilon(1e-14));
    CHECK(flicker.error.worst == Approx(99.0 / 256).epsilon(1e-14));
    CHECK(flicker.error.change == Approx(2 * 49.5 / 256).epsilon(1e-14));
    CHECK(flicker.visibility == flicker.error);
    CHECK(flicker.truth == Unsteadiness{});
}
