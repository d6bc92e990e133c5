#include "pipeline/binning.h"

#include "pipeline/peer_clip.h"
#include "pipeline/peer_planes.h"
#include "pipeline/peer_setup.h"
#include "sim/denormals.h"

#include <algorithm>

namespace gnomon {

namespace {

constexpr std::uint64_t kChunkPrimitives = 1024;
constexpr std::uint64_t kAssembledTogether = 64;
// A chunk ends early where its bins grow beyond this: large primitives on a large target fall into many tiles each.
constexpr std::size_t kChunkBins = 1u << 17;

/// Whether a whole tile lies outside one edge: the edge function is negative even at the tile's most inner sample.
bool tile_outside(const Edge& edge, int x0, int y0, const PixelRect& samples) {
    constexpr std::int64_t kReach = (kTileSize - 1) * kSubpixels;
    const std::int64_t x = std::int64_t{x0} * kSubpixels + (edge.a > 0 ? kReach + samples.x1 : samples.x0);
    const std::int64_t y = std::int64_t{y0} * kSubpixels + (edge.b > 0 ? kReach + samples.y1 : samples.y0);
    return edge.a * x + edge.b * y + edge.c < 0;
}

/// Clipping and setup of one chunk.
template <class Scalar>
class ChunkBuilder {
public:
    ChunkBuilder(const BinningInput<Scalar>& input, const ProjectedVertices<Scalar>& projected, PrimitiveChunk<Scalar>& chunk)
        : input_(input), state_(input.state), projected_(projected), chunk_(chunk), stride_(input.vertices.stride) {}

    void add(const AssembledPrimitive& assembled, std::uint32_t instance, std::uint32_t id) {
        ++chunk_.counters.primitives_in;
        const std::size_t first = std::size_t{instance} * input_.vertices_per_instance;
        const auto position = [&](std::uint32_t vertex) { return first + (vertex - input_.base); };
        const std::array<std::size_t, 3> at{position(assembled.vertex[0]), position(assembled.vertex[1]),
                                            position(assembled.vertex[2])};

        PrimitiveHead<Scalar> head{.id = id};
        const Scalar* provoking = record(position(assembled.provoking));
        head.flat = provoking + kPositionScalars;
        if (input_.layered) {
            const auto index = [&](int from_end, int limit) {
                const auto value = static_cast<int>(provoking[stride_ - from_end]);
                return value >= 0 && value < limit ? value : 0;
            };
            head.layer = static_cast<std::uint16_t>(index(2, state_.layers));
            head.viewport = static_cast<std::uint32_t>(index(1, static_cast<int>(state_.viewports.size())));
        }
        viewport_ = &state_.viewports[head.viewport];

        bool drawn = false;
        switch (input_.corners) {
            case 1: drawn = add_point(at[0], head); break;
            case 2: drawn = add_line({at[0], at[1]}, head); break;
            default: drawn = add_triangle(at, head); break;
        }
        ++(drawn ? chunk_.counters.primitives_drawn : chunk_.counters.primitives_culled);
    }

private:
    const Scalar* record(std::size_t position) const {
        return input_.vertices.scalars.data() + position * static_cast<std::size_t>(stride_);
    }
    std::uint32_t code(std::size_t position) const {
        if (!projected_.codes.empty()) return projected_.codes[position];
        return clip_code(record(position), viewport_->guard, state_.raster.depth_clip);
    }
    SetupVertex<Scalar> setup_vertex(std::size_t position) const {
        const Scalar* from = record(position);
        if (!projected_.screen.empty()) return {from, projected_.screen[position]};
        return {from, project(from, viewport_->viewport, state_)};
    }

    bool add_point(std::size_t at, const PrimitiveHead<Scalar>& head) {
        if ((code(at) & (kClipPlanes | kNotFinite)) != 0) return false;
        const SetupVertex<Scalar> centre = setup_vertex(at);
        if (!centre.screen.valid) return false;
        std::array<Primitive<Scalar>, 2> pieces;
        return keep(pieces, set_up_point(centre, head, state_, pieces));
    }

