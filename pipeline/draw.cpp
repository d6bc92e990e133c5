#include "pipeline/draw.h"

#include "sim/denormals.h"
#include "sim/error.h"
#include "sim/progress.h"

#include <mutex>

namespace gnomon {

namespace {

// One batch of a draw is set up and drawn before the next, so that memory stays bounded however much is drawn.
constexpr std::uint64_t kBatchPrimitives = 1u << 16;
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
        if (assembly_.count() == 0 || draw_.instance_count == 0) return;
        // A range of vertices that is mostly not used is not worth shading: then every corner is shaded for itself.
        const std::uint64_t range = std::uint64_t{context_.highest} - context_.lowest + 1;
        const bool by_corner = range > 2 * std::uint64_t{draw_.count} + 1024;
        VertexFetch fetch{.vertices = context_.vertices,
                          .instances = context_.instances,
                          .corners = by_corner ? &numbers_ : nullptr,
                          .first = context_.lowest,
                          .base_vertex = draw_.base_vertex,
                          .vertex_id_base = numbers_.indexed() ? 0 : draw_.first,
                          .count = by_corner ? draw_.count : static_cast<std::uint32_t>(range),
                          .first_instance = draw_.first_instance};
        const std::uint32_t together = std::max(1u, kBatchVertices / fetch.count);
        for (std::uint32_t i = 0; i < draw_.instance_count;) {
            fetch.instance_begin = i;
            fetch.instance_count = std::min(together, draw_.instance_count - i);
            draw_instances(fetch);
            i += fetch.instance_count;
        }
    }

private:
    void draw_instances(const VertexFetch& fetch) {
        const bool flush = machine_.profile.flush_denormals;
        const Program& program = *draw_.program;
        program.shade_vertices.template get<Real>()(context_.vertex_functor.data(), fetch, machine_.workers, flush,
                                                    scratch_.vertices);
        scratch_.projected.codes.clear();
        scratch_.projected.screen.clear();
        if (context_.viewports.size() == 1)
            project_vertices(scratch_.vertices, context_.setup, machine_.workers, flush, scratch_.projected);
        const BinningInput<Scalar> input{.vertices = scratch_.vertices,
                                         .assembly = assembly_,
                                         .numbers = fetch.corners == nullptr ? &numbers_ : nullptr,
                                         .number_base = fetch.first,
                                         .vertices_per_instance = fetch.count,
                                         .corners = corner_count(draw_.topology),
                                         .layered = program.layered,
                                         .linear = program.linear,
                                         .state = context_.setup,
                                         .tiles_x = context_.tiles_x,
                                         .tiles = context_.tiles_x * context_.tiles_y};
        const std::uint64_t primitives = std::uint64_t{assembly_.count()} * fetch.instance_count;
        for (std::uint64_t begin = 0; begin < primitives; begin += kBatchPrimitives) {
            bin_primitives(input, begin, std::min(primitives, begin + kBatchPrimitives), machine_.workers, flush,
                           scratch_.projected, scratch_.primitives);
            draw_tiles();
        }
        if (machine_.tally != nullptr) count_vertices(fetch);
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

    void count_vertices(const VertexFetch& fetch) {
        const std::uint64_t shaded = std::uint64_t{fetch.count} * fetch.instance_count;
        const auto floats = [](int count) { return static_cast<std::uint64_t>(count) * sizeof(float); };
        machine_.tally->counters.vertices += shaded;
        machine_.tally->read(draw_.vertices, shaded * floats(draw_.program->vertex_floats));
        if (draw_.program->instance_floats > 0)
            machine_.tally->read(draw_.instances, shaded * floats(draw_.program->instance_floats));
        if (draw_.indices != BufferId::None)
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
    for (const auto& chunk : scratch.primitives.chunks) bytes += size(chunk.pieces) + size(chunk.bins);
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
