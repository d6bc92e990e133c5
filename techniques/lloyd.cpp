// Lloyd's relaxation: clusters measured on the device, splits moved on the host. [Lauritzen08] 4.1.2, 4.1.3
#include "techniques/lloyd.h"

#include "pipeline/program.h"

#include <algorithm>
#include <cstring>

namespace gnomon::techniques {

namespace {

/// Second occluder and weight of the 2x2 texels around a corner, if they belong to one of two clusters. [Lauritzen08] 4.1.3
struct GatherClusters {
    TextureId moments = TextureId::None;
    Sampler sampler{};
    int count = 1;                                // splits
    std::array<float, kMaxDepthLayers> splits{};  // ascending
    int first = 0;
    int second = 0;
    float least_weight = 0.0f;
    float most_weight = 1.0f;

    static constexpr auto fields() {
        using G = GatherClusters;
        return std::tuple{Field{"moments", &G::moments},
                          Field{"sampler", &G::sampler},
                          Field{"count", &G::count},
                          Field{"splits", &G::splits},
                          Field{"first", &G::first},
                          Field{"second", &G::second},
                          Field{"least_weight", &G::least_weight},
                          Field{"most_weight", &G::most_weight}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const glm::ivec2 size = f.size(moments);
        // Half a pixel on lies the corner that four texels share: a bilinear sample is their mean.
        const Vec2<Real> corner{(f.position.x + Real(0.5f)) * Real(1.0f / static_cast<float>(size.x)),
                                (f.position.y + Real(0.5f)) * Real(1.0f / static_cast<float>(size.y))};
        const Vec4<Real> texel = f.sample(moments, sampler, corner);
        const Moments<Real> m{texel.x, texel.y};
        const Real depth = second_occluder(m);
        const Real sigma2 = variance(m);
        const Real weight = select(sigma2 < Real(least_weight), Real(0.0f), min(sigma2, Real(most_weight)));

        // The nearest split; of two as near the first.
        Real nearest(0.0f);
        Real distance = abs(depth - Real(splits[0]));
        for (int i = 1; i < count; ++i) {
            const Real next = abs(depth - Real(splits[static_cast<std::size_t>(i)]));
            nearest = select(next < distance, Real(static_cast<float>(i)), nearest);
            distance = min(distance, next);
        }
        const auto share = [&](int split) { return select(nearest == Real(static_cast<float>(split)), weight, Real(0.0f)); };
        const Real a = share(first);
        const Real b = share(second);
        return Vec4<Real>{a * depth, a, b * depth, b};
    }
};

}  // namespace

SplitRelaxation::SplitRelaxation(int count, bool teleports) : SplitRelaxation(uniform_splits(count + 1), teleports) {}

SplitRelaxation::SplitRelaxation(std::vector<double> splits, bool teleports)
    : splits_(std::move(splits)), weights_(splits_.size()), teleports_(teleports) {}

void SplitRelaxation::update(int split, const ClusterMean& mean) {
    const auto i = static_cast<std::size_t>(split);
    weights_[i] = mean.weight;
    if (mean.weight > 0) {
        splits_[i] = std::clamp(mean.weighted_depth / mean.weight, 0.0, 1.0);
        // Results that come late can overtake a neighbour.
        if (!std::ranges::is_sorted(splits_)) {
            std::ranges::sort(splits_);
            std::ranges::fill(weights_, std::nullopt);
            ++generation_;
        }
        return;
    }
    const bool all_known = std::ranges::all_of(weights_, [](const auto& weight) { return weight.has_value(); });
    if (teleports_ && all_known) teleport(i);
}

void SplitRelaxation::teleport(std::size_t empty) {
    const auto heaviest = static_cast<std::size_t>(std::ranges::max_element(weights_) - weights_.begin());
    if (!(*weights_[heaviest] > 0)) return;  // nothing anywhere

    // The bounds of the heaviest cluster lie halfway to its neighbours; put two splits at a third and two thirds of it.
    const double low = heaviest == 0 ? 0.0 : 0.5 * (splits_[heaviest - 1] + splits_[heaviest]);
    const double high = heaviest + 1 == splits_.size() ? 1.0 : 0.5 * (splits_[heaviest] + splits_[heaviest + 1]);
    splits_[heaviest] = low + (high - low) / 3;
    splits_[empty] = low + 2 * (high - low) / 3;
    std::ranges::sort(splits_);
    std::ranges::fill(weights_, std::nullopt);
    ++generation_;
    ++teleportations_;
}

LloydPasses::LloydPasses(Device& device, TextureId moments, const LloydOptions& options)
    : device_(device), moments_(moments), options_(options), full_screen_(device) {
    const Texture& texture = device.texture(moments);
    const int width = texture.width(0);
    const int height = texture.height(0);
    clusters_ = device.create_texture(
        "clusters",
        {.format = Format::Rgba32Float, .width = width, .height = height, .levels = full_level_count(width, height)});
}

std::array<ClusterMean, 2> LloydPasses::measure(std::span<const double> splits, int first, int second) const {
    static const Program program = make_program<FullScreenVertex, GatherClusters>("lloyd.gather");
    GatherClusters pixel{.moments = moments_,
                         .count = static_cast<int>(splits.size()),
                         .first = first,
                         .second = second,
                         .least_weight = options_.least_weight,
                         .most_weight = options_.most_weight};
    for (std::size_t i = 0; i < splits.size(); ++i) pixel.splits[i] = static_cast<float>(splits[i]);
    const std::array<TargetView, 1> target{clusters_};
    full_screen_.run("gather clusters", program, pixel, target);
    device_.execute(GenerateMips{clusters_});

    const Texture& pyramid = device_.texture(clusters_);
    const std::vector<std::byte> bytes = pyramid.level_bytes(pyramid.desc().levels - 1);
    std::array<float, 4> mean{};
    std::memcpy(mean.data(), bytes.data(), sizeof(mean));
    const auto cluster = [&](std::size_t i) {
        return ClusterMean{static_cast<double>(mean[i]), static_cast<double>(mean[i + 1])};
    };
    return {cluster(0), cluster(2)};
}

void LloydPasses::relax_frame(SplitRelaxation& splits, int frame) {
    deliver(splits, frame);

    // Two splits per pass, in turns.
    const int count = static_cast<int>(splits.splits().size());
    const int pairs = (count + 1) / 2;
    const int begin = options_.updates_all ? 0 : frame % pairs;
    const int end = options_.updates_all ? pairs : begin + 1;
    const int generation = splits.generation();
    const std::vector<double> measured(splits.splits().begin(), splits.splits().end());
    for (int pair = begin; pair < end; ++pair) {
        const int first = 2 * pair;
        const int second = std::min(first + 1, count - 1);
        const auto means = measure(measured, first, second);
        pending_.push_back({frame + options_.latency, generation, first, means[0]});
        if (second != first) pending_.push_back({frame + options_.latency, generation, second, means[1]});
    }
    if (options_.latency == 0) deliver(splits, frame);
}

void LloydPasses::deliver(SplitRelaxation& splits, int frame) {
    while (!pending_.empty() && pending_.front().due <= frame) {
        const Pending result = pending_.front();
        pending_.pop_front();
        if (result.generation == splits.generation()) splits.update(result.split, result.mean);
    }
}

std::vector<double> LloydPasses::relax(int layers) {
    if (layers < 2) return {};
    SplitRelaxation splits(layers - 1, options_.teleports);
    pending_.clear();
    for (int frame = 0; frame < options_.frames; ++frame) relax_frame(splits, frame);
    return {splits.splits().begin(), splits.splits().end()};
}

}  // namespace gnomon::techniques
