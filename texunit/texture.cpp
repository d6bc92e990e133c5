#include "texunit/texture.h"

#include <bit>
#include <cstring>
#include <limits>

namespace gnomon {

namespace {

constexpr std::int64_t even(int size) { return size + (size & 1); }
constexpr std::int64_t aligned(std::int64_t bytes) { return (bytes + 63) & ~std::int64_t{63}; }
constexpr std::int64_t kTail = 4;  // gathers read 32 bits from any byte of a level's last texel

/// Bytes from one row to the next. Long rows take an odd number of cache lines: with a power of two of them, the rows of a tile
/// would fall into a few sets of the cache, and loads would wait for stores that only look like theirs.
/// Rows of depth hold whole waves (pipeline/depth.h).
constexpr std::int64_t row_pitch(int width, const FormatInfo& format) {
    constexpr std::int64_t kLong = 512;
    const std::int64_t texels = format.is_depth ? (width + 7) & ~std::int64_t{7} : even(width);
    const std::int64_t bytes = texels * format.bytes_per_texel;
    return bytes < kLong ? bytes : aligned(bytes) | 64;
}

/// The layers that a texture of a kind may have: lowest and highest.
constexpr std::pair<int, int> layer_limits(TextureKind kind) {
    switch (kind) {
        case TextureKind::Flat: return {1, 1};
        case TextureKind::Array: return {1, kMaxLayers};
        case TextureKind::Cube: return {kCubeFaces, kCubeFaces};
    }
    __builtin_unreachable();
}

}  // namespace

Texture::Texture(const TextureDesc& desc) : desc_(desc) {
    check_enum(desc.format, "format of a texture");
    check_enum(desc.kind, "kind of a texture");
    if (desc.width < 1 || desc.width > kMaxTextureSize || desc.height < 1 || desc.height > kMaxTextureSize)
        fail("texture of {}x{} texels: each side must be from 1 to {}", desc.width, desc.height, kMaxTextureSize);
    if (desc.levels < 1 || desc.levels > full_level_count(desc.width, desc.height))
        fail("texture of {}x{} texels with {} levels: expected 1 to {}", desc.width, desc.height, desc.levels,
             full_level_count(desc.width, desc.height));

    const auto [fewest, most] = layer_limits(desc.kind);
    if (desc.layers < fewest || desc.layers > most)
        fail("{} texture with {} layers: expected {} to {}", name_of(desc.kind), desc.layers, fewest, most);
    if (desc.kind == TextureKind::Cube && desc.width != desc.height)
        fail("cube texture with faces of {}x{} texels: expected squares", desc.width, desc.height);

    if (desc.samples < 1 || desc.samples > kMaxSamples || !std::has_single_bit(static_cast<unsigned>(desc.samples)))
        fail("texture with {} samples per texel: expected 1, 2, 4, 8 or 16", desc.samples);
    if (desc.samples > 1 && (desc.levels != 1 || desc.kind == TextureKind::Cube))
        fail("texture with {} samples per texel, {} levels, {}: expected one level and no cube", desc.samples, desc.levels,
             name_of(desc.kind));
    const std::int64_t planes = std::int64_t{desc.layers} * desc.samples;

    // Lay the levels out one after the other; lanes address them with 31-bit offsets.
    std::int64_t offset = 0;
    for (int level = 0; level < desc.levels; ++level) {
        const auto l = static_cast<std::size_t>(level);
        const std::int64_t pitch = row_pitch(width(level), info());
        const std::int64_t bytes = aligned(pitch * even(height(level)) + kTail);
        if ((offset + bytes) * planes > std::numeric_limits<std::int32_t>::max())
            fail("texture of {}x{} texels, {} layers and {} samples in {}: larger than 2 GiB", desc.width, desc.height,
                 desc.layers, desc.samples, info().name);
        table_.offset[l] = static_cast<std::int32_t>(offset);
        table_.pitch[l] = static_cast<std::int32_t>(pitch);
        table_.width[l] = width(level);
        table_.height[l] = height(level);
        offset += bytes;
    }

    layer_stride_ = static_cast<std::int32_t>(offset);
    size_ = static_cast<std::size_t>(offset * planes);
    bytes_ = hwy::AllocateAligned<std::byte>(size_);
    if (!bytes_) fail("texture of {}x{} texels in {}: not enough memory", desc.width, desc.height, info().name);
    std::memset(bytes_.get(), 0, size_);
    if (!info().has_stencil) return;
    stencil_size_ = size_ / static_cast<std::size_t>(info().bytes_per_texel);
    stencil_ = hwy::AllocateAligned<std::uint8_t>(stencil_size_);
    if (!stencil_) fail("texture of {}x{} texels in {}: not enough memory", desc.width, desc.height, info().name);
    std::memset(stencil_.get(), 0, stencil_size_);
}

std::vector<std::byte> Texture::level_bytes(int level, int layer, int sample) const {
    const auto row_bytes = static_cast<std::size_t>(width(level) * info().bytes_per_texel);
    std::vector<std::byte> bytes(row_bytes * static_cast<std::size_t>(height(level)));
    for (int y = 0; y < height(level); ++y)
        std::memcpy(bytes.data() + row_bytes * static_cast<std::size_t>(y), row(level, y, layer, sample), row_bytes);
    return bytes;
}

std::vector<std::uint8_t> Texture::stencil_bytes(int level, int layer, int sample) const {
    if (!info().has_stencil) fail("texture in {}: it has no stencil", info().name);
    const auto row_bytes = static_cast<std::size_t>(width(level));
    std::vector<std::uint8_t> bytes(row_bytes * static_cast<std::size_t>(height(level)));
    for (int y = 0; y < height(level); ++y)
        std::memcpy(bytes.data() + row_bytes * static_cast<std::size_t>(y), stencil_row(level, y, layer, sample), row_bytes);
    return bytes;
}

void Texture::set_level_bytes(int level, const std::byte* bytes, std::size_t size, int layer, int sample) {
    const auto row_bytes = static_cast<std::size_t>(width(level) * info().bytes_per_texel);
    if (size != row_bytes * static_cast<std::size_t>(height(level)))
        fail("texture level {} of {}x{} texels in {}: {} bytes given, expected {}", level, width(level), height(level),
             info().name, size, row_bytes * static_cast<std::size_t>(height(level)));
    for (int y = 0; y < height(level); ++y)
        std::memcpy(row(level, y, layer, sample), bytes + row_bytes * static_cast<std::size_t>(y), row_bytes);
}

}  // namespace gnomon
