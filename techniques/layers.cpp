// Where layers begin and end. [Lauritzen08] 4.1.1, 4.1.2
#include "techniques/layers.h"

#include "sim/error.h"

#include <algorithm>

namespace gnomon::techniques {

namespace {

/// A layer between splits that fell together still has a width: no division by nothing.
constexpr double kThinnest = 1.0 / (1 << 16);

}  // namespace

DepthLayers make_layers(std::span<const double> inner_splits, double overlap) {
    GNOMON_CHECK_LT(inner_splits.size(), std::size_t{kMaxDepthLayers});
    GNOMON_CHECK(std::ranges::is_sorted(inner_splits));
    DepthLayers layers{.count = static_cast<int>(inner_splits.size()) + 1};
    const auto count = static_cast<std::size_t>(layers.count);
    for (std::size_t i = 1; i < count; ++i) layers.splits[i] = static_cast<float>(inner_splits[i - 1]);
    for (std::size_t i = count; i <= std::size_t{kMaxDepthLayers}; ++i) layers.splits[i] = 1.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const double p = i == 0 ? 0.0 : inner_splits[i - 1] - overlap;
        const double q = i + 1 == count ? 1.0 : inner_splits[i] + overlap;
        layers.begin[i] = static_cast<float>(p);
        layers.inverse[i] = static_cast<float>(1.0 / std::max(q - p, kThinnest));
        if (i == 0) continue;
        const double before = i == 1 ? 2 * overlap : inner_splits[i - 1] - inner_splits[i - 2];
        const double behind = i + 1 == count ? 2 * overlap : inner_splits[i] - inner_splits[i - 1];
        const double half_width = std::min({overlap, 0.5 * before, 0.5 * behind});
        layers.fade[i] = static_cast<float>(0.5 / std::max(half_width, kThinnest));
    }
    return layers;
}

std::vector<double> uniform_splits(int count) {
    std::vector<double> splits;
    for (int i = 1; i < count; ++i) splits.push_back(static_cast<double>(i) / count);
    return splits;
}

}  // namespace gnomon::techniques
