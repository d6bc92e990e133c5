// How steady a shadow is while the camera moves: fixed points of surfaces, followed from frame to frame.
//
// Nothing but the camera moves, so a point's own truth never changes, and what flickers against it is the visibility alone:
// that is the flicker of a point. It is read at the centre of the pixel that the point falls into, which is not exactly the
// point and from frame to frame lies elsewhere beside it: near the edge of a shadow even a machine that is always right
// flickers. How much, the flicker of the truth at the same pixels says. The flicker of the error, visibility less truth at the
// pixel's centre in each frame, takes that off pixel by pixel: it is 0 for a machine that is always right. But a soft edge that
// stays where it is has an error that jumps wherever the hard truth does, so to compare methods of different softness, or one
// with and without a cure, the first is the better measure.
#pragma once

#include "scenes/reference.h"
#include "scenes/view.h"
#include "sim/fields.h"
#include "studies/images.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gnomon::studies {

/// A point counts when it was judged in so many frames.
inline constexpr std::uint32_t kLeastFrames = 3;

/// Points are those that the first frame shows at the centres of every eighth pixel of every eighth row, from 4 on.
inline constexpr int kPointSpacing = 8;  // pixels

/// The deviation of numbers that come one by one. Of numbers that are all the same it is exactly 0.
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
    Unsteadiness visibility;   // less the point's own truth, which is constant
    Unsteadiness truth;        // at the centres of the same pixels
    Unsteadiness error;        // visibility - truth at the centre of the pixel in each frame

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

/// Pixels kPointSpacing apart, x and y from half of it on, row by row.
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
    static constexpr std::size_t kQuantities = 3;  // visibility, truth, error

    struct Track {
        scenes::SurfacePoint point{};
        std::array<RunningDeviation, kQuantities> over_frames{};
        std::array<double, kQuantities> last{};
        std::optional<int> last_frame{};  // in which it was judged
    };

    std::vector<Track> tracks_;
    int frames_ = 0;
    std::uint64_t pairs_ = 0;
    std::array<double, kQuantities> changes_{};  // absolute, summed over the pairs
};

}  // namespace gnomon::studies
