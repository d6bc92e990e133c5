#include "tests/agree/raster_compare.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

namespace gnomon::agree {

std::string_view name_of(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return "rgba8";
        case ColorFormat::Rgba16Unorm: return "rgba16unorm";
        case ColorFormat::Rgba16f: return "rgba16f";
        case ColorFormat::Rgba32f: return "rgba32f";
    }
    return "?";
}

void on_each_driver(const std::function<void(RasterPeer&, Driver)>& check_on) {
    for (const peer::PeerDevice& device : peer::usable_devices()) {
        const std::optional<Driver> driver = driver_of(device);
        if (!driver) continue;
        INFO("device " << device.name);
        RasterPeer machine(device);
        check_on(machine, *driver);
    }
}

std::string text(const ClipTriangle& triangle) {
    std::string all;
    for (const ClipVertex& v : triangle)
        all += fmt::format(" ({:a} {:a} {:a} {:a})", v.clip[0], v.clip[1], v.clip[2], v.clip[3]);
    return all;
}
std::string text(const std::vector<CoveredPixel>& pixels) {
    std::string all;
    for (const CoveredPixel& p : pixels) all += fmt::format(" {},{}:{:x}", p.x, p.y, p.mask);
    return all.substr(0, 400);
}
std::string text(const Codes& codes) { return fmt::format("{:x} {:x} {:x} {:x}", codes[0], codes[1], codes[2], codes[3]); }

std::string text(const BlendState& state, const BlendCase& blended) {
    const auto equation = [](const BlendEquation& e) {
        return fmt::format("{}*s {}*d op {}", static_cast<int>(e.source), static_cast<int>(e.destination),
                           static_cast<int>(e.operation));
    };
    const Color& s = blended.source;
    return fmt::format("color {}, alpha {}, source {:a} {:a} {:a} {:a}, destination {}", equation(state.color),
                       equation(state.alpha), s[0], s[1], s[2], s[3], text(blended.destination));
}

void Differences::add(const std::function<std::string()>& describe) {
    if (++count_ <= 3) first_ += describe() + "\n";
}
void Differences::report(const std::string& what, std::size_t of) const {
    INFO(fmt::format("{}: {} of {} differ\n{}", what, count_, of, first_));
    CHECK(count_ == 0);
}

DepthDraw scene_depth(const scenes::Scene& scene, const scenes::View& view, int width, int height) {
    DepthDraw draw{.width = width, .height = height};
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& mesh = scene.meshes[instance.mesh];
        const glm::mat4 clip_from_object = view.clip_from_world() * instance.world_from_object;
        const auto first = static_cast<std::uint32_t>(draw.vertices.size());
        for (const scenes::Vertex& vertex : mesh.vertices) {
            const glm::vec4 clip = clip_from_object * glm::vec4(vertex.position, 1.0f);
            draw.vertices.push_back({.clip = {clip.x, clip.y, clip.z, clip.w}});
        }
        for (const std::uint32_t index : mesh.indices) draw.indices.push_back(first + index);
    }
    return draw;
}

DepthDraw random_depth(TriangleKind kind, std::uint64_t run, DepthFormat format, int samples) {
    DepthDraw draw{.width = 97, .height = 61, .samples = samples, .format = format};
    if (run % 4 == 1) draw.bias_constant = 3;
    if (run % 4 == 2) draw.bias_slope = 1.5f;
    for (const ClipTriangle& triangle : random_triangles(kind, 12, draw.width, draw.height, 100 + run))
        for (const ClipVertex& vertex : triangle) {
            draw.indices.push_back(static_cast<std::uint32_t>(draw.vertices.size()));
            draw.vertices.push_back(vertex);
        }
    return draw;
}

namespace {

bool is_nan(ColorFormat format, std::uint32_t code) {
    if (format == ColorFormat::Rgba16f) return (code & 0x7fffu) > 0x7c00u;
    return format == ColorFormat::Rgba32f && (code & 0x7fffffffu) > 0x7f800000u;
}

}  // namespace

bool same(ColorFormat format, const Codes& a, const Codes& b) {
    for (std::size_t c = 0; c < 4; ++c)
        if (a[c] != b[c] && !(is_nan(format, a[c]) && is_nan(format, b[c]))) return false;
    return true;
}

}  // namespace gnomon::agree
