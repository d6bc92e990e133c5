// The depth and stencil tests on stored codes: convert, compare, write, and the hierarchy above them. D3D11.3 17.9 to 17.12
//
// Every depth format is stored as 32-bit codes that order as the depths do, so one integer comparison serves all.
#pragma once

#include "pipeline/command.h"
#include "pipeline/primitive.h"
#include "pipeline/wave.h"
#include "sim/fixed.h"
#include "texunit/compare.h"
#include "texunit/texture.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gnomon {

/// The depth range of a viewport. D3D11.3 17.10
template <class Scalar>
struct DepthRange {
    Scalar least = 0;
    Scalar most = 1;
};

/// Codes of depths as drivers round them, in binary32; llvmpipe's clamp takes NaN for the upper end.
template <class Real>
Int driver_depth_code(const Real& z, const DepthRange<typename Real::Scalar>& range, ComponentType type,
                      DepthRounding rounding) {
    const bool llvmpipe = rounding == DepthRounding::Llvmpipe;
    const Real least(range.least);
    const Real most(range.most);
    const Float limited = to_float(llvmpipe ? max(select(z < most, z, most), least) : clamp(z, least, most));
    switch (type) {
        case ComponentType::Depth16:
            if (llvmpipe) return bits_of(limited * Float(65535.0f / 65536.0f) + Float(128.0f)) & Int(0xffff);
            return bounded_round_to_int(limited * Float(65535.0f));
        case ComponentType::Depth24: return bounded_round_to_int(limited * Float(16777215.0f));
        default: return bits_of(limited + Float(0.0f));
    }
}

/// Clamp to the viewport's range (NaN gives its lower end) and convert to the format. D3D11.3 16.9.2.1, 17.10, 17.11
template <class Real>
Int depth_code(const Real& z, const DepthRange<typename Real::Scalar>& range, ComponentType type, DepthRounding rounding) {
    if (rounding != DepthRounding::HalfUp) return driver_depth_code(z, range, type, rounding);
    const Real limited = clamp(z, Real(range.least), Real(range.most));
    switch (type) {
        case ComponentType::Depth16: return unorm_from_float(limited, 16);
        case ComponentType::Depth24: return unorm_from_float(limited, 24);
        default: return bits_of(to_float(limited) + Float(0.0f));
    }
}

/// The same for one value.
template <class Scalar>
std::int32_t depth_code_scalar(Scalar z, const DepthRange<Scalar>& range, ComponentType type, DepthRounding rounding) {
    if (rounding != DepthRounding::HalfUp) {
        using Real = std::conditional_t<std::is_same_v<Scalar, float>, Float, Double>;
        return lane(driver_depth_code(Real(z), range, type, rounding), 0);
    }
    const Scalar limited = z > range.least ? (z < range.most ? z : range.most) : range.least;
    switch (type) {
        case ComponentType::Depth16: return static_cast<std::int32_t>(static_cast<double>(limited) * 65535.0 + 0.5);
        case ComponentType::Depth24: return static_cast<std::int32_t>(static_cast<double>(limited) * 16777215.0 + 0.5);
        default: return std::bit_cast<std::int32_t>(static_cast<float>(limited) + 0.0f);
    }
}

/// One stencil value after one operation. D3D11.3 17.8
constexpr int stencil_result(StencilOp op, int stored, int reference) {
    switch (op) {
        case StencilOp::Keep: return stored;
        case StencilOp::Zero: return 0;
        case StencilOp::Replace: return reference;
        case StencilOp::IncrementSaturate: return stored < 255 ? stored + 1 : 255;
        case StencilOp::DecrementSaturate: return stored > 0 ? stored - 1 : 0;
        case StencilOp::Invert: return ~stored & 0xff;
        case StencilOp::Increment: return (stored + 1) & 0xff;
        case StencilOp::Decrement: return (stored - 1) & 0xff;
    }
    __builtin_unreachable();
}

/// Whether a face's comparison passes.
constexpr bool stencil_passes(CompareOp op, int reference, int stored) {
    switch (op) {
        case CompareOp::Never: return false;
        case CompareOp::Less: return reference < stored;
        case CompareOp::Equal: return reference == stored;
        case CompareOp::LessEqual: return reference <= stored;
        case CompareOp::Greater: return reference > stored;
        case CompareOp::NotEqual: return reference != stored;
        case CompareOp::GreaterEqual: return reference >= stored;
        case CompareOp::Always: return true;
    }
    __builtin_unreachable();
}

/// The depth target of a draw, at one layer.
class DepthTarget {
public:
    DepthTarget(Texture& texture, const TargetView& view, const DepthState& depth, const StencilState& stencil)
        : texture_(&texture),
          view_(view),
          pitch_(texture.table().pitch[static_cast<std::size_t>(view.level)]),
          plane_(texture.layer_stride()),
          type_(texture.info().type),
          depth_(depth),
          stencil_(stencil) {
        if (!texture.info().has_stencil) stencil_.test = false;
        if (stencil_.test) stencil_pitch_ = texture.stencil_pitch(view.level);
        set_layer(0);
    }

