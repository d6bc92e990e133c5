// A 2D texture and its mip chain in memory. D3D11.3 5.3
#pragma once

#include "texunit/format.h"

#include <hwy/aligned_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gnomon {

inline constexpr int kMaxTextureSize = 16384;  // D3D11.3 21.2 (resource limits)
inline constexpr int kMaxLevels = 15;          // of a 16384 texel side
static_assert(kMaxTextureSize == 1 << (kMaxLevels - 1));

struct TextureDesc {
    Format format = Format::Rgba8Unorm;
    int width = 1;   // texels, 1 to kMaxTextureSize
    int height = 1;  // texels, 1 to kMaxTextureSize
    int levels = 1;  // 1 to full_level_count(width, height)

    bool operator==(const TextureDesc&) const = default;
};

/// Number of levels down to 1x1.
constexpr int full_level_count(int width, int height) {
    int levels = 1;
    for (int size = width > height ? width : height; size > 1; size /= 2) ++levels;
    return levels;
}

/// Side of a level: halved and rounded down, at least 1. D3D11.3 5.7
constexpr int level_size(int size, int level) { return size >> level > 1 ? size >> level : 1; }

/// Where each level lies: the tables that lanes on different levels gather from.
struct LevelTable {
    alignas(64) std::array<std::int32_t, 16> offset{};  // bytes from the start of the texture
    alignas(64) std::array<std::int32_t, 16> pitch{};   // bytes per row
    alignas(64) std::array<std::int32_t, 16> width{};   // texels
    alignas(64) std::array<std::int32_t, 16> height{};  // texels
};

/// Texels in rows, top row first; every level is padded to even sides so that a 2x2 quad never leaves it.
class Texture {
public:
    /// Zero-filled. Throws Error for sides, level counts or sizes in bytes that are out of range.
    explicit Texture(const TextureDesc& desc);

    [[nodiscard]] const TextureDesc& desc() const { return desc_; }
    [[nodiscard]] const FormatInfo& info() const { return format_info(desc_.format); }
    [[nodiscard]] const LevelTable& table() const { return table_; }
    [[nodiscard]] int width(int level) const { return level_size(desc_.width, level); }
    [[nodiscard]] int height(int level) const { return level_size(desc_.height, level); }

    [[nodiscard]] std::byte* data() { return bytes_.get(); }
    [[nodiscard]] const std::byte* data() const { return bytes_.get(); }
    [[nodiscard]] std::byte* row(int level, int y) { return bytes_.get() + row_offset(level, y); }
    [[nodiscard]] const std::byte* row(int level, int y) const { return bytes_.get() + row_offset(level, y); }

    /// One level's bytes without the padding, rows top first.
    [[nodiscard]] std::vector<std::byte> level_bytes(int level) const;
    /// Replaces one level; `bytes` is laid out as level_bytes gives it and must have that size.
    void set_level_bytes(int level, const std::byte* bytes, std::size_t size);

private:
    [[nodiscard]] std::size_t row_offset(int level, int y) const {
        const auto l = static_cast<std::size_t>(level);
        return static_cast<std::size_t>(table_.offset[l]) +
               static_cast<std::size_t>(table_.pitch[l]) * static_cast<std::size_t>(y);
    }

    TextureDesc desc_;
    LevelTable table_;
    std::size_t size_ = 0;
    hwy::AlignedFreeUniquePtr<std::byte[]> bytes_;
};

}  // namespace gnomon
