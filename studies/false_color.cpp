#include "studies/false_color.h"

#include "sim/error.h"
#include "studies/metrics.h"
#include "techniques/frame.h"

#include <algorithm>
#include <cmath>

namespace gnomon::studies {

Rgb error_color(float error) {
    if (!std::isfinite(error)) return kNotFinite;
    const Rgb& end = error > 0.0f ? kTooBright : kTooDark;
    const float amount = std::sqrt(std::min(std::fabs(error), 1.0f));
    Rgb color{};
    for (std::size_t i = 0; i < color.size(); ++i) {
        const auto from = static_cast<float>(kRight[i]);
        color[i] = static_cast<std::uint8_t>(from + (static_cast<float>(end[i]) - from) * amount + 0.5f);
    }
    return color;
}

ByteImage derivative_image(std::span<const std::uint32_t> causes, const FloatImage& visibility) {
    GNOMON_CHECK_EQ(causes.size(), visibility.values.size());
    ByteImage image{.width = visibility.width, .height = visibility.height, .channels = 3, .values = {}};
    image.values.reserve(3 * causes.size());
    for (std::size_t i = 0; i < causes.size(); ++i) {
        const bool drawn = visibility.values[i] != techniques::Frame::kNoSurface;
        const Rgb& color = drawn ? kDerivativeColors[causes[i] & 7u] : kNotJudged;
        image.values.insert(image.values.end(), color.begin(), color.end());
    }
    return image;
}

ByteImage difference_image(const FloatImage& visibility, const scenes::ReferenceImage& truth) {
    ByteImage image{.width = visibility.width, .height = visibility.height, .channels = 3, .values = {}};
    image.values.reserve(3 * visibility.values.size());
    for (std::size_t i = 0; i < visibility.values.size(); ++i) {
        const bool judged = is_judged(visibility, truth, i);
        const Rgb color = judged ? error_color(visibility.values[i] - truth.visibility[i]) : kNotJudged;
        image.values.insert(image.values.end(), color.begin(), color.end());
    }
    return image;
}

}  // namespace gnomon::studies
