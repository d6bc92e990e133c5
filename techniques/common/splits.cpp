// Split distances in closed form and from a histogram. [Zhang06], [Lauritzen10]
#include "techniques/common/splits.h"

#include "sim/error.h"
#include "sim/scalar_math.h"

#include <algorithm>
#include <numeric>

namespace gnomon::techniques {

namespace {

/// Distances of one partition are at least this much farther than those before them, so that no part is empty.
constexpr double kLeastGrowth = 1.0 + 1e-4;

}  // namespace

std::vector<double> practical_splits(double nearest, double farthest, int count, double lambda) {
    GNOMON_CHECK_LT(0.0, nearest);
    GNOMON_CHECK_LT(nearest, farthest);
    GNOMON_CHECK_LE(1, count);
    std::vector<double> distances(static_cast<std::size_t>(count) + 1, nearest);
    for (int i = 1; i < count; ++i) {
        const double share = static_cast<double>(i) / count;
        const double logarithmic = nearest * scalar::pow(farthest / nearest, share);
        const double uniform = nearest + (farthest - nearest) * share;
        distances[static_cast<std::size_t>(i)] = lambda * logarithmic + (1.0 - lambda) * uniform;
    }
    distances.back() = farthest;
    return distances;
}

std::vector<double> histogram_splits(std::span<const std::uint32_t> bins, double nearest, double farthest, int count) {
    GNOMON_CHECK_LT(0.0, nearest);
    GNOMON_CHECK_LT(nearest, farthest);
    GNOMON_CHECK_LE(1, count);
    const auto is_filled = [](std::uint32_t pixels) { return pixels > 0; };
    const auto first = std::ranges::find_if(bins, is_filled);
    if (first == bins.end()) return practical_splits(nearest, farthest, count, 1.0);
    const auto last = std::find_if(bins.rbegin(), bins.rend(), is_filled).base();
    const auto distance_at = [&](double bin) {
        return nearest * scalar::pow(farthest / nearest, bin / static_cast<double>(bins.size()));
    };

    const double total = std::accumulate(bins.begin(), bins.end(), 0.0);
    std::vector<double> distances{distance_at(static_cast<double>(first - bins.begin()))};
    auto bin = first;
    double before = 0;  // pixels in the bins before this one
    for (int i = 1; i < count; ++i) {
        const double wanted = total * i / count;
        while (before + *bin < wanted) before += *bin++;
        const double share = (wanted - before) / *bin;
        distances.push_back(distance_at(static_cast<double>(bin - bins.begin()) + share));
    }
    distances.push_back(distance_at(static_cast<double>(last - bins.begin())));
    for (std::size_t i = 1; i < distances.size(); ++i) distances[i] = std::max(distances[i], distances[i - 1] * kLeastGrowth);
    return distances;
}

}  // namespace gnomon::techniques
