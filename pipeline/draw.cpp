#include "pipeline/draw.h"

#include "sim/denormals.h"
#include "sim/error.h"
#include "sim/progress.h"

#include <mutex>

namespace gnomon {

namespace {

// One batch of a draw is set up and drawn before the next, so that memory stays bounded however much is drawn.
constexpr std::uint64_t kBatchPrimitives = 1u << 14;  // and its pieces stay in the second-level cache
constexpr std::uint32_t kBatchVertices = 1u << 18;

template <class Real>
class DrawRun {
public:
    using Scalar = typename Real::Scalar;

    DrawRun(const DrawContext& context, const DrawMachine& machine)
        : context_(context),
          machine_(machine),
          draw_(*context.draw),
          scratch_(machine.scratch.get<Scalar>()),
          numbers_(context.indices, draw_.index_type, draw_.first, draw_.count),
          assembly_(numbers_, draw_.topology, draw_.raster.provoking, draw_.primitive_restart) {}

    void run() {
        const std::uint32_t primitives = assembly_.count();
        if (primitives == 0 || draw_.instance_count == 0) return;
        const Window whole = window_of(0, primitives);
        if (whole.count <= kBatchVertices) {
            // Few vertices: as many instances together as fit.
            const std::uint32_t together = std::max(1u, kBatchVertices / whole.count);
            for (std::uint32_t i = 0; i < draw_.instance_count; i += together) {
                const std::uint32_t count = std::min(together, draw_.instance_count - i);
                draw_window(whole, {i, count}, 0, std::uint64_t{primitives} * count);
            }
            return;
        }
        // Many: the vertices of one batch of primitives at a time.
        for (std::uint32_t i = 0; i < draw_.instance_count; ++i) {
            for (std::uint64_t begin = 0; begin < primitives; begin += kBatchPrimitives) {
                const std::uint64_t end = std::min<std::uint64_t>(primitives, begin + kBatchPrimitives);
                draw_window(window_of(begin, end), {i, 1}, begin, end);
            }
        }
    }

private:
    /// The vertices that some primitives use: a range of vertex numbers or, where that is mostly not used, a range of corners,
    /// each shaded for itself.
    struct Window {
        bool by_corner = false;
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };
    struct InstanceRange {
        std::uint32_t begin = 0;
        std::uint32_t count = 1;
    };

    Window window_of(std::uint64_t begin, std::uint64_t end) const {
        const auto corners = static_cast<std::size_t>(corner_count(draw_.topology));
        std::uint32_t first_corner = ~0u;
        std::uint32_t last_corner = 0;
        std::uint32_t lowest = ~0u;
        std::uint32_t highest = 0;
        for (std::uint64_t p = begin; p < end; ++p) {
            const AssembledPrimitive primitive = assembly_[static_cast<std::uint32_t>(p)];
            for (std::size_t c = 0; c < corners; ++c) {
                const std::uint32_t number = numbers_[primitive.corner[c]];
                first_corner = std::min(first_corner, primitive.corner[c]);
                last_corner = std::max(last_corner, primitive.corner[c]);
                lowest = std::min(lowest, number);
                highest = std::max(highest, number);
            }
        }
        const std::uint64_t range = std::uint64_t{highest} - lowest + 1;
        const std::uint64_t span = std::uint64_t{last_corner} - first_corner + 1;
        if (range > 2 * span + 1024) return {true, first_corner, static_cast<std::uint32_t>(span)};
        return {false, lowest, static_cast<std::uint32_t>(range)};
    }

