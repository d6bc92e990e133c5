// Attributes and depth between the vertices of a snapped triangle: exact barycentrics, values from them, and how far an fp32
// evaluation may be off. D3D11.3 3.5.5, 15.10, 15.16.2, 16.4, 16.5.3
#pragma once

#include "tests/oracle/coverage.h"

#include <array>
#include <cstdint>

namespace oracle {

// --- Where an attribute is evaluated --------------------------------------------------------------------------------------

/// The centre of a pixel.
Point pixel_center(int x, int y);

/// `covered` is the primitive's coverage before the sample mask. All samples covered: the centre. Else the first sample that is
/// covered and in the mask. None (helper pixels): the first sample of the mask if it lacks any of the pattern's, else the
/// centre. D3D11.3 3.5.5
Point centroid_point(int x, int y, std::uint32_t covered, std::uint32_t sample_mask, const SamplePattern& pattern);

/// The centre moved by 4-bit offsets in 1/16 pixel, of which only the low 4 bits count: -8 to 7. D3D11.3 16.5.3
Point snapped_offset_point(int x, int y, int dx, int dy);

// --- Values ---------------------------------------------------------------------------------------------------------------

/// Barycentric i is weight[i] / area, exactly; the weights add up to the area. At points outside they are negative or above 1.
struct Barycentric {
    std::array<std::int64_t, 3> weight;
    std::int64_t area;
};
Barycentric barycentric(const SnappedTriangle& t, const Point& p);

/// sum v_i weight_i / area. The result's own error is below 2^-60 sum |v_i weight_i / area| where long double has 64 bits.
long double linear(const Barycentric& b, const std::array<float, 3>& v);

/// (sum v_i weight_i / w_i) / (sum weight_i / w_i). D3D11.3 15.5
long double perspective(const Barycentric& b, const std::array<float, 3>& v, const std::array<float, 3>& w);

/// w as the pixel shader's position has it: the reciprocal of the linearly interpolated 1 / w. D3D11.3 16.3
long double perspective_w(const Barycentric& b, const std::array<float, 3>& w);

/// How far along the line from a to b the point projected onto it lies, 0 at a and 1 at b. Direct3D does not say how attributes
/// vary along aliased lines; this is OpenGL's and Vulkan's rule. OpenGL 4.6 14.5.1
long double line_parameter(const Point& a, const Point& b, const Point& p);

/// The change of the linear interpolation per pixel to the right, or down.
struct Slopes {
    long double dx, dy;
};
Slopes slopes(const SnappedTriangle& t, const std::array<float, 3>& v);

// --- Error bounds ---------------------------------------------------------------------------------------------------------

/// A value and how far an fp32 evaluation of the same expression, rounded to nearest operation by operation, can be from it.
/// Denormal results may be flushed. Overflow is not covered.
struct Rounded {
    long double value = 0;
    long double error = 0;

    /// A number that fp32 holds.
    static Rounded exactly(float v);
    /// The nearest fp32 number to v.
    static Rounded nearest(long double v);
    [[nodiscard]] bool allows(float v) const;
};
Rounded operator+(const Rounded& a, const Rounded& b);
Rounded operator-(const Rounded& a, const Rounded& b);
Rounded operator*(const Rounded& a, const Rounded& b);
/// `roundings` in units of half an ULP: 1 for a division, 3 for a reciprocal within 1 ULP and a product.
Rounded divide(const Rounded& a, const Rounded& b, int roundings = 1);

/// v0 + (dx v_dx + dy v_dy) around vertex `origin`, slopes rounded once: depth and noperspective attributes from a plane.
/// `slope_error` adds what slopes may be off beyond that rounding, relative to the products they are sums of.
Rounded plane_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const Point& p, std::size_t origin = 0,
                    long double slope_error = 0);

/// The noperspective value from barycentrics: v0 + (l1 (v1 - v0) + l2 (v2 - v0)), l1 and l2 as below.
Rounded linear_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const Point& p);

/// The perspective value from barycentrics: l1 and l2 from planes through 0 at vertex 0, 1 / w from
/// 1/w0 + (l1 (1/w1 - 1/w0) + l2 (1/w2 - 1/w0)), b1 = l1 (1/w1) w, b2 alike, v0 + (b1 (v1 - v0) + b2 (v2 - v0)).
/// Infinite where 1 / w may be 0.
Rounded perspective_bound(const SnappedTriangle& t, const std::array<float, 3>& v, const std::array<float, 3>& w,
                          const Point& p, int division_roundings = 1);

/// w from the same arithmetic.
Rounded perspective_w_bound(const SnappedTriangle& t, const std::array<float, 3>& w, const Point& p);

// --- Depth bias -----------------------------------------------------------------------------------------------------------

struct DepthBias {
    std::int32_t constant = 0;
    float slope_scaled = 0;
    float clamp = 0;
};
enum class DepthKind { Unorm16, Unorm24, Float32 };

/// max(|dz/dx|, |dz/dy|) per pixel.
long double max_depth_slope(const SnappedTriangle& t, const std::array<float, 3>& z);

/// What is added to each vertex's z, without fp32 rounding except of r. The specification leaves the exponent of 0 open: here a
/// primitive whose every z is 0 or denormal has no constant term with a float depth buffer. D3D11.3 15.10
long double bias_value(const DepthBias& bias, DepthKind kind, long double max_slope, float max_abs_z);

}  // namespace oracle
