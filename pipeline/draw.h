// A draw call from end to end, instantiated once per program: only what the draw needs is compiled in.
#pragma once

#include "pipeline/device.h"
#include "pipeline/program.h"
#include "pipeline/tile_raster.h"
#include "pipeline/vertex_stage.h"

#include <mutex>

namespace gnomon {

/// Memory that draws reuse.
struct DrawScratch {
    VertexBlock<float> vertices_fp32;
    VertexBlock<double> vertices_fp64;
    BinnedTriangles<float> triangles_fp32;
    BinnedTriangles<double> triangles_fp64;

    template <class Scalar>
    VertexBlock<Scalar>& vertices() {
        if constexpr (std::is_same_v<Scalar, float>) {
            return vertices_fp32;
        } else {
            return vertices_fp64;
        }
    }
    template <class Scalar>
    BinnedTriangles<Scalar>& triangles() {
        if constexpr (std::is_same_v<Scalar, float>) {
            return triangles_fp32;
        } else {
            return triangles_fp64;
        }
    }
};

/// A validated draw with everything resolved.
struct DrawContext {
    const Draw& draw;
    const Profile& profile;
    Workers& workers;
    DrawScratch& scratch;
    std::span<const float> vertices;
    PrimitiveSource source;
    std::uint32_t vertex_count = 0;  // vertices from source.base on that the draw uses
    SetupState setup;
    TileState tiles;
    int tiles_x = 0;
    int tiles_y = 0;
    Counters* counters = nullptr;
    const std::atomic<bool>* stop = nullptr;
};

template <class Real, class VertexFunctor, class PixelFunctor>
void run_draw(const DrawContext& context, const VertexFunctor& vertex_functor, const PixelFunctor& pixel_functor) {
    using Scalar = typename Real::Scalar;
    const bool flush = context.profile.flush_denormals;

    // Vertices, then triangles by tile.
    auto& vertices = context.scratch.vertices<Scalar>();
    shade_vertices<Real>(vertex_functor, context.vertices, context.source.base, context.vertex_count, context.workers, flush,
                         vertices);
    auto& binned = context.scratch.triangles<Scalar>();
    bin_triangles(vertices, context.source, context.setup, context.tiles_x, context.tiles_x * context.tiles_y, context.workers,
                  flush, binned);

    // Tiles in parallel; each pixel belongs to one tile, and each tile keeps primitive order.
    std::mutex counters_mutex;
    context.workers.for_each(binned.busy_tiles.size(), [&](std::size_t i) {
        if (context.stop != nullptr && context.stop->load(std::memory_order_relaxed)) throw Stopped();
        const DenormalScope denormals(flush);
        const std::uint32_t tile = binned.busy_tiles[i];
        const int tile_x = static_cast<int>(tile) % context.tiles_x * kTileSize;
        const int tile_y = static_cast<int>(tile) / context.tiles_x * kTileSize;
        Counters local;
        TileRaster<Real, VertexFunctor, PixelFunctor> raster(pixel_functor, context.tiles, tile_x, tile_y,
                                                             context.counters != nullptr ? &local : nullptr);
        for (std::uint32_t r = binned.tile_start[tile]; r < binned.tile_start[tile + 1]; ++r)
            raster.draw(binned.chunks[binned.refs[r].chunk].triangles[binned.refs[r].index]);
        if (context.counters != nullptr) {
            const std::lock_guard lock(counters_mutex);
            *context.counters += local;
        }
    });

    if (context.counters != nullptr) {
        context.counters->vertices += context.vertex_count;
        for (const auto& chunk : binned.chunks) *context.counters += chunk.counters;
    }
}

template <class VertexFunctor, class PixelFunctor>
void run_program(const DrawContext& context) {
    const auto vertex_functor = functor_from<VertexFunctor>(context.draw.vertex_constants);
    PixelFunctor pixel_functor;
    if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>)
        pixel_functor = functor_from<PixelFunctor>(context.draw.pixel_constants);
    if (context.profile.arithmetic == Arithmetic::Fp32) {
        run_draw<Float>(context, vertex_functor, pixel_functor);
    } else {
        run_draw<Double>(context, vertex_functor, pixel_functor);
    }
}

/// The program made of two functors. Call it in the .cpp of the technique, so that the quad loop is compiled there once.
template <class VertexFunctor, class PixelFunctor = NoPixelFunctor>
Program make_program(std::string_view name) {
    using Varyings = typename VertexFunctor::template Varyings<Float>;
    Program program{.name = name,
                    .vertex_floats = static_cast<int>(kRealCount<typename VertexFunctor::template Input<Float>, Float>),
                    .varyings = static_cast<int>(kRealCount<Varyings, Float>),
                    .targets = 0,
                    .vertex_constants_size = sizeof(VertexFunctor),
                    .pixel_constants_size = 0,
                    .vertex_constants = &named_constants<VertexFunctor>,
                    .pixel_constants = nullptr,
                    .run = &run_program<VertexFunctor, PixelFunctor>};
    if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>) {
        using Result = decltype(std::declval<const PixelFunctor&>()(std::declval<const FragmentContext<Float, Varyings>&>()));
        program.targets = static_cast<int>(std::tuple_size_v<std::remove_cvref_t<decltype(as_array(std::declval<Result>()))>>);
        program.pixel_constants_size = sizeof(PixelFunctor);
        program.pixel_constants = &named_constants<PixelFunctor>;
    }
    return program;
}

}  // namespace gnomon