    /// Draws primitives [begin, end), counted through the instances.
    void draw_window(const Window& window, const InstanceRange& instances, std::uint64_t begin, std::uint64_t end) {
        const bool flush = machine_.profile.flush_denormals;
        const Program& program = *draw_.program;
        const VertexFetch fetch{.vertices = context_.vertices,
                                .instances = context_.instances,
                                .corners = window.by_corner ? &numbers_ : nullptr,
                                .first = window.first,
                                .base_vertex = draw_.base_vertex,
                                .vertex_id_base = numbers_.indexed() ? 0 : draw_.first,
                                .count = window.count,
                                .first_instance = draw_.first_instance,
                                .instance_begin = instances.begin,
                                .instance_count = instances.count};
        program.shade_vertices.template get<Real>()(context_.vertex_functor.data(), fetch, machine_.workers, flush,
                                                    scratch_.vertices);
        scratch_.projected.codes.clear();
        scratch_.projected.screen.clear();
        if (context_.viewports.size() == 1)
            project_vertices(scratch_.vertices, context_.setup, machine_.workers, flush, scratch_.projected);
        const BinningInput<Scalar> input{.vertices = scratch_.vertices,
                                         .assembly = assembly_,
                                         .numbers = window.by_corner ? nullptr : &numbers_,
                                         .base = window.first,
                                         .vertices_per_instance = window.count,
                                         .corners = corner_count(draw_.topology),
                                         .layered = program.layered,
                                         .linear = program.linear,
                                         .state = context_.setup,
                                         .tiles_x = context_.tiles_x,
                                         .tiles = context_.tiles_x * context_.tiles_y};
        for (std::uint64_t next = begin; next < end;) {
            next = bin_primitives(input, next, std::min(end, next + kBatchPrimitives), machine_.workers, flush,
                                  scratch_.projected, scratch_.primitives);
            draw_tiles();
        }
        if (machine_.tally != nullptr) count_vertices(fetch, begin == 0);
    }

    /// Tiles in parallel; each pixel belongs to one tile, and each tile keeps primitive order.
    void draw_tiles() {
        const BinnedPrimitives<Scalar>& binned = scratch_.primitives;
        std::mutex tally_mutex;
        machine_.workers.for_each(binned.busy_tiles.size(), [&](std::size_t i) {
            if (machine_.stop != nullptr && machine_.stop->load(std::memory_order_relaxed)) throw Stopped();
            const DenormalScope denormals(machine_.profile.flush_denormals);
            if (machine_.tally == nullptr) {
                raster_tile<Real>(context_.tiles, binned, binned.busy_tiles[i], context_.tiles_x, nullptr);
                return;
            }
            Tally local;
            raster_tile<Real>(context_.tiles, binned, binned.busy_tiles[i], context_.tiles_x, &local);
            const std::lock_guard lock(tally_mutex);
            *machine_.tally += local;
        });
        if (machine_.tally == nullptr) return;
        for (const auto& chunk : binned.chunks) machine_.tally->counters += chunk.counters;
    }

    void count_vertices(const VertexFetch& fetch, bool first_batch) {
        const std::uint64_t shaded = std::uint64_t{fetch.count} * fetch.instance_count;
        const auto floats = [](int count) { return static_cast<std::uint64_t>(count) * sizeof(float); };
        machine_.tally->counters.vertices += shaded;
        machine_.tally->read(draw_.vertices, shaded * floats(draw_.program->vertex_floats));
        if (draw_.program->instance_floats > 0)
            machine_.tally->read(draw_.instances, shaded * floats(draw_.program->instance_floats));
        // Every index once per instance, with its first batch.
        if (draw_.indices != BufferId::None && first_batch)
            machine_.tally->read(draw_.indices, std::uint64_t{draw_.count} * fetch.instance_count * numbers_.bytes_each());
    }

    const DrawContext& context_;
    const DrawMachine& machine_;
    const Draw& draw_;
    BatchScratch<Scalar>& scratch_;
    VertexNumbers numbers_;
    Assembly assembly_;
};

template <class Scalar>
std::size_t bytes_of(const BatchScratch<Scalar>& scratch) {
    const auto size = [](const auto& vector) { return vector.capacity() * sizeof(vector[0]); };
    std::size_t bytes = size(scratch.vertices.scalars) + size(scratch.projected.screen) + size(scratch.projected.codes) +
                        size(scratch.primitives.refs) + size(scratch.primitives.tile_start) +
                        size(scratch.primitives.busy_tiles);
    for (const auto& chunk : scratch.primitives.chunks)
        bytes += size(chunk.pieces) + size(chunk.bins) + size(chunk.peer_planes) +
                 chunk.peer_planes.size() * sizeof(PeerPlanes<Scalar>);
    return bytes;
}

}  // namespace

std::size_t DrawScratch::bytes() const { return bytes_of(fp32) + bytes_of(fp64); }

void run_draw(const DrawContext& context, const DrawMachine& machine) {
    if (machine.profile.arithmetic == Arithmetic::Fp32) {
        DrawRun<Float>(context, machine).run();
    } else {
        DrawRun<Double>(context, machine).run();
    }
}

}  // namespace gnomon
