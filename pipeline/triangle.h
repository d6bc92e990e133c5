// A triangle ready for the rasteriser: exact integer edges and the planes of everything that is interpolated.
#pragma once

#include "pipeline/tiling.h"

#include <array>
#include <cstdint>

namespace gnomon {

inline constexpr int kSubpixelBits = 8;  // of the coordinates below; a profile with fewer snaps to coarser positions
inline constexpr int kSubpixels = 1 << kSubpixelBits;

/// Edge functions on pixels: pixel (x, y) is inside where a x + b y + c >= 0 for all three. The snapped 16.8 edge function at
/// the pixel centre, less one where the edge is neither top nor left, divided by 256 and rounded down, which keeps its sign.
/// D3D11.3 3.4.2.1
struct Edge {
    std::int32_t a = 0;  // |a|, |b| <= 2^24 as positions span 16 bits of pixels
    std::int32_t b = 0;
    std::int64_t c = 0;
};

template <class Scalar>
struct Triangle {
    std::array<Edge, 3> edges;
    PixelRect bounds;  // pixels it may cover, inside the viewport

    // Planes over (dx, dy) = pixel centre - vertex 0, in pixels.
    std::int32_t x0 = 0;  // snapped position of vertex 0, 1/256 pixel
    std::int32_t y0 = 0;
    Scalar z0, z_dx, z_dy;                  // depth, linear on the screen
    Scalar l1_dx, l1_dy;                    // linear barycentric of vertex 1
    Scalar l2_dx, l2_dy;                    // and of vertex 2
    std::array<Scalar, 3> inv_w;            // 1 / w at the vertices
    std::array<const Scalar*, 3> varyings;  // at the vertices
};

}  // namespace gnomon
