#include "pipeline/primitives.h"

#include "sim/denormals.h"

#include <algorithm>

namespace gnomon {

namespace {

constexpr std::uint32_t kChunkTriangles = 1024;

/// Whether a whole tile lies outside one edge: the edge function at the tile's most inner pixel is negative.
bool tile_outside(const Edge& edge, int x0, int y0) {
    const std::int64_t reach = kTileSize - 1;
    const std::int64_t inner = std::int64_t{edge.a} * x0 + std::int64_t{edge.b} * y0 + edge.c +
                               (edge.a > 0 ? edge.a * reach : 0) + (edge.b > 0 ? edge.b * reach : 0);
    return inner < 0;
}

template <class Scalar>
void bin_triangle(TriangleChunk<Scalar>& chunk, int tiles_x) {
    const Triangle<Scalar>& triangle = chunk.triangles.back();
    const auto index = static_cast<std::uint32_t>(chunk.triangles.size() - 1);
    const int first_x = triangle.bounds.x0 / kTileSize;
    const int last_x = (triangle.bounds.x1 - 1) / kTileSize;
    const int first_y = triangle.bounds.y0 / kTileSize;
    const int last_y = (triangle.bounds.y1 - 1) / kTileSize;
    const bool single = first_x == last_x && first_y == last_y;
    for (int ty = first_y; ty <= last_y; ++ty) {
        for (int tx = first_x; tx <= last_x; ++tx) {
            if (!single && std::ranges::any_of(triangle.edges, [&](const Edge& edge) {
                    return tile_outside(edge, tx * kTileSize, ty * kTileSize);
                }))
                continue;
            chunk.bins.emplace_back(static_cast<std::uint32_t>(ty * tiles_x + tx), index);
        }
    }
}

/// Assembly, clipping and setup of one chunk.
template <class Scalar>
class ChunkBuilder {
public:
    ChunkBuilder(const VertexBlock<Scalar>& vertices, const SetupState& state, int tiles_x, TriangleChunk<Scalar>& chunk)
        : vertices_(vertices), state_(state), guard_(guard_band<double>(state.viewport)), tiles_x_(tiles_x), chunk_(chunk) {}

    void add(std::uint32_t i0, std::uint32_t i1, std::uint32_t i2) {
        ++chunk_.counters.primitives_in;
        const std::array<const Scalar*, 3> corners{vertex(i0), vertex(i1), vertex(i2)};
        const unsigned c0 = clip_code(corners[0], guard_);
        const unsigned c1 = clip_code(corners[1], guard_);
        const unsigned c2 = clip_code(corners[2], guard_);
        // Positions that are no numbers drop the primitive (D3D11.3 15.4); all outside one plane means out of sight.
        if (((c0 | c1 | c2) & kNotFinite) != 0 || (c0 & c1 & c2) != 0) {
            ++chunk_.counters.primitives_culled;
            return;
        }
        const unsigned planes = (c0 | c1 | c2) & kClipPlanes;
        const bool drawn = planes == 0 ? set_up(corners) : add_clipped(corners, planes);
        if (!drawn) ++chunk_.counters.primitives_culled;
    }

private:
    const Scalar* vertex(std::uint32_t i) const {
        return vertices_.scalars.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(vertices_.stride);
    }

    bool set_up(const std::array<const Scalar*, 3>& corners) {
        Triangle<Scalar> triangle;
        if (set_up_triangle(corners, state_, triangle) == SetupResult::Culled) return false;
        ++chunk_.counters.triangles_set_up;
        chunk_.triangles.push_back(triangle);
        bin_triangle(chunk_, tiles_x_);
        return true;
    }

