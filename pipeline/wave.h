// A wave: as many quads of one primitive as the SIMD width holds, and which of their pixels count.
#pragma once

#include "pipeline/tiling.h"
#include "sim/lanes.h"
#include "sim/quad.h"
#include "texunit/texture.h"

#include <array>
#include <cstdint>

namespace gnomon {

/// Pixel offsets of the lanes inside a row of quads.
inline Int lane_dx() {
    const Int i = lane_index();
    return shift_right_logical<2>(i) + shift_right_logical<2>(i) + (i & Int(1));
}
inline Int lane_dy() { return shift_right_logical<1>(lane_index()) & Int(1); }

/// Pixel coordinates of the lanes.
struct PixelLanes {
    Int x, y;
};

/// As many quads as a wave holds, side by side: where the first one's first pixel is.
struct QuadRow {
    int x = 0;  // even, as is y
    int y = 0;

    [[nodiscard]] PixelLanes pixels() const { return {Int(x) + lane_dx(), Int(y) + lane_dy()}; }
    [[nodiscard]] int pixel_x(std::size_t lane) const { return x + static_cast<int>(lane / 4 * 2 + lane % 2); }
    [[nodiscard]] int pixel_y(std::size_t lane) const { return y + static_cast<int>(lane / 2 % 2); }
};

/// Lanes by sample. Coverage is before the sample mask; what is live has passed whatever was tested so far.
template <std::size_t kSamples>
struct LanesBySample {
    std::array<std::uint32_t, kSamples> covered;
    std::array<std::uint32_t, kSamples> live;
};

struct Wave {
    PixelLanes pixels;
    std::uint32_t covered = 0;  // lanes with a sample inside primitive and sample mask; the others are helpers
    int quads = 0;              // quads in use, from lane 0; lanes behind them repeat quad 0 and count for nothing
    bool row = false;           // the quads are a QuadRow
    std::array<std::int32_t, kQuadsPerWave> quad_x;  // top-left pixel of each quad in use
    std::array<std::int32_t, kQuadsPerWave> quad_y;
    LanesBySample<kMaxSamples> samples;  // of as many as there are; not set for one per pixel but live[0]

    [[nodiscard]] int pixel_x(std::size_t lane) const { return quad_x[lane / 4] + static_cast<int>(lane % 2); }
    [[nodiscard]] int pixel_y(std::size_t lane) const { return quad_y[lane / 4] + static_cast<int>(lane / 2 % 2); }
};

/// Collects the quads of one primitive until a wave is full.
class QuadPacker {
public:
    [[nodiscard]] bool full() const { return !taken_ && wave_.quads == kQuadsPerWave; }
    [[nodiscard]] bool empty() const { return taken_ || wave_.quads == 0; }

    /// Quad number `from` of a row whose lanes are `covered`, and by sample as given.
    template <std::size_t kSamples>
    void add(const QuadRow& row, int from, std::uint32_t covered, const LanesBySample<kSamples>& samples, int sample_count) {
        const int q = taken_ ? 0 : wave_.quads;
        const auto i = static_cast<std::size_t>(q);
        const int x = row.x + 2 * from;
        if (q == 0) {
            taken_ = false;
            wave_.covered = 0;
            wave_.samples.live[0] = 0;
            wave_.pixels = {Int(x), Int(row.y)};
        } else {
            const Mask here = Mask::from_bits(0xfu << (4 * q));
            wave_.pixels = {select(here, Int(x), wave_.pixels.x), select(here, Int(row.y), wave_.pixels.y)};
        }
        wave_.quads = q + 1;
        wave_.quad_x[i] = x;
        wave_.quad_y[i] = row.y;
        const auto moved = [&](std::uint32_t lanes) { return (lanes >> (4 * from) & 0xfu) << (4 * q); };
        wave_.covered |= moved(covered);
        if (kSamples == 1) {
            wave_.samples.live[0] |= moved(samples.live[0]);
            return;
        }
        for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count); ++s) {
            if (q == 0) wave_.samples.covered[s] = wave_.samples.live[s] = 0;
            wave_.samples.covered[s] |= moved(samples.covered[s]);
            wave_.samples.live[s] |= moved(samples.live[s]);
        }
    }

    /// The wave so far, good until the next quad is added; the packer is empty afterwards.
    const Wave& take() {
        wave_.pixels.x = wave_.pixels.x + (lane_index() & Int(1));
        wave_.pixels.y = wave_.pixels.y + lane_dy();
        taken_ = true;
        return wave_;
    }

private:
    Wave wave_;
    bool taken_ = false;
};

/// A row with all of its quads in use.
template <std::size_t kSamples>
Wave row_wave(const QuadRow& row, std::uint32_t covered, const LanesBySample<kSamples>& samples, int sample_count) {
    Wave wave;
    wave.pixels = row.pixels();
    wave.covered = covered;
    wave.quads = kQuadsPerWave;
    wave.row = true;
    for (int q = 0; q < kQuadsPerWave; ++q) {
        wave.quad_x[static_cast<std::size_t>(q)] = row.x + 2 * q;
        wave.quad_y[static_cast<std::size_t>(q)] = row.y;
    }
    wave.samples.live[0] = samples.live[0];
    if (kSamples == 1) return wave;
    for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count); ++s) {
        wave.samples.covered[s] = samples.covered[s];
        wave.samples.live[s] = samples.live[s];
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