    void set_layer(int layer) {
        layer_ = layer;
        base_ = texture_->row(view_.level, 0, view_.first_layer + layer);
        if (stencil_.test) stencil_base_ = texture_->stencil_row(view_.level, 0, view_.first_layer + layer);
    }
    [[nodiscard]] int layer() const { return layer_; }

    [[nodiscard]] ComponentType type() const { return type_; }
    [[nodiscard]] const DepthState& depth() const { return depth_; }
    [[nodiscard]] const StencilState& stencil() const { return stencil_; }

    /// Lanes of `mask` whose code passes at sample s.
    [[nodiscard]] std::uint32_t test(const Wave& wave, std::uint32_t mask, Int code, int s, Int& stored) const {
        const std::byte* plane = base_ + std::ptrdiff_t{plane_} * s;
        if (wave.row) {
            const std::byte* upper = row_of(plane, wave);
            stored = load_quad_row(upper, upper + pitch_);
        } else {
            stored = gather_bits(plane, wave.y * Int(pitch_) + shift_left<2>(wave.x));
        }
        return compare(depth_.compare, code, stored).bits() & mask;
    }

    /// Writes the codes of the lanes in `passed`.
    void write(const Wave& wave, Int code, Int stored, std::uint32_t passed, int s) {
        std::byte* plane = base_ + std::ptrdiff_t{plane_} * s;
        const Int merged = select(Mask::from_bits(passed), code, stored);
        if (wave.row) {
            // Lanes that failed get back what they had: the tile is this worker's alone.
            std::byte* upper = row_of(plane, wave);
            store_quad_row(merged, upper, upper + pitch_);
            return;
        }
        alignas(64) const std::array<std::int32_t, kLanes> lanes = merged.lanes();
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
            if ((passed >> (4 * q) & 0xfu) == 0) continue;
            std::byte* row = plane + std::ptrdiff_t{wave.quad_y[q]} * pitch_ + std::ptrdiff_t{wave.quad_x[q]} * 4;
            std::memcpy(row, &lanes[4 * q], 8);
            std::memcpy(row + pitch_, &lanes[4 * q + 2], 8);
        }
    }

    /// Lanes of `mask` that pass the stencil test at sample s.
    [[nodiscard]] std::uint32_t test_stencil(const Wave& wave, std::uint32_t mask, int s, bool front) const {
        const StencilFace& face = front ? stencil_.front : stencil_.back;
        std::uint32_t passed = 0;
        for_each_lane(wave, mask, s, [&](std::uint32_t bit, const std::uint8_t* stored) {
            if (stencil_passes(face.compare, stencil_.reference & stencil_.read_mask, *stored & stencil_.read_mask))
                passed |= bit;
        });
        return passed;
    }
    /// Applies one operation to the lanes of `mask`.
    void update_stencil(const Wave& wave, std::uint32_t mask, int s, StencilOp op) {
        if (op == StencilOp::Keep || stencil_.write_mask == 0) return;
        for_each_lane(wave, mask, s, [&](std::uint32_t, std::uint8_t* stored) {
            const int result = stencil_result(op, *stored, stencil_.reference);
            *stored = static_cast<std::uint8_t>((result & stencil_.write_mask) | (*stored & ~stencil_.write_mask));
        });
    }

    /// The largest (or smallest) code stored in an 8x8 block that lies inside `limit`, over all samples.
    [[nodiscard]] std::int32_t block_extreme(int x, int y, const PixelRect& limit, int samples, bool largest) const {
        std::array<std::int32_t, kBlockSize> found;
        found.fill(largest ? 0 : std::numeric_limits<std::int32_t>::max());
        const auto width = static_cast<std::size_t>(std::min(kBlockSize, limit.x1 - x));
        for (int s = 0; s < samples; ++s) {
            for (int row = y; row < std::min(y + kBlockSize, limit.y1); ++row) {
                std::array<std::int32_t, kBlockSize> codes = found;  // columns past the limit count for nothing
                std::memcpy(codes.data(),
                            base_ + std::ptrdiff_t{plane_} * s + std::ptrdiff_t{row} * pitch_ + std::ptrdiff_t{x} * 4,
                            4 * width);
                for (std::size_t i = 0; i < codes.size(); ++i)
                    found[i] = largest ? std::max(found[i], codes[i]) : std::min(found[i], codes[i]);
            }
        }
        return largest ? *std::ranges::max_element(found) : *std::ranges::min_element(found);
    }

