// A texture in memory: 2D, an array of 2D or a cube, with its mip chain. D3D11.3 5.3
#pragma once

#include "texunit/format.h"

#include <hwy/aligned_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gnomon {

inline constexpr int kMaxTextureSize = 16384;  // D3D11.3 21
inline constexpr int kMaxLevels = 15;          // of a 16384 texel side
inline constexpr int kMaxLayers = 2048;        // D3D11.3 21
static_assert(kMaxTextureSize == 1 << (kMaxLevels - 1));

enum class TextureKind {
    Flat,
    Array,  // slices of one size. D3D11.3 5.3.6
    Cube,   // six square faces: +x, -x, +y, -y, +z, -z. D3D11.3 5.3.8
};
template <>
inline constexpr std::array kEnumNames<TextureKind>{EnumName{TextureKind::Flat, "flat"}, EnumName{TextureKind::Array, "array"},
                                                    EnumName{TextureKind::Cube, "cube"}};

inline constexpr int kCubeFaces = 6;
inline constexpr int kMaxSamples = 16;

struct TextureDesc {
    Format format = Format::Rgba8Unorm;
    int width = 1;   // texels, 1 to kMaxTextureSize
    int height = 1;  // texels, 1 to kMaxTextureSize
    int levels = 1;  // 1 to full_level_count(width, height)
    TextureKind kind = TextureKind::Flat;
    int layers = 1;   // 1 of a flat texture, 1 to kMaxLayers of an array, kCubeFaces of a cube
    int samples = 1;  // 1, 2, 4, 8 or 16 per texel; more than one: one level, no cube. D3D11.3 19.2

    bool operator==(const TextureDesc&) const = default;
};

/// Number of levels down to 1x1.
constexpr int full_level_count(int width, int height) {
    int levels = 1;
    for (int size = width > height ? width : height; size > 1; size /= 2) ++levels;
    return levels;
}

/// Side of a level: halved and rounded down, at least 1.
constexpr int level_size(int size, int level) { return size >> level > 1 ? size >> level : 1; }

/// Where each level lies: the tables that lanes on different levels gather from.
struct LevelTable {
    alignas(64) std::array<std::int32_t, 16> offset{};  // bytes from the start of the texture
    alignas(64) std::array<std::int32_t, 16> pitch{};   // bytes per row
    alignas(64) std::array<std::int32_t, 16> width{};   // texels
    alignas(64) std::array<std::int32_t, 16> height{};  // texels
};

/// Texels in rows, top row first; every level is padded to even sides so that a 2x2 quad never leaves it. A layer holds its
/// whole mip chain. Each sample of a layer is a plane of its own, the samples of one layer after the other. Stencil values are
/// bytes in planes of their own.
class Texture {
public:
    /// Zero-filled. Throws Error for sides, level and layer counts or sizes in bytes that are out of range.
    explicit Texture(const TextureDesc& desc);

    [[nodiscard]] const TextureDesc& desc() const { return desc_; }
    [[nodiscard]] const FormatInfo& info() const { return format_info(desc_.format); }
    [[nodiscard]] const LevelTable& table() const { return table_; }
    [[nodiscard]] int width(int level) const { return level_size(desc_.width, level); }
    [[nodiscard]] int height(int level) const { return level_size(desc_.height, level); }

    /// Bytes from one layer to the next where there is one sample, from one sample to the next where there are more.
    [[nodiscard]] std::int32_t layer_stride() const { return layer_stride_; }
    /// Bytes of all of it, padding included.
    [[nodiscard]] std::size_t size_bytes() const { return size_ + stencil_size_; }

    [[nodiscard]] std::byte* data() { return bytes_.get(); }
    [[nodiscard]] const std::byte* data() const { return bytes_.get(); }
    [[nodiscard]] std::byte* row(int level, int y, int layer = 0, int sample = 0) {
        return bytes_.get() + row_offset(level, y, layer, sample);
    }
    [[nodiscard]] const std::byte* row(int level, int y, int layer = 0, int sample = 0) const {
        return bytes_.get() + row_offset(level, y, layer, sample);
    }
    /// One byte per texel, `stencil_pitch(level)` per row; only where the format has stencil.
    [[nodiscard]] std::uint8_t* stencil_row(int level, int y, int layer = 0, int sample = 0) {
        return stencil_.get() + stencil_offset(level, y, layer, sample);
    }
    [[nodiscard]] const std::uint8_t* stencil_row(int level, int y, int layer = 0, int sample = 0) const {
        return stencil_.get() + stencil_offset(level, y, layer, sample);
    }
    [[nodiscard]] std::int32_t stencil_pitch(int level) const {
        const auto l = static_cast<std::size_t>(level);
        return table_.pitch[l] / info().bytes_per_texel;
    }

    /// One level's bytes without the padding, rows top first.
    [[nodiscard]] std::vector<std::byte> level_bytes(int level, int layer = 0, int sample = 0) const;
    [[nodiscard]] std::vector<std::uint8_t> stencil_bytes(int level, int layer = 0, int sample = 0) const;
    /// Replaces one level; `bytes` is laid out as level_bytes gives it and must have that size.
    void set_level_bytes(int level, const std::byte* bytes, std::size_t size, int layer = 0, int sample = 0);

private:
    [[nodiscard]] std::size_t plane(int layer, int sample) const {
        return static_cast<std::size_t>(layer * desc_.samples + sample);
    }
    [[nodiscard]] std::size_t row_offset(int level, int y, int layer, int sample) const {
        const auto l = static_cast<std::size_t>(level);
        return static_cast<std::size_t>(table_.offset[l]) +
               static_cast<std::size_t>(table_.pitch[l]) * static_cast<std::size_t>(y) +
               static_cast<std::size_t>(layer_stride_) * plane(layer, sample);
    }
    /// The levels of stencil lie as those of depth do, with a byte for each texel.
    [[nodiscard]] std::size_t stencil_offset(int level, int y, int layer, int sample) const {
        return row_offset(level, y, layer, sample) / static_cast<std::size_t>(info().bytes_per_texel);
    }

    TextureDesc desc_;
    LevelTable table_;
    std::int32_t layer_stride_ = 0;
    std::size_t size_ = 0;
    std::size_t stencil_size_ = 0;
    hwy::AlignedFreeUniquePtr<std::byte[]> bytes_;
    hwy::AlignedFreeUniquePtr<std::uint8_t[]> stencil_;
};

}  // namespace gnomon
