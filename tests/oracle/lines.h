// Lines and points on the snapped grid: the aliased line by its diamonds, the rectangle of a multisampled line, the square of a
// point. D3D11.3 3.4.3, 3.4.5, 3.4.6
//
// The figure of 3.4.3 says which parts of the diamond |u| + |v| = 1/2 around a pixel's centre belong to it; Direct3D's
// "Rasterization Rules" has it in words (v down): both lower edges and the bottom corner do, the upper edges and the other
// corners do not; for y-major lines (|dy| > |dx|) the right corner does too. A line draws the pixels whose diamond it leaves on
// its way from start to end: those it meets that do not hold its end. A line without length draws nothing.
//
// Hence a chain of lines draws a joint's pixel where it leaves the diamond, once, with the line that does so; a chain that
// turns back into a diamond it has left draws the pixel again. One exception is in the rule itself: a joint exactly on a right
// corner (x an integer, y halfway) is outside for an x-major line that ends there and inside for a y-major line that starts
// there, so that both draw the pixel; the other way round neither need do so.
#pragma once

#include "tests/oracle/coverage.h"

#include <array>
#include <cstdint>
#include <vector>

namespace oracle {

/// A pixel's column and row.
struct Pixel {
    int x, y;

    auto operator<=>(const Pixel&) const = default;
};

/// Steep lines; |slope| = 1 is x-major.
bool is_y_major(const Point& a, const Point& b);

/// Whether the pixel's diamond, as it is for y-major or x-major lines, holds the point.
bool in_diamond(const Pixel& pixel, const Point& p, bool y_major);

/// Whether the line from a to b draws the pixel, by intersecting the segment with every part of the diamond.
bool line_draws(const Point& a, const Point& b, const Pixel& pixel);

/// The pixels of `rect` that the line draws, top to bottom, left to right: every pixel near the line is asked.
std::vector<Pixel> aliased_line(const Point& a, const Point& b, const PixelRect& rect);

/// The same pixels in closed form, in the same order: where the line crosses the centre of a column (x-major) or row (y-major)
/// it is in exactly one diamond, the upper or the left one on ties; add the diamond of the start, remove that of the end.
std::vector<Pixel> aliased_line_by_crossings(const Point& a, const Point& b, const PixelRect& rect);

/// A position in 1/65536 pixel, within +-2^31.
struct FinePoint {
    std::int64_t x, y;

    bool operator==(const FinePoint&) const = default;
};

/// Corners of the rectangle of width 1.4 around the line from a to b, its ends flush with them, in order around it: a + n, b +
/// n, b - n, a - n with n = 0.7 (dy, -dx) / length. The specification expands before it snaps (3.4.1, 3.4.5), so that each
/// exact corner is rounded to the nearest grid point, ties to even; for ends on the grid no tie occurs and the result is a
/// parallelogram. Without length all four are the snapped point: nothing is drawn.
std::array<Point, 4> line_rectangle(const FinePoint& a, const FinePoint& b);

/// Corners of the square of width 1 around a snapped point: top left, top right, bottom right, bottom left.
std::array<Point, 4> point_square(const Point& center);

/// Samples of a quadrilateral given by its corners in order around it, as two triangles. Which diagonal does not matter as long
/// as it is convex: samples on it belong to exactly one of them.
Masks quadrilateral_coverage(const std::array<Point, 4>& corners, const PixelRect& rect, const SamplePattern& pattern);

}  // namespace oracle
