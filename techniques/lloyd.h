// Where to split depth into layers: weighted k-means over second occluders by Lloyd's relaxation. [Lauritzen08] 4.1.2, 4.1.3
#pragma once

#include "techniques/common/full_screen.h"
#include "techniques/layers.h"

#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::techniques {

/// Depth of the second of two occluders from the moments of a filter that both cover: mu + sigma, exact where each covers half.
/// [Lauritzen08] 4.1.2
template <class Real>
Real second_occluder(const Moments<Real>& m) {
    return mean(m) + sqrt(max(variance(m), Real(0.0f)));
}

struct LloydOptions {
    int frames = 60;           // of relaxation, starting from uniform splits
    bool updates_all = false;  // every split each frame, else two in turns
    int latency = 0;           // frames until a result is read back, 0 or more
    bool teleports = true;
    float least_weight = 0.0f;  // a smaller variance weighs nothing
    float most_weight = 1.0f;   // a larger one weighs no more than this
};

/// What a pass says of one split: averages over the map.
struct ClusterMean {
    double weighted_depth = 0;  // of weight times second occluder
    double weight = 0;
};

/// The splits under relaxation, on the host. Nothing in here knows where the means come from.
class SplitRelaxation {
public:
    /// `count` >= 1 splits, uniform in (0, 1).
    SplitRelaxation(int count, bool teleports);
    /// From splits of one's own, ascending in [0, 1].
    SplitRelaxation(std::vector<double> splits, bool teleports);

    [[nodiscard]] std::span<const double> splits() const { return splits_; }
    /// Changes where a split is another one than before: what was measured for it then means nothing any more.
    [[nodiscard]] int generation() const { return generation_; }
    [[nodiscard]] int teleportations() const { return teleportations_; }

    /// Moves a split to the mean of its cluster. A cluster without weight, once every weight is known: its split goes and the
    /// heaviest cluster is split in two ("teleportation").
    void update(int split, const ClusterMean& mean);

private:
    void teleport(std::size_t empty);

    std::vector<double> splits_;
    std::vector<std::optional<double>> weights_;  // of the latest measurement
    bool teleports_;
    int generation_ = 0;
    int teleportations_ = 0;
};

/// Measures clusters on a device, from a map of unwarped moments (two components, filtered bilinearly), and relaxes splits.
class LloydPasses {
public:
    LloydPasses(Device& device, TextureId moments, const LloydOptions& options);

    /// All frames of relaxation for this number of layers. Returns the inner splits.
    std::vector<double> relax(int layers);
    /// One frame; `frame` counts from 0.
    void relax_frame(SplitRelaxation& splits, int frame);

private:
    struct Pending {
        int due;  // frame
        int generation;
        int split;
        ClusterMean mean;
    };

    /// Hands over what has been waiting for this frame.
    void deliver(SplitRelaxation& splits, int frame);
    /// Both clusters in one pass. The splits may be the same one.
    std::array<ClusterMean, 2> measure(std::span<const double> splits, int first, int second) const;

    Device& device_;
    TextureId moments_;
    LloydOptions options_;
    TextureId clusters_;  // rgba32f: weight times depth and weight of two clusters
    FullScreen full_screen_;
    std::deque<Pending> pending_;
};

}  // namespace gnomon::techniques
