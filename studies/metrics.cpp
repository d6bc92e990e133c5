#include "studies/metrics.h"

#include "sim/error.h"
#include "sim/warn.h"
#include "techniques/frame.h"

#include <algorithm>
#include <cmath>

namespace gnomon::studies {

namespace {

double mean(double sum, std::uint64_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

}  // namespace

double error_of(float visibility, float truth) {
    if (!std::isfinite(visibility)) return truth < 0.5f ? 1.0 : -1.0;
    return static_cast<double>(visibility) - static_cast<double>(truth);
}

double percentile(std::vector<double>& values, std::size_t percent) {
    if (values.empty()) return 0.0;
    const std::size_t rank = (percent * values.size() + 99) / 100;  // from 1
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::ranges::nth_element(values, at);
    return *at;
}

bool is_judged(const FloatImage& visibility, const scenes::ReferenceImage& truth, std::size_t i) {
    return visibility.values[i] != techniques::Frame::kNoSurface && truth.weight[i] > kJudgedWeight;
}

Metrics measure(const FloatImage& visibility, const scenes::ReferenceImage& truth) {
    GNOMON_CHECK_EQ(visibility.width, truth.width);
    GNOMON_CHECK_EQ(visibility.height, truth.height);
    Metrics metrics;
    std::vector<double> errors;
    double squares = 0;
    double absolute = 0;
    double leaked = 0;
    double missing = 0;
    for (std::size_t i = 0; i < visibility.values.size(); ++i) {
        if (!is_judged(visibility, truth, i)) continue;
        const double wanted = static_cast<double>(truth.visibility[i]);
        metrics.not_finite += !std::isfinite(visibility.values[i]);
        const double signed_error = error_of(visibility.values[i], truth.visibility[i]);
        const double error = std::fabs(signed_error);
        errors.push_back(error);
        squares += error * error;
        absolute += error;
        if (wanted == 0.0) {
            ++metrics.shadowed_pixels;
            leaked += signed_error;
        }
        if (wanted == 1.0) {
            ++metrics.lit_pixels;
            missing -= signed_error;
        }
    }
    metrics.pixels = errors.size();
    metrics.rmse = std::sqrt(mean(squares, metrics.pixels));
    metrics.mae = mean(absolute, metrics.pixels);
    metrics.p99 = percentile(errors, 99);
    metrics.leak = mean(leaked, metrics.shadowed_pixels);
    metrics.acne = mean(missing, metrics.lit_pixels);
    return metrics;
}

std::optional<Metrics> measure_judged(const FloatImage& visibility, const scenes::ReferenceImage& truth) {
    const Metrics metrics = measure(visibility, truth);
    if (metrics.pixels > 0) return metrics;
    warn_once("no pixel can be judged: nothing drawn faces the light inside its frustum; there are no metrics");
    return std::nullopt;
}

}  // namespace gnomon::studies