    bool add_line(const std::array<std::size_t, 2>& at, const PrimitiveHead<Scalar>& head) {
        const std::uint32_t c0 = code(at[0]);
        const std::uint32_t c1 = code(at[1]);
        if (((c0 | c1) & kNotFinite) != 0 || (c0 & c1 & kClipPlanes) != 0) return false;
        const std::uint32_t planes = (c0 | c1) & kClipPlanes;
        if (planes == 0) return draw_line({setup_vertex(at[0]), setup_vertex(at[1])}, head, Scalar(0), true);

        ++chunk_.counters.primitives_clipped;
        begin_polygon();
        for (const std::size_t position : at) append_to_polygon(record(position));
        clip_line(polygon_, planes, viewport_->guard);
        if (polygon_.count() < 2) return false;
        const Scalar* kept = keep_polygon();
        return draw_line({clipped_vertex(kept, 0), clipped_vertex(kept, 1)}, head, Scalar(0), true);
    }

    bool add_triangle(const std::array<std::size_t, 3>& at, const PrimitiveHead<Scalar>& head) {
        const std::uint32_t c0 = code(at[0]);
        const std::uint32_t c1 = code(at[1]);
        const std::uint32_t c2 = code(at[2]);
        // Positions that are no numbers drop the primitive (D3D11.3 15.4); all outside one plane means out of sight.
        const bool wide = state_.raster.fill == FillMode::Wireframe;
        if (((c0 | c1 | c2) & kNotFinite) != 0 || (c0 & c1 & c2 & (wide ? kClipPlanes : ~0u)) != 0) return false;
        const std::uint32_t planes = (c0 | c1 | c2) & kClipPlanes;
        const std::array<const Scalar*, 3> corners{record(at[0]), record(at[1]), record(at[2])};
        if (planes != 0 && !wide && state_.clipping != Clipping::GuardBand) return add_clipped_by_driver(corners, planes, head);
        if (planes != 0) return add_clipped(corners, planes, head);
        const std::array<SetupVertex<Scalar>, 3> v{setup_vertex(at[0]), setup_vertex(at[1]), setup_vertex(at[2])};
        if (!v[0].screen.valid || !v[1].screen.valid || !v[2].screen.valid) return false;
        if (!wide) {
            if (state_.winding_area == WindingArea::Float32) {
                const std::int64_t area = signed_area(v[0].screen.at, v[1].screen.at, v[2].screen.at);
                if (turns_counter_clockwise(corners, viewport_->viewport, state_) != (area < 0)) return false;
            }
            return draw_triangle(v, head);
        }

        const Facing facing = facing_of(signed_area(v[0].screen.at, v[1].screen.at, v[2].screen.at), state_.raster);
        if (facing.culled) return false;
        const Scalar bias = triangle_depth_bias(v, state_);
        bool drawn = false;
        for (std::size_t i = 0; i < 3; ++i) drawn = draw_line({v[i], v[(i + 1) % 3]}, head, bias, facing.front) || drawn;
        return drawn;
    }

    bool add_clipped(const std::array<const Scalar*, 3>& corners, std::uint32_t planes, const PrimitiveHead<Scalar>& head) {
        ++chunk_.counters.primitives_clipped;
        begin_polygon();
        for (const Scalar* corner : corners) append_to_polygon(corner);
        clip(polygon_, planes, viewport_->guard);
        if (polygon_.count() < 3) return false;

        // The polygon's vertices stay with the chunk; its triangles follow from where they snap to.
        const Scalar* kept = keep_polygon();
        std::vector<SetupVertex<Scalar>> vertices;
        std::vector<GridPoint> corners_on_grid;
        for (std::size_t i = 0; i < polygon_.count(); ++i) {
            vertices.push_back(clipped_vertex(kept, i));
            if (!vertices.back().screen.valid) return false;
            corners_on_grid.push_back(vertices.back().screen.at);
        }
        const auto pieces = triangulate(corners_on_grid);
        bool drawn = false;
        if (state_.raster.fill == FillMode::Solid) {
            for (const auto& [a, b, c] : pieces) drawn = draw_triangle({vertices[a], vertices[b], vertices[c]}, head) || drawn;
            return drawn;
        }

        // A line for what is left of each original edge; facing is the polygon's, bias that of the edge's triangle, as where it
        // is solid. D3D11.3 15.13
        std::int64_t area = 0;
        for (const auto& [a, b, c] : pieces) area += signed_area(corners_on_grid[a], corners_on_grid[b], corners_on_grid[c]);
        const Facing facing = facing_of(area, state_.raster);
        if (facing.culled) return false;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (polygon_.edges[i] == 0) continue;
            const auto [a, b, c] = piece_at_edge(pieces, i, vertices.size());
            const Scalar bias = triangle_depth_bias<Scalar>({vertices[a], vertices[b], vertices[c]}, state_);
            drawn = draw_line({vertices[i], vertices[(i + 1) % vertices.size()]}, head, bias, facing.front) || drawn;
        }
        return drawn;
    }
    /// The triangle of a polygon that has the edge from corner `i` on. Where that one has no area it is not among the pieces:
    /// then one that has an end of the edge.
    static std::array<std::size_t, 3> piece_at_edge(const std::vector<std::array<std::size_t, 3>>& pieces, std::size_t i,
                                                    std::size_t corners) {
        const std::size_t next = (i + 1) % corners;
        std::array<std::size_t, 3> best{i, next, (i + 2) % corners};
        int most = 0;
        for (const auto& piece : pieces) {
            const auto ends = static_cast<int>(std::ranges::count(piece, i) + std::ranges::count(piece, next));
            if (ends > most) best = piece;
            most = std::max(most, ends);
        }
        return best;
    }

