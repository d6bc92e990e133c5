// From object space to the shadow map: texture coordinates, projective depth, and the linear depth that filtering wants.
#pragma once

#include "scenes/view.h"
#include "sim/fields.h"
#include "sim/vec.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace gnomon::techniques {

/// Constants of one object under one light.
struct LightSpace {
    glm::mat4 texture_from_object{1.0f};  // gives (s, t, z, q): texture coordinates s/q, t/q and projective depth z/q
    glm::vec4 depth_from_object{0.0f};  // dot with (position, 1): linear depth, 0 at the light's near plane, 1 at its far plane

    static constexpr auto fields() {
        using L = LightSpace;
        return std::tuple{Field{"texture_from_object", &L::texture_from_object},
                          Field{"depth_from_object", &L::depth_from_object}};
    }

    template <class Real>
    [[nodiscard]] Vec4<Real> texture(const Vec3<Real>& position) const {
        return transform_point(texture_from_object, position);
    }
    template <class Real>
    [[nodiscard]] Real depth(const Vec3<Real>& p) const {
        const glm::vec4& d = depth_from_object;
        return ((Real(d.x) * p.x + Real(d.y) * p.y) + Real(d.z) * p.z) + Real(d.w);
    }
};

LightSpace make_light_space(const scenes::View& light, const glm::mat4& world_from_object);

}  // namespace gnomon::techniques
