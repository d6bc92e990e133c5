#include "bench/pass_cases.h"

#include "scenes/view.h"

#include <cmath>

namespace gnomon::bench {

namespace {

constexpr float kTextureRepeats = 0.5f;  // per metre of a scene

/// [0, 1), the same sequence everywhere.
class Random {
public:
    float next() {
        state_ = state_ * 1664525u + 1013904223u;
        return static_cast<float>(state_ >> 8) * 0x1p-24f;
    }

private:
    std::uint32_t state_ = 1;
};

}  // namespace

peer::RawMesh scene_mesh(const scenes::Scene& scene, int width, int height) {
    peer::RawMesh mesh;
    mesh.clip_from_mesh =
        scenes::camera_view(scene.camera, static_cast<float>(width) / static_cast<float>(height)).clip_from_world();
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& source = scene.meshes.at(instance.mesh);
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const scenes::Vertex& vertex : source.vertices) {
            const glm::vec3 position(instance.world_from_object * glm::vec4(vertex.position, 1.0f));
            // No axis is left out, so that no surface has one texel all over.
            const glm::vec2 along(position.x + 0.3f * position.y, position.z + 0.6f * position.y);
            mesh.vertices.push_back({position, kTextureRepeats * along});
        }
        for (const std::uint32_t index : source.indices) mesh.indices.push_back(base + index);
    }
    return mesh;
}

peer::RawMesh small_triangles(int count, float area_px, int width, int height) {
    const float side_px = std::sqrt(2.0f * area_px);
    const int columns = static_cast<int>(std::ceil(static_cast<float>(width) / side_px));
    const int rows = static_cast<int>(std::ceil(static_cast<float>(height) / side_px));
    const int sheets = (count + 2 * columns * rows - 1) / (2 * columns * rows);
    peer::RawMesh mesh;
    Random random;
    for (int sheet = 0; sheet < sheets; ++sheet) {
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        const float depth = 0.9f - 0.8f * static_cast<float>(sheet) / static_cast<float>(sheets);
        // Corners off the pixel grid, each sheet by another distance.
        const glm::vec2 shift(random.next(), random.next());
        for (int y = 0; y <= rows; ++y) {
            for (int x = 0; x <= columns; ++x) {
                const glm::vec2 at = glm::vec2(static_cast<float>(x), static_cast<float>(y)) /
                                     glm::vec2(static_cast<float>(columns), static_cast<float>(rows));
                const glm::vec2 pixel = shift / glm::vec2(static_cast<float>(width), static_cast<float>(height));
                mesh.vertices.push_back({{2.0f * (at + pixel) - 1.0f, depth + 0.01f * random.next()}, at});
            }
        }
        const auto stride = static_cast<std::uint32_t>(columns) + 1;
        for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(rows); ++y) {
            for (std::uint32_t x = 0; x < static_cast<std::uint32_t>(columns); ++x) {
                const std::uint32_t corner = base + y * stride + x;
                for (const std::uint32_t step : {0u, 1u, stride, 1u, stride + 1, stride}) mesh.indices.push_back(corner + step);
            }
        }
    }
    return mesh;
}

peer::RawMesh large_triangles(int count, LargeOrder order) {
    peer::RawMesh mesh;
    Random random;
    for (int i = 0; i < count; ++i) {
        const float depth = 0.9f - 0.8f * static_cast<float>(i) / static_cast<float>(count);
        for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(3, -1), glm::vec2(-1, 3)}) {
            const float z = order == LargeOrder::Random ? 0.1f + 0.8f * random.next() : depth;
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back({{corner, z}, 0.5f * (corner + 1.0f)});
        }
    }
    return mesh;
}

}  // namespace gnomon::bench
