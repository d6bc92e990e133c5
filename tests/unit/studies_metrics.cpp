// Metrics and false colours on images small enough to do by hand.
#include "studies/false_color.h"
#include "studies/metrics.h"
#include "techniques/frame.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

scenes::ReferenceImage truth_of(std::vector<float> visibility, std::vector<float> weight) {
    const int width = static_cast<int>(visibility.size());
    return {.width = width, .height = 1, .visibility = std::move(visibility), .weight = std::move(weight)};
}
FloatImage image_of(std::vector<float> values) {
    const int width = static_cast<int>(values.size());
    return {.width = width, .height = 1, .values = std::move(values)};
}

}  // namespace

TEST_CASE("metrics of six pixels by hand", "[studies]") {
    //                              leak   right  acne   partial, no surface,             not judged
    const FloatImage machine = image_of({0.25f, 0.0f, 0.5f, 0.75f, techniques::Frame::kNoSurface, 0.0f});
    const auto truth = truth_of({0.0f, 0.0f, 1.0f, 0.5f, 1.0f, 1.0f}, {1, 1, 1, 1, 1, 0.98f});
    const Metrics metrics = measure(machine, truth);
    CHECK(metrics.pixels == 4);
    CHECK(metrics.shadowed_pixels == 2);
    CHECK(metrics.lit_pixels == 1);
    CHECK(metrics.not_finite == 0);
    CHECK(metrics.mae == Approx((0.25 + 0.0 + 0.5 + 0.25) / 4).epsilon(1e-12));
    CHECK(metrics.rmse == Approx(std::sqrt((0.0625 + 0.25 + 0.0625) / 4)).epsilon(1e-12));
    CHECK(metrics.leak == Approx(0.125).epsilon(1e-12));
    CHECK(metrics.acne == Approx(0.5).epsilon(1e-12));
    CHECK(metrics.p99 == 0.5);
}

TEST_CASE("p99 is the nearest rank", "[studies]") {
    std::vector<float> values(200, 0.0f);
    values[7] = 1.0f;
    values[100] = 0.5f;
    const auto truth = truth_of(std::vector<float>(200, 0.0f), std::vector<float>(200, 1.0f));
    CHECK(measure(image_of(values), truth).p99 == 0.0);  // rank 198 of 200
    values[150] = 0.25f;
    CHECK(measure(image_of(values), truth).p99 == 0.25);
}

TEST_CASE("what is no number counts as an error of 1, and no pixels give zeros", "[studies]") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Metrics metrics = measure(image_of({nan, 1.0f}), truth_of({0.0f, 1.0f}, {1, 1}));
    CHECK(metrics.not_finite == 1);
    CHECK(metrics.mae == 0.5);
    CHECK(metrics.leak == 1.0);
    CHECK(measure(image_of({0.5f}), truth_of({0.0f}, {0})) == Metrics{});
}

TEST_CASE("false colours: white is right, red too bright, blue too dark", "[studies]") {
    CHECK(error_color(0.0f) == kRight);
    CHECK(error_color(1.0f) == kTooBright);
    CHECK(error_color(7.0f) == kTooBright);
    CHECK(error_color(-1.0f) == kTooDark);
    CHECK(error_color(std::numeric_limits<float>::quiet_NaN()) == studies::kNotFinite);
    const Rgb quarter = error_color(0.25f);  // half the way: the square root
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(2 * quarter[c] - (kRight[c] + kTooBright[c])) <= 1);

    const ByteImage image = difference_image(image_of({0.0f, 1.0f, 0.5f}), truth_of({0.0f, 0.0f, 0.5f}, {1, 1, 0}));
    CHECK(std::equal(kRight.begin(), kRight.end(), image.values.begin()));
    CHECK(std::equal(kTooBright.begin(), kTooBright.end(), image.values.begin() + 3));
    CHECK(std::equal(kNotJudged.begin(), kNotJudged.end(), image.values.begin() + 6));
}
