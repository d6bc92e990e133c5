// The presets, field by field with certainty and source. A test asks that no field of any preset is left without.
//
// Sources: D3D11.3 and Vulkan 1.3 by section; nouveau is Mesa's driver and its register headers, which say what the hardware
// can be told; "Mesa 22.3.6" and "SwiftShader" are those renderers' own published source.
#include "sim/profile.h"

#include <algorithm>
#include <vector>

namespace gnomon {

namespace {

using enum Certainty;
using P = Profile;

/// A preset under construction.
struct Preset {
    Profile profile;
    std::vector<Provenance> provenance;

    template <class Value>
    void set(Value P::* member, std::type_identity_t<Value> value, Certainty certainty, std::string_view source) {
        profile.*member = value;
        std::apply([&](const auto&... field) { (note(field, member, {field.name, certainty, source}), ...); }, P::fields());
    }

    /// Into the order of the fields.
    void sort() {
        const auto rank = [](const Provenance& entry) {
            int place = 0;
            int found = 0;
            std::apply([&](const auto&... field) { ((++place, found = field.name == entry.field ? place : found), ...); },
                       P::fields());
            return found;
        };
        std::ranges::sort(provenance, {}, rank);
    }

private:
    template <class Member, class Value>
    void note(const Field<P, Member>& field, Value P::* member, const Provenance& said) {
        if constexpr (std::is_same_v<Member, Value>) {
            if (field.member != member) return;
            std::erase_if(provenance, [&](const Provenance& old) { return old.field == said.field; });
            provenance.push_back(said);
        }
    }
};

Preset d3d11() {
    Preset p;
    p.profile.name = "d3d11";
    p.profile.summary = "the Direct3D 11.3 functional specification; the default";
    p.set(&P::arithmetic, Arithmetic::Fp32, Specified, "D3D11.3 3.1.3");
    p.set(&P::flush_denormals, true, Specified, "D3D11.3 3.1.3.2");
    p.set(&P::float_narrowing, Narrowing::TowardZero, Specified, "D3D11.3 3.2.2");
    p.set(&P::raster_subpixel_bits, 8, Specified, "D3D11.3 3.4.1");
    p.set(&P::max_samples, 16, Specified, "D3D11.3 19.2.4: patterns up to 16; 19.2.5 asks for 1, 4 and 8");
    constexpr std::string_view kPositions = "Vulkan 1.3 26.4 (Standard Sample Locations); D3D11.3 19.2.4 has them as figures";
    p.set(&P::sample_positions_2, kStandardSamples2, Specified, kPositions);
    p.set(&P::sample_positions_4, kStandardSamples4, Specified, kPositions);
    p.set(&P::sample_positions_8, kStandardSamples8, Specified, kPositions);
    p.set(&P::sample_positions_16, kStandardSamples16, Specified, kPositions);
    p.set(&P::multisamples_float, true, Specified, "D3D11.3 19.2.5");
    p.set(&P::viewport_arithmetic, ViewportArithmetic::D3d11, Specified, "D3D11.3 15.5, 15.6, 3.4.1");
    p.set(&P::clipping, Clipping::GuardBand, Specified, "D3D11.3 15.4, 3.4.1");
    p.set(&P::winding_area, WindingArea::Exact, Specified, "D3D11.3 15.11, 15.11.1");
    p.set(&P::plane_equations, PlaneEquations::Barycentric, Assumed, "D3D11.3 15.16.2 leaves the rounding of planes open");
    p.set(&P::mirrors_sample_depth, false, Specified, "D3D11.3 3.5.4: at the sample");
    p.set(&P::derivative_corner, DerivativeCorner::TopLeft, Assumed, "D3D11.3 22.5.2 leaves the corner to the vendor");
    p.set(&P::plain_derivative, PlainDerivative::Coarse, Assumed, "Direct3D's ddx may be either; HLSL compiles it to coarse");
    p.set(&P::max_targets, 8, Specified, "D3D11.3 17.14");
    p.set(&P::blends_float16, true, Specified, "D3D11.3 19.1.4");
    p.set(&P::blends_float32, true, Specified, "D3D11.3 19.1.4");
    p.set(&P::alpha_to_coverage, AlphaToCoverage::Rounded, Assumed, "D3D11.3 17.18 fixes only alpha 0 and 1");
    p.set(&P::depth_bias_place, DepthBiasPlace::Vertex, Specified, "D3D11.3 15.10");
    p.set(&P::depth_bias_steps, 1, Specified, "D3D11.3 15.10");
    p.set(&P::depth_bias_arithmetic, DepthBiasArithmetic::D3d11, Specified, "D3D11.3 15.10");
    p.set(&P::depth_rounding, DepthRounding::HalfUp, Specified, "D3D11.3 3.2.3.6");
    p.set(&P::blend_arithmetic, BlendArithmetic::D3d11, Assumed, "D3D11.3 17.5 bounds the precision, not the roundings");
    p.set(&P::unorm_rounding, UnormRounding::HalfUp, Specified, "D3D11.3 3.2.3.6");
    p.set(&P::half_targets, HalfTargets::Narrowed, Specified, "D3D11.3 3.2.2");
    p.set(&P::resolve_arithmetic, ResolveArithmetic::Mean, Assumed, "D3D11.3 19.2.4 leaves the roundings open");
    p.set(&P::address_arithmetic, AddressArithmetic::FixedPoint, Specified, "D3D11.3 7.18.5 to 7.18.9");
    p.set(&P::texel_fraction_bits, 8, Specified, "D3D11.3 7.18.8, 7.18.16.1: at least 8");
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Specified, "D3D11.3 3.2.4.1: the ideal; 0.6 ULP allowed");
    p.set(&P::texel_carry, TexelCarry::Texel, Specified, "D3D11.3 7.18.8");
    p.set(&P::bilinear_form, BilinearForm::Lerp, Assumed, "D3D11.3 7.18.8 gives products, 7.18.16.3 what only lerps keep");
    p.set(&P::unorm_decode, UnormDecode::Divide, Specified, "D3D11.3 3.2.3.5, 3.2.3.2");
    p.set(&P::unorm_filter, UnormFilter::Float, Assumed, "D3D11.3 7.18.16.2: at least the precision of the format");
    p.set(&P::filters_float32, true, Specified, "D3D11.3 19.1.4");
    p.set(&P::border_precision, BorderPrecision::Float, Specified, "D3D11.3 7.18.9.1");
    p.set(&P::compare_reference, CompareReference::Quantised, Specified, "D3D11.3 22.4.19");
    p.set(&P::cube_edges, CubeEdges::Seamless, Specified, "D3D11.3 7.18.12");
    p.set(&P::cube_corner, CubeCorner::ThreeTexels, Specified, "D3D11.3 7.18.12: the reference of two that are allowed");
    p.set(&P::lod_rule, LodRule::Longest, Specified, "D3D11.3 7.18.11");
    p.set(&P::log2_model, Log2Model::Exact, Specified, "D3D11.3 7.18.11");
    p.set(&P::lod_fraction_bits, 8, Specified, "D3D11.3 7.18.10, 7.18.16.1: at least 8");
    p.set(&P::lod_rounding, FixedRounding::NearestEven, Specified, "D3D11.3 3.2.4.1: the ideal; 0.6 ULP allowed");
    p.set(&P::lod_sharing, LodSharing::Quad, Assumed, "D3D11.3 22.4.15 allows quads and pixels");
    p.set(&P::mip_tie, MipTie::Up, Specified, "D3D11.3 7.18.10");
    p.set(&P::aniso_rule, AnisoRule::D3d11, Specified, "D3D11.3 7.18.11");
    p.set(&P::ellipse_transform, true, Specified, "D3D11.3 7.18.11: ideal; isotropic filters do without, as it allows");
    p.set(&P::aniso_clamps_to_top, false, Specified, "D3D11.3 7.18.11: recommended since 2009");
    p.set(&P::probe_count, ProbeCount::Ceil, Assumed, "D3D11.3 leaves it open; EXT_texture_filter_anisotropic's example");
    p.set(&P::probe_placement, ProbePlacement::Interior, Assumed,
          "D3D11.3 leaves it open; Vulkan 1.3 (Texel Anisotropic Filtering)'s example");
    p.set(&P::aniso_limits, AnisoLimits::Any, Specified, "D3D11.3 7.18.3");
    p.set(&P::mip_generation, MipGeneration::Box, Assumed, "D3D11.3 5.9.3.3.1 leaves it to the driver");
    return p;
}

Preset ideal() {
    constexpr std::string_view kYardstick = "the yardstick: no error but that of the storage format";
    Preset p = d3d11();
    p.profile.name = "ideal";
    p.profile.summary = "double arithmetic, exact weights and elliptical filters: the yardstick";
    p.set(&P::arithmetic, Arithmetic::Fp64, Assumed, kYardstick);
    p.set(&P::flush_denormals, false, Assumed, kYardstick);
    p.set(&P::float_narrowing, Narrowing::NearestEven, Assumed, kYardstick);
    p.set(&P::texel_fraction_bits, kExactBits, Assumed, kYardstick);
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Assumed, "not used: nothing is rounded");
    p.set(&P::compare_reference, CompareReference::Raw, Assumed, kYardstick);
    p.set(&P::lod_fraction_bits, kExactBits, Assumed, kYardstick);
    p.set(&P::lod_rounding, FixedRounding::NearestEven, Assumed, "not used: nothing is rounded");
    p.set(&P::lod_sharing, LodSharing::Pixel, Assumed, "the sharpest of what D3D11.3 22.4.15 allows");
    p.set(&P::probe_placement, ProbePlacement::Ewa, Assumed, "[Heckbert89] 3.5.8: the filter that probes approximate");
    return p;
}

