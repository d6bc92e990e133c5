// Vertices to binned triangles: assembly, clipping, setup and binning, in parallel over chunks and in primitive order.
#pragma once

#include "pipeline/setup.h"
#include "sim/counters.h"
#include "sim/parallel.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon {

/// Vertices after the vertex functor, `stride` scalars each: clip x, y, z, w, varyings.
template <class Scalar>
struct VertexBlock {
    int stride = kPositionScalars;
    std::vector<Scalar> scalars;
};

/// What one chunk of primitives became.
template <class Scalar>
struct TriangleChunk {
    std::vector<Triangle<Scalar>> triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> bins;  // (tile, index into triangles), in primitive order
    std::vector<std::unique_ptr<Scalar[]>> clipped;             // vertices that clipping made
    Counters counters;
};

struct TriangleRef {
    std::uint32_t chunk;
    std::uint32_t index;
};

/// The triangles of a draw by tile; every tile's list is in primitive order.
template <class Scalar>
struct BinnedTriangles {
    std::vector<TriangleChunk<Scalar>> chunks;
    std::vector<std::uint32_t> tile_start;  // tiles + 1 entries into refs
    std::vector<TriangleRef> refs;
    std::vector<std::uint32_t> busy_tiles;  // tiles with at least one triangle
};

/// The source of vertex numbers: indices, or the numbers themselves.
struct PrimitiveSource {
    std::span<const std::uint32_t> indices;  // empty: first, first + 1, ...
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t base = 0;  // vertex number of the block's first vertex

    /// Position in the vertex block of corner i.
    [[nodiscard]] std::uint32_t operator[](std::uint32_t i) const {
        return (indices.empty() ? first + i : indices[first + i]) - base;
    }
};

/// `tiles_x` tiles per row, `tiles` in all.
template <class Scalar>
void bin_triangles(const VertexBlock<Scalar>& vertices, const PrimitiveSource& source, const SetupState& state, int tiles_x,
                   int tiles, Workers& workers, bool flush_denormals, BinnedTriangles<Scalar>& out);

extern template void bin_triangles(const VertexBlock<float>&, const PrimitiveSource&, const SetupState&, int, int, Workers&,
                                   bool, BinnedTriangles<float>&);
extern template void bin_triangles(const VertexBlock<double>&, const PrimitiveSource&, const SetupState&, int, int, Workers&,
                                   bool, BinnedTriangles<double>&);

}  // namespace gnomon
