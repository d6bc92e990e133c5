// Whether the result of a sample is legal: intervals from declared precisions, in double arithmetic.
//
// Every input that an implementation may round (coordinate, weight, level of detail, colour) becomes the interval of what it
// may have been; the result is legal if the filter reaches it from some point of those intervals. Sound: what an
// implementation of the declared precision computes is never refused. The filter is multilinear in its weights, so bounds over
// a box of weights lie at its corners; boxes are halved so that the components of one result have to agree on the weights.
// The conformance tests of Vulkan and OpenGL, KhronosGroup/VK-GL-CTS framework/common/tcuTexLookupVerifier.cpp, do the same.
#pragma once

#include "sim/profile_choices.h"
#include "texunit/record.h"
#include "texunit/sampler.h"

#include <array>
#include <string>
#include <vector>

namespace verify {

using Color = std::array<double, 4>;

/// A mip chain as numbers. Components the format lacks are 0, alpha 1.
struct Image {
    struct Level {
        int width = 1;  // texels
        int height = 1;
        std::vector<Color> texels;  // rows, top first
    };
    std::vector<Level> levels;
    int components = 4;          // that the format has: the border colour supplies only these. D3D11.3 7.18.9.1
    bool unit_range = false;     // the format holds [0, 1]: border and reference are clamped to it
    double depth_codes = 0;      // largest code of a depth format of integers, 0 for others
    double largest_texel = 1.0;  // magnitude, for relative errors of sums
};

/// What an implementation declares about its arithmetic and about the choices that specifications leave open.
struct LookupPrecision {
    // Coordinates, in texels of the level that is sampled.
    int coordinate_bits = 8;           // below the point, gnomon::kExactBits for none. D3D11.3 7.18.16.1
    double coordinate_rounding = 0.6;  // units in the last of those bits. D3D11.3 3.2.4.1
    double coordinate_error = 4;       // of the normalised coordinate and its scaling, in `epsilon` at their magnitude
    double epsilon = 0x1p-24;          // half a unit in the last place of 1
    // Weights within a level and between two: error on top of that of the coordinate and of the level of detail.
    int weight_bits = gnomon::kExactBits;
    double weight_rounding = 0.6;  // units in the last of those bits
    // Level of detail.
    int lod_bits = 8;            // below the point, gnomon::kExactBits for none. D3D11.3 7.18.16.1
    double lod_rounding = 0.6;   // units in the last of those bits. D3D11.3 3.2.4.1
    double lod_error_low = 0;    // levels that the logarithm may be too low
    double lod_error_high = 0;   // and too high
    double gradient_error = 16;  // relative, of lengths and ratios made from gradients, in `epsilon`
    // Colours.
    double color_absolute = 0;
    double color_relative = 0x1p-20;  // of the largest texel
    double border_error = 0;
    bool reference_quantised = true;  // and clamped, D3D11.3 22.4.19; otherwise clamped or not
    // Choices.
    gnomon::LodRule lod_rule = gnomon::LodRule::Longest;
    bool ellipse_transform = true;            // for anisotropic filters. D3D11.3 7.18.11
    bool ellipse_transform_isotropic = true;  // for the others
    bool aniso_clamps_to_top = false;
    gnomon::AnisoRule aniso_rule = gnomon::AnisoRule::D3d11;
    gnomon::ProbeCount probe_count = gnomon::ProbeCount::Ceil;
    gnomon::AnisoLimits aniso_limits = gnomon::AnisoLimits::Any;
    /// Ewa stands for any weights: the result lies between the extremes of the texels under the ellipse.
    gnomon::ProbePlacement probe_placement = gnomon::ProbePlacement::Interior;
};

/// Whether `result` is legal for the request. Otherwise `why`, if given, tells the interval of each component.
bool is_legal(const Image& image, const gnomon::Sampler& sampler, const LookupPrecision& precision,
              const gnomon::SampleRequest& request, const Color& result, std::string* why);

/// Whether `lod` is legal as the level of detail before bias, clamps and fixed point.
bool is_legal_lod(const Image& image, const gnomon::Sampler& sampler, const LookupPrecision& precision,
                  const gnomon::SampleRequest& request, double lod, std::string* why);

}  // namespace verify
