// The seam laboratory: what the lanes of a quad do where a discrete choice (a split, a layer, a face, a tile) differs between
// them, the level of detail that their sample takes from it, and what it should have been. [PSVSM]
#pragma once

#include "pipeline/device.h"
#include "sim/fields.h"
#include "studies/images.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gnomon::studies {

/// What one pixel says of its sample, as the machine computed it.
struct SeamPixel {
    float own = -1.0f;  // the choice that the pixel's own inputs call for, a whole number from 0; -1 where nothing is drawn
    float used = 0.0f;  // the one it took, after a cure
    float lod = 0.0f;   // level of detail of the sample, before bias and clamp
    float smooth_lod = 0.0f;  // of the same instruction in a quad all of whose lanes took this choice: what the seam took away
    float exact_lod = 0.0f;   // of the exact derivatives at the pixel's centre
    float level = 0.0f;       // after the clamp: the level read
    float probes = 1.0f;      // of anisotropic filters
    float flags = 0.0f;       // kDisagrees + kOutside
    float value = 0.0f;       // what the sample gave, or the visibility made of it
    float quad = 0.0f;  // `own` of the four lanes of its quad, helpers too: lane i times 16^i, where choices are less than 16

    static constexpr int kDisagrees = 1;  // not all four lanes of its quad, helpers too, took one choice
    static constexpr int kOutside = 2;    // the sample lies outside of the map it read

    [[nodiscard]] bool drawn() const { return own >= 0.0f; }
    [[nodiscard]] bool is(int flag) const { return (static_cast<int>(flags) & flag) != 0; }
};

/// One picture of a case under one cure.
struct SeamImage {
    int width = 0;  // pixels
    int height = 0;
    std::vector<SeamPixel> pixels;           // row by row
    std::vector<std::uint32_t> derivatives;  // DerivativeCause bits per pixel
    Counters counters;                       // of the pass as a user would run it, without what the laboratory asks beside
    double milliseconds = 0;                 // of the same
};

/// Level of detail from which on a pixel's is wrong: the smallest step of the texture unit's fixed point. D3D11.3 7.18.10
inline constexpr double kLodStep = 1.0 / 256;

/// What a picture comes to.
struct SeamMeasures {
    std::uint64_t pixels = 0;             // drawn
    std::uint64_t quads = 0;              // with a pixel drawn
    std::uint64_t disagreeing_quads = 0;  // whose lanes took different choices
    std::uint64_t bad_quads = 0;          // with a bad pixel
    std::uint64_t bad_pixels = 0;         // |lod - smooth_lod| >= kLodStep
    std::uint64_t outside_pixels = 0;     // read outside of their map
    double worst_lod_error = 0;           // |lod - smooth_lod|, levels; up to kWorstLod
    double mean_lod_error = 0;            // over the bad pixels
    double exact_lod_error = 0;           // mean of |lod - exact_lod| over all pixels: what finite differences cost everywhere
    double crossing_lod_error = 0;        // the same over pixels of quads that disagree without a cure
    double worst_value_error = 0;         // |value - that of explicit gradients|
    double mean_value_error = 0;          // over pixels that were bad without a cure
    std::uint64_t changed_pixels = 0;     // values that differ from those of explicit gradients by 1/255 or more

    static constexpr auto fields() {
        using S = SeamMeasures;
        return std::tuple{Field{"pixels", &S::pixels},
                          Field{"quads", &S::quads},
                          Field{"disagreeing_quads", &S::disagreeing_quads},
                          Field{"bad_quads", &S::bad_quads},
                          Field{"bad_pixels", &S::bad_pixels},
                          Field{"outside_pixels", &S::outside_pixels},
                          Field{"worst_lod_error", &S::worst_lod_error},
                          Field{"mean_lod_error", &S::mean_lod_error},
                          Field{"exact_lod_error", &S::exact_lod_error},
                          Field{"crossing_lod_error", &S::crossing_lod_error},
                          Field{"worst_value_error", &S::worst_value_error},
                          Field{"mean_value_error", &S::mean_value_error},
                          Field{"changed_pixels", &S::changed_pixels}};
    }
};

/// Errors of the level of detail count up to so many levels, as between nothing and infinity.
inline constexpr double kWorstLod = 32;

/// |lod - smooth_lod|, from 0 to kWorstLod; of what is not a number, kWorstLod.
double lod_error(const SeamPixel& pixel);

/// `uncured` and `reference` (explicit gradients) are pictures of the same case; either may be the picture itself.
SeamMeasures measure_seam(const SeamImage& image, const SeamImage& uncured, const SeamImage& reference);

/// The pictures of a case, each as a PNG of one pixel per pixel: which choice, where quads disagree, how wrong the level of
/// detail is, which one was taken, how many probes, and which derivatives read lanes that were none of theirs.
struct SeamPicture {
    std::string_view name;  // of the file, without folder and ending
    ByteImage image;
};
std::vector<SeamPicture> seam_pictures(const SeamImage& image);
/// Their names.
std::span<const std::string_view> seam_picture_names();

}  // namespace gnomon::studies