    /// As llvmpipe or SwiftShader clips: a fan of triangles, or one polygon with the planes of the whole triangle.
    bool add_clipped_by_driver(const std::array<const Scalar*, 3>& corners, std::uint32_t planes,
                               const PrimitiveHead<Scalar>& head) {
        ++chunk_.counters.primitives_clipped;
        const ClippedTriangle<Scalar> clipped(corners, static_cast<std::size_t>(stride_), planes, input_.linear,
                                              state_.clipping);
        const std::size_t count = clipped.made.size();
        if (count < 3) return false;
        chunk_.clipped.emplace_back(clipped.records.begin(), clipped.records.end());
        std::vector<SetupVertex<Scalar>> v;
        for (std::size_t i = 0; i < count; ++i) {
            const Scalar* from = chunk_.clipped.back().data() + i * static_cast<std::size_t>(stride_);
            v.push_back({from, project(from, viewport_->viewport, state_, clipped.made[i] != 0)});
            if (!v.back().screen.valid) return false;
        }
        if (state_.clipping == Clipping::SwiftShader) return draw_outline(v, corners, head);
        bool drawn = false;
        for (std::size_t i = 2; i < count; ++i) drawn = draw_triangle({v[0], v[i - 1], v[i]}, head) || drawn;
        return drawn;
    }

    bool draw_outline(const std::vector<SetupVertex<Scalar>>& v, const std::array<const Scalar*, 3>& corners,
                      const PrimitiveHead<Scalar>& head) {
        auto outline = std::make_unique<Outline>();
        GridPoint low = v[0].screen.at;
        GridPoint high = low;
        for (const SetupVertex<Scalar>& vertex : v) {
            const GridPoint& at = vertex.screen.at;
            outline->points.push_back(at);
            low = {std::min(low.x, at.x), std::min(low.y, at.y)};
            high = {std::max(high.x, at.x), std::max(high.y, at.y)};
        }
        std::int64_t area = 0;
        for (std::size_t i = 2; i < v.size(); ++i) area += signed_area(v[0].screen.at, v[i - 1].screen.at, v[i].screen.at);
        outline->counter_clockwise = state_.winding_area == WindingArea::Float32
                                         ? turns_counter_clockwise(corners, viewport_->viewport, state_)
                                         : area < 0;
        const PixelRect bounds = pixel_bounds(low, high, head.viewport, state_);
        if (bounds.empty() || facing_of(outline->counter_clockwise ? -1 : 1, state_.raster).culled) return false;

        // Varyings go through the three corners that span the most.
        OutlineCorners<Scalar> planes;
        std::int64_t widest = 0;
        for (std::size_t i = 0; i < v.size(); ++i) {
            for (std::size_t j = i + 1; j < v.size(); ++j) {
                for (std::size_t k = j + 1; k < v.size(); ++k) {
                    const std::int64_t size = std::abs(signed_area(v[i].screen.at, v[j].screen.at, v[k].screen.at));
                    if (size <= widest) continue;
                    widest = size;
                    planes.polygon = {v[i], v[j], v[k]};
                }
            }
        }
        if (widest == 0) return false;
        for (std::size_t i = 0; i < 3; ++i) planes.triangle[i] = {corners[i], project(corners[i], viewport_->viewport, state_)};
        chunk_.outlines.push_back(std::move(outline));
        Primitive<Scalar>& piece = chunk_.pieces.emplace_back();
        set_up_outline(planes, *chunk_.outlines.back(), bounds, head, state_, piece);
        piece.peer_planes = peer_planes(planes.triangle, head);
        bin(chunk_.pieces.size() - 1);
        return true;
    }

