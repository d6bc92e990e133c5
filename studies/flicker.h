// How steady a shadow is while the camera moves: fixed points of surfaces, followed from frame to frame.
//
// A pixel's centre is not exactly the point that falls into the pixel, and from frame to frame it lies elsewhere beside it.
// Near the edge of a shadow the truth therefore differs between the frames, and a machine that is right in every one of them
// would seem to flicker. So there are two measures. The flicker of the *error* takes the truth at the pixel's centre in each
// frame off first: it is 0 for a machine that is right. The flicker of the *visibility* is what an eye sees at the point: the
// point's own truth never changes (nothing but the camera moves), so against it only the visibility does.
#pragma once

#include "scenes/reference.h"
#include "scenes/view.h"
#include "sim/fields.h"
#include "studies/images.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gnomon::studies {

/// A point counts when it was judged in so many frames.
inline constexpr std::uint32_t kLeastFrames = 3;

/// Points lie at the centres of the pixels of the first frame whose x and y leave this over from twice this.
inline constexpr int kPointSpacing = 8;  // pixels

/// The deviation of numbers that come one by one. Of numbers that are all the same it is exactly 0. [Welford62]
class RunningDeviation {
public:
    void add(double value);
    [[nodiscard]] std::uint32_t count() const { return count_; }
    /// Root of the mean squared difference from the mean; of no numbers, 0.
    [[nodiscard]] double deviation() const;

private:
    std::uint32_t count_ = 0;
    double mean_ = 0;
    double squares_ = 0;  // sum of squared differences from the mean
};

/// What one quantity did at the points. Of no points, zeros.
struct Unsteadiness {
    double mean = 0;  // over the points, of the deviation over the frames in which the point was judged
    double p95 = 0;   // nearest rank
    double p99 = 0;
    double worst = 0;
    double change = 0;  // mean absolute change from one frame to the next, over all pairs with the point judged in both

    static constexpr auto fields() {
        using U = Unsteadiness;
        return std::tuple{Field{"mean", &U::mean}, Field{"p95", &U::p95}, Field{"p99", &U::p99}, Field{"worst", &U::worst},
                          Field{"change", &U::change}};
    }
    bool operator==(const Unsteadiness&) const = default;
};

struct Flicker {
    std::uint64_t points = 0;  // judged in kLeastFrames frames or more
    std::uint64_t pairs = 0;   // what `change` is the mean of
    Unsteadiness error;        // of visibility - truth of the same pixel in the same frame
    Unsteadiness visibility;   // of visibility - the point's own truth, which is constant

    bool operator==(const Flicker&) const = default;
};

/// One frame. The images have one size.
struct FrameImages {
    const scenes::View& camera;
    const FloatImage& depth;       // as the machine left it
    const FloatImage& visibility;  // techniques::Frame::kNoSurface where nothing was drawn
    const scenes::ReferenceImage& truth;
};

/// The pixel that a point falls into, row by row, if the machine drew the point's surface there: the surface at the pixel's
/// centre, as its depth has it, lies in the plane of the triangle that the point is on. It may be off by an eighth of a pixel
/// (what a pixel spans at that distance), and by what depth cannot resolve there.
std::optional<std::size_t> pixel_showing(const scenes::SurfacePoint& point, const scenes::View& camera,
                                         const FloatImage& depth);

/// Pixels of the grid.
std::vector<glm::ivec2> grid_pixels(int width, int height);

/// Follows points through the frames of a sequence.
class FlickerMeter {
public:
    explicit FlickerMeter(const std::vector<scenes::SurfacePoint>& points);

    /// The next frame.
    void add(const FrameImages& frame);

    /// Of the frames so far.
    [[nodiscard]] Flicker result() const;

private:
    struct Track {
        scenes::SurfacePoint point{};
        RunningDeviation error{};
        RunningDeviation visibility{};
        std::optional<int> last_frame{};  // in which it was judged
        double last_error = 0;
        double last_visibility = 0;
    };

    std::vector<Track> tracks_;
    int frames_ = 0;
    std::uint64_t pairs_ = 0;
    double error_changes_ = 0;
    double visibility_changes_ = 0;
};

}  // namespace gnomon::studies
