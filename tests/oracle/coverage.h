// Which samples a snapped triangle covers, by two ways that share nothing: the definition, sample by sample, and exact spans,
// row by row. D3D11.3 3.4.2.1, 3.5.4, 15.7, 15.11
#pragma once

#include "tests/oracle/raster.h"
#include "tests/oracle/samples.h"

#include <array>
#include <cstdint>
#include <vector>

namespace oracle {

/// Vertices on the snapped grid, 1/256 pixel, each within +-2^23 (16.8).
using SnappedTriangle = std::array<Point, 3>;

/// A rectangle of pixels; right and bottom are not part of it.
struct PixelRect {
    int left = 0, top = 0, right = 0, bottom = 0;

    bool operator==(const PixelRect&) const = default;
    [[nodiscard]] bool contains(int x, int y) const { return x >= left && x < right && y >= top && y < bottom; }
    [[nodiscard]] bool empty() const { return left >= right || top >= bottom; }
};

/// What both hold.
PixelRect intersection(const PixelRect& a, const PixelRect& b);

/// The scissor a viewport implies: each edge rounded to negative infinity; right and bottom from the unrounded sums.
/// D3D11.3 15.7
PixelRect implicit_scissor(float x, float y, float width, float height);

/// Facing on the snapped grid; no area is back facing. D3D11.3 15.11, 15.11.1
enum class Facing { Front, Back };
Facing facing(const SnappedTriangle& t, bool front_is_counter_clockwise = false);

/// The sample masks of a rectangle of pixels, bit i for sample i.
class Masks {
public:
    explicit Masks(const PixelRect& rect);

    [[nodiscard]] const PixelRect& rect() const { return rect_; }
    [[nodiscard]] std::uint32_t at(int x, int y) const { return masks_[index(x, y)]; }
    std::uint32_t& at(int x, int y) { return masks_[index(x, y)]; }
    void clear();
    [[nodiscard]] std::uint64_t samples() const;
    bool operator==(const Masks&) const = default;

private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rect_.top) * static_cast<std::size_t>(rect_.right - rect_.left) +
               static_cast<std::size_t>(x - rect_.left);
    }
    PixelRect rect_;
    std::vector<std::uint32_t> masks_;
};

/// The mask of one pixel by the definition: each sample against each edge (raster.h).
std::uint32_t mask_by_definition(const SnappedTriangle& t, int x, int y, const SamplePattern& pattern);

/// Adds (ORs) the triangle's samples to the masks, by spans: on the row of a sample the triangle is the interval from its left
/// edge, included, to its right edge, excluded; an edge is met from its upper end, included, to its lower, excluded. About 20
/// ns per row of samples that meets the triangle.
void add_coverage(Masks& masks, const SnappedTriangle& t, const SamplePattern& pattern);

/// Its masks in `rect`, by spans.
Masks coverage(const SnappedTriangle& t, const PixelRect& rect, const SamplePattern& pattern);

/// A pixel and its covered samples.
struct CoveredPixel {
    int x, y;
    std::uint32_t mask;

    bool operator==(const CoveredPixel&) const = default;
};

/// The pixels of the masks with any sample, top to bottom, left to right.
std::vector<CoveredPixel> covered_pixels(const Masks& masks);

/// Counts coverage of every sample of a rectangle over many triangles, front faces and back faces apart.
class SampleCounts {
public:
    SampleCounts(const PixelRect& rect, const SamplePattern& pattern);

    /// Adds one triangle under its facing (clockwise is front).
    void add(const SnappedTriangle& t);
    /// Adds masks drawn by somebody else.
    void add(const Masks& masks, Facing facing);

    [[nodiscard]] int front(int x, int y, int sample) const { return front_[index(x, y, sample)]; }
    [[nodiscard]] int back(int x, int y, int sample) const { return back_[index(x, y, sample)]; }

private:
    [[nodiscard]] std::size_t index(int x, int y, int sample) const {
        const auto width = static_cast<std::size_t>(rect_.right - rect_.left);
        return (static_cast<std::size_t>(y - rect_.top) * width + static_cast<std::size_t>(x - rect_.left)) * 16 +
               static_cast<std::size_t>(sample);
    }
    PixelRect rect_;
    SamplePattern pattern_;
    std::vector<int> front_, back_;
};

}  // namespace oracle
