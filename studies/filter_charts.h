// The classical test scenes of texture filters, one sample per pixel: what a filter looks like, which level of detail it chose
// and how much it read.
//
// A scene is a set of patches, as a GPU would draw primitives: every quad is drawn once for each patch it touches, with the
// coordinates of that patch in all four of its pixels, so that derivatives never mix two patches.
#pragma once

#include "sim/parallel.h"
#include "sim/profile.h"
#include "sim/progress.h"
#include "studies/false_color.h"
#include "studies/images.h"
#include "texunit/sampler.h"

#include <glm/vec2.hpp>

#include <span>
#include <string>

namespace gnomon::studies {

enum class ChartScene {
    Plane,   // a checkerboard to the horizon
    Tunnel,  // down a round tunnel; every mip level has a colour of its own
    Angles,  // a disc of 24 sectors, each the plane turned about the axis of view
};

enum class ChartFilter {
    Nearest,    // nearest texel of the nearest level
    Bilinear,   // level 0 alone
    Trilinear,  // both levels
    Aniso,      // the same, anisotropic
};

}  // namespace gnomon::studies

namespace gnomon {

template <>
inline constexpr std::array kEnumNames<studies::ChartScene>{EnumName{studies::ChartScene::Plane, "plane"},
                                                            EnumName{studies::ChartScene::Tunnel, "tunnel"},
                                                            EnumName{studies::ChartScene::Angles, "angles"}};
template <>
inline constexpr std::array kEnumNames<studies::ChartFilter>{
    EnumName{studies::ChartFilter::Nearest, "nearest"}, EnumName{studies::ChartFilter::Bilinear, "bilinear"},
    EnumName{studies::ChartFilter::Trilinear, "trilinear"}, EnumName{studies::ChartFilter::Aniso, "aniso"}};

}  // namespace gnomon

namespace gnomon::studies {

/// A scene at a size in pixels.
struct ChartView {
    ChartScene scene = ChartScene::Plane;
    int width = 512;
    int height = 512;
};

inline constexpr int kNoPatch = -1;  // the background

/// The patch that covers a pixel.
int chart_patch(const ChartView& view, int x, int y);

/// Texture coordinates of a pixel's centre on a patch, which goes on outside the pixels it covers; the texture repeats.
glm::dvec2 chart_coordinate(const ChartView& view, int patch, int x, int y);

/// 256x256 texels with all levels: a checkerboard whose levels the profile's rule makes, or a colour per level. Throws Error
/// for formats of integers, which no filter reads.
Texture chart_texture(ChartScene scene, Format format, const Profile& profile, Workers& workers);

/// `max_anisotropy` counts for ChartFilter::Aniso alone.
Sampler chart_sampler(ChartFilter filter, int max_anisotropy);

struct Chart {
    ByteImage picture;  // red, green and blue as the texture unit gives them, times 255
    ByteImage lod;      // lod_color
    ByteImage probes;   // amount_color of probe_step, or of texel_step where the filter is elliptical
};

/// Draws the scene with the instructions that shaders use; the same bytes for any number of threads. Throws Stopped.
Chart draw_chart(const ChartView& view, const Texture& texture, const Sampler& sampler, const Profile& profile,
                 Workers& workers, const Progress& progress = {});

/// Anisotropic samples of the profile weigh all texels under an ellipse instead of probes along a line.
bool is_elliptical(const Sampler& sampler, const Profile& profile);

inline constexpr Rgb kBackground{38, 42, 50};
inline constexpr Rgb kMagnified{150, 150, 150};

/// Levels 0 to 8: of the tunnel's texture and of pictures of the level of detail. 8-bit codes, not linear light.
inline constexpr std::array<Rgb, 9> kLevelColors{Rgb{220, 30, 30},  Rgb{255, 140, 0},   Rgb{250, 230, 20},
                                                 Rgb{40, 180, 50},  Rgb{0, 205, 215},   Rgb{40, 80, 230},
                                                 Rgb{130, 40, 190}, Rgb{245, 110, 200}, Rgb{255, 255, 255}};

/// A level of detail after the clamp: between the colours of its two levels, grey where it is at most 0 (magnified).
Rgb lod_color(double clamped_lod);

/// Sixteen colours from dark blue over green to yellow: matplotlib's viridis at even distances.
inline constexpr int kAmountSteps = 16;
Rgb amount_color(int step);

/// Probes 1 to 16 are steps 0 to 15.
int probe_step(int probes);
/// The most texels of steps 0 to 14: 4, 6, 8, 12, 16, 24, ... 384, 512; step 15 is more.
int texel_limit(int step);
int texel_step(int texels);

/// One chart on a page.
struct ChartEntry {
    std::string scene;
    std::string profile;
    std::string filter;
    bool elliptical = false;
};

/// The name of a chart's file: `<scene>_<profile>_<filter><suffix>.png`.
std::string chart_file(const ChartEntry& entry, std::string_view suffix);

inline constexpr std::string_view kPictureSuffix;
inline constexpr std::string_view kLodSuffix = "_lod";
inline constexpr std::string_view kProbesSuffix = "_probes";

/// A page that shows the charts beside it: a table per scene, rows by filter, columns by profile, and what the colours mean.
/// `note` is a line about the pictures. Names must need no escaping.
std::string charts_html(std::span<const ChartEntry> entries, std::string_view note);

}  // namespace gnomon::studies