Preset d3d10() {
    Preset p = d3d11();
    p.profile.name = "d3d10";
    p.profile.summary = "Direct3D 10 class: 6-bit weights, no level of detail below 0 before bias";
    p.set(&P::texel_fraction_bits, 6, Assumed, "the least that Direct3D 10 hardware is known with");
    p.set(&P::lod_fraction_bits, 6, Assumed, "as the texel fraction");
    p.set(&P::aniso_clamps_to_top, true, Specified, "D3D11.3 7.18.11: the Direct3D 10 specification until 2009-08-17");
    return p;
}

Preset nv40() {
    constexpr std::string_view kAsD3d = "unknown; as the specification has it";
    Preset p = d3d11();
    p.profile.name = "nv40";
    p.profile.summary = "GeForce 6800 class (2004): registers documented, filter arithmetic assumed";
    p.set(&P::arithmetic, Arithmetic::Fp32, Assumed, "unknown; the shaders' binary32");
    p.set(&P::flush_denormals, true, Assumed, "unknown; its successors flush");
    p.set(&P::float_narrowing, Narrowing::NearestEven, Assumed, "unknown; what most hardware does");
    p.set(&P::raster_subpixel_bits, 8, Assumed, "unknown; GL_SUBPIXEL_BITS is commonly 8");
    p.set(&P::max_samples, 4, Measured, "published reviews of 2004: 2 on a diagonal, 4 on a rotated grid");
    p.set(&P::sample_positions_2, kStandardSamples2, Assumed, "unknown; a diagonal, as reviews describe it");
    p.set(&P::sample_positions_4, kStandardSamples4, Assumed, "unknown; a rotated grid, as reviews describe it");
    p.set(&P::sample_positions_8, kStandardSamples8, Assumed, "not used: it has 4 samples");
    p.set(&P::sample_positions_16, kStandardSamples16, Assumed, "not used: it has 4 samples");
    p.set(&P::multisamples_float, false, Measured, "published reviews: no antialiasing of fp16 targets");
    p.set(&P::derivative_corner, DerivativeCorner::TopLeft, Assumed, "unknown");
    p.set(&P::plain_derivative, PlainDerivative::Coarse, Assumed, "unknown");
    p.set(&P::max_targets, 4, Assumed, "Direct3D 9 class: four; recalled, not re-read");
    p.set(&P::blends_float16, true, Documented, "its maker's statement of 2004");
    p.set(&P::blends_float32, false, Assumed, "Direct3D 9 class; recalled, not re-read");
    p.set(&P::alpha_to_coverage, AlphaToCoverage::Rounded, Assumed, "unknown");
    p.set(&P::depth_bias_place, DepthBiasPlace::Vertex, Assumed, kAsD3d);
    p.set(&P::depth_bias_steps, 1, Assumed,
          "nouveau nv30 programs twice OpenGL's units, so its unit is likely half of two steps");
    p.set(&P::viewport_arithmetic, ViewportArithmetic::D3d11, Assumed, kAsD3d);
    p.set(&P::clipping, Clipping::GuardBand, Assumed, kAsD3d);
    p.set(&P::winding_area, WindingArea::Exact, Assumed, kAsD3d);
    p.set(&P::plane_equations, PlaneEquations::Barycentric, Assumed, kAsD3d);
    p.set(&P::mirrors_sample_depth, false, Assumed, kAsD3d);
    p.set(&P::depth_bias_arithmetic, DepthBiasArithmetic::D3d11, Assumed, kAsD3d);
    p.set(&P::depth_rounding, DepthRounding::HalfUp, Assumed, kAsD3d);
    p.set(&P::blend_arithmetic, BlendArithmetic::D3d11, Assumed, kAsD3d);
    p.set(&P::unorm_rounding, UnormRounding::HalfUp, Assumed, kAsD3d);
    p.set(&P::half_targets, HalfTargets::Narrowed, Assumed, kAsD3d);
    p.set(&P::resolve_arithmetic, ResolveArithmetic::Mean, Assumed, kAsD3d);
    p.set(&P::address_arithmetic, AddressArithmetic::FixedPoint, Assumed, kAsD3d);
    p.set(&P::texel_fraction_bits, 8, Assumed, "unknown; all of its successors have 8");
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Assumed, kAsD3d);
    p.set(&P::texel_carry, TexelCarry::Texel, Assumed, kAsD3d);
    p.set(&P::bilinear_form, BilinearForm::Lerp, Assumed, kAsD3d);
    p.set(&P::unorm_decode, UnormDecode::Divide, Assumed, kAsD3d);
    p.set(&P::unorm_filter, UnormFilter::Float, Assumed, kAsD3d);
    p.set(&P::filters_float32, false, Documented, "nouveau nv30: 32-bit float textures are forced to nearest");
    p.set(&P::border_precision, BorderPrecision::Unorm8, Documented, "nouveau nv30: the border colour register is 8-bit RGBA");
    p.set(&P::compare_reference, CompareReference::Quantised, Assumed, kAsD3d);
    p.set(&P::cube_edges, CubeEdges::PerFace, Assumed, "Direct3D 9 class: faces are filtered on their own");
    p.set(&P::cube_corner, CubeCorner::ThreeTexels, Assumed, "not used: faces are filtered on their own");
    p.set(&P::lod_rule, LodRule::Longest, Assumed, kAsD3d);
    p.set(&P::log2_model, Log2Model::Exact, Assumed, "unknown");
    p.set(&P::lod_fraction_bits, 8, Assumed, "unknown; nouveau nv30: the bias register is signed 5.8, the limits are 4.8");
    p.set(&P::lod_rounding, FixedRounding::NearestEven, Assumed, kAsD3d);
    p.set(&P::mip_tie, MipTie::Up, Assumed, kAsD3d);
    p.set(&P::aniso_rule, AnisoRule::OpenGl, Assumed, "unknown; EXT_texture_filter_anisotropic is its maker's");
    p.set(&P::ellipse_transform, false, Assumed, "unknown; its extension's example does without");
    p.set(&P::aniso_clamps_to_top, true, Assumed, "unknown; Direct3D 10 class and before were allowed to");
    p.set(&P::probe_count, ProbeCount::Steps, Assumed, "unknown; nouveau nv30: the limits have these values");
    p.set(&P::probe_placement, ProbePlacement::Interior, Assumed, "unknown; EXT_texture_filter_anisotropic's example");
    p.set(&P::aniso_limits, AnisoLimits::Steps, Documented, "nouveau nv30: the field for the limit has these values");
    p.set(&P::mip_generation, MipGeneration::Box, Assumed, "unknown");
    return p;
}

