// The scene as one Embree geometry, in world space, and the two questions the reference asks it.
#pragma once

#include "scenes/scene.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gnomon::scenes {

/// A ray from `origin` along `direction` (any length), between the parameters `near_t` and `far_t`.
struct Ray {
    glm::dvec3 origin;
    glm::dvec3 direction;
    double near_t = 0;
    double far_t = 0;
};

/// Where a ray meets a triangle. Embree chooses the triangle; the point is computed again in double.
struct Hit {
    std::array<glm::dvec3, 3> corners_ws;
    glm::dvec3 position_ws;
    glm::dvec3 normal_ws;            // interpolated, unit length
    glm::dvec3 geometric_normal_ws;  // of the triangle, unit length
};

class EmbreeScene {
public:
    explicit EmbreeScene(const Scene& scene);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// The nearest triangle on the ray, whichever way it faces.
    [[nodiscard]] std::optional<Hit> nearest(const Ray& ray) const;

    /// Is there any triangle on the ray?
    [[nodiscard]] bool blocked(const Ray& ray) const;

private:
    struct Handles;
    std::vector<Vertex> vertices_ws_;
    std::vector<glm::uvec3> triangles_;
    std::unique_ptr<Handles> handles_;
};

}  // namespace gnomon::scenes
