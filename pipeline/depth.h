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
GNOMON_INLINE Int depth_code(const Real& z, const DepthRange<typename Real::Scalar>& range, ComponentType type,
                             DepthRounding rounding) {
    if (rounding != DepthRounding::HalfUp) return driver_depth_code(z, range, type, rounding);
    const Real limited = clamp_to_numbers(z, Real(range.least), Real(range.most));
    switch (type) {
        case ComponentType::Depth16: return unorm_from_float(limited, 16);
        case ComponentType::Depth24: return unorm_from_float(limited, 24);
        default: return bits_of(to_float(limited) + Float(0.0f));
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

    /// What is stored in a row at sample s.
    [[nodiscard]] GNOMON_INLINE Int stored(const QuadRow& row, int s) const {
        const std::byte* upper = row_of(base_, row, s);
        return load_quad_row(upper, upper + pitch_);
    }
    [[nodiscard]] Int stored(const Wave& wave, int s) const {
        if (wave.row) return stored(QuadRow{wave.quad_x[0], wave.quad_y[0]}, s);
        return gather_bits(base_ + std::ptrdiff_t{plane_} * s, wave.pixels.y * Int(pitch_) + shift_left<2>(wave.pixels.x));
    }

    /// Lanes of `mask` whose code passes.
    [[nodiscard]] GNOMON_INLINE std::uint32_t test(std::uint32_t mask, Int code, Int stored) const {
        return compare(depth_.compare, code, stored).bits() & mask;
    }

    /// Writes the codes of the lanes in `passed` over what was stored.
    GNOMON_INLINE void write(const QuadRow& row, Int code, Int stored, std::uint32_t passed, int s) {
        // Lanes that failed get back what they had: the tile is this worker's alone, and rows are padded.
        std::byte* upper = row_of(base_, row, s);
        store_quad_row(select(Mask::from_bits(passed), code, stored), upper, upper + pitch_);
    }
    void write(const Wave& wave, Int code, Int stored, std::uint32_t passed, int s) {
        if (wave.row) {
            write(QuadRow{wave.quad_x[0], wave.quad_y[0]}, code, stored, passed, s);
            return;
        }
        alignas(64) const std::array<std::int32_t, kLanes> lanes = select(Mask::from_bits(passed), code, stored).lanes();
        std::byte* plane = base_ + std::ptrdiff_t{plane_} * s;
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q) {
            if ((passed >> (4 * q) & 0xfu) == 0) continue;
            std::byte* row = plane + std::ptrdiff_t{wave.quad_y[q]} * pitch_ + std::ptrdiff_t{wave.quad_x[q]} * 4;
            std::memcpy(row, &lanes[4 * q], 8);
            std::memcpy(row + pitch_, &lanes[4 * q + 2], 8);
        }
    }

    /// Lanes of `mask` that pass the stencil test at sample s.
    template <class Place>
    [[nodiscard]] std::uint32_t test_stencil(const Place& place, std::uint32_t mask, int s, bool front) const {
        const StencilFace& face = front ? stencil_.front : stencil_.back;
        std::uint32_t passed = 0;
        for_each_lane(place, mask, s, [&](std::uint32_t bit, const std::uint8_t* stored) {
            if (stencil_passes(face.compare, stencil_.reference & stencil_.read_mask, *stored & stencil_.read_mask))
                passed |= bit;
        });
        return passed;
    }
    /// Applies one operation to the lanes of `mask`.
    template <class Place>
    void update_stencil(const Place& place, std::uint32_t mask, int s, StencilOp op) {
        if (op == StencilOp::Keep || stencil_.write_mask == 0) return;
        for_each_lane(place, mask, s, [&](std::uint32_t, std::uint8_t* stored) {
            const int result = stencil_result(op, *stored, stencil_.reference);
            *stored = static_cast<std::uint8_t>((result & stencil_.write_mask) | (*stored & ~stencil_.write_mask));
        });
    }

    /// The largest (or smallest) code stored in an 8x8 block that lies inside `limit`, over all samples.
    [[nodiscard]] std::int32_t block_extreme(int x, int y, const PixelRect& limit, int samples, bool largest) const {
        const bool whole = x + kBlockSize <= limit.x1 && y + kBlockSize <= limit.y1;
        Int found = stored(QuadRow{x, y}, 0);
        if (!whole) found = Int(code_at(x, y, 0));  // what lies past the limit counts for nothing
        for (int s = 0; s < samples; ++s) {
            for (int dy = 0; dy < kBlockSize; dy += kWaveHeight) {
                for (int dx = 0; dx < kBlockSize; dx += kWaveWidth) {
                    const QuadRow row{x + dx, y + dy};
                    if (whole) {
                        const Int codes = stored(row, s);
                        found = largest ? max(found, codes) : min(found, codes);
                        continue;
                    }
                    for (std::size_t lane = 0; lane < kLanes; ++lane) {
                        if (row.pixel_x(lane) >= limit.x1 || row.pixel_y(lane) >= limit.y1) continue;
                        const Int code(code_at(row.pixel_x(lane), row.pixel_y(lane), s));
                        found = largest ? max(found, code) : min(found, code);
                    }
                }
            }
        }
        return largest ? max_of_lanes(found) : min_of_lanes(found);
    }

private:
    /// Where the upper row of a row of quads begins at sample s.
    template <class Byte>
    Byte* row_of(Byte* base, const QuadRow& row, int s) const {
        return base + std::ptrdiff_t{plane_} * s + std::ptrdiff_t{row.y} * pitch_ + std::ptrdiff_t{row.x} * 4;
    }
    [[nodiscard]] std::int32_t code_at(int x, int y, int s) const {
        std::int32_t code = 0;
        std::memcpy(&code, row_of(base_, QuadRow{x, y}, s), 4);
        return code;
    }

    template <class Place, class Visit>
    void for_each_lane(const Place& place, std::uint32_t mask, int s, const Visit& visit) const {
        std::uint8_t* plane = stencil_base_ + std::ptrdiff_t{plane_ / 4} * s;
        for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
            visit(1u << lane, plane + std::ptrdiff_t{place.pixel_y(lane)} * stencil_pitch_ + place.pixel_x(lane));
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

    /// Of the blocks n, n + 1, ... in `blocks` those where no sample can pass if no new code is nearer than `nearest`. Never
    /// wrong, only sometimes cautious: what a test lets through is nearer than what was there, so a farthest depth of old still
    /// bounds what is stored, and is looked up again only when much was written since.
    std::uint32_t rejects(int n, Int nearest, std::uint32_t blocks) {
        const std::int32_t* farthest = farthest_.data() + n;
        std::uint32_t rejected = beyond(nearest, Int::load(farthest)) & blocks;
        std::uint32_t looked_up = 0;
        for (std::uint32_t rest = blocks & ~rejected; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
            const std::size_t block = static_cast<std::size_t>(n) + lane;
            if (written_[block] < kStaleQuads) continue;
            look_up(block);
            looked_up |= 1u << lane;
        }
        if (looked_up != 0) rejected |= beyond(nearest, Int::load(farthest)) & looked_up;
        return rejected;
    }

    /// The lanes in `passed` were written.
    GNOMON_INLINE void note_write(const QuadRow& row, std::uint32_t passed) {
        if ((row.x & (kBlockSize - 1)) + kWaveWidth <= kBlockSize) {
            note_quads(row.x, row.y, std::popcount(quad_any(passed)) / 4);
            return;
        }
        for (int q = 0; q < kQuadsPerWave; ++q)
            if ((passed >> (4 * q) & 0xfu) != 0) note_quads(row.x + 2 * q, row.y, 1);
    }
    void note_write(const Wave& wave, std::uint32_t passed) {
        for (std::size_t q = 0; q < static_cast<std::size_t>(wave.quads); ++q)
            if ((passed >> (4 * q) & 0xfu) != 0) note_quads(wave.quad_x[q], wave.quad_y[q], 1);
    }
    /// Every sample of a block was written with codes up to `farthest`.
    void note_covered(int block, std::int32_t farthest) {
        const auto i = static_cast<std::size_t>(block);
        farthest_[i] = larger_is_far_ ? std::min(farthest_[i], farthest) : std::max(farthest_[i], farthest);
        written_[i] = 0;
    }
    /// Another target: nothing is known.
    void forget_all() {
        written_.fill(kStaleQuads);
        farthest_.fill(larger_is_far_ ? std::numeric_limits<std::int32_t>::max() : std::numeric_limits<std::int32_t>::min());
    }

private:
    /// Blocks whose nearest new code is no nearer than the farthest stored one.
    [[nodiscard]] std::uint32_t beyond(Int nearest, Int farthest) const {
        switch (target_.depth().compare) {
            case CompareOp::Less: return (nearest >= farthest).bits();
            case CompareOp::LessEqual: return (nearest > farthest).bits();
            case CompareOp::Greater: return (nearest <= farthest).bits();
            case CompareOp::GreaterEqual: return (nearest < farthest).bits();
            case CompareOp::Never:
            case CompareOp::Equal:
            case CompareOp::NotEqual:
            case CompareOp::Always: break;
        }
        return 0;
    }
    void look_up(std::size_t block) {
        const int x = static_cast<int>(block) % kBlocksPerTile * kBlockSize;
        const int y = static_cast<int>(block) / kBlocksPerTile * kBlockSize;
        farthest_[block] = target_.block_extreme(tile_x_ + x, tile_y_ + y, limit_, samples_, larger_is_far_);
        written_[block] = 0;
    }
    GNOMON_INLINE void note_quads(int x, int y, int quads) {
        constexpr auto kMask = static_cast<unsigned>(kTileSize - 1);  // tiles begin at multiples of their size
        const unsigned block_x = (static_cast<unsigned>(x) & kMask) / kBlockSize;
        const unsigned block_y = (static_cast<unsigned>(y) & kMask) / kBlockSize;
        std::uint8_t& written = written_[block_y * kBlocksPerTile + block_x];
        written = static_cast<std::uint8_t>(std::min(written + quads, int{kStaleQuads}));
    }

    const DepthTarget& target_;
    int tile_x_;
    int tile_y_;
    PixelRect limit_;
    int samples_;
    bool usable_ = false;
    bool larger_is_far_ = false;
    static constexpr std::uint8_t kStaleQuads = 16;  // a whole block
    std::array<std::int32_t, kBlocksPerTile * kBlocksPerTile> farthest_;
    std::array<std::uint8_t, kBlocksPerTile * kBlocksPerTile> written_;  // quads since farthest_ was looked up
};

}  // namespace gnomon
