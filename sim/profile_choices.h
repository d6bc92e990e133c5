// The choices of a hardware profile: what each field may be, and who says so.
#pragma once

#include "sim/enum_names.h"
#include "sim/half.h"

namespace gnomon {

/// The type that shaders, interpolators and texture filters compute in.
enum class Arithmetic { Fp32, Fp64 };
template <>
inline constexpr std::array kEnumNames<Arithmetic>{EnumName{Arithmetic::Fp32, "fp32"}, EnumName{Arithmetic::Fp64, "fp64"}};

template <>
inline constexpr std::array kEnumNames<Narrowing>{EnumName{Narrowing::TowardZero, "toward-zero"},
                                                  EnumName{Narrowing::NearestEven, "nearest-even"}};

/// How a texel coordinate becomes fixed point.
enum class FixedRounding { NearestEven, Truncate };
template <>
inline constexpr std::array kEnumNames<FixedRounding>{EnumName{FixedRounding::NearestEven, "nearest-even"},
                                                      EnumName{FixedRounding::Truncate, "truncate"}};

/// How a normalised coordinate becomes texel indices and weights.
enum class AddressArithmetic {
    FixedPoint,   // range reduction, scale, i.f fixed point, integer address modes. D3D11.3 7.18.5 to 7.18.9
    Llvmpipe,     // binary32 throughout, as Mesa 22.3.6 computes it
    SwiftShader,  // binary32 throughout, as SwiftShader computes it
};
template <>
inline constexpr std::array kEnumNames<AddressArithmetic>{EnumName{AddressArithmetic::FixedPoint, "fixed-point"},
                                                          EnumName{AddressArithmetic::Llvmpipe, "llvmpipe"},
                                                          EnumName{AddressArithmetic::SwiftShader, "swiftshader"}};

/// Where a fraction goes that rounds up to a whole texel.
enum class TexelCarry {
    Texel,   // to the next texel, with weight 0: coordinate and weight are one fixed-point number. D3D11.3 7.18.8
    Weight,  // to a weight of 1: the texel comes from the unrounded coordinate. CUDA C++ Programming Guide 19.2 (1.8 weights)
};
template <>
inline constexpr std::array kEnumNames<TexelCarry>{EnumName{TexelCarry::Texel, "texel"},
                                                   EnumName{TexelCarry::Weight, "weight"}};

/// How taps and levels are combined.
enum class BilinearForm {
    Lerp,       // u first, then v, each a + w (b - a): keeps constants constant. D3D11.3 7.18.16.3
                // What is not finite comes from a (1 - w) + b w without terms of weight 0. D3D11.3 7.18.16.2
    Products,   // the sum of the four texels times wU wV, in the order of D3D11.3 7.18.8
    PlainLerp,  // a + w (b - a), infinities and NaN as they come
    FusedLerp,  // the same with one rounding for product and sum
};
template <>
inline constexpr std::array kEnumNames<BilinearForm>{
    EnumName{BilinearForm::Lerp, "lerp"}, EnumName{BilinearForm::Products, "products"},
    EnumName{BilinearForm::PlainLerp, "plain-lerp"}, EnumName{BilinearForm::FusedLerp, "fused-lerp"}};

/// How the code of an unsigned normalised integer becomes a number.
enum class UnormDecode {
    Divide,      // code / (2^n - 1), correctly rounded. D3D11.3 3.2.3.5
    Reciprocal,  // code * binary32(1 / (2^n - 1))
    Late,        // the filter sees 16-bit integers, its result is multiplied by the reciprocal of the largest
};
template <>
inline constexpr std::array kEnumNames<UnormDecode>{EnumName{UnormDecode::Divide, "divide"},
                                                    EnumName{UnormDecode::Reciprocal, "reciprocal"},
                                                    EnumName{UnormDecode::Late, "late"}};

/// What the filter of 8-bit UNORM formats computes in.
enum class UnormFilter {
    Float,     // the profile's arithmetic, like any other format
    Llvmpipe,  // 8-bit integers, each lerp rounded, where Mesa 22.3.6 does so: wrap and clamp, one filter for min and mag
};
template <>
inline constexpr std::array kEnumNames<UnormFilter>{EnumName{UnormFilter::Float, "float"},
                                                    EnumName{UnormFilter::Llvmpipe, "llvmpipe"}};

/// What the border colour is stored as.
enum class BorderPrecision { Float, Unorm8 };
template <>
inline constexpr std::array kEnumNames<BorderPrecision>{EnumName{BorderPrecision::Float, "float"},
                                                        EnumName{BorderPrecision::Unorm8, "unorm8"}};

/// What happens to the reference value of a comparison before it meets the texel.
enum class CompareReference { Quantised, Raw };
template <>
inline constexpr std::array kEnumNames<CompareReference>{EnumName{CompareReference::Quantised, "quantised"},
                                                         EnumName{CompareReference::Raw, "raw"}};

/// What a filter finds past the edge of a cube face.
enum class CubeEdges {
    Seamless,  // the adjacent face. D3D11.3 7.18.12
    PerFace,   // the face's own edge texels again
};
template <>
inline constexpr std::array kEnumNames<CubeEdges>{EnumName{CubeEdges::Seamless, "seamless"},
                                                  EnumName{CubeEdges::PerFace, "per-face"}};

/// Where the weight of the missing fourth texel at a cube corner goes. D3D11.3 7.18.12 allows both.
enum class CubeCorner { ThreeTexels, TwoAdjacent };
template <>
inline constexpr std::array kEnumNames<CubeCorner>{EnumName{CubeCorner::ThreeTexels, "three-texels"},
                                                   EnumName{CubeCorner::TwoAdjacent, "two-adjacent"}};

/// The isotropic scale factor: texels per pixel from the two derivative vectors dX and dY, in texels of level 0.
enum class LodRule {
    Longest,  // max(|dX|, |dY|). D3D11.3 7.18.11; Vulkan and OpenGL allow it
    Box,      // the largest component of either: the lower bound of Vulkan 1.3 (Scale Factor Operation) and OpenGL 4.6 8.14.1
    Area,     // sqrt(|dX x dY|). [Lefohn07] eq. 1
};
template <>
inline constexpr std::array kEnumNames<LodRule>{EnumName{LodRule::Longest, "longest"}, EnumName{LodRule::Box, "box"},
                                                EnumName{LodRule::Area, "area"}};

/// How the level of detail is taken from the scale factor rho.
enum class Log2Model {
    Exact,    // log2(rho)
    Linear2,  // half of the piecewise linear log2 of rho^2: up to 0.0430 too low
    Linear4,  // a quarter of the piecewise linear log2 of rho^4: up to 0.0215 too low
};
template <>
inline constexpr std::array kEnumNames<Log2Model>{EnumName{Log2Model::Exact, "exact"}, EnumName{Log2Model::Linear2, "linear-2"},
                                                  EnumName{Log2Model::Linear4, "linear-4"}};

/// Whether the lanes of a quad share one level of detail.
enum class LodSharing { Quad, Pixel };
template <>
inline constexpr std::array kEnumNames<LodSharing>{EnumName{LodSharing::Quad, "quad"}, EnumName{LodSharing::Pixel, "pixel"}};

/// The level that nearest mip selection takes half-way between two.
enum class MipTie {
    Up,    // the coarser: floor(lod + 1/2). D3D11.3 7.18.10
    Down,  // the finer: ceil(lod + 1/2) - 1. Vulkan 1.3 (Image Level(s) Selection) (preferred)
    Even,  // the even one
};
template <>
inline constexpr std::array kEnumNames<MipTie>{EnumName{MipTie::Up, "up"}, EnumName{MipTie::Down, "down"},
                                               EnumName{MipTie::Even, "even"}};

/// Degree of anisotropy and level of detail from the two derivative vectors.
enum class AnisoRule {
    D3d11,        // ratio major^2 / |det|, level of detail from the minor axis. D3D11.3 7.18.11
    OpenGl,       // N = min(ceil(Pmax / Pmin), max), log2(Pmax / N). EXT_texture_filter_anisotropic
    Vulkan,       // eta = min(Pmax / Pmin, max), log2(Pmax / eta). Vulkan 1.3 (Scale Factor Operation)
    Llvmpipe,     // an elliptic weighted average of nearest texels of one level, as Mesa 22.3.6 walks it
    SwiftShader,  // as SwiftShader computes it
};
template <>
inline constexpr std::array kEnumNames<AnisoRule>{
    EnumName{AnisoRule::D3d11, "d3d11"}, EnumName{AnisoRule::OpenGl, "opengl"}, EnumName{AnisoRule::Vulkan, "vulkan"},
    EnumName{AnisoRule::Llvmpipe, "llvmpipe"}, EnumName{AnisoRule::SwiftShader, "swiftshader"}};

/// The number of probes for a ratio of anisotropy, at most the sampler's limit.
enum class ProbeCount {
    Ceil,   // the next whole number. EXT_texture_filter_anisotropic
    Round,  // the nearest whole number, halves up
    Steps,  // the next of 1, 2, 4, 6, 8, 10, 12, 16
};
template <>
inline constexpr std::array kEnumNames<ProbeCount>{EnumName{ProbeCount::Ceil, "ceil"}, EnumName{ProbeCount::Round, "round"},
                                                   EnumName{ProbeCount::Steps, "steps"}};

/// Where the probes of an anisotropic filter lie.
enum class ProbePlacement {
    Interior,  // at i / (N + 1) - 1/2 of the major axis, i = 1..N. Vulkan 1.3 (Texel Anisotropic Filtering),
               // EXT_texture_filter_anisotropic
    Centred,   // at (k + 1/2) / N - 1/2, k = 0..N-1
    Ewa,       // no line of probes: every texel in the ellipse, weighted by a Gaussian. [Heckbert89] 3.5.8
};
template <>
inline constexpr std::array kEnumNames<ProbePlacement>{EnumName{ProbePlacement::Interior, "interior"},
                                                       EnumName{ProbePlacement::Centred, "centred"},
                                                       EnumName{ProbePlacement::Ewa, "ewa"}};

/// Which limits of anisotropy the hardware has.
enum class AnisoLimits {
    Any,    // every whole number from 1 to 16
    Steps,  // 1, 2, 4, 6, 8, 10, 12, 16: others count as the next lower one
};
template <>
inline constexpr std::array kEnumNames<AnisoLimits>{EnumName{AnisoLimits::Any, "any"}, EnumName{AnisoLimits::Steps, "steps"}};

/// The filter that makes a mip level from the one above.
enum class MipGeneration {
    Box,       // the exact area of the coarser texel: 2 texels per axis of even size, 3 of odd size
    Bilinear,  // one bilinear sample at the coarser texel's centre: the middle 2 texels of any size
};
template <>
inline constexpr std::array kEnumNames<MipGeneration>{EnumName{MipGeneration::Box, "box"},
                                                      EnumName{MipGeneration::Bilinear, "bilinear"}};

/// Where one sample of a pixel lies, in 1/16 pixel from its top-left corner. D3D11.3 19.2.4
struct SamplePosition {
    int x = 8;  // 0 to 15
    int y = 8;

