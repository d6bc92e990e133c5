// Counts and bounds of a scene.
#include "scenes/scene.h"

#include <glm/common.hpp>
#include <glm/vec4.hpp>

namespace gnomon::scenes {

std::size_t Scene::triangle_count() const {
    std::size_t count = 0;
    for (const Instance& instance : instances) count += meshes[instance.mesh].indices.size() / 3;
    return count;
}

Bounds Scene::bounds() const {
    Bounds result;
    bool first = true;
    for (const Instance& instance : instances) {
        for (const Vertex& vertex : meshes[instance.mesh].vertices) {
            const glm::vec3 position_ws(instance.world_from_object * glm::vec4(vertex.position, 1.0f));
            result.lower = first ? position_ws : glm::min(result.lower, position_ws);
            result.upper = first ? position_ws : glm::max(result.upper, position_ws);
            first = false;
        }
    }
    return result;
}

}  // namespace gnomon::scenes
