// The state of a draw call: plain values with the specification's defaults, checked when a draw is built (validate.h).
#pragma once

#include "sim/enum_names.h"
#include "sim/fields.h"
#include "texunit/sampler.h"

#include <glm/vec4.hpp>

#include <array>
#include <cstdint>

namespace gnomon {

inline constexpr int kMaxTargets = 8;     // D3D11.3 17.14
inline constexpr int kMaxViewports = 16;  // D3D11.3 15.8.1

/// How vertices become primitives. D3D11.3 8.10; fans as Vulkan 1.3 20.1 has them
enum class Topology { PointList, LineList, LineStrip, TriangleList, TriangleStrip, TriangleFan };
template <>
inline constexpr std::array kEnumNames<Topology>{
    EnumName{Topology::PointList, "point-list"},         EnumName{Topology::LineList, "line-list"},
    EnumName{Topology::LineStrip, "line-strip"},         EnumName{Topology::TriangleList, "triangle-list"},
    EnumName{Topology::TriangleStrip, "triangle-strip"}, EnumName{Topology::TriangleFan, "triangle-fan"}};

enum class IndexType { Uint16, Uint32 };
template <>
inline constexpr std::array kEnumNames<IndexType>{EnumName{IndexType::Uint16, "uint16"}, EnumName{IndexType::Uint32, "uint32"}};

/// Which triangles are dropped for the way they face. D3D11.3 15.11
enum class CullMode { None, Front, Back };
template <>
inline constexpr std::array kEnumNames<CullMode>{EnumName{CullMode::None, "none"}, EnumName{CullMode::Front, "front"},
                                                 EnumName{CullMode::Back, "back"}};

/// D3D11.3 15.13
enum class FillMode { Solid, Wireframe };
template <>
inline constexpr std::array kEnumNames<FillMode>{EnumName{FillMode::Solid, "solid"},
                                                 EnumName{FillMode::Wireframe, "wireframe"}};

/// The vertex that gives a primitive its flat values, its viewport and its array slice.
enum class ProvokingVertex {
    First,  // the leading vertex. D3D11.3 8.14
    Last,   // OpenGL 4.6 13.4 (its default)
};
template <>
inline constexpr std::array kEnumNames<ProvokingVertex>{EnumName{ProvokingVertex::First, "first"},
                                                        EnumName{ProvokingVertex::Last, "last"}};

/// D3D11.3 15.14.1
enum class LineMode {
    Aliased,        // pixels whose diamond the line leaves; every sample of them. D3D11.3 3.4.3
    Quadrilateral,  // a rectangle of width 1.4. D3D11.3 3.4.5
};
template <>
inline constexpr std::array kEnumNames<LineMode>{EnumName{LineMode::Aliased, "aliased"},
                                                 EnumName{LineMode::Quadrilateral, "quadrilateral"}};

/// D3D11.3 15.1
struct RasterState {
    FillMode fill = FillMode::Solid;
    CullMode cull = CullMode::None;
    bool front_counter_clockwise = true;  // as glTF winds its triangles
    ProvokingVertex provoking = ProvokingVertex::First;
    LineMode lines = LineMode::Aliased;
    bool depth_clip = true;                // false: depths beyond the viewport's range are clamped to it. D3D11.3 15.4
    int depth_bias = 0;                    // units of the smallest step of the depth format. D3D11.3 15.10
    float slope_scaled_depth_bias = 0.0f;  // finite
    float depth_bias_clamp = 0.0f;         // 0: none; no NaN

    static constexpr auto fields() {
        using R = RasterState;
        return std::tuple{Field{"fill", &R::fill},
                          Field{"cull", &R::cull},
                          Field{"front_counter_clockwise", &R::front_counter_clockwise},
                          Field{"provoking", &R::provoking},
                          Field{"lines", &R::lines},
                          Field{"depth_clip", &R::depth_clip},
                          Field{"depth_bias", &R::depth_bias},
                          Field{"slope_scaled_depth_bias", &R::slope_scaled_depth_bias},
                          Field{"depth_bias_clamp", &R::depth_bias_clamp}};
    }
    bool operator==(const RasterState&) const = default;
};

/// D3D11.3 17.9 to 17.11
struct DepthState {
    bool test = true;  // false: no test and no write
    bool write = true;
    CompareOp compare = CompareOp::Less;  // new OP stored

    static constexpr auto fields() {
        using D = DepthState;
        return std::tuple{Field{"test", &D::test}, Field{"write", &D::write}, Field{"compare", &D::compare}};
    }
    bool operator==(const DepthState&) const = default;
};

/// What happens to a stored stencil value. D3D11.3 17.8
enum class StencilOp { Keep, Zero, Replace, IncrementSaturate, DecrementSaturate, Invert, Increment, Decrement };
template <>
inline constexpr std::array kEnumNames<StencilOp>{EnumName{StencilOp::Keep, "keep"},
                                                  EnumName{StencilOp::Zero, "zero"},
                                                  EnumName{StencilOp::Replace, "replace"},
                                                  EnumName{StencilOp::IncrementSaturate, "increment-saturate"},
                                                  EnumName{StencilOp::DecrementSaturate, "decrement-saturate"},
                                                  EnumName{StencilOp::Invert, "invert"},
                                                  EnumName{StencilOp::Increment, "increment"},
                                                  EnumName{StencilOp::Decrement, "decrement"}};

/// Of primitives that face one way.
struct StencilFace {
    CompareOp compare = CompareOp::Always;  // (reference & read_mask) OP (stored & read_mask)
    StencilOp fail = StencilOp::Keep;       // the comparison failed
    StencilOp depth_fail = StencilOp::Keep;
    StencilOp pass = StencilOp::Keep;