    bool operator==(const SamplePosition&) const = default;
};

/// Which pixels of a quad a coarse derivative is taken from: a row and a column through one corner. D3D11.3 22.5.2
enum class DerivativeCorner { TopLeft, TopRight, BottomLeft, BottomRight };
template <>
inline constexpr std::array kEnumNames<DerivativeCorner>{
    EnumName{DerivativeCorner::TopLeft, "top-left"}, EnumName{DerivativeCorner::TopRight, "top-right"},
    EnumName{DerivativeCorner::BottomLeft, "bottom-left"}, EnumName{DerivativeCorner::BottomRight, "bottom-right"}};

/// What a derivative is that the shader asks for without saying coarse or fine.
enum class PlainDerivative { Coarse, Fine };
template <>
inline constexpr std::array kEnumNames<PlainDerivative>{EnumName{PlainDerivative::Coarse, "coarse"},
                                                        EnumName{PlainDerivative::Fine, "fine"}};

/// How alpha becomes a coverage mask. D3D11.3 17.18 fixes only both ends.
enum class AlphaToCoverage {
    Rounded,  // the first round(alpha N) samples, halves up
    Ramp,     // sample s where alpha > s / N
};
template <>
inline constexpr std::array kEnumNames<AlphaToCoverage>{EnumName{AlphaToCoverage::Rounded, "rounded"},
                                                        EnumName{AlphaToCoverage::Ramp, "ramp"}};

/// Where the depth bias is added.
enum class DepthBiasPlace {
    Vertex,    // to each vertex, before the plane is set up. D3D11.3 15.10
    Fragment,  // to the interpolated depth of each fragment
};
template <>
inline constexpr std::array kEnumNames<DepthBiasPlace>{EnumName{DepthBiasPlace::Vertex, "vertex"},
                                                       EnumName{DepthBiasPlace::Fragment, "fragment"}};

/// How a clip position becomes a position on the raster grid.
enum class ViewportArithmetic {
    D3d11,     // divide, scale, offset, snap, a rounding each. D3D11.3 15.5, 15.6, 3.4.1
    Llvmpipe,  // times 1/w, scale and offset fused (of vertices that clipping made: not), snapped from the first sample centre
    SwiftShader,  // times 1/w, then scale and offset in grid steps, snapped in one go
};
template <>
inline constexpr std::array kEnumNames<ViewportArithmetic>{EnumName{ViewportArithmetic::D3d11, "d3d11"},
                                                           EnumName{ViewportArithmetic::Llvmpipe, "llvmpipe"},
                                                           EnumName{ViewportArithmetic::SwiftShader, "swiftshader"}};

/// What is clipped, and what becomes of it.
enum class Clipping {
    GuardBand,    // near, far, and what 16.8 positions cannot hold; the rest is triangles that share no pixel. D3D11.3 15.4
    Llvmpipe,     // the whole view volume in binary32, right first, near and far last; the rest is a fan, each with its planes
    SwiftShader,  // the whole view volume in binary32, near first, top and bottom last; the rest is filled as one polygon
};
template <>
inline constexpr std::array kEnumNames<Clipping>{EnumName{Clipping::GuardBand, "guard-band"},
                                                 EnumName{Clipping::Llvmpipe, "llvmpipe"},
                                                 EnumName{Clipping::SwiftShader, "swiftshader"}};

/// What decides which way round a triangle is.
enum class WindingArea {
    Exact,    // the area of what is drawn. D3D11.3 15.11.1
    Float32,  // that of the unclipped triangle, in binary32 grid steps; where it is wrong or zero, nothing is drawn
};
template <>
inline constexpr std::array kEnumNames<WindingArea>{EnumName{WindingArea::Exact, "exact"},
                                                    EnumName{WindingArea::Float32, "float32"}};

/// How depth and varyings follow from the vertices.
enum class PlaneEquations {
    Barycentric,  // through snapped positions, slopes in double rounded once, from a vertex. D3D11.3 15.16.2 leaves it open
    Llvmpipe,     // through positions that were not snapped, from the target's corner, evaluated with fused multiply-adds
    SwiftShader,  // through snapped positions of the unclipped triangle, in binary32 from the vertex of largest w
};
template <>
inline constexpr std::array kEnumNames<PlaneEquations>{EnumName{PlaneEquations::Barycentric, "barycentric"},
                                                       EnumName{PlaneEquations::Llvmpipe, "llvmpipe"},
                                                       EnumName{PlaneEquations::SwiftShader, "swiftshader"}};

/// How a depth becomes the code of d16 or d24; NaN gives the lower end of the depth range, to llvmpipe the upper.
enum class DepthRounding {
    HalfUp,       // exact, halves up. D3D11.3 3.2.3.6
    Llvmpipe,     // d16 in two binary32 roundings, d24 as nearest-even
    NearestEven,  // of the binary32 product
};
template <>
inline constexpr std::array kEnumNames<DepthRounding>{EnumName{DepthRounding::HalfUp, "half-up"},
                                                      EnumName{DepthRounding::Llvmpipe, "llvmpipe"},
                                                      EnumName{DepthRounding::NearestEven, "nearest-even"}};

/// How the depth bias is computed.
enum class DepthBiasArithmetic {
    D3d11,        // D3D11.3 15.10
    Llvmpipe,     // the same in binary32 from its own slopes
    SwiftShader,  // a step is 1.01 / 65535, or that of the first depth and of the others' differences from it
};
template <>
inline constexpr std::array kEnumNames<DepthBiasArithmetic>{EnumName{DepthBiasArithmetic::D3d11, "d3d11"},
                                                            EnumName{DepthBiasArithmetic::Llvmpipe, "llvmpipe"},
                                                            EnumName{DepthBiasArithmetic::SwiftShader, "swiftshader"}};

/// What blend equations are computed in.
enum class BlendArithmetic {
    D3d11,        // the profile's arithmetic, products rounded, then the sum. D3D11.3 17.1, 17.5
    Llvmpipe,     // UNORM on integers of the target's width, floats with one product where both factors are one name
    SwiftShader,  // binary32; equations that are nothing, the source or the target are not computed
};
template <>
inline constexpr std::array kEnumNames<BlendArithmetic>{EnumName{BlendArithmetic::D3d11, "d3d11"},
                                                        EnumName{BlendArithmetic::Llvmpipe, "llvmpipe"},
                                                        EnumName{BlendArithmetic::SwiftShader, "swiftshader"}};

/// How a colour becomes the code of an UNORM target.
enum class UnormRounding {
    HalfUp,       // exact, halves up. D3D11.3 3.2.3.6
    Llvmpipe,     // 8 bits: nearest-even of the binary32 product; 16 bits: in two binary32 roundings
    NearestEven,  // of the binary32 product
};
template <>
inline constexpr std::array kEnumNames<UnormRounding>{EnumName{UnormRounding::HalfUp, "half-up"},
                                                      EnumName{UnormRounding::Llvmpipe, "llvmpipe"},
                                                      EnumName{UnormRounding::NearestEven, "nearest-even"}};

/// The halves of targets.
enum class HalfTargets {
    Narrowed,     // IEEE, rounded as `float_narrowing` says. D3D11.3 3.2.2
    TowardZero,   // IEEE, cut off
    SwiftShader,  // no infinities: exponent 31 is one more exponent, and 0x7fff holds all that is larger
};
template <>
inline constexpr std::array kEnumNames<HalfTargets>{EnumName{HalfTargets::Narrowed, "narrowed"},
                                                    EnumName{HalfTargets::TowardZero, "toward-zero"},
                                                    EnumName{HalfTargets::SwiftShader, "swiftshader"}};

/// The mean of the samples of a pixel.
enum class ResolveArithmetic {
    Mean,         // the sum in the profile's arithmetic, in order of samples. D3D11.3 19.2.4
    Llvmpipe,     // the same of texels as its filters read them, stored as a colour is
    SwiftShader,  // 8 bits: the upper mean of two upper means; 16 bits: of codes; floats: of numbers
};
template <>
inline constexpr std::array kEnumNames<ResolveArithmetic>{EnumName{ResolveArithmetic::Mean, "mean"},
                                                          EnumName{ResolveArithmetic::Llvmpipe, "llvmpipe"},
                                                          EnumName{ResolveArithmetic::SwiftShader, "swiftshader"}};

/// Number of fraction bits that means "not quantised at all".
inline constexpr int kExactBits = -1;

}  // namespace gnomon