    void begin_polygon() {
        polygon_.stride = static_cast<std::size_t>(stride_);
        polygon_.vertices.clear();
        polygon_.edges.assign(3, char{1});
        polygon_.linear = input_.linear;
    }
    void append_to_polygon(const Scalar* corner) {
        polygon_.vertices.insert(polygon_.vertices.end(), corner, corner + stride_);
    }
    const Scalar* keep_polygon() {
        std::vector<Scalar>& kept = chunk_.clipped.emplace_back(polygon_.vertices.size());
        std::ranges::transform(polygon_.vertices, kept.begin(), [](double value) { return static_cast<Scalar>(value); });
        return kept.data();
    }
    SetupVertex<Scalar> clipped_vertex(const Scalar* kept, std::size_t i) const {
        const Scalar* from = kept + i * static_cast<std::size_t>(stride_);
        return {from, project(from, viewport_->viewport, state_)};
    }

    /// Of varyings, where the profile has them.
    const PeerPlanes<Scalar>* peer_planes(const std::array<SetupVertex<Scalar>, 3>& vertices,
                                          const PrimitiveHead<Scalar>& head) {
        if (state_.plane_equations == PlaneEquations::Barycentric || stride_ == kPositionScalars) return nullptr;
        const Viewport& viewport = state_.viewports[head.viewport].viewport;
        chunk_.peer_planes.push_back(std::make_unique<PeerPlanes<Scalar>>(make_peer_planes(vertices, viewport, state_)));
        return chunk_.peer_planes.back().get();
    }

    bool draw_triangle(const std::array<SetupVertex<Scalar>, 3>& vertices, const PrimitiveHead<Scalar>& head) {
        Primitive<Scalar>& piece = chunk_.pieces.emplace_back();
        if (set_up_triangle(vertices, head, state_, piece)) {
            piece.peer_planes = peer_planes(vertices, head);
            bin(chunk_.pieces.size() - 1);
            return true;
        }
        chunk_.pieces.pop_back();
        return false;
    }
    bool draw_line(const std::array<SetupVertex<Scalar>, 2>& ends, const PrimitiveHead<Scalar>& head, Scalar bias, bool front) {
        if (!ends[0].screen.valid || !ends[1].screen.valid) return false;
        std::array<Primitive<Scalar>, 2> pieces;
        return keep(pieces, set_up_line(ends, head, bias, front, state_, pieces));
    }
    bool keep(const std::array<Primitive<Scalar>, 2>& pieces, int count) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            chunk_.pieces.push_back(pieces[i]);
            bin(chunk_.pieces.size() - 1);
        }
        return count > 0;
    }

    void bin(std::size_t index) {
        const Primitive<Scalar>& piece = chunk_.pieces[index];
        const int first_x = piece.bounds.x0 / kTileSize;
        const int last_x = (piece.bounds.x1 - 1) / kTileSize;
        const int first_y = piece.bounds.y0 / kTileSize;
        const int last_y = (piece.bounds.y1 - 1) / kTileSize;
        const bool whole = (first_x == last_x && first_y == last_y) || piece.shape != PrimitiveShape::Triangle;
        for (int ty = first_y; ty <= last_y; ++ty) {
            for (int tx = first_x; tx <= last_x; ++tx) {
                if (!whole && std::ranges::any_of(piece.edges, [&](const Edge& edge) {
                        return tile_outside(edge, tx * kTileSize, ty * kTileSize, state_.sample_extent);
                    }))
                    continue;
                chunk_.bins.emplace_back(static_cast<std::uint32_t>(ty * input_.tiles_x + tx),
                                         static_cast<std::uint32_t>(index));
            }
        }
    }

    const BinningInput<Scalar>& input_;
    const SetupState& state_;
    const ProjectedVertices<Scalar>& projected_;
    PrimitiveChunk<Scalar>& chunk_;
    int stride_;
    const ViewportTransform* viewport_ = nullptr;  // of the primitive at hand
    ClipPolygon polygon_;
};

