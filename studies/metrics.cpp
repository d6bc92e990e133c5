#include "studies/metrics.h"

#include "sim/error.h"
#include "techniques/frame.h"

#include <algorithm>
#include <cmath>

namespace gnomon::studies {

namespace {

double mean(double sum, std::uint64_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

/// The smallest value that at least 99 % of them do not exceed.
double percentile_99(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const std::size_t rank = (99 * values.size() + 99) / 100;  // from 1
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::ranges::nth_element(values, at);
    return *at;
}

}  // namespace

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
        double got = static_cast<double>(visibility.values[i]);
        if (!std::isfinite(got)) {
            ++metrics.not_finite;
            got = wanted < 0.5 ? wanted + 1.0 : wanted - 1.0;
        }
        const double error = std::fabs(got - wanted);
        errors.push_back(error);
        squares += error * error;
        absolute += error;
        if (wanted == 0.0) {
            ++metrics.shadowed_pixels;
            leaked += got;
        }
        if (wanted == 1.0) {
            ++metrics.lit_pixels;
            missing += 1.0 - got;
        }
    }
    metrics.pixels = errors.size();
    metrics.rmse = std::sqrt(mean(squares, metrics.pixels));
    metrics.mae = mean(absolute, metrics.pixels);
    metrics.p99 = percentile_99(errors);
    metrics.leak = mean(leaked, metrics.shadowed_pixels);
    metrics.acne = mean(missing, metrics.lit_pixels);
    return metrics;
}

}  // namespace gnomon::studies
