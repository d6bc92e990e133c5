// A hardware profile: everything in which GPUs differ, as data. docs/profiles.md explains each field.
//
// `d3d11` is what the Direct3D 11.3 functional specification says, `ideal` is the yardstick: double arithmetic and exact
// weights.
#pragma once

#include "sim/enum_names.h"
#include "sim/fields.h"
#include "sim/half.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

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

/// How the four taps of a bilinear filter are combined.
enum class BilinearForm {
    Lerp,      // u first, then v, each a + w (b - a): keeps constants constant. D3D11.3 7.18.16.3
    Products,  // the sum of the four texels times wU wV, in the order of D3D11.3 7.18.8
};
template <>
inline constexpr std::array kEnumNames<BilinearForm>{EnumName{BilinearForm::Lerp, "lerp"},
                                                     EnumName{BilinearForm::Products, "products"}};

/// Whether the lanes of a quad share one level of detail.
enum class LodSharing { Quad, Pixel };
template <>
inline constexpr std::array kEnumNames<LodSharing>{EnumName{LodSharing::Quad, "quad"}, EnumName{LodSharing::Pixel, "pixel"}};

/// What happens to the reference value of a comparison before it meets the texel.
enum class CompareReference { Quantised, Raw };
template <>
inline constexpr std::array kEnumNames<CompareReference>{EnumName{CompareReference::Quantised, "quantised"},
                                                         EnumName{CompareReference::Raw, "raw"}};

/// Number of fraction bits that means "not quantised at all".
inline constexpr int kExactBits = -1;

struct Profile {
    std::string name;
    std::string summary;

    Arithmetic arithmetic = Arithmetic::Fp32;
    bool flush_denormals = true;                                       // D3D11.3 3.1.3.2
    Narrowing float_narrowing = Narrowing::TowardZero;                 // D3D11.3 3.2.2
    int raster_subpixel_bits = 8;                                      // D3D11.3 3.4.1; 1 to 8
    int texel_fraction_bits = 8;                                       // D3D11.3 7.18.8; 1 to 8 or kExactBits
    FixedRounding texel_rounding = FixedRounding::NearestEven;         // D3D11.3 3.2.4.1
    BilinearForm bilinear_form = BilinearForm::Lerp;                   // D3D11.3 7.18.8, 7.18.16.3
    int lod_fraction_bits = 8;                                         // D3D11.3 7.18.10; 1 to 8 or kExactBits
    LodSharing lod_sharing = LodSharing::Quad;                         // D3D11.3 7.18.11 allows both; assumed
    CompareReference compare_reference = CompareReference::Quantised;  // D3D11.3 22.4.19

    static constexpr auto fields() {
        using P = Profile;
        return std::tuple{Field{"name", &P::name},
                          Field{"summary", &P::summary},
                          Field{"arithmetic", &P::arithmetic},
                          Field{"flush_denormals", &P::flush_denormals},
                          Field{"float_narrowing", &P::float_narrowing},
                          Field{"raster_subpixel_bits", &P::raster_subpixel_bits},
                          Field{"texel_fraction_bits", &P::texel_fraction_bits},
                          Field{"texel_rounding", &P::texel_rounding},
                          Field{"bilinear_form", &P::bilinear_form},
                          Field{"lod_fraction_bits", &P::lod_fraction_bits},
                          Field{"lod_sharing", &P::lod_sharing},
                          Field{"compare_reference", &P::compare_reference}};
    }
    bool operator==(const Profile&) const = default;
};

/// The presets, `d3d11` first.
std::span<const Profile> profile_presets();

/// The profile as a JSON object; every field, in order.
std::string profile_to_json(const Profile& profile);

/// Reads a JSON object. A field "base" names the preset (default d3d11) that gives every field not mentioned; without a "name"
/// the profile is called by the stem of `where`, the file's path. Throws Error, with `where` in front, for unknown fields,
/// wrong types and values out of range.
Profile profile_from_json(std::string_view json, std::string_view where);

/// A preset by name, or a JSON file by path. Throws Error.
Profile load_profile(const std::string& name_or_path);

}  // namespace gnomon
