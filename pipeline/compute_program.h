// A compute program: a compute functor under a registered name, and the resources its constants name. D3D11.3 18.6
#pragma once

#include "pipeline/program.h"

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace gnomon {

struct DispatchContext;  // compute.h

/// Words of 32 bits: integers (signed or not, as the functor takes them) or floats. D3D11.3 5.3.9 (R32_SINT, R32_FLOAT)
template <class Word>
concept BufferWord = std::is_same_v<Word, std::int32_t> || std::is_same_v<Word, float>;

/// Members of a compute functor that name a resource. The `Read` ones may not be written by the same dispatch, by any name.
template <BufferWord Word>
struct ReadBuffer {
    BufferId buffer = BufferId::None;

    static constexpr auto fields() { return std::tuple{Field{"buffer", &ReadBuffer::buffer}}; }
};
template <BufferWord Word>
struct RwBuffer {
    BufferId buffer = BufferId::None;

    static constexpr auto fields() { return std::tuple{Field{"buffer", &RwBuffer::buffer}}; }
};

namespace detail {
enum class ImageAccess { Read, ReadUint, Rw, RwUint };

/// One level of one layer (or cube face) of a texture.
template <ImageAccess kAccess>
struct ImageBinding {
    TextureId texture = TextureId::None;
    int level = 0;
    int layer = 0;

    static constexpr auto fields() {
        return std::tuple{Field{"texture", &ImageBinding::texture}, Field{"level", &ImageBinding::level},
                          Field{"layer", &ImageBinding::layer}};
    }
};
}  // namespace detail

/// Texels as numbers, of every format but unsigned integers. Depth is read, never written. What an Rw image may be written, it
/// may be read: the specification asks that of R32 formats only. D3D11.3 5.3.9.5
using ReadImage = detail::ImageBinding<detail::ImageAccess::Read>;
using RwImage = detail::ImageBinding<detail::ImageAccess::Rw>;
/// Texels as codes, of formats of unsigned integers.
using ReadUintImage = detail::ImageBinding<detail::ImageAccess::ReadUint>;
using RwUintImage = detail::ImageBinding<detail::ImageAccess::RwUint>;

/// Threads of a group. D3D11.3 18.6.3
struct GroupSize {
    int x = 1;  // 1 to 1024
    int y = 1;  // 1 to 1024
    int z = 1;  // 1 to 64

    [[nodiscard]] constexpr int threads() const { return x * y * z; }  // up to 1024
    bool operator==(const GroupSize&) const = default;
};
constexpr bool is_group_size(const GroupSize& size) {
    return size.x >= 1 && size.x <= 1024 && size.y >= 1 && size.y <= 1024 && size.z >= 1 && size.z <= 64 &&
           size.threads() <= 1024;
}

/// Words of group-shared memory, all arrays of a group together; a number takes one word whatever the arithmetic of the
/// profile. D3D11.3 18.6.6, 18.6.10
inline constexpr int kMaxSharedWords = 8192;

/// One resource of a functor, as the device checks it.
struct ComputeBinding {
    std::string name;
    BufferId buffer = BufferId::None;     // of these two,
    TextureId texture = TextureId::None;  // the one `is_image` says
    int level = 0;
    int layer = 0;
    bool is_image = false;
    bool is_written = false;
    bool is_uint = false;  // of images
};

struct ComputeProgram {
    std::string_view name;
    GroupSize group_size;
    std::size_t constants_size = 0;  // bytes
    std::vector<NamedConstant> (*named_constants)(std::span<const std::byte>) = nullptr;
    std::vector<ComputeBinding> (*bindings)(std::span<const std::byte>) = nullptr;
    void (*run)(const DispatchContext&) = nullptr;
};

namespace detail {

template <class Value>
void append_binding(std::vector<ComputeBinding>&, const std::string&, const Value&) {}
template <BufferWord Word>
void append_binding(std::vector<ComputeBinding>& bindings, const std::string& name, const ReadBuffer<Word>& value) {
    bindings.push_back({.name = name, .buffer = value.buffer});
}
template <BufferWord Word>
void append_binding(std::vector<ComputeBinding>& bindings, const std::string& name, const RwBuffer<Word>& value) {
    bindings.push_back({.name = name, .buffer = value.buffer, .is_written = true});
}
template <ImageAccess kAccess>
void append_binding(std::vector<ComputeBinding>& bindings, const std::string& name, const ImageBinding<kAccess>& value) {
    bindings.push_back({.name = name,
                        .texture = value.texture,
                        .level = value.level,
                        .layer = value.layer,
                        .is_image = true,
                        .is_written = kAccess == ImageAccess::Rw || kAccess == ImageAccess::RwUint,
                        .is_uint = kAccess == ImageAccess::ReadUint || kAccess == ImageAccess::RwUint});
}

template <HasFields Struct>
void append_binding(std::vector<ComputeBinding>& bindings, const std::string& name, const Struct& nested) {
    for_each_field(nested, [&](std::string_view inner, const auto& value) {
        append_binding(bindings, fmt::format("{}.{}", name, inner), value);
    });
}

}  // namespace detail

/// Every resource that a functor names, those of structs inside it as "outer.inner".
template <class Functor>
std::vector<ComputeBinding> compute_bindings(std::span<const std::byte> bytes) {
    std::vector<ComputeBinding> bindings;
    const Functor functor = functor_from<Functor>(bytes);
    for_each_field(
        functor, [&](std::string_view name, const auto& value) { detail::append_binding(bindings, std::string(name), value); });
    return bindings;
}

}  // namespace gnomon
