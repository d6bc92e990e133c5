// A hardware profile: everything in which GPUs differ, as data. docs/profiles.md explains each field, profile_choices.h what
// each may be, profile_presets.cpp where each preset has it from.
//
// `d3d11` is what the Direct3D 11.3 functional specification says, `ideal` is the yardstick: double arithmetic and exact
// weights.
#pragma once

#include "sim/fields.h"
#include "sim/profile_choices.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace gnomon {

/// The standard sample positions, by sample index. D3D11.3 19.2.4; Vulkan 1.3 26.4 (Standard Sample Locations)
inline constexpr std::array<SamplePosition, 2> kStandardSamples2{{{12, 12}, {4, 4}}};
inline constexpr std::array<SamplePosition, 4> kStandardSamples4{{{6, 2}, {14, 6}, {2, 10}, {10, 14}}};
inline constexpr std::array<SamplePosition, 8> kStandardSamples8{
    {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}}};
inline constexpr std::array<SamplePosition, 16> kStandardSamples16{{{9, 9},
                                                                    {7, 5},
                                                                    {5, 10},
                                                                    {12, 7},
                                                                    {3, 6},
                                                                    {10, 13},
                                                                    {13, 11},
                                                                    {11, 3},
                                                                    {6, 14},
                                                                    {8, 1},
                                                                    {4, 2},
                                                                    {2, 12},
                                                                    {0, 8},
                                                                    {15, 4},
                                                                    {14, 15},
                                                                    {1, 0}}};

struct Profile {
    std::string name;
    std::string summary;

    // Arithmetic and storage.
    Arithmetic arithmetic = Arithmetic::Fp32;
    bool flush_denormals = true;
    Narrowing float_narrowing = Narrowing::TowardZero;
    // Rasteriser.
    int raster_subpixel_bits = 8;  // 1 to 8
    int max_samples = 16;          // 1, 2, 4, 8 or 16
    std::array<SamplePosition, 2> sample_positions_2 = kStandardSamples2;
    std::array<SamplePosition, 4> sample_positions_4 = kStandardSamples4;
    std::array<SamplePosition, 8> sample_positions_8 = kStandardSamples8;
    std::array<SamplePosition, 16> sample_positions_16 = kStandardSamples16;
    bool multisamples_float = true;  // false: targets of floats have one sample
    ViewportArithmetic viewport_arithmetic = ViewportArithmetic::D3d11;
    Clipping clipping = Clipping::GuardBand;
    WindingArea winding_area = WindingArea::Exact;
    PlaneEquations plane_equations = PlaneEquations::Barycentric;
    bool mirrors_sample_depth = false;  // the depth of a sample is taken at the mirror image of its x in the pixel
    // Derivatives.
    DerivativeCorner derivative_corner = DerivativeCorner::TopLeft;
    PlainDerivative plain_derivative = PlainDerivative::Coarse;
    // Output merger.
    int max_targets = 8;  // 1 to 8
    bool blends_float16 = true;
    bool blends_float32 = true;
    AlphaToCoverage alpha_to_coverage = AlphaToCoverage::Rounded;
    DepthBiasPlace depth_bias_place = DepthBiasPlace::Vertex;
    int depth_bias_steps = 1;  // 1 to 8: smallest steps of a UNORM depth format in one unit of the constant bias
    DepthBiasArithmetic depth_bias_arithmetic = DepthBiasArithmetic::D3d11;
    DepthRounding depth_rounding = DepthRounding::HalfUp;
    BlendArithmetic blend_arithmetic = BlendArithmetic::D3d11;
    UnormRounding unorm_rounding = UnormRounding::HalfUp;  // of UNORM colour targets
    HalfTargets half_targets = HalfTargets::Narrowed;
    ResolveArithmetic resolve_arithmetic = ResolveArithmetic::Mean;
    // Texture unit: addresses and weights.
    AddressArithmetic address_arithmetic = AddressArithmetic::FixedPoint;
    int texel_fraction_bits = 8;  // 1 to 8 or kExactBits
    FixedRounding texel_rounding = FixedRounding::NearestEven;
    TexelCarry texel_carry = TexelCarry::Texel;
    // Texture unit: texels and filter.
    BilinearForm bilinear_form = BilinearForm::Lerp;
    UnormDecode unorm_decode = UnormDecode::Divide;
    UnormFilter unorm_filter = UnormFilter::Float;
    bool filters_float32 = true;  // false: formats of 32-bit floats can only be point-sampled
    BorderPrecision border_precision = BorderPrecision::Float;
    CompareReference compare_reference = CompareReference::Quantised;
    CubeEdges cube_edges = CubeEdges::Seamless;
    CubeCorner cube_corner = CubeCorner::ThreeTexels;
    // Texture unit: level of detail.
    LodRule lod_rule = LodRule::Longest;
    Log2Model log2_model = Log2Model::Exact;
    int lod_fraction_bits = 8;  // 1 to 8 or kExactBits
    FixedRounding lod_rounding = FixedRounding::NearestEven;
    LodSharing lod_sharing = LodSharing::Quad;
    MipTie mip_tie = MipTie::Up;
    // Texture unit: anisotropy.
    AnisoRule aniso_rule = AnisoRule::D3d11;
    bool ellipse_transform =
        true;  // of anisotropic filters: derivatives become the axes of their ellipse first. D3D11.3 7.18.11
    bool aniso_clamps_to_top = false;  // the level of detail takes a minor axis below one texel for one. D3D11.3 7.18.11
    ProbeCount probe_count = ProbeCount::Ceil;
    ProbePlacement probe_placement = ProbePlacement::Interior;
    AnisoLimits aniso_limits = AnisoLimits::Any;
    // Mip generation.
    MipGeneration mip_generation = MipGeneration::Box;