private:
    /// Where the upper row of a row of quads begins. All of its quads are in use, so all of it lies inside the (even) padding.
    template <class Byte>
    Byte* row_of(Byte* plane, const Wave& wave) const {
        return plane + std::ptrdiff_t{wave.quad_y[0]} * pitch_ + std::ptrdiff_t{wave.quad_x[0]} * 4;
    }

    template <class Visit>
    void for_each_lane(const Wave& wave, std::uint32_t mask, int s, const Visit& visit) const {
        std::uint8_t* plane = stencil_base_ + std::ptrdiff_t{plane_ / 4} * s;
        for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
            const std::size_t q = lane / 4;
            const std::int32_t x = wave.quad_x[q] + static_cast<std::int32_t>(lane & 1u);
            const std::int32_t y = wave.quad_y[q] + static_cast<std::int32_t>(lane >> 1 & 1u);
            visit(1u << lane, plane + std::ptrdiff_t{y} * stencil_pitch_ + x);
        }
    }

    Texture* texture_;
    TargetView view_;
    std::int32_t pitch_;
    std::int32_t plane_;
    std::int32_t stencil_pitch_ = 0;
    int layer_ = 0;
    ComponentType type_;
    DepthState depth_;
    StencilState stencil_;
    std::byte* base_ = nullptr;
    std::uint8_t* stencil_base_ = nullptr;
};

/// Farthest stored depth of each block of one tile, computed when first asked for and again after writes. What is far depends
/// on the comparison: only Less, LessEqual, Greater and GreaterEqual have a hierarchy.
class HierarchicalDepth {
public:
    HierarchicalDepth(const DepthTarget& target, int tile_x, int tile_y, const PixelRect& limit, int samples)
        : target_(target), tile_x_(tile_x), tile_y_(tile_y), limit_(limit), samples_(samples) {
        switch (target.depth().compare) {
            case CompareOp::Less:
            case CompareOp::LessEqual: usable_ = larger_is_far_ = true; break;
            case CompareOp::Greater:
            case CompareOp::GreaterEqual: usable_ = true; break;
            case CompareOp::Never:
            case CompareOp::Equal:
            case CompareOp::NotEqual:
            case CompareOp::Always: break;
        }
        forget_all();
        // A failing sample must leave no trace.
        usable_ = usable_ && target.depth().test && !target.stencil().test;
    }

    [[nodiscard]] bool usable() const { return usable_; }
    /// Whether small codes are near.
    [[nodiscard]] bool larger_is_far() const { return larger_is_far_; }

    /// Whether no sample of the block can pass if no new code is nearer than `nearest`. Never wrong, only sometimes cautious:
    /// what a test lets through is nearer than what was there, so a farthest depth of old still bounds what is stored, and is
    /// looked up again only when much was written since and the primitive at hand is `large` enough to pay for it.
    bool rejects(int block_x, int block_y, std::int32_t nearest, bool large) {
        const std::size_t i = index(block_x, block_y);
        if (large && written_[i] >= kStaleQuads) {
            farthest_[i] = target_.block_extreme(tile_x_ + block_x * kBlockSize, tile_y_ + block_y * kBlockSize, limit_,
                                                 samples_, larger_is_far_);
            written_[i] = 0;
        }
        if (written_[i] == kUnknown) return false;
        switch (target_.depth().compare) {
            case CompareOp::Less: return nearest >= farthest_[i];
            case CompareOp::LessEqual: return nearest > farthest_[i];
            case CompareOp::Greater: return nearest <= farthest_[i];
            case CompareOp::GreaterEqual: return nearest < farthest_[i];
            case CompareOp::Never:
            case CompareOp::Equal:
            case CompareOp::NotEqual:
            case CompareOp::Always: break;
        }
        return false;
    }

    /// A quad at (x, y) was written.
    void note_write(int x, int y) {
        std::uint8_t& written = written_[index((x - tile_x_) / kBlockSize, (y - tile_y_) / kBlockSize)];
        if (written < kUnknown - 1) ++written;
    }
    /// Another target: nothing is known.
    void forget_all() { written_.fill(kUnknown); }

private:
    static std::size_t index(int block_x, int block_y) { return static_cast<std::size_t>(block_y * kBlocksPerTile + block_x); }

    const DepthTarget& target_;
    int tile_x_;
    int tile_y_;
    PixelRect limit_;
    int samples_;
    bool usable_ = false;
    bool larger_is_far_ = false;
    static constexpr std::uint8_t kStaleQuads = 16;  // a whole block
    static constexpr std::uint8_t kUnknown = 255;
    std::array<std::int32_t, kBlocksPerTile * kBlocksPerTile> farthest_;
    std::array<std::uint8_t, kBlocksPerTile * kBlocksPerTile> written_;  // quads since farthest_ was looked up, or kUnknown
};

}  // namespace gnomon
