// What is rendered: meshes, instances, one camera, one light. World space is right handed, y up, in metres, as in glTF 2.0.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::scenes {

/// One corner of a mesh; the interleaved layout that the vertex stage fetches (6 floats).
struct Vertex {
    glm::vec3 position;  // object space
    glm::vec3 normal;    // object space, unit length

    bool operator==(const Vertex&) const = default;
};

/// An indexed triangle list. Indices are in range and every vertex is finite: importers refuse anything else.
struct Mesh {
    std::string name;
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
    glm::vec3 base_color{0.8f};  // linear, [0, 1]
};

/// One placement of a mesh.
struct Instance {
    std::uint32_t mesh = 0;
    glm::mat4 world_from_object{1.0f};
};

/// A pinhole camera that looks along its local -z, as in glTF 2.0 section 3.10.
struct Camera {
    glm::mat4 world_from_camera{1.0f};  // rigid
    float yfov_rad = 0.8f;              // full vertical angle, (0, pi)
    float znear = 0.1f;                 // > 0
    float zfar = 100.0f;                // > znear
};

enum class LightKind { Spot, Directional };

/// One light that shines along its local -z, as in KHR_lights_punctual. A spot ends sharply at its outer cone.
struct Light {
    LightKind kind = LightKind::Spot;
    glm::mat4 world_from_light{1.0f};  // rigid
    float outer_cone_rad = 0.5f;       // half angle of the cone, (0, pi/2); spots only
    glm::vec3 color{1.0f};
};

/// Axis-aligned box in world space; `lower <= upper` unless the scene is empty.
struct Bounds {
    glm::vec3 lower{0.0f};
    glm::vec3 upper{0.0f};
};

struct Scene {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    Camera camera;
    Light light;

    [[nodiscard]] std::size_t triangle_count() const;  // over all instances
    [[nodiscard]] Bounds bounds() const;               // over all instances, world space
};

}  // namespace gnomon::scenes
