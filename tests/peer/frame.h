// What a peer renders: draws, two views and a shadow technique; and what comes back. Plain values.
#pragma once

#include "scenes/scene.h"
#include "scenes/view.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace gnomon::peer {

enum class Technique {
    None,       // everything lit; no light pass
    ShadowMap,  // one nearest comparison with a d32f map; `taps` and `filter` are ignored
    Pcf,        // the mean of taps x taps comparisons one texel apart, each Nearest or Bilinear (the sampler's own PCF)
    Vsm,        // variance shadow map. [Donnelly06] section 4
    Evsm4,      // exponential variance shadow map of both warps, four moments. [Lauritzen08] section 4.2
};

/// What the light's map holds: projective depth; linear depth and its square; two warps of linear depth and their squares.
enum class MapKind { None, Depth, Moments, WarpedMoments };
MapKind map_kind(Technique technique);

/// 0 without a map, 1 for depth, 2 or 4 for moments.
std::uint32_t map_channels(MapKind map);

enum class MapFilter { Nearest, Bilinear, Trilinear };  // Trilinear makes mips, every frame; moments only

/// Two channels for Vsm, four for Evsm4.
enum class MomentFormat { Rg32f, Rg16f, Rg16Unorm, Rgba32f, Rgba16f };

enum class Encoding { Float32, Float16, Unorm16 };

struct MomentFormatTraits {
    MomentFormat format = MomentFormat::Rg32f;
    std::string_view name;  // "rg32f"
    std::uint32_t channels = 2;
    Encoding encoding = Encoding::Float32;  // of each channel
};
const MomentFormatTraits& format_traits(MomentFormat format);

/// The largest c for which a map of this encoding holds e^{2c}, the square of the largest warp, and for which the receiver's
/// sums of such squares stay finite: 5.54 for halves, 42.97 for floats. Throws Error for Unorm16, which holds no warp.
float largest_exponent(Encoding encoding);

struct TechniqueOptions {
    Technique technique = Technique::ShadowMap;
    std::uint32_t map_size = 512;
    MapFilter filter = MapFilter::Nearest;

    // Of the light pass's rasteriser. Vulkan 1.3 29.11.3 (Depth Bias)
    float depth_bias_constant = 0;  // in steps of the format
    float depth_bias_slope = 0;

    // Pcf: a d32f map, as ShadowMap; reference <= texel is lit.
    std::int32_t taps = 1;  // per axis, 1..31

    // Vsm and Evsm4: moments of the linear depth d, 0 at the light's znear and 1 at its zfar.
    MomentFormat moment_format = MomentFormat::Rg32f;
    float max_anisotropy = 1;          // > 1 turns anisotropic filtering on; 1..16, by what the device can do
    float min_variance = 1e-5f;        // of d: 0..1, for Evsm4 up to 1e-3
    std::vector<float> blur_kernel{};  // odd count up to 31, symmetric; empty: no blur

    // Evsm4: the warps e^{c+ x} and -e^{-c- x} of x = 2d - 1; over 0, and up to largest_exponent().
    float positive_exponent = 40;  // c+
    float negative_exponent = 5;   // c-

    bool operator==(const TechniqueOptions&) const = default;
};

/// Weights of `taps` samples one texel apart, summing to 1, with sigma = (taps - 1) / 4 as techniques/common/gaussian.h; `taps`
/// is odd, 1..31.
std::vector<float> gaussian_kernel(int taps);

/// Lambert under one light and its cone, as techniques/common/receiver.h.
struct Lighting {
    glm::vec3 light_color{1.0f};  // linear
    float cone_scale = 0.0f;      // spot attenuation = saturate(scale * cos(angle) + offset)
    float cone_offset = 1.0f;
    float ambient = 0.08f;
};

/// The mesh need live only until the FrameRenderer is constructed. Draws that share a mesh share its buffers.
struct Draw {
    const scenes::Mesh* mesh = nullptr;
    glm::mat4 world_from_object{1.0f};  // affine, invertible
    glm::vec3 base_color{0.8f};
};

struct Frame {
    std::vector<Draw> draws{};
    scenes::View camera{};
    scenes::View light{};  // a perspective projection is a spot at position_ws, an orthographic one shines along direction_ws
    Lighting lighting{};
    glm::vec4 background{0.35f, 0.42f, 0.5f, 1.0f};
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    TechniqueOptions technique{};
};

Lighting scene_lighting(const scenes::Light& light);

/// The scene through its own camera and light; every other member as by default. The scene must live until the FrameRenderer is
/// constructed.
Frame scene_frame(const scenes::Scene& scene, std::uint32_t width, std::uint32_t height);

/// Throws Error on what no device could render: no draws, empty meshes, indices out of range, sizes and options out of range.
void check_frame(const Frame& frame);

inline constexpr float kNoSurface = -1.0f;

/// Row-major, top row first.
struct FrameImages {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> color{};  // rgba8 unorm, encoded with gamma 2 (the square root of linear light)
    std::vector<float> visibility{};    // r32f, [0, 1]; kNoSurface where nothing was drawn
    std::vector<float> depth{};         // d32f, 1 where nothing was drawn
    std::uint32_t map_size = 0;         // 0 without a map
    std::uint32_t map_channels = 0;     // as map_channels()
    std::vector<float> map{};           // level 0 as the receiver samples it (after any blur), 16-bit formats widened
};

}  // namespace gnomon::peer
