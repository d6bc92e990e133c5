// Everything the device can be told: the one narrow interface, which a recorder can observe.
//
// Commands are plain values. Spans point into the caller's memory and are valid only while the command executes.
#pragma once

#include "pipeline/state.h"
#include "texunit/texture.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <variant>

namespace gnomon {

/// Stable names of resources, given by the device in the order of creation, from 1.
enum class BufferId : std::uint32_t { None = 0 };
enum class TextureId : std::uint32_t { None = 0 };

/// How a pixel functor names what it reads, as data members. A TextureId is a texture with one sample per texel and all of its
/// levels, this is some of its levels: the draw may write the others. A TextureId stands for it wherever a functor takes one.
/// D3D11.3 5.2
struct TextureLevels {
    TextureId texture = TextureId::None;
    int first_level = 0;  // what the functor sees as level 0
    int levels = 0;       // 0: all from there on

    constexpr TextureLevels() = default;
    constexpr TextureLevels(TextureId id, int first = 0, int count = 0) : texture(id), first_level(first), levels(count) {}
    bool operator==(const TextureLevels&) const = default;
};

/// A texture with any number of samples per texel, one too: it can only be loaded from, sample by sample. D3D11.3 22.4.7
struct MultisampledTexture {
    TextureId texture = TextureId::None;

    bool operator==(const MultisampledTexture&) const = default;
};

inline constexpr std::uint32_t kMaxGroups = 65535;           // per dimension of a dispatch. D3D11.3 18.6.2
inline constexpr std::size_t kMaxBufferBytes = 1ull << 31u;  // word indices fit 31 bits with room to spare

struct Program;         // program.h
struct ComputeProgram;  // compute_program.h

/// One level of a texture and a run of its layers, as a target. D3D11.3 5.2
struct TargetView {
    TextureId texture = TextureId::None;
    int level = 0;
    int first_layer = 0;
    int layers = 1;  // more than one: primitives choose theirs. D3D11.3 15.15

    TargetView() = default;
    TargetView(TextureId id) : texture(id) {}  // level 0, layer 0
    TargetView(TextureId id, int at_level, int at_layer = 0, int layer_count = 1)
        : texture(id), level(at_level), first_layer(at_layer), layers(layer_count) {}
    bool operator==(const TargetView&) const = default;
};

struct CreateBuffer {
    BufferId id;
    std::string_view label;
    std::span<const std::byte> data;
    std::size_t size = 0;  // bytes, up to kMaxBufferBytes; 0: as many as data. What lies behind the data is zero
};

/// Replaces bytes [offset, offset + data.size()) of a buffer, which must lie inside it.
struct WriteBuffer {
    BufferId id;
    std::size_t offset = 0;
    std::span<const std::byte> data;
};

struct CreateTexture {
    TextureId id;
    std::string_view label;
    TextureDesc desc;
};

struct WriteTexture {
    TextureId id;
    int level = 0;
    std::span<const std::byte> data;  // rows, top first, no padding
    int layer = 0;
    int sample = 0;
};

/// Every sample of every layer of the view.
struct ClearColor {
    TargetView target;
    glm::vec4 value{0.0f};
};

struct ClearDepth {
    TargetView target;
    float value = 1.0f;  // [0, 1]
};

struct ClearStencil {
    TargetView target;
    int value = 0;  // 0 to 255
};

/// Box filter from level 0 down. mipmap.h
struct GenerateMips {
    TextureId id;
};

/// The mean of the samples of each pixel, in linear space for sRGB; one layer. D3D11.3 19.2.4, 5.6.6
struct Resolve {
    TargetView source;       // level 0 of a multisampled texture
    TargetView destination;  // the same format and size, one sample
};

/// One draw call: vertices through a program into its targets.
struct Draw {
    std::string_view label{};
    const Program* program = nullptr;
    std::span<const std::byte> vertex_constants{};  // the vertex functor
    std::span<const std::byte> pixel_constants{};   // the pixel functor; empty for depth-only programs

    Topology topology = Topology::TriangleList;
    BufferId vertices = BufferId::None;   // interleaved floats, program->vertex_floats each
    BufferId instances = BufferId::None;  // interleaved floats, program->instance_floats each; None if that is 0
    BufferId indices = BufferId::None;    // None: vertices in order
    IndexType index_type = IndexType::Uint32;
    bool primitive_restart = false;  // the index with all bits set ends a strip, a fan or an unfinished primitive. D3D11.3 8.12
    std::uint32_t first = 0;         // index or vertex
    std::uint32_t count = 0;         // per instance; what makes no whole primitive is left out. D3D11.3 8.13
    std::int32_t base_vertex = 0;    // added to every index
    std::uint32_t first_instance = 0;  // of `instances`
    std::uint32_t instance_count = 1;

    RasterState raster{};
    DepthState depth_state{};
    StencilState stencil{};
    OutputState output{};
    Viewport viewport{};
    std::span<const Viewport> viewports{};    // instead of `viewport`, where primitives choose theirs: up to kMaxViewports
    std::span<const ScissorRect> scissors{};  // empty: none; else one for every viewport

    std::array<TargetView, kMaxTargets> color{};  // the first program->targets of them; None: not written
    TargetView depth{};                           // None: no depth and stencil test

    /// Where a picture of bad derivatives goes: r32ui of the targets' size with one sample, or None. derivatives.h
    TextureId derivative_report = TextureId::None;
};

/// One compute call: a grid of groups of threads through a compute program. D3D11.3 18.6.2
struct Dispatch {
    std::string_view label{};
    const ComputeProgram* program = nullptr;
    std::span<const std::byte> constants{};  // the compute functor, which names its resources
    std::uint32_t groups_x = 1;              // each 0 to kMaxGroups; where one is 0 nothing happens
    std::uint32_t groups_y = 1;
    std::uint32_t groups_z = 1;
};

using Command = std::variant<CreateBuffer, CreateTexture, WriteBuffer, WriteTexture, ClearColor, ClearDepth, ClearStencil,
                             GenerateMips, Resolve, Draw, Dispatch>;

}  // namespace gnomon