    static constexpr auto fields() {
        using S = StencilFace;
        return std::tuple{Field{"compare", &S::compare}, Field{"fail", &S::fail}, Field{"depth_fail", &S::depth_fail},
                          Field{"pass", &S::pass}};
    }
    bool operator==(const StencilFace&) const = default;
};

/// D3D11.3 17.8, 17.12
struct StencilState {
    bool test = false;
    int reference = 0;  // 0 to 255
    int read_mask = 0xff;
    int write_mask = 0xff;
    StencilFace front{};
    StencilFace back{};

    static constexpr auto fields() {
        using S = StencilState;
        return std::tuple{Field{"test", &S::test},           Field{"reference", &S::reference},
                          Field{"read_mask", &S::read_mask}, Field{"write_mask", &S::write_mask},
                          Field{"front", &S::front},         Field{"back", &S::back}};
    }
    bool operator==(const StencilState&) const = default;
};

/// D3D11.3 17.1
enum class BlendFactor {
    Zero,
    One,
    SrcColor,
    InvSrcColor,
    SrcAlpha,
    InvSrcAlpha,
    DstAlpha,
    InvDstAlpha,
    DstColor,
    InvDstColor,
    SrcAlphaSaturate,
    Constant,
    InvConstant,
    Src1Color,  // the second colour of the pixel functor. D3D11.3 17.6
    InvSrc1Color,
    Src1Alpha,
    InvSrc1Alpha,
};
template <>
inline constexpr std::array kEnumNames<BlendFactor>{EnumName{BlendFactor::Zero, "zero"},
                                                    EnumName{BlendFactor::One, "one"},
                                                    EnumName{BlendFactor::SrcColor, "src-color"},
                                                    EnumName{BlendFactor::InvSrcColor, "inv-src-color"},
                                                    EnumName{BlendFactor::SrcAlpha, "src-alpha"},
                                                    EnumName{BlendFactor::InvSrcAlpha, "inv-src-alpha"},
                                                    EnumName{BlendFactor::DstAlpha, "dst-alpha"},
                                                    EnumName{BlendFactor::InvDstAlpha, "inv-dst-alpha"},
                                                    EnumName{BlendFactor::DstColor, "dst-color"},
                                                    EnumName{BlendFactor::InvDstColor, "inv-dst-color"},
                                                    EnumName{BlendFactor::SrcAlphaSaturate, "src-alpha-saturate"},
                                                    EnumName{BlendFactor::Constant, "constant"},
                                                    EnumName{BlendFactor::InvConstant, "inv-constant"},
                                                    EnumName{BlendFactor::Src1Color, "src1-color"},
                                                    EnumName{BlendFactor::InvSrc1Color, "inv-src1-color"},
                                                    EnumName{BlendFactor::Src1Alpha, "src1-alpha"},
                                                    EnumName{BlendFactor::InvSrc1Alpha, "inv-src1-alpha"}};

/// Min and Max take no factors. D3D11.3 17.1
enum class BlendOp { Add, Subtract, ReverseSubtract, Min, Max };
template <>
inline constexpr std::array kEnumNames<BlendOp>{EnumName{BlendOp::Add, "add"}, EnumName{BlendOp::Subtract, "subtract"},
                                                EnumName{BlendOp::ReverseSubtract, "reverse-subtract"},
                                                EnumName{BlendOp::Min, "min"}, EnumName{BlendOp::Max, "max"}};

/// Of one target. D3D11.3 17.1, 17.15
struct BlendState {
    bool enable = false;
    BlendFactor src = BlendFactor::One;
    BlendFactor dst = BlendFactor::Zero;
    BlendOp op = BlendOp::Add;
    BlendFactor src_alpha = BlendFactor::One;
    BlendFactor dst_alpha = BlendFactor::Zero;
    BlendOp op_alpha = BlendOp::Add;
    int write_mask = 0xf;  // bit c: component c is written

    static constexpr auto fields() {
        using B = BlendState;
        return std::tuple{Field{"enable", &B::enable},
                          Field{"src", &B::src},
                          Field{"dst", &B::dst},
                          Field{"op", &B::op},
                          Field{"src_alpha", &B::src_alpha},
                          Field{"dst_alpha", &B::dst_alpha},
                          Field{"op_alpha", &B::op_alpha},
                          Field{"write_mask", &B::write_mask}};
    }
    bool operator==(const BlendState&) const = default;
};

/// Of all targets of a draw. D3D11.3 17.1, 17.17, 17.18
struct OutputState {
    std::array<BlendState, kMaxTargets> blend{};
    glm::vec4 blend_constant{0.0f};
    std::uint32_t sample_mask = 0xffffffffu;  // bit s: sample s may be written
    bool alpha_to_coverage = false;           // of the first colour's alpha

    bool operator==(const OutputState&) const = default;
};

/// In pixels, y down. D3D11.3 15.6, 15.6.1, 15.9
struct Viewport {
    float x = 0.0f;
    float y = 0.0f;
    float width = 0.0f;  // 0: the whole target
    float height = 0.0f;
    float min_depth = 0.0f;  // 0 <= min_depth <= max_depth <= 1
    float max_depth = 1.0f;

    bool operator==(const Viewport&) const = default;
};

/// Pixels [x0, x1) x [y0, y1) that may be written; it may be larger than the target. D3D11.3 15.7
struct ScissorRect {
    int x0 = 0;
    int y0 = 0;
    int x1 = 0;
    int y1 = 0;

    bool operator==(const ScissorRect&) const = default;
};

}  // namespace gnomon
