// The checks on a frame's description, and the blur's weights.
#include "tests/peer/frame.h"

#include "sim/error.h"
#include "sim/scalar_math.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace gnomon::peer {
namespace {

constexpr std::array<MomentFormatTraits, 5> kMomentFormats{{
    {MomentFormat::Rg32f, "rg32f", 2, Encoding::Float32},
    {MomentFormat::Rg16f, "rg16f", 2, Encoding::Float16},
    {MomentFormat::Rg16Unorm, "rg16unorm", 2, Encoding::Unorm16},
    {MomentFormat::Rgba32f, "rgba32f", 4, Encoding::Float32},
    {MomentFormat::Rgba16f, "rgba16f", 4, Encoding::Float16},
}};

constexpr float kLargestWarpedMinVariance = 1e-3f;  // of depth
constexpr std::uint32_t kMaxImageSize = 4096;       // every Vulkan device has this much. Vulkan 1.3 33 (maxImageDimension2D)

void check_mesh(const scenes::Mesh& mesh) {
    if (mesh.vertices.empty() || mesh.indices.empty() || mesh.indices.size() % 3 != 0)
        fail("mesh '{}': {} vertices, {} indices; expected whole triangles", mesh.name, mesh.vertices.size(),
             mesh.indices.size());
    const std::uint32_t largest = *std::max_element(mesh.indices.begin(), mesh.indices.end());
    if (largest >= mesh.vertices.size()) fail("mesh '{}': index {} of {} vertices", mesh.name, largest, mesh.vertices.size());
}

void check_blur(const std::vector<float>& kernel) {
    if (kernel.empty()) return;
    if (kernel.size() % 2 == 0 || kernel.size() > 31)
        fail("blur kernel of {} weights; expected an odd count up to 31", kernel.size());
    if (!std::equal(kernel.begin(), kernel.end(), kernel.rbegin())) fail("blur kernel is not symmetric");
}

void check_exponent(float exponent, const MomentFormatTraits& format) {
    const float largest = largest_exponent(format.encoding);
    if (!(exponent > 0 && exponent <= largest))
        fail("warp exponent {}; expected over 0 and up to {} for {}", exponent, largest, format.name);
}

void check_moments(const TechniqueOptions& technique) {
    const MapKind map = map_kind(technique.technique);
    const MomentFormatTraits& format = format_traits(technique.moment_format);
    if (format.channels != map_channels(map))
        fail("map of {} channels in {}, which has {}", map_channels(map), format.name, format.channels);
    const float largest_variance = map == MapKind::WarpedMoments ? kLargestWarpedMinVariance : 1;
    if (!(technique.min_variance >= 0 && technique.min_variance <= largest_variance))
        fail("least variance {}; expected 0..{}", technique.min_variance, largest_variance);
    check_blur(technique.blur_kernel);
    if (map != MapKind::WarpedMoments) return;
    check_exponent(technique.positive_exponent, format);
    check_exponent(technique.negative_exponent, format);
}

void check_technique(const TechniqueOptions& t) {
    if (t.map_size == 0 || t.map_size > kMaxImageSize) fail("map size {}; expected 1..{}", t.map_size, kMaxImageSize);
    if (t.taps < 1 || t.taps > 31) fail("{} taps; expected 1..31", t.taps);
    if (!(t.max_anisotropy >= 1 && t.max_anisotropy <= 16)) fail("anisotropy {}; expected 1..16", t.max_anisotropy);
    if (map_channels(map_kind(t.technique)) >= 2) return check_moments(t);
    if (t.filter == MapFilter::Trilinear) fail("trilinear filtering of a depth map");
    if (t.max_anisotropy > 1) fail("anisotropic filtering of a depth map");
}

}  // namespace

MapKind map_kind(Technique technique) {
    switch (technique) {
        case Technique::None: return MapKind::None;
        case Technique::ShadowMap: return MapKind::Depth;
        case Technique::Pcf: return MapKind::Depth;
        case Technique::Vsm: return MapKind::Moments;
        case Technique::Evsm4: return MapKind::WarpedMoments;
    }
    return MapKind::None;
}

