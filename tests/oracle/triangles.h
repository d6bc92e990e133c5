// Triangles on the snapped grid for coverage tests: random ones by kind, seeded from the index of the case, and complete sets.
#pragma once

#include "tests/oracle/coverage.h"
#include "tests/oracle/random.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace oracle {

enum class TriangleKind {
    Ordinary,     // corners in and around the target
    SubPixel,     // within about a pixel
    Sliver,       // the third corner within 2 grid steps of the line through the others
    Huge,         // corners as far as 16.8 reaches
    OnSamples,    // corners on sample positions of the pattern, on pixel corners or on pixel edges
    EdgeThrough,  // an edge passes exactly through a sample
    AxisAligned,  // legs parallel to the axes, often through samples
    ZeroArea,
};
inline constexpr std::array<TriangleKind, 8> kTriangleKinds{
    TriangleKind::Ordinary,  TriangleKind::SubPixel,    TriangleKind::Sliver,      TriangleKind::Huge,
    TriangleKind::OnSamples, TriangleKind::EdgeThrough, TriangleKind::AxisAligned, TriangleKind::ZeroArea};
std::string_view name_of(TriangleKind kind);

/// The largest grid coordinate the generators use: 32767 pixels, which a viewport at the origin can place in clip space.
inline constexpr std::int64_t kFarthest = std::int64_t{32767} * 256;

/// A target of `width` x `height` pixels whose top left corner is the origin, and the samples the triangles are aimed at.
struct TriangleTarget {
    int width = 16, height = 16;
    SamplePattern pattern = standard_pattern(1);

    [[nodiscard]] PixelRect rect() const { return {0, 0, width, height}; }
};

/// A triangle of the kind, either winding.
SnappedTriangle random_triangle(Random& random, TriangleKind kind, const TriangleTarget& target);

/// Case `index` of a run: kinds take turns, its random numbers come from the index alone.
struct TriangleCase {
    TriangleKind kind;
    SnappedTriangle triangle;
};
TriangleCase triangle_case(std::uint64_t index, const TriangleTarget& target);

/// Two triangles on opposite sides of one edge: no sample belongs to both, and every sample inside their union, shared edge
/// included, to one.
std::array<SnappedTriangle, 2> random_neighbours(Random& random, TriangleKind kind, const TriangleTarget& target);

/// A complete set of triangles, indexed. All act on the 4 x 4 pixels from the origin; sweeps are over the cell of pixel (1, 1),
/// its borders included.
struct CompleteSet {
    std::string_view name;
    std::uint64_t size;
    SnappedTriangle (*triangle)(std::uint64_t index);
};

/// One corner over every grid position of the cell (257 x 257) against 24 fixed edges: 1585176 triangles.
/// Two corners over every position on the 1/16 grid of the cell (17 x 17, all sample positions among them) against 12 fixed
/// corners: 1002252. All three corners over the 1/8 grid of the cell (9 x 9): 531441, degenerate ones and every order included.
const std::array<CompleteSet, 3>& complete_sets();

/// The fp32 clip-space x of a grid position in a viewport of `size` pixels at `origin` with w = 1 (y: negate the result).
/// Exact, and the viewport transform gives the position back exactly, if `size` is a power of two, `origin` is 0 and the
/// position is within +-(2^23 - 128 size).
float ndc_of(std::int64_t grid, int origin, int size);

/// A clip-space vertex for a wanted grid position and where the specification's own arithmetic puts it, which is the wanted
/// position wherever ndc_of() is exact. w is often a power of two other than 1, z is w / 2.
struct PlacedVertex {
    std::array<float, 4> clip;
    Point snapped;
};
PlacedVertex place(Random& random, const Point& wanted, const PixelRect& viewport, int subpixel_bits = 8);

/// Start and end of a line in or near the target: ends on corners and edges of diamonds, on pixel corners and centres, or
/// anywhere; long, short, axis-aligned, diagonal ones and single points.
std::array<Point, 2> random_line(Random& random, const TriangleTarget& target);

}  // namespace oracle