/// Gathers the chunks' bins into one list per tile: a counting sort that keeps the order.
template <class Scalar>
void collect_bins(int tiles, BinnedPrimitives<Scalar>& out, std::size_t chunks) {
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
void project_vertices(const VertexBlock<Scalar>& vertices, const SetupState& state, Workers& workers, bool flush_denormals,
                      ProjectedVertices<Scalar>& out) {
    constexpr std::size_t kPiece = 1024;
    const auto stride = static_cast<std::size_t>(vertices.stride);
    const std::size_t count = vertices.scalars.size() / stride;
    out.screen.resize(count);
    out.codes.resize(count);
    const ViewportTransform& viewport = state.viewports.front();
    workers.for_each((count + kPiece - 1) / kPiece, [&](std::size_t piece) {
        const DenormalScope denormals(flush_denormals);
        for (std::size_t i = piece * kPiece; i < std::min(count, (piece + 1) * kPiece); ++i) {
            const Scalar* record = vertices.scalars.data() + i * stride;
            out.codes[i] = clip_code(record, viewport.guard, state.raster.depth_clip);
            if ((out.codes[i] & (kClipPlanes | kNotFinite)) == 0) out.screen[i] = project(record, viewport.viewport, state);
        }
    });
}

template <class Scalar>
std::uint64_t bin_primitives(const BinningInput<Scalar>& input, AssemblyCursor& at, std::uint64_t count, Workers& workers,
                             bool flush_denormals, const ProjectedVertices<Scalar>& projected, BinnedPrimitives<Scalar>& out) {
    const auto chunks = static_cast<std::size_t>((count + kChunkPrimitives - 1) / kChunkPrimitives);
    if (out.chunks.size() < chunks) out.chunks.resize(chunks);
    const auto clear = [](PrimitiveChunk<Scalar>& chunk) {
        chunk.pieces.clear();
        chunk.bins.clear();
        chunk.clipped.clear();
        chunk.taken = 0;
        chunk.outlines.clear();
        chunk.peer_planes.clear();
        chunk.counters = {};
    };
    for (auto& chunk : out.chunks) clear(chunk);
    for (std::size_t c = 0; c < chunks; ++c) {
        out.chunks[c].at = at;
        if (c + 1 < chunks) input.assembly.advance(at, kChunkPrimitives);
    }
    workers.for_each(chunks, [&](std::size_t c) {
        const DenormalScope denormals(flush_denormals);
        PrimitiveChunk<Scalar>& chunk = out.chunks[c];
        ChunkBuilder<Scalar> builder(input, projected, chunk);
        const std::uint64_t limit = std::min(count - c * kChunkPrimitives, kChunkPrimitives);
        std::array<AssembledPrimitive, kAssembledTogether> group;
        for (AssemblyCursor next = chunk.at; chunk.taken < limit && chunk.bins.size() < kChunkBins;) {
            const AssemblyCursor first = next;
            const std::size_t wanted = std::min(limit - chunk.taken, kAssembledTogether);
            const std::size_t taken = input.assembly.take(next, input.by_position, std::span(group).first(wanted));
            for (std::uint32_t i = 0; i < taken && chunk.bins.size() < kChunkBins; ++i, ++chunk.taken)
                builder.add(group[i], first.instance, first.id + i);
        }
    });

    // Where a chunk ended early, the batch ends with it: those behind wait for the next.
    std::uint64_t taken = 0;
    std::size_t kept = 0;
    while (kept < chunks && taken == kept * kChunkPrimitives) taken += out.chunks[kept++].taken;
    for (std::size_t c = kept; c < chunks; ++c) clear(out.chunks[c]);
    collect_bins(input.tiles, out, kept);
    at = out.chunks[kept - 1].at;
    input.assembly.advance(at, out.chunks[kept - 1].taken);
    return taken;
}

#define GNOMON_INSTANTIATE(Scalar)                                                                                             \
    template void project_vertices(const VertexBlock<Scalar>&, const SetupState&, Workers&, bool, ProjectedVertices<Scalar>&); \
    template std::uint64_t bin_primitives(const BinningInput<Scalar>&, AssemblyCursor&, std::uint64_t, Workers&, bool,         \
                                          const ProjectedVertices<Scalar>&, BinnedPrimitives<Scalar>&);
GNOMON_INSTANTIATE(float)
GNOMON_INSTANTIATE(double)
#undef GNOMON_INSTANTIATE

}  // namespace gnomon
