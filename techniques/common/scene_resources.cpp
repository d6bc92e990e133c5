#include "techniques/common/scene_resources.h"

namespace gnomon::techniques {

std::vector<SceneDraw> upload_scene(Device& device, const scenes::Scene& scene) {
    static_assert(sizeof(scenes::Vertex) == 6 * sizeof(float));
    std::vector<std::pair<BufferId, BufferId>> buffers;
    for (const scenes::Mesh& mesh : scene.meshes) {
        const BufferId vertices = device.create_buffer(mesh.name + " vertices", std::as_bytes(std::span(mesh.vertices)));
        const BufferId indices = device.create_buffer(mesh.name + " indices", std::as_bytes(std::span(mesh.indices)));
        buffers.emplace_back(vertices, indices);
    }
    std::vector<SceneDraw> draws;
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& mesh = scene.meshes[instance.mesh];
        draws.push_back({.label = mesh.name,
                         .vertices = buffers[instance.mesh].first,
                         .indices = buffers[instance.mesh].second,
                         .count = static_cast<std::uint32_t>(mesh.indices.size()),
                         .world_from_object = instance.world_from_object,
                         .base_color = mesh.base_color});
    }
    return draws;
}

}  // namespace gnomon::techniques
