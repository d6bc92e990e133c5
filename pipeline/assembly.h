// Vertices to primitives: indices, restart, strips and fans. D3D11.3 8.10, 8.12 to 8.14
#pragma once

#include "pipeline/state.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

namespace gnomon {

/// The lowest and the highest of some vertex numbers; lowest > highest where there is none.
struct VertexRange {
    std::uint32_t lowest = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t highest = 0;

    [[nodiscard]] bool empty() const { return lowest > highest; }
    [[nodiscard]] std::uint64_t size() const { return empty() ? 0 : std::uint64_t{highest} - lowest + 1; }
    VertexRange& operator|=(const VertexRange& other) {
        lowest = std::min(lowest, other.lowest);
        highest = std::max(highest, other.highest);
        return *this;
    }
};

/// The vertex numbers of a draw: its indices, or 0, 1, 2, ...
class VertexNumbers {
public:
    /// `data` is empty for draws without indices.
    VertexNumbers(std::span<const std::byte> data, IndexType type, std::uint32_t first, std::uint32_t count)
        : data_(data.data()), type_(type), first_(first), count_(count) {}

    [[nodiscard]] std::uint32_t count() const { return count_; }
    [[nodiscard]] bool indexed() const { return data_ != nullptr; }
    [[nodiscard]] std::size_t bytes_each() const { return data_ == nullptr ? 0 : type_ == IndexType::Uint16 ? 2 : 4; }
    /// The index that restarts. D3D11.3 8.12
    [[nodiscard]] std::uint32_t restart() const { return type_ == IndexType::Uint16 ? 0xffffu : 0xffffffffu; }

    /// Calls body(number) with what maps a position to its vertex number, and returns what that returns: one loop for each way
    /// that the numbers are stored.
    template <class Body>
    auto read(const Body& body) const {
        if (data_ == nullptr) return body([this](std::uint32_t i) { return first_ + i; });
        if (type_ == IndexType::Uint16)
            return body([from = data_ + std::size_t{first_} * 2](std::uint32_t i) {
                std::uint16_t value = 0;
                std::memcpy(&value, from + std::size_t{i} * 2, 2);
                return std::uint32_t{value};
            });
        return body([from = data_ + std::size_t{first_} * 4](std::uint32_t i) {
            std::uint32_t value = 0;
            std::memcpy(&value, from + std::size_t{i} * 4, 4);
            return value;
        });
    }
    [[nodiscard]] std::uint32_t operator[](std::uint32_t i) const {
        return read([&](const auto& number) { return number(i); });
    }

    /// Of positions [begin, end), where `restarts` without those that restart.
    [[nodiscard]] VertexRange range(std::uint32_t begin, std::uint32_t end, bool restarts) const;
    /// The first position in [begin, end) that restarts, or `end`.
    [[nodiscard]] std::uint32_t next_restart(std::uint32_t begin, std::uint32_t end) const;

private:
    const std::byte* data_;
    IndexType type_;
    std::uint32_t first_;
    std::uint32_t count_;
};

/// A primitive: its vertices, as numbers or as positions in the list of numbers.
struct AssembledPrimitive {
    std::array<std::uint32_t, 3> vertex{};  // of which a line uses two and a point one
    std::uint32_t provoking = 0;            // one of them
};

/// Corners of a primitive. D3D11.3 8.10
constexpr int corner_count(Topology topology) {
    switch (topology) {
        case Topology::PointList: return 1;
        case Topology::LineList:
        case Topology::LineStrip: return 2;
        case Topology::TriangleList:
        case Topology::TriangleStrip:
        case Topology::TriangleFan: return 3;
    }
    __builtin_unreachable();
}

/// Positions [begin, end) between two restarts, as a list of its own.
struct AssemblyRun {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t primitives = 0;
};

/// A place in the primitives of all instances, one instance behind the other.
struct AssemblyCursor {
    std::uint32_t instance = 0;
    std::uint32_t id = 0;  // of the primitive, in its instance
    AssemblyRun run;       // that it is in
    std::uint32_t in_run = 0;
};

/// The primitives of a draw, in order. It holds nothing per primitive: restarts are looked for on the way.
class Assembly {
public:
    Assembly(const VertexNumbers& numbers, Topology topology, ProvokingVertex provoking, bool restart);

    /// Primitives of one instance.
    [[nodiscard]] std::uint32_t count() const { return count_; }

    /// The first primitive. `count` is not 0, here and below.
    [[nodiscard]] AssemblyCursor begin() const;
    /// Goes on by so many primitives.
    void advance(AssemblyCursor& cursor, std::uint64_t primitives) const;

    /// Puts primitives at the cursor into `out` and goes on behind them: as many as fit, but none of another run. Returns how
    /// many. Their vertices are numbers, or positions where `by_position`.
    std::size_t take(AssemblyCursor& cursor, bool by_position, std::span<AssembledPrimitive> out) const;

    /// Positions that the next primitives of this instance, at least one and at most to its end, lie between: all of their
    /// corners but the first vertex of the fan at the cursor, which is `run.begin`.
    struct Positions {
        std::uint32_t first;
        std::uint32_t last;
    };
    [[nodiscard]] Positions positions(const AssemblyCursor& cursor, std::uint32_t primitives) const;

    /// Distinct vertex numbers of all primitives of an instance, which lie in `range`. Takes a bit of memory for each number
    /// in the range where the draw has indices.
    [[nodiscard]] std::uint64_t distinct_vertices(const VertexRange& range) const;

private:
    [[nodiscard]] std::uint32_t primitives_of(std::uint32_t vertices) const;
    /// Vertices of a run that its primitives use: all but what is left over.
    [[nodiscard]] std::uint32_t used_of(const AssemblyRun& run) const;
    /// The next run with a primitive from a position on; it has none where there is no such run.
    [[nodiscard]] AssemblyRun run_from(std::uint32_t position) const;

    VertexNumbers numbers_;
    Topology topology_;
    ProvokingVertex provoking_;
    bool restarts_;
    std::uint32_t count_ = 0;
};

}  // namespace gnomon
