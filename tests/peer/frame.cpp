// The checks on a frame's description, and the blur's weights.
#include "tests/peer/frame.h"

#include "sim/error.h"
#include "sim/scalar_math.h"

#include <algorithm>
#include <cstddef>

namespace gnomon::peer {
namespace {

constexpr std::uint32_t kMaxImageSize = 4096;  // every Vulkan device has this much. Vulkan 1.3 33 (maxImageDimension2D)

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

}  // namespace

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

    const TechniqueOptions& t = frame.technique;
    if (t.map_size == 0 || t.map_size > kMaxImageSize) fail("map size {}; expected 1..{}", t.map_size, kMaxImageSize);
    if (t.taps < 1 || t.taps > 31) fail("{} taps; expected 1..31", t.taps);
    if (!(t.max_anisotropy >= 1 && t.max_anisotropy <= 16)) fail("anisotropy {}; expected 1..16", t.max_anisotropy);
    if (t.technique != Technique::Vsm && t.filter == MapFilter::Trilinear) fail("trilinear filtering of a depth map");
    check_blur(t.blur_kernel);
}

}  // namespace gnomon::peer