    static constexpr auto fields() {
        using P = Profile;
        return std::tuple{Field{"name", &P::name},
                          Field{"summary", &P::summary},
                          Field{"arithmetic", &P::arithmetic},
                          Field{"flush_denormals", &P::flush_denormals},
                          Field{"float_narrowing", &P::float_narrowing},
                          Field{"raster_subpixel_bits", &P::raster_subpixel_bits},
                          Field{"max_samples", &P::max_samples},
                          Field{"sample_positions_2", &P::sample_positions_2},
                          Field{"sample_positions_4", &P::sample_positions_4},
                          Field{"sample_positions_8", &P::sample_positions_8},
                          Field{"sample_positions_16", &P::sample_positions_16},
                          Field{"multisamples_float", &P::multisamples_float},
                          Field{"viewport_arithmetic", &P::viewport_arithmetic},
                          Field{"clipping", &P::clipping},
                          Field{"winding_area", &P::winding_area},
                          Field{"plane_equations", &P::plane_equations},
                          Field{"mirrors_sample_depth", &P::mirrors_sample_depth},
                          Field{"derivative_corner", &P::derivative_corner},
                          Field{"plain_derivative", &P::plain_derivative},
                          Field{"max_targets", &P::max_targets},
                          Field{"blends_float16", &P::blends_float16},
                          Field{"blends_float32", &P::blends_float32},
                          Field{"alpha_to_coverage", &P::alpha_to_coverage},
                          Field{"depth_bias_place", &P::depth_bias_place},
                          Field{"depth_bias_steps", &P::depth_bias_steps},
                          Field{"depth_bias_arithmetic", &P::depth_bias_arithmetic},
                          Field{"depth_rounding", &P::depth_rounding},
                          Field{"blend_arithmetic", &P::blend_arithmetic},
                          Field{"unorm_rounding", &P::unorm_rounding},
                          Field{"half_targets", &P::half_targets},
                          Field{"resolve_arithmetic", &P::resolve_arithmetic},
                          Field{"address_arithmetic", &P::address_arithmetic},
                          Field{"texel_fraction_bits", &P::texel_fraction_bits},
                          Field{"texel_rounding", &P::texel_rounding},
                          Field{"texel_carry", &P::texel_carry},
                          Field{"bilinear_form", &P::bilinear_form},
                          Field{"unorm_decode", &P::unorm_decode},
                          Field{"unorm_filter", &P::unorm_filter},
                          Field{"filters_float32", &P::filters_float32},
                          Field{"border_precision", &P::border_precision},
                          Field{"compare_reference", &P::compare_reference},
                          Field{"cube_edges", &P::cube_edges},
                          Field{"cube_corner", &P::cube_corner},
                          Field{"lod_rule", &P::lod_rule},
                          Field{"log2_model", &P::log2_model},
                          Field{"lod_fraction_bits", &P::lod_fraction_bits},
                          Field{"lod_rounding", &P::lod_rounding},
                          Field{"lod_sharing", &P::lod_sharing},
                          Field{"mip_tie", &P::mip_tie},
                          Field{"aniso_rule", &P::aniso_rule},
                          Field{"ellipse_transform", &P::ellipse_transform},
                          Field{"aniso_clamps_to_top", &P::aniso_clamps_to_top},
                          Field{"probe_count", &P::probe_count},
                          Field{"probe_placement", &P::probe_placement},
                          Field{"aniso_limits", &P::aniso_limits},
                          Field{"mip_generation", &P::mip_generation}};
    }
    bool operator==(const Profile&) const = default;
};

