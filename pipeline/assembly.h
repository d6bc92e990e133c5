// Vertices to primitives: indices, restart, strips and fans. D3D11.3 8.10, 8.12 to 8.14
#pragma once

#include "pipeline/state.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

/// The vertex numbers of a draw: its indices, or 0, 1, 2, ...
class VertexNumbers {
public:
    /// `data` is empty for draws without indices.
    VertexNumbers(std::span<const std::byte> data, IndexType type, std::uint32_t first, std::uint32_t count)
        : data_(data.data()), type_(type), first_(first), count_(count) {}

    [[nodiscard]] std::uint32_t count() const { return count_; }
    [[nodiscard]] bool indexed() const { return data_ != nullptr; }
    [[nodiscard]] std::size_t bytes_each() const { return data_ == nullptr ? 0 : type_ == IndexType::Uint16 ? 2 : 4; }

    [[nodiscard]] std::uint32_t operator[](std::uint32_t i) const {
        const std::size_t at = std::size_t{first_} + i;
        if (data_ == nullptr) return first_ + i;
        if (type_ == IndexType::Uint16) {
            std::uint16_t value = 0;
            std::memcpy(&value, data_ + 2 * at, 2);
            return value;
        }
        std::uint32_t value = 0;
        std::memcpy(&value, data_ + 4 * at, 4);
        return value;
    }
    /// The index that restarts. D3D11.3 8.12
    [[nodiscard]] std::uint32_t restart() const { return type_ == IndexType::Uint16 ? 0xffffu : 0xffffffffu; }

private:
    const std::byte* data_;
    IndexType type_;
    std::uint32_t first_;
    std::uint32_t count_;
};

/// A primitive as positions in the list of vertex numbers.
struct AssembledPrimitive {
    std::array<std::uint32_t, 3> corner{};  // of which a line uses two and a point one
    int provoking = 0;                      // which of them is the provoking vertex
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

/// All primitives of one instance, by number.
class Assembly {
public:
    Assembly(const VertexNumbers& numbers, Topology topology, ProvokingVertex provoking, bool restart)
        : topology_(topology), provoking_(provoking) {
        if (!restart || !numbers.indexed()) {
            count_ = primitives_of(numbers.count());
            return;
        }
        // Restarts cut the list into runs; each is as a list of its own.
        std::uint32_t begin = 0;
        starts_.emplace();
        for (std::uint32_t i = 0; i <= numbers.count(); ++i) {
            if (i < numbers.count() && numbers[i] != numbers.restart()) continue;
            for (std::uint32_t k = 0; k < primitives_of(i - begin); ++k) starts_->push_back({begin, k});
            begin = i + 1;
        }
        count_ = static_cast<std::uint32_t>(starts_->size());
    }

    [[nodiscard]] std::uint32_t count() const { return count_; }

    [[nodiscard]] AssembledPrimitive operator[](std::uint32_t i) const {
        const Start start = starts_ ? (*starts_)[i] : Start{0, i};
        const std::uint32_t run = start.run;
        const std::uint32_t k = start.number;
        const bool last = provoking_ == ProvokingVertex::Last;
        switch (topology_) {
            case Topology::PointList: return {{run + k}, 0};
            case Topology::LineList: return {{run + 2 * k, run + 2 * k + 1}, last ? 1 : 0};
            case Topology::LineStrip: return {{run + k, run + k + 1}, last ? 1 : 0};
            case Topology::TriangleList: return {{run + 3 * k, run + 3 * k + 1, run + 3 * k + 2}, last ? 2 : 0};
            case Topology::TriangleStrip:
                // Every second one turns its last two corners, so that all wind the same way.
                if (k % 2 == 0) return {{run + k, run + k + 1, run + k + 2}, last ? 2 : 0};
                return {{run + k, run + k + 2, run + k + 1}, last ? 1 : 0};
            case Topology::TriangleFan: return {{run + k + 1, run + k + 2, run}, last ? 1 : 0};
        }
        __builtin_unreachable();
    }

private:
    struct Start {
        std::uint32_t run;
        std::uint32_t number;
    };

    [[nodiscard]] std::uint32_t primitives_of(std::uint32_t vertices) const {
        const auto strip = [&](std::uint32_t corners) { return vertices >= corners ? vertices - corners + 1 : 0; };
        switch (topology_) {
            case Topology::PointList: return vertices;
            case Topology::LineList: return vertices / 2;
            case Topology::LineStrip: return strip(2);
            case Topology::TriangleList: return vertices / 3;
            case Topology::TriangleStrip:
            case Topology::TriangleFan: return strip(3);
        }
        __builtin_unreachable();
    }

    Topology topology_;
    ProvokingVertex provoking_;
    std::optional<std::vector<Start>> starts_;  // only where the draw restarts
    std::uint32_t count_ = 0;
};

}  // namespace gnomon
