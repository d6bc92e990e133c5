// Everything the device can be told: the one narrow interface, which a recorder can observe.
//
// Commands are plain values. Spans point into the caller's memory and are valid only while the command executes.
#pragma once

#include "sim/enum_names.h"
#include "texunit/sampler.h"
#include "texunit/texture.h"

#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gnomon {

/// Stable names of resources, given by the device in the order of creation, from 1.
enum class BufferId : std::uint32_t { None = 0 };
enum class TextureId : std::uint32_t { None = 0 };

inline constexpr int kMaxTargets = 8;                        // D3D11.3 17.1
inline constexpr std::uint32_t kMaxGroups = 65535;           // per dimension of a dispatch. D3D11.3 18.6.2
inline constexpr std::size_t kMaxBufferBytes = 1ull << 31u;  // word indices fit 31 bits with room to spare

struct Program;         // program.h
struct ComputeProgram;  // compute_program.h

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
};

struct ClearColor {
    TextureId id;  // level 0
    glm::vec4 value{0.0f};
};

struct ClearDepth {
    TextureId id;
    float value = 1.0f;  // [0, 1]
};

/// Box filter from level 0 down. mipmap.h
struct GenerateMips {
    TextureId id;
};

/// Which triangles are dropped for the way they face. D3D11.3 15.11
enum class CullMode { None, Front, Back };
template <>
inline constexpr std::array kEnumNames<CullMode>{EnumName{CullMode::None, "none"}, EnumName{CullMode::Front, "front"},
                                                 EnumName{CullMode::Back, "back"}};

/// D3D11.3 15.10, 15.11
struct RasterState {
    CullMode cull = CullMode::None;
    bool front_counter_clockwise = true;  // as glTF winds its triangles
    int depth_bias = 0;                   // units of the smallest step of the depth format
    float slope_scaled_depth_bias = 0.0f;
    float depth_bias_clamp = 0.0f;  // 0: none

    static constexpr auto fields() {
        using R = RasterState;
        return std::tuple{Field{"cull", &R::cull}, Field{"front_counter_clockwise", &R::front_counter_clockwise},
                          Field{"depth_bias", &R::depth_bias}, Field{"slope_scaled_depth_bias", &R::slope_scaled_depth_bias},
                          Field{"depth_bias_clamp", &R::depth_bias_clamp}};
    }
    bool operator==(const RasterState&) const = default;
};

/// D3D11.3 17.9 to 17.11
struct DepthState {
    bool write = true;
    CompareOp compare = CompareOp::Less;  // new OP stored

    static constexpr auto fields() {
        using D = DepthState;
        return std::tuple{Field{"write", &D::write}, Field{"compare", &D::compare}};
    }
    bool operator==(const DepthState&) const = default;
};

/// In pixels, y down; the depth range is [0, 1]. D3D11.3 15.6
struct Viewport {
    int x = 0;
    int y = 0;
    int width = 0;  // 0: the whole target
    int height = 0;

    bool operator==(const Viewport&) const = default;
};

/// One draw call: an indexed or plain triangle list through a program into its targets.
struct Draw {
    std::string_view label{};
    const Program* program = nullptr;
    std::span<const std::byte> vertex_constants{};  // the vertex functor
    std::span<const std::byte> pixel_constants{};   // the pixel functor; empty for depth-only programs
    BufferId vertices = BufferId::None;             // interleaved floats, program->vertex_floats each
    BufferId indices = BufferId::None;              // 32 bit; None: vertices in order
    std::uint32_t first = 0;                        // index or vertex
    std::uint32_t count = 0;                        // a multiple of 3
    RasterState raster{};
    DepthState depth_state{};
    Viewport viewport{};
    std::array<TextureId, kMaxTargets> color{};  // the first program->targets of them, level 0
    TextureId depth = TextureId::None;           // None: no depth test
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

using Command =
    std::variant<CreateBuffer, CreateTexture, WriteTexture, ClearColor, ClearDepth, GenerateMips, Draw, WriteBuffer, Dispatch>;

}  // namespace gnomon