/// How sure a field of a preset is.
enum class Certainty {
    Specified,   // a specification says so
    Documented,  // documentation or published source says so, its maker's or a driver's
    Measured,    // somebody measured it
    Assumed,     // nobody outside knows; the choice is ours
};
template <>
inline constexpr std::array kEnumNames<Certainty>{
    EnumName{Certainty::Specified, "specified"}, EnumName{Certainty::Documented, "documented"},
    EnumName{Certainty::Measured, "measured"}, EnumName{Certainty::Assumed, "assumed"}};

/// Where a preset has the value of one field from.
struct Provenance {
    std::string_view field;
    Certainty certainty = Certainty::Assumed;
    std::string_view source;
};

/// The presets, `d3d11` first.
std::span<const Profile> profile_presets();

/// One entry per field of the preset but name and summary, in their order; empty for other profiles.
std::span<const Provenance> provenance_of(std::string_view preset);

/// The profile as a JSON object; every field, in order.
std::string profile_to_json(const Profile& profile);

/// One field as people read it: "exact", "true", "nearest-even", "6,2 14,6 ...".
inline std::string field_text(const std::string& value) { return value; }
inline std::string field_text(bool value) { return value ? "true" : "false"; }
inline std::string field_text(int value) { return value == kExactBits ? "exact" : fmt::format("{}", value); }
template <std::size_t kCount>
std::string field_text(const std::array<SamplePosition, kCount>& positions) {
    std::string text;
    for (const SamplePosition& at : positions) text += fmt::format("{}{},{}", text.empty() ? "" : " ", at.x, at.y);
    return text;
}
template <NamedEnum E>
std::string field_text(E value) {
    return std::string(name_of(value));
}

/// Throws Error, with `where` in front, for a field out of range. Sample positions may coincide, as programmable ones may: such
/// samples are covered together.
void check_profile(const Profile& profile, std::string_view where);

/// Reads a JSON object. A field "base" names the preset (default d3d11) that gives every field not mentioned; without a "name"
/// the profile is called by the stem of `where`, the file's path. Throws Error, with `where` in front, for unknown fields,
/// wrong types and values out of range.
Profile profile_from_json(std::string_view json, std::string_view where);

/// A preset by name, or a JSON file by path. Throws Error.
Profile load_profile(const std::string& name_or_path);

}  // namespace gnomon
