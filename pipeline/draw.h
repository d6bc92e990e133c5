// A draw call from end to end: vertices, primitives, tiles, in batches that bound the memory it takes.
#pragma once

#include "pipeline/tile_raster.h"
#include "sim/parallel.h"

#include <atomic>

namespace gnomon {

/// Memory that draws reuse.
template <class Scalar>
struct BatchScratch {
    VertexBlock<Scalar> vertices;
    ProjectedVertices<Scalar> projected;
    BinnedPrimitives<Scalar> primitives;
};
struct DrawScratch {
    BatchScratch<float> fp32;
    BatchScratch<double> fp64;

    template <class Scalar>
    BatchScratch<Scalar>& get() {
        if constexpr (std::is_same_v<Scalar, float>) {
            return fp32;
        } else {
            return fp64;
        }
    }
    /// Bytes held, capacity included.
    [[nodiscard]] std::size_t bytes() const;
};

/// A validated draw with everything resolved (validate.h).
struct DrawContext {
    const Draw* draw = nullptr;
    std::vector<std::max_align_t> vertex_functor;  // its bytes, where a functor may lie
    std::vector<std::max_align_t> pixel_functor;
    std::span<const float> vertices;
    std::span<const float> instances;
    std::span<const std::byte> indices;  // empty: none
    VertexRange index_range;             // of the indices, those that restart left out
    std::vector<ViewportTransform> viewports;
    std::vector<ColorTarget> color;
    SetupState setup;
    TileState tiles;
    int tiles_x = 0;
    int tiles_y = 0;
};

/// What a draw runs on.
struct DrawMachine {
    const Profile& profile;
    Workers& workers;
    DrawScratch& scratch;
    Tally* tally = nullptr;                   // null: nothing is counted
    const std::atomic<bool>* stop = nullptr;  // where it becomes true, Stopped is thrown between tiles
};

void run_draw(const DrawContext& context, const DrawMachine& machine);

}  // namespace gnomon
