// A scene on the device: one vertex and index buffer per mesh, one draw per instance.
#pragma once

#include "pipeline/device.h"
#include "scenes/scene.h"

#include <glm/mat4x4.hpp>

#include <string>
#include <vector>

namespace gnomon::techniques {

struct SceneDraw {
    std::string label;
    BufferId vertices = BufferId::None;  // scenes::Vertex: position and normal, 6 floats
    BufferId indices = BufferId::None;
    std::uint32_t count = 0;  // corners
    glm::mat4 world_from_object{1.0f};
    glm::vec3 base_color{0.8f};
};

/// Uploads every mesh; instances share them.
std::vector<SceneDraw> upload_scene(Device& device, const scenes::Scene& scene);

}  // namespace gnomon::techniques
