// Vertices to binned primitives: clipping, setup and binning, in parallel over chunks and in primitive order.
#pragma once

#include "pipeline/peer_planes.h"
#include "pipeline/setup.h"
#include "pipeline/vertex_stage.h"
#include "sim/counters.h"
#include "sim/parallel.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon {

/// What one chunk of primitives became.
template <class Scalar>
struct PrimitiveChunk {
    std::vector<Primitive<Scalar>> pieces;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> bins;  // (tile, index into pieces), in primitive order
    std::vector<std::vector<Scalar>> clipped;                   // vertices that clipping made
    AssemblyCursor at;                                          // its first primitive
    std::uint64_t taken = 0;                                    // primitives
    std::vector<std::unique_ptr<Outline>> outlines;             // of pieces that are filled as polygons
    std::vector<std::unique_ptr<PeerPlanes<Scalar>>> peer_planes;
    Counters counters;
};

struct PieceRef {
    std::uint32_t chunk;
    std::uint32_t index;
};

/// The pieces of some primitives by tile; every tile's list is in primitive order.
template <class Scalar>
struct BinnedPrimitives {
    std::vector<PrimitiveChunk<Scalar>> chunks;
    std::vector<std::uint32_t> tile_start;  // tiles + 1 entries into refs
    std::vector<PieceRef> refs;
    std::vector<std::uint32_t> busy_tiles;  // tiles with at least one piece
};

/// Vertices that share one viewport, projected once each.
template <class Scalar>
struct ProjectedVertices {
    std::vector<ScreenVertex<Scalar>> screen;
    std::vector<std::uint32_t> codes;  // clip_code
};

/// What binning reads.
template <class Scalar>
struct BinningInput {
    const VertexBlock<Scalar>& vertices;
    const Assembly& assembly;
    bool by_position = false;  // corners are shaded one by one, by their position in the list of numbers
    std::uint32_t base = 0;    // the number, or position, of the block's first vertex
    std::uint32_t vertices_per_instance = 0;
    int corners = 3;                         // of each primitive
    bool layered = false;                    // records end with layer and viewport
    std::span<const std::uint8_t> linear{};  // ClipPolygon
    const SetupState& state;
    int tiles_x = 0;  // per row
    int tiles = 0;    // in all
};

/// Bins the next `count` primitives of the instances that the block holds, or as many of them as leave the bins within their
/// bound, and goes on behind them; returns how many. The cursor counts instances from the first of the block.
template <class Scalar>
std::uint64_t bin_primitives(const BinningInput<Scalar>& input, AssemblyCursor& at, std::uint64_t count, Workers& workers,
                             bool flush_denormals, const ProjectedVertices<Scalar>& projected, BinnedPrimitives<Scalar>& out);

/// Projects all vertices of a block, where all primitives share the first viewport.
template <class Scalar>
void project_vertices(const VertexBlock<Scalar>& vertices, const SetupState& state, Workers& workers, bool flush_denormals,
                      ProjectedVertices<Scalar>& out);

}  // namespace gnomon