Preset g80() {
    constexpr std::string_view kAsD3d = "Direct3D 10 hardware: as the specification has it";
    Preset p = nv40();
    p.profile.name = "g80";
    p.profile.summary = "GeForce 8800 class (2006): weights documented, probes assumed";
    p.set(&P::flush_denormals, true, Assumed, "CUDA C Programming Guide, compute capability 1.x; recalled, not re-read");
    p.set(&P::raster_subpixel_bits, 8, Specified, "D3D11.3 3.4.1, the same in Direct3D 10");
    constexpr std::string_view kNv50Samples = "nouveau nv50_surface.c: the standard set in its own order";
    p.set(&P::max_samples, 8, Documented, "nouveau nv50; coverage samples beyond these are not modelled");
    p.set(&P::sample_positions_2, {{{4, 4}, {12, 12}}}, Documented, kNv50Samples);
    p.set(&P::sample_positions_4, kStandardSamples4, Documented, kNv50Samples);
    p.set(&P::sample_positions_8, {{{1, 7}, {5, 3}, {3, 13}, {7, 11}, {9, 5}, {15, 1}, {11, 15}, {13, 9}}}, Documented,
          kNv50Samples);
    p.set(&P::sample_positions_16, kStandardSamples16, Assumed, "not used: it has 8 samples");
    p.set(&P::multisamples_float, true, Measured, "published reviews of 2006");
    p.set(&P::max_targets, 8, Specified, "Direct3D 10");
    p.set(&P::blends_float16, true, Measured, "published reviews of 2006");
    p.set(&P::blends_float32, true, Measured, "published reviews of 2006");
    p.set(&P::depth_bias_place, DepthBiasPlace::Vertex, Specified, "D3D11.3 15.10, the same in Direct3D 10");
    p.set(&P::depth_bias_steps, 1, Specified, "D3D11.3 15.10, the same in Direct3D 10");
    p.set(&P::address_arithmetic, AddressArithmetic::FixedPoint, Assumed, kAsD3d);
    p.set(&P::texel_fraction_bits, 8, Documented, "CUDA C++ Programming Guide 19.2: 1.8 weights");
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Measured,
          "forums.developer.nvidia.com/t/tex1d-accuracy/6801: nearest; which way ties go is assumed");
    p.set(&P::texel_carry, TexelCarry::Weight, Assumed, "CUDA C++ Programming Guide 19.2: a weight of 1 is representable");
    p.set(&P::filters_float32, true, Measured, "published reviews of 2006");
    p.set(&P::border_precision, BorderPrecision::Float, Documented, "nouveau nv50: the border colour is four floats");
    p.set(&P::compare_reference, CompareReference::Quantised, Assumed, kAsD3d);
    p.set(&P::cube_edges, CubeEdges::Seamless, Assumed, kAsD3d);
    p.set(&P::cube_corner, CubeCorner::ThreeTexels, Assumed, kAsD3d);
    p.set(&P::lod_fraction_bits, 8, Assumed, "unknown; nouveau nv50: the bias register is signed 5.8, the limits are 4.8");
    p.set(&P::aniso_rule, AnisoRule::D3d11, Assumed, kAsD3d);
    p.set(&P::ellipse_transform, true, Assumed, "reviews found it nearly independent of the angle");
    p.set(&P::aniso_clamps_to_top, true, Assumed, "D3D11.3 7.18.11: part of the Direct3D 10 specification of its time");
    p.set(&P::probe_count, ProbeCount::Steps, Assumed, "unknown; nouveau nv50: the limits have these values");
    p.set(&P::aniso_limits, AnisoLimits::Steps, Documented, "nouveau nv50: the field for the limit has these values");
    return p;
}

