// A wave: as many quads of one primitive as the SIMD width holds, and which of their pixels count.
#pragma once

#include "pipeline/tiling.h"
#include "sim/lanes.h"
#include "sim/quad.h"
#include "texunit/texture.h"

#include <array>
#include <cstdint>
#include <span>

namespace gnomon {

/// Pixel offsets of the lanes inside a row of quads.
inline Int lane_dx() {
    const Int i = lane_index();
    return shift_right_logical<2>(i) + shift_right_logical<2>(i) + (i & Int(1));
}
inline Int lane_dy() { return shift_right_logical<1>(lane_index()) & Int(1); }

struct Wave {
    Int x;  // pixel coordinates per lane
    Int y;
    std::uint32_t covered = 0;  // lanes with a sample inside primitive and sample mask; the others are helpers
    int quads = 0;              // quads in use, from lane 0; lanes behind them repeat quad 0 and count for nothing
    bool row = false;           // the quads stand side by side, from an even pixel on
    std::array<std::int32_t, kQuadsPerWave> quad_x;  // top-left pixel of each quad in use
    std::array<std::int32_t, kQuadsPerWave> quad_y;
    std::array<std::uint32_t, kMaxSamples> samples;  // lanes by sample, before the sample mask; not set for one per pixel
};

/// Collects the quads of one primitive until a wave is full.
class QuadPacker {
public:
    [[nodiscard]] bool full() const { return !taken_ && wave_.quads == kQuadsPerWave; }
    [[nodiscard]] bool empty() const { return taken_ || wave_.quads == 0; }

    void add(int x, int y, std::uint32_t mask4) {
        if (taken_) begin();
        const auto q = static_cast<std::size_t>(wave_.quads++);
        wave_.quad_x[q] = x;
        wave_.quad_y[q] = y;
        wave_.covered |= mask4 << (4 * q);
    }
    /// Quad number `from` of a row whose samples cover `samples`.
    void add(int x, int y, std::uint32_t mask4, std::span<const std::uint32_t> samples, int from) {
        if (taken_) begin();
        const int q = wave_.quads;
        for (std::size_t s = 0; s < samples.size(); ++s) {
            if (q == 0) wave_.samples[s] = 0;
            wave_.samples[s] |= (samples[s] >> (4 * from) & 0xfu) << (4 * q);
        }
        add(x, y, mask4);
    }

    /// The wave so far, good until the next quad is added; the packer is empty afterwards.
    const Wave& take() {
        alignas(64) std::array<std::int32_t, kLanes> x;
        alignas(64) std::array<std::int32_t, kLanes> y;
        for (std::size_t q = 0; q < kQuadsPerWave; ++q) {
            const std::size_t from = q < static_cast<std::size_t>(wave_.quads) ? q : 0;
            for (std::size_t i = 0; i < 4; ++i) {
                x[4 * q + i] = wave_.quad_x[from];
                y[4 * q + i] = wave_.quad_y[from];
            }
        }
        wave_.x = Int::load(x.data()) + (lane_index() & Int(1));
        wave_.y = Int::load(y.data()) + lane_dy();
        taken_ = true;
        return wave_;
    }

private:
    void begin() {
        wave_.quads = 0;
        wave_.covered = 0;
        taken_ = false;
    }

    Wave wave_;
    bool taken_ = false;
};

/// A full row of quads starting at (x, y).
inline Wave row_wave(int x, int y, std::uint32_t covered) {
    Wave wave;
    wave.x = Int(x) + lane_dx();
    wave.y = Int(y) + lane_dy();
    wave.covered = covered;
    wave.quads = kQuadsPerWave;
    wave.row = true;
    for (int q = 0; q < kQuadsPerWave; ++q) {
        wave.quad_x[static_cast<std::size_t>(q)] = x + 2 * q;
        wave.quad_y[static_cast<std::size_t>(q)] = y;
    }
    return wave;
}

/// The 32-bit texels of a row of quads in lane order from the two rows of memory they stand in, and back.
inline Int load_quad_row(const std::byte* upper, const std::byte* lower) {
    const hn::Half<detail::IntTag> half;
    const auto load = [&](const std::byte* row) { return hn::LoadU(half, reinterpret_cast<const std::int32_t*>(row)); };
    alignas(64) static constexpr auto kFrom = [] {
        std::array<std::int32_t, kLanes> from{};
        for (int i = 0; i < kLanes; ++i) from[static_cast<std::size_t>(i)] = i / 4 * 2 + i % 2 + (i % 4 < 2 ? 0 : kLanes / 2);
        return from;
    }();
    return Int(hn::TableLookupLanes(hn::Combine(detail::IntTag{}, load(lower), load(upper)),
                                    hn::SetTableIndices(detail::IntTag{}, kFrom.data())));
}
inline void store_quad_row(Int lanes, std::byte* upper, std::byte* lower) {
    const hn::Half<detail::IntTag> half;
    alignas(64) static constexpr auto kFrom = [] {
        std::array<std::int32_t, kLanes> from{};
        for (int i = 0; i < kLanes / 2; ++i) {
            from[static_cast<std::size_t>(i)] = i / 2 * 4 + i % 2;
            from[static_cast<std::size_t>(i + kLanes / 2)] = i / 2 * 4 + i % 2 + 2;
        }
        return from;
    }();
    const auto rows = hn::TableLookupLanes(lanes.v, hn::SetTableIndices(detail::IntTag{}, kFrom.data()));
    hn::StoreU(hn::LowerHalf(half, rows), half, reinterpret_cast<std::int32_t*>(upper));
    hn::StoreU(hn::UpperHalf(half, rows), half, reinterpret_cast<std::int32_t*>(lower));
}

}  // namespace gnomon
