// The camera pass shared by all techniques: what the vertex functor hands over, and how visibility becomes colour.
#pragma once

#include "pipeline/fragment.h"
#include "techniques/common/caster.h"
#include "techniques/common/light_space.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>

namespace gnomon::techniques {

template <class Real>
struct ReceiverVaryings {
    Vec3<Real> position_ws;
    Vec3<Real> normal_ws;
    Vec4<Real> light;  // (s, t, z, q) of LightSpace
    Real depth_ls;     // linear depth of LightSpace
};

struct ReceiverVertex {
    template <class Real>
    using Input = MeshVertex<Real>;
    template <class Real>
    using Varyings = ReceiverVaryings<Real>;

    glm::mat4 clip_from_object{1.0f};
    glm::mat4 world_from_object{1.0f};
    glm::mat4 normal_from_object{1.0f};  // upper 3x3: the inverse transpose, up to a positive factor
    LightSpace light{};

    static constexpr auto fields() {
        using R = ReceiverVertex;
        return std::tuple{Field{"clip_from_object", &R::clip_from_object}, Field{"world_from_object", &R::world_from_object},
                          Field{"normal_from_object", &R::normal_from_object}, Field{"light", &R::light}};
    }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> world = transform_point(world_from_object, v.in.position);
        return VertexOutput{transform_point(clip_from_object, v.in.position),
                            ReceiverVaryings<Real>{.position_ws = {world.x, world.y, world.z},
                                                   .normal_ws = transform_vector(normal_from_object, v.in.normal),
                                                   .light = light.texture(v.in.position),
                                                   .depth_ls = light.depth(v.in.position)}};
    }
};

/// Lambert under one light. A spot fades linearly in the cosine of the angle from its axis between an inner and its outer cone.
struct Lighting {
    glm::vec3 base_color{0.8f};                        // linear
    glm::vec3 light_color{1.0f};                       // linear
    glm::vec4 light_position{0.0f, 1.0f, 0.0f, 0.0f};  // world; w 1: a position, w 0: the direction towards the light
    glm::vec3 light_direction{0.0f, -1.0f, 0.0f};      // world, unit, from the light
    float cone_scale = 0.0f;                           // spot attenuation = saturate(scale cos(angle) + offset)
    float cone_offset = 1.0f;
    float ambient = 0.08f;

    static constexpr auto fields() {
        using L = Lighting;
        return std::tuple{Field{"base_color", &L::base_color},
                          Field{"light_color", &L::light_color},
                          Field{"light_position", &L::light_position},
                          Field{"light_direction", &L::light_direction},
                          Field{"cone_scale", &L::cone_scale},
                          Field{"cone_offset", &L::cone_offset},
                          Field{"ambient", &L::ambient}};
    }
};

/// A receiver writes two targets: colour (encoded with gamma 2: the square root of linear light) and visibility.
inline constexpr std::size_t kReceiverTargets = 2;
template <class Real>
using ReceiverColors = std::array<Vec4<Real>, kReceiverTargets>;

/// Where a fragment falls in a shadow map. Samplers take the derivatives of the quad.
template <class Real>
struct MapPosition {
    Vec2<Real> uv;
    Real depth;   // projective, [0, 1]
    Mask inside;  // inside the light's frustum
};

/// The same in one of several maps; the shader may bring the derivatives along.
template <class Real>
struct GradientPosition {
    Vec2<Real> uv;
    Real depth;
    Mask inside;
    bool has_gradients = false;  // else those of the quad
    Gradients<Real> gradients{};
};

template <class F>
auto map_position(const F& f) {
    using Real = typename F::Real;
    const Real inv_q = f.rcp(f.in.light.w);
    const MapPosition<Real> at{{f.in.light.x * inv_q, f.in.light.y * inv_q}, f.in.light.z * inv_q, Mask(true)};
    const Real zero(0.0f);
    const Real one(1.0f);
    const Mask inside = (f.in.light.w > zero) & (at.uv.x >= zero) & (at.uv.x <= one) & (at.uv.y >= zero) & (at.uv.y <= one) &
                        (at.depth >= zero) & (at.depth <= one);
    return MapPosition<Real>{at.uv, at.depth, inside};
}

/// A sample at `coordinate`: (u, v), or (u, v, slice) of an array, (u, v) those of `at` or close to them.
template <class F, class Coordinate, class Real = typename F::Real>
Vec4<Real> sample_at(const F& f, TextureId map, const Sampler& sampler, const MapPosition<Real>&,
                     const Coordinate& coordinate) {
    return f.sample(map, sampler, coordinate);
}
template <class F, class Coordinate, class Real = typename F::Real>
Vec4<Real> sample_at(const F& f, TextureId map, const Sampler& sampler, const GradientPosition<Real>& at,
                     const Coordinate& coordinate) {
    return at.has_gradients ? f.sample_gradient(map, sampler, coordinate, at.gradients) : f.sample(map, sampler, coordinate);
}

/// One comparison sample of a map of depths.
template <class F, class Real = typename F::Real>
Real compare_sample(const F& f, TextureId map, const Sampler& sampler, const MapPosition<Real>& at) {
    if (sampler.max_anisotropy > 1) return f.sample_compare_quad(map, sampler, at.uv, at.depth);
    return f.sample_compare(map, sampler, at.uv, at.depth);
}
template <class F, class Real = typename F::Real>
Real compare_sample(const F& f, TextureId map, const Sampler& sampler, const GradientPosition<Real>& at) {
    if (sampler.max_anisotropy > 1 && at.has_gradients)
        return f.sample_compare_gradient(map, sampler, at.uv, at.depth, at.gradients);
    return compare_sample(f, map, sampler, MapPosition<Real>{at.uv, at.depth, at.inside});
}

/// Colour and visibility of a fragment. Outside the light's frustum nothing is known to be in shadow.
template <class F, class Real = typename F::Real>
ReceiverColors<Real> shade(const F& f, const Lighting& lighting, Mask inside, const Real& map_visibility) {
    const Real zero(0.0f);
    const Real one(1.0f);
    const Real visibility = select(inside, map_visibility, one);

    // n.l and the spot's cone.
    const Real position_weight(lighting.light_position.w);
    const Vec3<Real> to_light = normalize(splat<Real>(glm::vec3(lighting.light_position)) - f.in.position_ws * position_weight);
    const Vec3<Real> normal = normalize(f.in.normal_ws);
    const Real cos_normal = max(dot(normal, to_light), zero);
    const Real cos_axis = zero - dot(to_light, splat<Real>(lighting.light_direction));
    const Real cone = saturate(cos_axis * Real(lighting.cone_scale) + Real(lighting.cone_offset));

    const Real light = cos_normal * cone * visibility;
    const auto channel = [&](int c) {
        return sqrt(saturate(Real(lighting.base_color[c]) * (Real(lighting.ambient) + light * Real(lighting.light_color[c]))));
    };
    return {Vec4<Real>{channel(0), channel(1), channel(2), one}, Vec4<Real>{visibility, zero, zero, one}};
}

/// The camera pass of a technique with one map: `Receiver` turns what it reads at a position into visibility, by
/// `visibility(f, at)`.
template <class Receiver>
struct ShadedReceiver {
    Lighting lighting{};
    Receiver receiver{};

    static constexpr auto fields() {
        using S = ShadedReceiver;
        return std::tuple{Field{"lighting", &S::lighting}, Field{"receiver", &S::receiver}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const auto at = map_position(f);
        return shade(f, lighting, at.inside, receiver.visibility(f, at));
    }
};

}  // namespace gnomon::techniques
