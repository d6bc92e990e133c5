#include "pipeline/draw.h"

#include "sim/denormals.h"
#include "sim/error.h"
#include "sim/progress.h"

#include <mutex>

namespace gnomon {

namespace {

// One batch of a draw is set up and drawn before the next, so that memory stays bounded however much is drawn: small enough for
// the caches, large enough for threads not to wait for each other all the time.
constexpr std::uint32_t kBatchPrimitives = 1u << 15;
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
        if (machine_.tally != nullptr) count_vertices();
        const AssemblyCursor first = assembly_.begin();
        const Window whole = window_of(first, primitives);
        if (whole.count <= kBatchVertices) {
            // Few vertices: as many instances together as fit.
            const std::uint32_t together = std::max(1u, kBatchVertices / whole.count);
            for (std::uint32_t i = 0; i < draw_.instance_count; i += together) {
                const std::uint32_t count = std::min(together, draw_.instance_count - i);
                AssemblyCursor at = first;
                draw_window(whole, {i, count}, at, std::uint64_t{primitives} * count);
            }
            return;
        }
        // Many: the vertices of one batch of primitives at a time.
        for (std::uint32_t i = 0; i < draw_.instance_count; ++i) {
            AssemblyCursor at = first;
            for (std::uint32_t left = primitives; left != 0;) {
                const std::uint32_t count = std::min(left, kBatchPrimitives);
                draw_window(window_of(at, count), {i, 1}, at, count);
                left -= count;
            }
        }
    }

private:
    /// The vertices that some primitives use: a range of vertex numbers or, where that is mostly not used, a range of positions
    /// in the list of numbers, each shaded for itself.
    struct Window {
        bool by_position = false;
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };
    struct InstanceRange {
        std::uint32_t begin = 0;
        std::uint32_t count = 1;
    };

    /// Of so many primitives of one instance.
    Window window_of(const AssemblyCursor& at, std::uint32_t primitives) const {
        const auto [first, last] = assembly_.positions(at, primitives);
        const bool whole = primitives == assembly_.count() && numbers_.indexed();
        VertexRange range = whole ? context_.index_range : numbers_.range(first, last + 1, draw_.primitive_restart);
        std::uint32_t begin = first;
        if (draw_.topology == Topology::TriangleFan) {
            begin = at.run.begin;
            range |= numbers_.range(begin, begin + 1, false);
        }
        const std::uint64_t span = std::uint64_t{last} - begin + 1;
        if (range.size() > 2 * span + 1024) return {true, begin, static_cast<std::uint32_t>(span)};
        return {false, range.lowest, static_cast<std::uint32_t>(range.size())};
    }

    /// Draws so many primitives from the cursor on, counted through the instances, and moves it behind them.
    void draw_window(const Window& window, const InstanceRange& instances, AssemblyCursor& at, std::uint64_t primitives) {
        const bool flush = machine_.profile.flush_denormals;
        const Program& program = *draw_.program;
        const VertexFetch fetch{.vertices = context_.vertices,
                                .instances = context_.instances,
                                .corners = window.by_position ? &numbers_ : nullptr,
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
                                         .by_position = window.by_position,
                                         .base = window.first,
                                         .vertices_per_instance = window.count,
                                         .corners = corner_count(draw_.topology),
                                         .layered = program.layered,
                                         .linear = program.linear,
                                         .state = context_.setup,
                                         .tiles_x = context_.tiles_x,
                                         .tiles = context_.tiles_x * context_.tiles_y};
        while (primitives != 0) {
            primitives -= bin_primitives(input, at, std::min<std::uint64_t>(primitives, kBatchPrimitives), machine_.workers,
                                         flush, scratch_.projected, scratch_.primitives);
            draw_tiles();
        }
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

    /// Each vertex once per instance, whatever windows it is shaded in; every index once per instance.
    void count_vertices() {
        const std::uint64_t shaded = assembly_.distinct_vertices(context_.index_range) * draw_.instance_count;
        const auto floats = [](int count) { return static_cast<std::uint64_t>(count) * sizeof(float); };
        machine_.tally->counters.vertices += shaded;
        machine_.tally->read(draw_.vertices, shaded * floats(draw_.program->vertex_floats));
        if (draw_.program->instance_floats > 0)
            machine_.tally->read(draw_.instances, shaded * floats(draw_.program->instance_floats));
        if (draw_.indices != BufferId::None)
            machine_.tally->read(draw_.indices, std::uint64_t{draw_.count} * draw_.instance_count * numbers_.bytes_each());
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
    bytes += size(scratch.primitives.chunks);
    for (const auto& chunk : scratch.primitives.chunks) {
        bytes += size(chunk.pieces) + size(chunk.bins) + size(chunk.clipped) + size(chunk.outlines) + size(chunk.peer_planes);
        for (const auto& vertices : chunk.clipped) bytes += size(vertices);
        for (const auto& outline : chunk.outlines) bytes += sizeof(Outline) + size(outline->points);
        bytes += chunk.peer_planes.size() * sizeof(PeerPlanes<Scalar>);
    }
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
