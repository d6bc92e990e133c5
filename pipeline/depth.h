// The depth test on stored codes: convert, compare, write, and the hierarchy above it. D3D11.3 17.9 to 17.11
//
// Every depth format is stored as 32-bit codes that order as the depths do, so one integer comparison serves all.
#pragma once

#include "pipeline/command.h"
#include "pipeline/triangle.h"
#include "pipeline/wave.h"
#include "sim/fixed.h"
#include "texunit/compare.h"
#include "texunit/texture.h"

#include <bit>
#include <cstring>

namespace gnomon {

/// Clamp to the viewport's range (NaN gives 0) and convert to the format. D3D11.3 17.10, 17.11
template <class Real>
Int depth_code(const Real& z, ComponentType type) {
    const Real limited = saturate(z);
    switch (type) {
        case ComponentType::Depth16: return unorm_from_float(limited, 16);
        case ComponentType::Depth24: return unorm_from_float(limited, 24);
        default: return bits_of(to_float(limited) + Float(0.0f));
    }
}

/// The same for one value.
template <class Scalar>
std::int32_t depth_code_scalar(Scalar z, ComponentType type) {
    const Scalar limited = z > Scalar(0) ? (z < Scalar(1) ? z : Scalar(1)) : Scalar(0);
    switch (type) {
        case ComponentType::Depth16: return static_cast<std::int32_t>(static_cast<double>(limited) * 65535.0 + 0.5);
        case ComponentType::Depth24: return static_cast<std::int32_t>(static_cast<double>(limited) * 16777215.0 + 0.5);
        default: return std::bit_cast<std::int32_t>(static_cast<float>(limited) + 0.0f);
    }
}

/// The depth target of a draw.
class DepthTarget {
public:
    DepthTarget(Texture& texture, const DepthState& state)
        : base_(texture.row(0, 0)), pitch_(texture.table().pitch[0]), type_(texture.info().type), state_(state) {}

    [[nodiscard]] ComponentType type() const { return type_; }
    [[nodiscard]] const DepthState& state() const { return state_; }

    /// Lanes of `covered` whose code passes.
    [[nodiscard]] std::uint32_t test(const Wave& wave, Int code, Int& stored) const {
        stored = gather_bits(base_, wave.y * Int(pitch_) + shift_left<2>(wave.x));
        return compare(state_.compare, code, stored).bits() & wave.covered;
    }

    /// Writes the codes of the lanes in `passed`.
    void write(const Wave& wave, Int code, Int stored, std::uint32_t passed) {
        alignas(64) std::array<std::int32_t, kLanes> merged;
        select(Mask::from_bits(passed), code, stored).store(merged.data());
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
            if ((passed >> (4 * q) & 0xfu) == 0) continue;
            std::byte* row = base_ + std::ptrdiff_t{wave.quad_y[q]} * pitch_ + std::ptrdiff_t{wave.quad_x[q]} * 4;
            std::memcpy(row, &merged[4 * q], 8);
            std::memcpy(row + pitch_, &merged[4 * q + 2], 8);
        }
    }

    /// The largest code stored in an 8x8 block that lies inside `limit`.
    [[nodiscard]] std::int32_t block_max(int x, int y, const PixelRect& limit) const {
        std::int32_t largest = 0;
        const int x_end = std::min(x + kBlockSize, limit.x1);
        for (int row = y; row < std::min(y + kBlockSize, limit.y1); ++row) {
            const auto* codes = reinterpret_cast<const std::int32_t*>(base_ + std::ptrdiff_t{row} * pitch_);
            for (int column = x; column < x_end; ++column) largest = std::max(largest, codes[column]);
        }
        return largest;
    }

private:
    std::byte* base_;
    std::int32_t pitch_;
    ComponentType type_;
    DepthState state_;
};

/// Largest stored depth of each block of one tile, computed when first asked for and again after writes.
class HierarchicalDepth {
public:
    HierarchicalDepth(const DepthTarget& target, int tile_x, int tile_y, const PixelRect& limit)
        : target_(target), tile_x_(tile_x), tile_y_(tile_y), limit_(limit) {
        usable_ = target.state().compare == CompareOp::Less || target.state().compare == CompareOp::LessEqual;
    }

    /// Whether no pixel of the block can pass if all new codes are at least `nearest`. Never wrong, only sometimes cautious.
    bool rejects(int block_x, int block_y, std::int32_t nearest) {
        if (!usable_) return false;
        const std::size_t i = index(block_x, block_y);
        if ((known_[i / 64] >> (i % 64) & 1u) == 0) {
            max_[i] = target_.block_max(tile_x_ + block_x * kBlockSize, tile_y_ + block_y * kBlockSize, limit_);
            known_[i / 64] |= std::uint64_t{1} << (i % 64);
        }
        return target_.state().compare == CompareOp::Less ? nearest >= max_[i] : nearest > max_[i];
    }

    /// Pixels at (x, y) were written.
    void forget(int x, int y) {
        const std::size_t i = index((x - tile_x_) / kBlockSize, (y - tile_y_) / kBlockSize);
        known_[i / 64] &= ~(std::uint64_t{1} << (i % 64));
    }

private:
    static std::size_t index(int block_x, int block_y) { return static_cast<std::size_t>(block_y * kBlocksPerTile + block_x); }

    const DepthTarget& target_;
    int tile_x_;
    int tile_y_;
    PixelRect limit_;
    bool usable_ = false;
    std::array<std::int32_t, kBlocksPerTile * kBlocksPerTile> max_;
    std::array<std::uint64_t, (kBlocksPerTile * kBlocksPerTile + 63) / 64> known_{};
};

}  // namespace gnomon
