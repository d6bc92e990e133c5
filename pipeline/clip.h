// Clipping in homogeneous space. D3D11.3 15.4
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// How far outside the viewport, in units of w, x and y may go before they are clipped: what 16.8 positions can hold.
template <class Scalar>
struct GuardBand {                    // D3D11.3 15.4
    Scalar left, right, bottom, top;  // -left w <= x <= right w and so on; each >= 1
    // How far out something can still be seen, in the same units: the pixels that the left and the top edge of a viewport cut
    // belong to it as a whole. D3D11.3 15.7
    Scalar seen_left = 1, seen_top = 1;
};

/// A vertex after the vertex functor: clip-space x, y, z, w, then the varyings.
inline constexpr int kPositionScalars = 4;

/// Planes a vertex can be outside of.
enum ClipCode : unsigned {
    kOutsideNear = 1u << 0,  // z < 0
    kOutsideFar = 1u << 1,   // z > w
    kOutsideLeft = 1u << 2,  // beyond the guard band
    kOutsideRight = 1u << 3,
    kOutsideBottom = 1u << 4,
    kOutsideTop = 1u << 5,
    kBeyondLeft = 1u << 6,  // beyond what is seen: if all three are, nothing is visible
    kBeyondRight = 1u << 7,
    kBeyondBottom = 1u << 8,
    kBeyondTop = 1u << 9,
    kNotFinite = 1u << 10,  // NaN or infinite
};
inline constexpr unsigned kClipPlanes =
    kOutsideNear | kOutsideFar | kOutsideLeft | kOutsideRight | kOutsideBottom | kOutsideTop;

/// Without depth clipping near and far are never left. Bits of kBeyond... say nothing about width: they are for triangles.
template <class Scalar>
unsigned clip_code(const Scalar* v, const GuardBand<double>& guard, bool depth_clip) {
    const Scalar x = v[0];
    const Scalar y = v[1];
    const Scalar z = v[2];
    const Scalar w = v[3];
    // x - x is 0 only for finite x.
    if (!((x - x) + (y - y) + (z - z) + (w - w) == Scalar(0))) return kNotFinite;
    unsigned code = 0;
    if (depth_clip && z < 0) code |= kOutsideNear;
    if (depth_clip && z > w) code |= kOutsideFar;
    // In double, as clip() cuts: two triangles must not disagree about a vertex next to the plane.
    const auto wide_x = static_cast<double>(x);
    const auto wide_y = static_cast<double>(y);
    const auto wide_w = static_cast<double>(w);
    if (wide_x < -guard.left * wide_w) code |= kOutsideLeft;
    if (wide_x > guard.right * wide_w) code |= kOutsideRight;
    if (wide_y < -guard.bottom * wide_w) code |= kOutsideBottom;
    if (wide_y > guard.top * wide_w) code |= kOutsideTop;
    if (wide_x < -guard.seen_left * wide_w) code |= kBeyondLeft;
    if (x > w) code |= kBeyondRight;
    if (y < -w) code |= kBeyondBottom;
    if (wide_y > guard.seen_top * wide_w) code |= kBeyondTop;
    return code;
}

/// A convex polygon being clipped; vertices of `stride` numbers each. Always in double: an fp32 intersection can be off by more
/// than a grid step where vertices are far away, and then the pieces of the polygon overlap. D3D11.3 15.4 asks for at least
/// fp32.
struct ClipPolygon {
    std::size_t stride = 0;
    std::vector<double> vertices;
    std::vector<char> edges;                 // [i]: the edge from vertex i to the next is an original one, or a part of it
    std::span<const std::uint8_t> linear{};  // [k]: scalar k behind the position is linear on the screen; empty: none is

    [[nodiscard]] std::size_t count() const { return vertices.size() / stride; }
};

/// Cuts the polygon by every plane named in `planes`. Each intersection is computed from the inner vertex towards the outer
/// one, so that two triangles cut a shared edge at the same point. Planes come in the order of ClipCode.
///
/// Scalars that are linear on the screen take the parameter that is linear there. Vulkan 1.3 27.4 (Clipping Shader Outputs)
void clip(ClipPolygon& polygon, unsigned planes, const GuardBand<double>& guard);

/// The same for a line: a polygon of two vertices, which is empty afterwards if nothing is left.
void clip_line(ClipPolygon& line, unsigned planes, const GuardBand<double>& guard);

}  // namespace gnomon