    bool add_clipped(const std::array<const Scalar*, 3>& corners, unsigned planes) {
        ++chunk_.counters.primitives_clipped;
        const auto stride = static_cast<std::size_t>(vertices_.stride);
        polygon_.stride = stride;
        polygon_.vertices.clear();
        for (const Scalar* corner : corners) polygon_.vertices.insert(polygon_.vertices.end(), corner, corner + stride);
        clip(polygon_, planes, guard_);
        if (polygon_.count() < 3) return false;

        // The polygon's vertices stay with the chunk; its triangles follow from where they snap to.
        auto kept = std::make_unique<Scalar[]>(polygon_.vertices.size());
        std::ranges::transform(polygon_.vertices, kept.get(), [](double value) { return static_cast<Scalar>(value); });
        std::vector<GridPoint> corners_on_grid;
        for (std::size_t i = 0; i < polygon_.count(); ++i) {
            const auto snapped = snap_vertex(kept.get() + i * stride, state_);
            if (!snapped) return false;
            corners_on_grid.push_back(*snapped);
        }
        bool drawn = false;
        for (const auto& [a, b, c] : triangulate(corners_on_grid))
            drawn = set_up({kept.get() + a * stride, kept.get() + b * stride, kept.get() + c * stride}) || drawn;
        chunk_.clipped.push_back(std::move(kept));
        return drawn;
    }

    const VertexBlock<Scalar>& vertices_;
    const SetupState& state_;
    GuardBand<double> guard_;
    int tiles_x_;
    TriangleChunk<Scalar>& chunk_;
    ClipPolygon polygon_;
};

/// Gathers the chunks' bins into one list per tile: a counting sort that keeps the order.
template <class Scalar>
void collect_bins(int tiles, BinnedTriangles<Scalar>& out, std::size_t chunks) {
    out.tile_start.assign(static_cast<std::size_t>(tiles) + 1, 0);
    for (std::size_t c = 0; c < chunks; ++c)
        for (const auto& [tile, index] : out.chunks[c].bins) ++out.tile_start[tile + 1];
    out.busy_tiles.clear();
    for (std::size_t t = 0; t < static_cast<std::size_t>(tiles); ++t) {
        if (out.tile_start[t + 1] != 0) out.busy_tiles.push_back(static_cast<std::uint32_t>(t));
        out.tile_start[t + 1] += out.tile_start[t];
    }
    out.refs.resize(out.tile_start.back());
    std::vector<std::uint32_t> next(out.tile_start.begin(), out.tile_start.end() - 1);
    for (std::size_t c = 0; c < chunks; ++c)
        for (const auto& [tile, index] : out.chunks[c].bins) out.refs[next[tile]++] = {static_cast<std::uint32_t>(c), index};
}

}  // namespace

template <class Scalar>
void bin_triangles(const VertexBlock<Scalar>& vertices, const PrimitiveSource& source, const SetupState& state, int tiles_x,
                   int tiles, Workers& workers, bool flush_denormals, BinnedTriangles<Scalar>& out) {
    const std::uint32_t triangles = source.count / 3;
    const std::size_t chunks = (triangles + kChunkTriangles - 1) / kChunkTriangles;
    if (out.chunks.size() < chunks) out.chunks.resize(chunks);
    for (auto& chunk : out.chunks) {
        chunk.triangles.clear();
        chunk.bins.clear();
        chunk.clipped.clear();
        chunk.counters = {};
    }
    workers.for_each(chunks, [&](std::size_t c) {
        const DenormalScope denormals(flush_denormals);
        ChunkBuilder<Scalar> builder(vertices, state, tiles_x, out.chunks[c]);
        const auto begin = static_cast<std::uint32_t>(c) * kChunkTriangles;
        const std::uint32_t end = std::min(triangles, begin + kChunkTriangles);
        for (std::uint32_t t = begin; t < end; ++t) builder.add(source[3 * t], source[3 * t + 1], source[3 * t + 2]);
    });
    collect_bins(tiles, out, chunks);
}

template void bin_triangles(const VertexBlock<float>&, const PrimitiveSource&, const SetupState&, int, int, Workers&, bool,
                            BinnedTriangles<float>&);
template void bin_triangles(const VertexBlock<double>&, const PrimitiveSource&, const SetupState&, int, int, Workers&, bool,
                            BinnedTriangles<double>&);

}  // namespace gnomon
