// The small cases one by one, with the geometry that their tests count on.
#pragma once

#include "studies/seams/cases.h"
#include "studies/seams/draw.h"

#include <glm/vec2.hpp>

#include <array>
#include <vector>

namespace gnomon::studies {

SeamCase atlas_seam();
SeamCase wrap_seam();
SeamCase pages_seam();
SeamCase branch_seam();
SeamCase discard_seam();
SeamCase lvsm_layers_seam();
SeamCase cube_faces_seam();
SeamCase centroid_seam();

/// Cells of a plane, each with a tile of its own out of kAtlasTiles x kAtlasTiles. Coordinates in tiles; no pixel's centre
/// lies on a border, as slopes are multiples of 1/1024 and the origin is 1/4096 off.
inline constexpr int kAtlasTiles = 8;
inline constexpr int kAtlasSide = 512;  // texels
inline constexpr SeamPlane kAtlasPlane{
    .origin = {3 + 0x1p-12f, 1 + 0x1p-12f, 0}, .dx = {31 * 0x1p-10f, 9 * 0x1p-10f, 0}, .dy = {-8 * 0x1p-10f, 27 * 0x1p-10f, 0}};

/// u goes around from 1 to 0. In repeats of the texture.
inline constexpr int kWrapSide = 256;  // texels
inline constexpr SeamPlane kWrapPlane{
    .origin = {2 + 0x1p-12f, 1 + 0x1p-12f, 0}, .dx = {25 * 0x1p-10f, 3 * 0x1p-10f, 0}, .dy = {-7 * 0x1p-10f, 11 * 0x1p-10f, 0}};

/// A page of the cache and what it covers of the virtual texture, in fine pages.
struct SeamPage {
    int left = 0;
    int top = 0;
    int side = 1;  // 1, 2 or 4: a page of level 0, 1 or 2
    int slot = 0;  // row by row in the cache
};
inline constexpr int kVirtualPages = 16;  // fine pages each way
inline constexpr int kCachePages = 8;     // each way
inline constexpr int kCacheSide = 512;    // texels
inline constexpr std::size_t kCachedPages = 64;
/// Page i of the picture is number i.
std::span<const SeamPage, kCachedPages> seam_pages();
/// Coordinates in fine pages.
inline constexpr SeamPlane kPagesPlane{.origin = {3 + 0x1p-12f, 1 + 0x1p-12f, 0},
                                       .dx = {40 * 0x1p-10f, 12 * 0x1p-10f, 0},
                                       .dy = {-9 * 0x1p-10f, 37 * 0x1p-10f, 0}};

/// A grid of discs, one in the middle of each square. No pixel's centre lies on a rim: squares of halves add up to halves.
struct SeamDiscs {
    int side = 32;                   // of a square, pixels
    float radius_squared = 106.25f;  // pixels^2
};
inline constexpr SeamDiscs kDiscs;
inline constexpr int kFlowSide = 256;  // texels
/// Coordinates in repeats of the texture.
inline constexpr SeamPlane kFlowPlane{
    .origin = {3, 1, 0}, .dx = {11 * 0x1p-10f, 4 * 0x1p-10f, 0}, .dy = {-3 * 0x1p-10f, 9 * 0x1p-10f, 0}};

/// Layers repeat along a depth, the third number: layer i holds fractions from i / kLayers on.
inline constexpr int kLayers = 4;
inline constexpr int kLayerSide = 512;  // texels of a layer
inline constexpr SeamPlane kLayerPlane{.origin = {0.25f, 0.0625f, 3 + 0x1p-14f},
                                       .dx = {2.5f * 0x1p-10f, 0.5f * 0x1p-10f, 6 * 0x1p-10f},
                                       .dy = {-0.75f * 0x1p-10f, 2.75f * 0x1p-10f, -7 * 0x1p-10f}};

/// A stereographic projection of all directions: (2x, 2y, 1 - x^2 - y^2).
inline constexpr int kFaceSide = 256;  // texels
inline constexpr SeamPlane kFacesPlane{.origin = {128 * -12 * 0x1p-10f + 0x1p-12f, 128 * -22 * 0x1p-10f + 0x1p-13f, 0},
                                       .dx = {17 * 0x1p-10f, 5 * 0x1p-10f, 0},
                                       .dy = {-5 * 0x1p-10f, 17 * 0x1p-10f, 0}};

/// Triangles that share no quad; corners in 1/256 pixel.
using CentroidTriangle = std::array<glm::ivec2, 3>;
const std::vector<CentroidTriangle>& centroid_triangles();
inline constexpr int kCentroidSamples = 4;
inline constexpr int kCentroidSide = 256;  // texels
/// Coordinates in repeats of the texture.
inline constexpr SeamPlane kCentroidPlane{
    .origin = {1, 1, 0}, .dx = {9 * 0x1p-10f, 2 * 0x1p-10f, 0}, .dy = {-3 * 0x1p-10f, 8 * 0x1p-10f, 0}};

}  // namespace gnomon::studies
