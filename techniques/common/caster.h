// The light pass: the scene as the light sees it. [Donnelly06] section 4, step 1
#pragma once

#include "pipeline/device.h"
#include "pipeline/vertex_stage.h"
#include "techniques/common/depth_metric.h"
#include "techniques/common/light_space.h"
#include "techniques/common/map_window.h"
#include "techniques/common/scene_resources.h"

#include <span>

namespace gnomon::techniques {

/// What the vertex functors of this layer fetch: scenes::Vertex.
template <class Real>
struct MeshVertex {
    Vec3<Real> position;
    Vec3<Real> normal;
};

/// Positions only, for depth passes.
struct DepthVertex {
    template <class Real>
    using Input = MeshVertex<Real>;
    template <class Real>
    using Varyings = NoVaryings<Real>;

    glm::mat4 clip_from_object{1.0f};

    static constexpr auto fields() { return std::tuple{Field{"clip_from_object", &DepthVertex::clip_from_object}}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{transform_point(clip_from_object, v.in.position), NoVaryings<typename V::Real>{}};
    }
};

template <class Real>
struct LinearDepth {
    Real depth_ls;  // [0, 1] between the light's planes
};

/// Positions and linear depth, for passes that store a function of depth.
struct CasterVertex {
    template <class Real>
    using Input = MeshVertex<Real>;
    template <class Real>
    using Varyings = LinearDepth<Real>;

    glm::mat4 clip_from_object{1.0f};
    LightSpace light{};

    static constexpr auto fields() {
        using C = CasterVertex;
        return std::tuple{Field{"clip_from_object", &C::clip_from_object}, Field{"light", &C::light}};
    }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{transform_point(clip_from_object, v.in.position), LinearDepth<Real>{light.depth(v.in.position)}};
    }
};

template <class Real>
struct CasterPosition {
    Vec3<Real> position_ws;
};

/// Positions twice, for passes that store a function of the distance from the light.
struct DistanceCasterVertex {
    template <class Real>
    using Input = MeshVertex<Real>;
    template <class Real>
    using Varyings = CasterPosition<Real>;

    glm::mat4 clip_from_object{1.0f};
    glm::mat4 world_from_object{1.0f};

    static constexpr auto fields() {
        using C = DistanceCasterVertex;
        return std::tuple{Field{"clip_from_object", &C::clip_from_object}, Field{"world_from_object", &C::world_from_object}};
    }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> world = transform_point(world_from_object, v.in.position);
        return VertexOutput{transform_point(clip_from_object, v.in.position),
                            CasterPosition<Real>{{world.x, world.y, world.z}}};
    }
};

/// Writes what an `Encoding` makes of a fragment's depth: its `encode(depth)` gives the colours of the targets.
template <class Encoding>
struct DepthCaster {
    DepthScale scale{};
    Encoding encoding{};

    static constexpr auto fields() {
        using C = DepthCaster;
        return std::tuple{Field{"scale", &C::scale}, Field{"encoding", &C::encoding}};
    }

    template <class F>
    auto operator()(const F& f) const {
        return encoding.encode(caster_depth(f, scale));
    }
};

/// The two programs of a light pass: depth that the vertex stage hands over, and distance.
struct CasterPrograms {
    Program plane;
    Program distance;
};

/// Depth-only program "depth": a DepthVertex and no pixel functor.
const Program& depth_program();

/// Draws every object of the scene into a depth texture (cleared first).
void draw_depth_map(Device& device, std::span<const SceneDraw> scene, const glm::mat4& clip_from_world, TextureId depth,
                    const RasterState& raster);

/// A light pass with colour targets; everything is cleared before.
struct CasterPass {
    const CasterPrograms& programs;
    std::span<const std::byte> constants;  // a DepthCaster
    bool euclidean = false;                // its DepthScale's
    std::span<const TargetView> colors;
    TextureId depth = TextureId::None;
    RasterState raster{};
    Viewport viewport{};
};
void draw_casters(Device& device, std::span<const SceneDraw> scene, const MapView& view, const CasterPass& pass);

}  // namespace gnomon::techniques
