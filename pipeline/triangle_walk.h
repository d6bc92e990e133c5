// From a triangle to the rows of quads it covers inside one tile: blocks first, many at a time, then rows.
#pragma once

#include "pipeline/coverage.h"

namespace gnomon {

/// The pixels that a walk goes through.
struct WalkArea {
    PixelRect tile;
    PixelRect visible;  // what viewport and scissor leave of the target
    int row_end = 0;    // rows of quads end here: a multiple of kBlockSize inside the tile
};

/// Few pixels: the cost of a look at blocks is more than they are worth.
inline bool is_small(const PixelRect& bounds) { return bounds.x1 - bounds.x0 + bounds.y1 - bounds.y0 < kBlockSize; }

inline bool contains(const PixelRect& outer, const PixelRect& inner) {
    return inner.x0 >= outer.x0 && inner.y0 >= outer.y0 && inner.x1 <= outer.x1 && inner.y1 <= outer.y1;
}

/// Goes through the samples of one tile that a triangle covers. `Client` has
///   std::uint32_t hidden(int n, std::uint32_t blocks): of the blocks n, n + 1, ... whose bits are set those to leave out;
///   void begin_whole_block(), end_whole_block(int n): around the rows of a block that is covered as a whole;
///   void add(const QuadRow&, std::uint32_t covered, Samples&): lanes with a covered sample, and each sample's in
///   Samples::covered, LanesBySample of one or kMaxSamples.
template <class Samples, class Client>
class TriangleWalk {
public:
    TriangleWalk(const SamplePattern& pattern, const WalkArea& area, Client& client)
        : pattern_(pattern), area_(area), client_(client) {}

    /// `bounds` are the pixels that the triangle may cover, inside area.visible. False: none of them is in the tile.
    bool walk(const std::array<Edge, 3>& triangle, const PixelRect& bounds) {
        touched_ = intersect(bounds, area_.tile);
        if (is_small(bounds) && has_short_edges(triangle)) {
            walk_small(triangle);
            return true;
        }
        const TileEdges edges(triangle, pattern_, area_.tile.x0, area_.tile.y0);
        if (edges.outside) return false;
        walk_blocks(edges);
        return true;
    }

private:
    static constexpr bool kMulti = std::tuple_size_v<decltype(Samples::covered)> > 1;
    [[nodiscard]] std::size_t sample_count() const { return kMulti ? static_cast<std::size_t>(pattern_.count) : 1; }

    void walk_small(const std::array<Edge, 3>& triangle) {
        const int first_x = std::min(touched_.x0 & ~1, area_.row_end - kWaveWidth);
        const int first_y = touched_.y0 & ~1;
        const TileEdges edges = TileEdges::around(triangle, pattern_, first_x, first_y);
        const LaneSteps steps(edges);
        for (int y = first_y; y < touched_.y1; y += kWaveHeight)
            for (int x = first_x; x < touched_.x1; x += kWaveWidth) add_row({x, y}, edges, steps, x - first_x, y - first_y);
    }

    void walk_blocks(const TileEdges& edges) {
        const LaneSteps steps(edges);
        const int x0 = (touched_.x0 - area_.tile.x0) / kBlockSize;
        const int x1 = (touched_.x1 - 1 - area_.tile.x0) / kBlockSize;
        const int y0 = (touched_.y0 - area_.tile.y0) / kBlockSize;
        const int y1 = (touched_.y1 - 1 - area_.tile.y0) / kBlockSize;
        // The blocks that the bounds touch, as bits. D3D11.3 3.4.2 names no order.
        const std::uint64_t columns = ((std::uint64_t{2} << x1) - (std::uint64_t{1} << x0)) * 0x0101010101010101u;
        const std::uint64_t wanted = columns & (~std::uint64_t{0} << (kBlocksPerTile * y0)) &
                                     (~std::uint64_t{0} >> (kBlocksPerTile * (kBlocksPerTile - 1 - y1)));
        static_assert(kBlocksPerTile == 8 && kBlocksPerTile * kBlocksPerTile % kLanes == 0);
        for (int n = kBlocksPerTile * y0 / kLanes * kLanes; n < kBlocksPerTile * (y1 + 1); n += kLanes) {
            auto blocks = static_cast<std::uint32_t>(wanted >> n) & kAllLanes;
            if (blocks == 0) continue;
            const BlockBits here = classify_blocks(edges, n);
            blocks &= ~here.outside;
            if (blocks != 0) blocks &= ~client_.hidden(n, blocks);
            for (; blocks != 0; blocks &= blocks - 1) {
                const int lane = std::countr_zero(blocks);
                const int block = n + lane;
                walk_block(edges, steps, (here.inside >> lane & 1u) != 0, block);
            }
        }
    }

    /// The rows and columns of waves that the bounds touch.
    void walk_block(const TileEdges& edges, const LaneSteps& steps, bool inside, int block) {
        const int dx = block % kBlocksPerTile * kBlockSize;
        const int dy = block / kBlocksPerTile * kBlockSize;
        const int x = area_.tile.x0 + dx;
        const int y = area_.tile.y0 + dy;
        const int first_y = std::max(0, touched_.y0 - y) & ~(kWaveHeight - 1);
        const int first_x = std::max(0, touched_.x0 - x) & ~(kWaveWidth - 1);
        const int end_y = std::min(kBlockSize, touched_.y1 - y);
        const int end_x = std::min(kBlockSize, touched_.x1 - x);
        if (!inside || !contains(area_.visible, {x, y, x + kBlockSize, y + kBlockSize})) {
            for (int v = first_y; v < end_y; v += kWaveHeight)
                for (int u = first_x; u < end_x; u += kWaveWidth) add_row({x + u, y + v}, edges, steps, dx + u, dy + v);
            return;
        }
        client_.begin_whole_block();
        for (int v = 0; v < kBlockSize; v += kWaveHeight) {
            for (int u = 0; u < kBlockSize; u += kWaveWidth) {
                Samples samples;
                for (std::size_t s = 0; s < sample_count(); ++s) samples.covered[s] = kAllLanes;
                client_.add({x + u, y + v}, kAllLanes, samples);
            }
        }
        client_.end_whole_block(block);
    }

    /// The row at (dx, dy) from where the edges begin.
    void add_row(const QuadRow& row, const TileEdges& edges, const LaneSteps& steps, int dx, int dy) {
        // The bounds of the triangle itself cut nothing off, what is visible may.
        const bool all = contains(area_.visible, {row.x, row.y, row.x + kWaveWidth, row.y + kWaveHeight});
        const std::uint32_t inside = all ? kAllLanes : lanes_inside(area_.visible, row.x, row.y);
        const std::array<Int, 3> values = edge_values(edges, edges.value, steps, dx, dy);
        Samples samples;
        std::uint32_t covered = samples.covered[0] = coverage(values) & inside;
        if constexpr (kMulti) {
            for (std::size_t s = 1; s < sample_count(); ++s)
                covered |= samples.covered[s] = coverage(values, edges, s) & inside;
        }
        if (covered != 0) client_.add(row, covered, samples);
    }

    const SamplePattern& pattern_;
    const WalkArea area_;
    Client& client_;
    PixelRect touched_;  // by the triangle at hand
};

}  // namespace gnomon
