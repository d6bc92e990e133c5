// What the rasteriser draws: exact integer edges, or the ends of an aliased line, and the planes of everything interpolated.
#pragma once

#include "pipeline/tiling.h"
#include "pipeline/triangulate.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gnomon {

inline constexpr int kSubpixelBits = 8;  // of the coordinates below; a profile with fewer snaps to coarser positions
inline constexpr int kSubpixels = 1 << kSubpixelBits;
inline constexpr int kSampleGrid = 16;  // sample positions are 1/16 pixel: 16 grid steps. D3D11.3 19.2.4

/// An edge function: a x + b y + c over positions in 1/256 pixel, less one where the edge is neither top nor left, so that a
/// sample is inside where it is not negative for all three edges. D3D11.3 3.4.2.1
struct Edge {
    std::int32_t a = 0;  // |a|, |b| < 2^24 as positions span 16 bits of pixels
    std::int32_t b = 0;
    std::int64_t c = 0;

    /// The constant of the same function over whole pixels, for the sample at (x, y) in 1/256 of each pixel: divided by 256 and
    /// rounded down, which keeps its sign.
    [[nodiscard]] std::int64_t at_sample(int x, int y) const {
        return (c + std::int64_t{a} * x + std::int64_t{b} * y) >> kSubpixelBits;
    }
};

enum class PrimitiveShape : std::uint8_t {
    Triangle,     // one of two where a point or a line is a quadrilateral
    AliasedLine,  // line.h
    Outline,      // outline.h
};

/// A polygon that is filled row by row from its left edges to its right ones.
struct Outline {
    std::vector<GridPoint> points;   // 1/256 pixel
    bool counter_clockwise = false;  // on the screen: edges that go down are left ones
};

template <class Scalar>
struct PeerPlanes;  // peer_planes.h

template <class Scalar>
struct Primitive {
    std::array<Edge, 3> edges;         // of a triangle
    std::array<GridPoint, 2> line{};   // of an aliased line: from, to
    const Outline* outline = nullptr;  // of an outline
    PixelRect bounds;                  // pixels it may cover, inside viewport and scissor
    PrimitiveShape shape = PrimitiveShape::Triangle;
    bool front = true;
    std::uint16_t layer = 0;  // of the targets
    std::uint32_t viewport = 0;
    std::uint32_t id = 0;  // counted from 0 in every instance. D3D11.3 8.17

    // Planes over (dx, dy) = position - vertex 0, in pixels.
    std::int32_t x0 = 0;  // snapped position of vertex 0, 1/256 pixel
    std::int32_t y0 = 0;
    Scalar z0, z_dx, z_dy;                  // depth, linear on the screen
    GridPoint z_origin;                     // where it is z0: vertex 0 but in profiles with plane equations of their own
    Scalar z_bias = 0;                      // of a profile that adds it to every fragment
    Scalar l1_dx, l1_dy;                    // linear barycentric of vertex 1
    Scalar l2_dx, l2_dy;                    // and of vertex 2
    std::array<Scalar, 3> inv_w;            // 1 / w at the vertices
    std::array<const Scalar*, 3> varyings;  // at the vertices
    const Scalar* flat = nullptr;           // at the provoking vertex
    const PeerPlanes<Scalar>* peer_planes = nullptr;  // of varyings, in profiles that have planes of their own
};

}  // namespace gnomon