Preset llvmpipe() {
    Preset p = d3d11();
    p.profile.name = "llvmpipe";
    p.profile.summary = "Mesa 22.3.6 llvmpipe, its 2D filters, coverage, depth and blending bit for bit";
    p.set(&P::arithmetic, Arithmetic::Fp32, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c");
    p.set(&P::flush_denormals, true, Documented, "Mesa 22.3.6 lp_rast.c; compute shaders keep denormals");
    p.set(&P::float_narrowing, Narrowing::NearestEven, Documented, "Mesa 22.3.6 lp_bld_conv.c");
    p.set(&P::raster_subpixel_bits, 8, Documented, "Mesa 22.3.6 lp_setup_tri.c");
    p.set(&P::max_samples, 4, Documented, "Mesa 22.3.6 lp_screen.c: 1 and 4");
    p.set(&P::sample_positions_4, kStandardSamples4, Documented, "Mesa 22.3.6 lp_rast.c");
    p.set(&P::viewport_arithmetic, ViewportArithmetic::Llvmpipe, Documented,
          "Mesa 22.3.6 draw_llvm.c generate_viewport(), lp_setup_tri.c calc_fixed_position()");
    p.set(&P::clipping, Clipping::Llvmpipe, Documented, "Mesa 22.3.6 draw_pipe_clip.c");
    p.set(&P::winding_area, WindingArea::Exact, Documented, "Mesa 22.3.6 lp_setup_tri.c");
    p.set(&P::plane_equations, PlaneEquations::Llvmpipe, Documented, "Mesa 22.3.6 lp_state_setup.c, lp_bld_interp.c");
    p.set(&P::mirrors_sample_depth, false, Documented, "Mesa 22.3.6 lp_bld_interp.c");
    p.set(&P::derivative_corner, DerivativeCorner::TopLeft, Documented, "Mesa 22.3.6 lp_bld_quad.c");
    p.set(&P::plain_derivative, PlainDerivative::Fine, Documented, "Mesa 22.3.6 lp_bld_quad.c");
    p.set(&P::max_targets, 8, Documented, "Mesa 22.3.6 lp_screen.c");
    p.set(&P::depth_bias_place, DepthBiasPlace::Fragment, Documented, "Mesa 22.3.6 lp_state_setup.c");
    p.set(&P::depth_bias_steps, 2, Documented, "Mesa 22.3.6 lp_state_setup.c: OpenGL's unit");
    p.set(&P::depth_bias_arithmetic, DepthBiasArithmetic::Llvmpipe, Documented, "Mesa 22.3.6 lp_state_setup.c");
    p.set(&P::depth_rounding, DepthRounding::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_depth.c, lp_bld_conv.c");
    p.set(&P::blend_arithmetic, BlendArithmetic::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_blend.c, lp_state_fs.c");
    p.set(&P::unorm_rounding, UnormRounding::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_conv.c");
    p.set(&P::half_targets, HalfTargets::TowardZero, Documented, "Mesa 22.3.6 lp_bld_conv.c lp_build_float_to_half()");
    p.set(&P::resolve_arithmetic, ResolveArithmetic::Llvmpipe, Documented,
          "Mesa 22.3.6 u_simple_shaders.c util_make_fs_msaa_resolve()");
    p.set(&P::address_arithmetic, AddressArithmetic::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c");
    p.set(&P::texel_fraction_bits, kExactBits, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c: the whole binary32 fraction");
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Documented, "Mesa 22.3.6 lp_bld_sample_aos.c: 24.8 of 8-bit formats");
    p.set(&P::texel_carry, TexelCarry::Texel, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c");
    p.set(&P::bilinear_form, BilinearForm::FusedLerp, Documented,
          "Mesa 22.3.6 lp_bld_arit.c: llvm.fmuladd on machines with FMA");
    p.set(&P::unorm_decode, UnormDecode::Reciprocal, Documented, "Mesa 22.3.6 lp_bld_conv.c");
    p.set(&P::unorm_filter, UnormFilter::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_sample_aos.c");
    p.set(&P::filters_float32, true, Documented, "Mesa 22.3.6 lp_screen.c");
    p.set(&P::border_precision, BorderPrecision::Float, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c");
    p.set(&P::compare_reference, CompareReference::Raw, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c: clamped, not quantised");
    p.set(&P::cube_edges, CubeEdges::Seamless, Assumed, "as the specification has it; not compared");
    p.set(&P::cube_corner, CubeCorner::ThreeTexels, Assumed, "as the specification has it; not compared");
    p.set(&P::lod_rule, LodRule::Longest, Documented, "Mesa 22.3.6 lp_bld_sample.c lp_build_rho; cubes not compared");
    p.set(&P::log2_model, Log2Model::Linear2, Documented, "Mesa 22.3.6 lp_bld_arit.c lp_build_fast_log2");
    p.set(&P::lod_fraction_bits, kExactBits, Documented, "Mesa 22.3.6 lp_bld_sample.c");
    p.set(&P::lod_rounding, FixedRounding::NearestEven, Documented, "not used: nothing is rounded");
    p.set(&P::lod_sharing, LodSharing::Quad, Documented, "Mesa 22.3.6 lp_bld_nir.c: per quad in fragment shaders");
    p.set(&P::mip_tie, MipTie::Even, Documented, "Mesa 22.3.6 lp_bld_sample.c; up where neither bias nor limits apply");
    p.set(&P::aniso_rule, AnisoRule::Llvmpipe, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c lp_build_sample_aniso");
    p.set(&P::ellipse_transform, false, Documented, "Mesa 22.3.6 lp_bld_sample.c lp_build_pmin");
    p.set(&P::aniso_clamps_to_top, false, Documented, "Mesa 22.3.6 lp_bld_sample.c lp_build_pmin");
    p.set(&P::aniso_limits, AnisoLimits::Any, Documented, "Mesa 22.3.6 lp_build_pmin: a limit above 1 bounds nothing");
    p.set(&P::probe_count, ProbeCount::Ceil, Documented, "not used: an ellipse is walked");
    p.set(&P::probe_placement, ProbePlacement::Ewa, Documented, "Mesa 22.3.6 lp_bld_sample_soa.c lp_build_sample_aniso");
    p.set(&P::mip_generation, MipGeneration::Bilinear, Documented,
          "Mesa 22.3.6 u_gen_mipmap.c; the 8-bit filter's rounding is not kept");
    return p;
}

Preset swiftshader() {
    Preset p = d3d11();
    p.profile.name = "swiftshader";
    p.profile.summary = "SwiftShader as Chromium builds it, its 2D filters, coverage, depth and blending bit for bit";
    p.set(&P::arithmetic, Arithmetic::Fp32, Documented, "SwiftShader SamplerCore.cpp: high precision filtering");
    p.set(&P::flush_denormals, true, Documented, "SwiftShader SwiftConfig.cpp");
    p.set(&P::float_narrowing, Narrowing::NearestEven, Documented, "SwiftShader Half.hpp");
    p.set(&P::raster_subpixel_bits, 4, Documented, "SwiftShader VkConfig.hpp");
    p.set(&P::max_samples, 4, Documented, "SwiftShader VkPhysicalDevice.cpp: 1 and 4");
    p.set(&P::sample_positions_4, kStandardSamples4, Documented, "SwiftShader Constants.cpp");
    p.set(&P::viewport_arithmetic, ViewportArithmetic::SwiftShader, Documented, "SwiftShader VertexRoutine.cpp");
    p.set(&P::clipping, Clipping::SwiftShader, Documented, "SwiftShader Clipper.cpp, SetupRoutine.cpp");
    p.set(&P::winding_area, WindingArea::Float32, Documented, "SwiftShader SetupRoutine.cpp");
    p.set(&P::plane_equations, PlaneEquations::SwiftShader, Documented, "SwiftShader SetupRoutine.cpp, QuadRasterizer.cpp");
    p.set(&P::mirrors_sample_depth, true, Documented, "SwiftShader QuadRasterizer.cpp: subtracts the sample's x");
    p.set(&P::derivative_corner, DerivativeCorner::TopLeft, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::depth_bias_place, DepthBiasPlace::Fragment, Documented, "SwiftShader QuadRasterizer.cpp");
    p.set(&P::depth_bias_arithmetic, DepthBiasArithmetic::SwiftShader, Documented, "SwiftShader SetupRoutine.cpp");
    p.set(&P::depth_rounding, DepthRounding::NearestEven, Documented, "SwiftShader PixelRoutine.cpp");
    p.set(&P::blend_arithmetic, BlendArithmetic::SwiftShader, Documented, "SwiftShader PixelRoutine.cpp alphaBlend()");
    p.set(&P::unorm_rounding, UnormRounding::NearestEven, Documented, "SwiftShader PixelRoutine.cpp writeColor()");
    p.set(&P::half_targets, HalfTargets::SwiftShader, Documented, "SwiftShader PixelRoutine.cpp, ShaderCore.cpp");
    p.set(&P::resolve_arithmetic, ResolveArithmetic::SwiftShader, Documented, "SwiftShader Blitter.cpp");
    p.set(&P::address_arithmetic, AddressArithmetic::SwiftShader, Documented, "SwiftShader SamplerCore.cpp address()");
    p.set(&P::texel_fraction_bits, kExactBits, Documented, "SwiftShader SamplerCore.cpp: the whole binary32 fraction");
    p.set(&P::texel_rounding, FixedRounding::NearestEven, Documented, "not used: nothing is rounded");
    p.set(&P::texel_carry, TexelCarry::Texel, Documented, "SwiftShader SamplerCore.cpp address()");
    p.set(&P::bilinear_form, BilinearForm::PlainLerp, Documented, "SwiftShader SamplerCore.cpp bilinearInterpolateFloat()");
    p.set(&P::unorm_decode, UnormDecode::Late, Documented, "SwiftShader SamplerCore.cpp");
    p.set(&P::filters_float32, true, Documented, "SwiftShader VkPhysicalDevice.cpp");
    p.set(&P::border_precision, BorderPrecision::Float, Documented, "SwiftShader SamplerCore.cpp replaceBorderTexel()");
    p.set(&P::compare_reference, CompareReference::Raw, Documented, "SwiftShader SamplerCore.cpp");
    p.set(&P::cube_edges, CubeEdges::Seamless, Assumed, "as the specification has it; not compared");
    p.set(&P::cube_corner, CubeCorner::ThreeTexels, Assumed, "as the specification has it; not compared");
    p.set(&P::lod_rule, LodRule::Longest, Documented, "SwiftShader SamplerCore.cpp computeLod2D(); its cubes have another");
    p.set(&P::log2_model, Log2Model::Linear4, Documented, "SwiftShader SamplerCore.cpp log2sqrt()");
    p.set(&P::lod_fraction_bits, kExactBits, Documented, "SwiftShader SamplerCore.cpp");
    p.set(&P::lod_rounding, FixedRounding::NearestEven, Documented, "not used: nothing is rounded");
    p.set(&P::lod_sharing, LodSharing::Quad, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::mip_tie, MipTie::Even, Documented, "SwiftShader SamplerCore.cpp selectMipmap()");
    p.set(&P::aniso_rule, AnisoRule::SwiftShader, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::ellipse_transform, false, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::aniso_clamps_to_top, false, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::aniso_limits, AnisoLimits::Any, Documented, "SwiftShader SamplerCore.cpp computeLod2D()");
    p.set(&P::probe_count, ProbeCount::Round, Documented, "SwiftShader SamplerCore.cpp sampleAniso(): halves to even");
    p.set(&P::probe_placement, ProbePlacement::Centred, Documented, "SwiftShader SamplerCore.cpp sampleAniso()");
    p.set(&P::mip_generation, MipGeneration::Bilinear, Assumed, "Vulkan leaves it to blits: bilinear ones");
    return p;
}

const std::vector<Preset>& presets() {
    static const std::vector<Preset> all = [] {
        std::vector<Preset> list{d3d11(), ideal(), d3d10(), nv40(), g80(), llvmpipe(), swiftshader()};
        for (Preset& preset : list) preset.sort();
        return list;
    }();
    return all;
}

}  // namespace

std::span<const Profile> profile_presets() {
    static const std::vector<Profile> profiles = [] {
        std::vector<Profile> list;
        for (const Preset& preset : presets()) list.push_back(preset.profile);
        return list;
    }();
    return profiles;
}

std::span<const Provenance> provenance_of(std::string_view preset) {
    for (const Preset& candidate : presets())
        if (candidate.profile.name == preset) return candidate.provenance;
    return {};
}

}  // namespace gnomon