std::uint32_t map_channels(MapKind map) {
    switch (map) {
        case MapKind::None: return 0;
        case MapKind::Depth: return 1;
        case MapKind::Moments: return 2;
        case MapKind::WarpedMoments: return 4;
    }
    return 0;
}

const MomentFormatTraits& format_traits(MomentFormat format) {
    const auto row = std::ranges::find(kMomentFormats, format, &MomentFormatTraits::format);
    if (row == kMomentFormats.end()) fail("unknown moment format {}", static_cast<int>(format));
    return *row;
}

float largest_exponent(Encoding encoding) {
    // Floats are added up in floats: the receiver's (t - mu)^2 is at most e^{2c}, its sigma^2 at most that or the least
    // variance, 4 c^2 e^{2c} kLargestWarpedMinVariance < 8 e^{2c}. Halves are widened before.
    constexpr double kLargestFloat = std::numeric_limits<float>::max();
    constexpr double kLargestHalf = 65504;
    switch (encoding) {
        case Encoding::Float32: return static_cast<float>(0.5 * scalar::log(kLargestFloat / 16));
        case Encoding::Float16: return static_cast<float>(0.5 * scalar::log(kLargestHalf));
        case Encoding::Unorm16: break;
    }
    fail("warped moments do not fit in 0..1");
}

std::vector<float> gaussian_kernel(int taps) {
    if (taps < 1 || taps > 31 || taps % 2 == 0) fail("Gaussian kernel of {} taps; expected an odd count in 1..31", taps);
    const double sigma = taps > 1 ? 0.25 * (taps - 1) : 1.0;
    std::vector<double> exact;
    double sum = 0;
    for (int i = 0; i < taps; ++i) {
        const double x = (i - taps / 2) / sigma;
        exact.push_back(scalar::exp(-0.5 * x * x));
        sum += exact.back();
    }
    std::vector<float> weights(exact.size());
    std::transform(exact.begin(), exact.end(), weights.begin(), [sum](double w) { return static_cast<float>(w / sum); });
    return weights;
}

Lighting scene_lighting(const scenes::Light& light) {
    Lighting lighting{.light_color = light.color};
    if (light.kind == scenes::LightKind::Directional) return lighting;
    // KHR_lights_punctual, inner and outer cone angles; the inner cone at 0.85 of the outer one, as techniques/frame.cpp.
    const double outer = scalar::cos(static_cast<double>(light.outer_cone_rad));
    const double inner = scalar::cos(0.85 * static_cast<double>(light.outer_cone_rad));
    lighting.cone_scale = static_cast<float>(1.0 / (inner - outer));
    lighting.cone_offset = static_cast<float>(-outer / (inner - outer));
    return lighting;
}

Frame scene_frame(const scenes::Scene& scene, std::uint32_t width, std::uint32_t height) {
    Frame frame{.camera = scenes::camera_view(scene.camera, static_cast<float>(width) / static_cast<float>(height)),
                .light = scenes::light_view(scene.light, scene.bounds()),
                .lighting = scene_lighting(scene.light),
                .width = width,
                .height = height};
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& mesh = scene.meshes.at(instance.mesh);
        frame.draws.push_back({&mesh, instance.world_from_object, mesh.base_color});
    }
    return frame;
}

void check_frame(const Frame& frame) {
    if (frame.width == 0 || frame.height == 0 || frame.width > kMaxImageSize || frame.height > kMaxImageSize)
        fail("frame of {}x{} pixels; expected 1..{}", frame.width, frame.height, kMaxImageSize);

    if (frame.draws.empty()) fail("frame without draws");
    for (const Draw& draw : frame.draws) {
        if (draw.mesh == nullptr) fail("draw without a mesh");
        check_mesh(*draw.mesh);
    }

    check_technique(frame.technique);
}

}  // namespace gnomon::peer
