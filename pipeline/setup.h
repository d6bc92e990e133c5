// From clip-space vertices to primitives for the rasteriser: divide, viewport, snap, cull, depth bias, planes.
// D3D11.3 15.5 to 15.14, 3.4
#pragma once

#include "pipeline/primitive.h"
#include "pipeline/samples.h"
#include "pipeline/viewport.h"
#include "sim/profile.h"
#include "texunit/format.h"

#include <array>
#include <span>

namespace gnomon {

/// What setup needs to know of a draw.
struct SetupState {
    RasterState raster;
    std::span<const ViewportTransform> viewports;
    int layers = 1;                     // of the targets
    int samples = 1;                    // of the targets
    int subpixel_bits = kSubpixelBits;  // of the profile, as are the next four
    ViewportArithmetic viewport_arithmetic = ViewportArithmetic::D3d11;
    Clipping clipping = Clipping::GuardBand;
    WindingArea winding_area = WindingArea::Exact;
    PlaneEquations plane_equations = PlaneEquations::Barycentric;
    ComponentType depth_type = ComponentType::Depth24;  // scale of the constant depth bias; UNORM without a depth target
    DepthBiasPlace bias_place = DepthBiasPlace::Vertex;
    int bias_steps = 1;
    DepthBiasArithmetic bias_arithmetic = DepthBiasArithmetic::D3d11;
    PixelRect sample_extent{128, 128, 128, 128};  // least and largest sample position, 1/256 pixel; both ends inclusive
};

/// A vertex on the screen.
template <class Scalar>
struct ScreenVertex {
    Scalar x, y;   // pixels
    GridPoint at;  // the same snapped, 1/256 pixel
    Scalar z;      // inside the viewport's depth range up to rounding
    Scalar inv_w;
    bool valid = false;  // false: a coordinate is not a number
};

/// Pixels to the profile's grid, nearest even; positions beyond the range of 16.8 saturate. D3D11.3 3.4.1, 3.2.4.1
GridPoint snap_position(float x, float y, const Profile& profile);

/// Perspective divide, viewport and snapping. D3D11.3 15.5, 15.6, 3.4.1
template <class Scalar>
ScreenVertex<Scalar> project(const Scalar* clip_position, const Viewport& viewport, int subpixel_bits);

/// A vertex as setup takes it.
template <class Scalar>
struct SetupVertex {
    const Scalar* record = nullptr;  // clip position, then varyings
    ScreenVertex<Scalar> screen;
};

/// What all pieces of one primitive share.
template <class Scalar>
struct PrimitiveHead {
    std::uint32_t id = 0;
    std::uint32_t viewport = 0;
    std::uint16_t layer = 0;
    const Scalar* flat = nullptr;  // varyings of the provoking vertex
};

/// Twice the signed area of what was snapped, and the side that shows. No area counts as back. D3D11.3 15.11, 15.11.1
struct Facing {
    bool front = false;
    bool culled = false;
};
Facing facing_of(std::int64_t signed_area, const RasterState& raster);

/// The piece of a solid triangle; false where it covers nothing.
template <class Scalar>
bool set_up_triangle(const std::array<SetupVertex<Scalar>, 3>& vertices, const PrimitiveHead<Scalar>& head,
                     const SetupState& state, Primitive<Scalar>& out);

/// What the planes of an outline go through.
template <class Scalar>
struct OutlineCorners {
    std::array<SetupVertex<Scalar>, 3> polygon;   // three of its corners, not all in a line: varyings
    std::array<SetupVertex<Scalar>, 3> triangle;  // what it was before it was clipped: depth, in profiles that have it so
};

/// The piece of a polygon that is filled as a whole, in the pixels of `bounds`.
template <class Scalar>
void set_up_outline(const OutlineCorners<Scalar>& corners, const Outline& outline, const PixelRect& bounds,
                    const PrimitiveHead<Scalar>& head, const SetupState& state, Primitive<Scalar>& out);

/// Pixels that what lies between two corners may cover, inside the viewport.
PixelRect pixel_bounds(const GridPoint& low, const GridPoint& high, std::uint32_t viewport, const SetupState& state);

/// The depth bias of a triangle. D3D11.3 15.10
template <class Scalar>
Scalar triangle_depth_bias(const std::array<SetupVertex<Scalar>, 3>& vertices, const SetupState& state);

/// An aliased line (one piece) or a rectangle (two); `bias` is added to both depths. Returns the number of pieces.
template <class Scalar>
int set_up_line(const std::array<SetupVertex<Scalar>, 2>& ends, const PrimitiveHead<Scalar>& head, Scalar bias, bool front,
                const SetupState& state, std::array<Primitive<Scalar>, 2>& out);

/// A square of one pixel, in two pieces. D3D11.3 3.4.6
template <class Scalar>
int set_up_point(const SetupVertex<Scalar>& centre, const PrimitiveHead<Scalar>& head, const SetupState& state,
                 std::array<Primitive<Scalar>, 2>& out);

}  // namespace gnomon
