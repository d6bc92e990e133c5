// Embree behind a small interface. Embree 3 API reference, "Device API", "Scene API", "Ray Queries".
//
// Same bytes everywhere: the device is pinned to SSE4.2, because Embree's wider code paths round differently; the scene is
// built by one thread, because the tree, and with it the winner among triangles at the same distance, follows the order of the
// work; the scene is robust, so that no ray slips between two triangles; and the hit point does not come from Embree's float
// arithmetic.
#include "scenes/embree_scene.h"

#include "sim/error.h"
#include "sim/parallel.h"

#include <embree3/rtcore.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <cmath>
#include <cstddef>
#include <limits>

namespace gnomon::scenes {

namespace {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class T>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, Release>;

void check_device(RTCDevice device, const char* doing) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) fail("reference: Embree ran out of memory {}", doing);
    if (error != RTC_ERROR_NONE) fail("reference: Embree failed {} (error {})", doing, static_cast<int>(error));
}

glm::dvec3 unit(const glm::dvec3& v) {
    const double length2 = glm::dot(v, v);
    return length2 > 0 ? v / std::sqrt(length2) : glm::dvec3(0.0);
}

/// Embree's ray: floats, its bounds widened by nothing.
RTCRay float_ray(const Ray& ray) {
    RTCRay r{};
    r.org_x = static_cast<float>(ray.origin.x);
    r.org_y = static_cast<float>(ray.origin.y);
    r.org_z = static_cast<float>(ray.origin.z);
    r.dir_x = static_cast<float>(ray.direction.x);
    r.dir_y = static_cast<float>(ray.direction.y);
    r.dir_z = static_cast<float>(ray.direction.z);
    r.tnear = static_cast<float>(ray.near_t);
    r.tfar = static_cast<float>(ray.far_t);
    r.mask = std::numeric_limits<unsigned>::max();
    return r;
}

}  // namespace

struct EmbreeScene::Handles {
    Owned<RTCDevice> device;
    Owned<RTCScene> scene;
};

EmbreeScene::EmbreeScene(const Scene& scene) : handles_(std::make_unique<Handles>()) {
    // Move every instance to world space: positions as the vertex stage does, normals by the inverse transpose.
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        const auto base = static_cast<std::uint32_t>(vertices_ws_.size());
        if (vertices_ws_.size() + mesh.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
            fail("reference: scene has more than {} vertices", std::numeric_limits<std::uint32_t>::max());
        }
        const glm::dmat3 cofactors = [&] {  // the inverse transpose times the determinant: defined for flattening matrices too
            const glm::dmat3 m(instance.world_from_object);
            const glm::dmat3 c(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
            return glm::dot(m[0], c[0]) < 0 ? -c : c;
        }();
        for (const Vertex& vertex : mesh.vertices) {
            const glm::vec3 position_ws(instance.world_from_object * glm::vec4(vertex.position, 1.0f));
            vertices_ws_.push_back({position_ws, glm::vec3(unit(cofactors * glm::dvec3(vertex.normal)))});
        }
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            triangles_.emplace_back(base + mesh.indices[i], base + mesh.indices[i + 1], base + mesh.indices[i + 2]);
        }
    }

    handles_->device.reset(rtcNewDevice("isa=sse4.2"));
    const RTCDevice device = handles_->device.get();
    if (device == nullptr) fail("reference: Embree cannot start (error {})", static_cast<int>(rtcGetDeviceError(nullptr)));
    handles_->scene.reset(rtcNewScene(device));
    const RTCScene embree_scene = handles_->scene.get();
    if (!triangles_.empty()) {
        const Owned<RTCGeometry> geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
        auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices_ws_.size()));
        auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
            geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles_.size()));
        check_device(device, "taking the triangles");
        for (const Vertex& vertex : vertices_ws_) {
            for (int axis = 0; axis < 3; ++axis) *positions++ = vertex.position[axis];
        }
        for (const glm::uvec3& triangle : triangles_) {
            for (int corner = 0; corner < 3; ++corner) *indices++ = triangle[corner];
        }
        rtcCommitGeometry(geometry.get());
        rtcAttachGeometry(embree_scene, geometry.get());
    }
    rtcSetSceneFlags(embree_scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(embree_scene, RTC_BUILD_QUALITY_HIGH);
    const Workers one_thread(1);  // limits Embree's use of TBB while it lives
    rtcCommitScene(embree_scene);
    check_device(device, "building the scene");
}

EmbreeScene::~EmbreeScene() = default;

std::optional<Hit> EmbreeScene::nearest(const Ray& ray) const {
    RTCRayHit query{};
    query.ray = float_ray(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(handles_->scene.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    // Intersect the ray with that triangle again: barycentric coordinates as ratios of volumes. [Moller97]
    const glm::uvec3 triangle = triangles_[query.hit.primID];
    Hit hit{};
    for (int i = 0; i < 3; ++i) hit.corners_ws[static_cast<std::size_t>(i)] = glm::dvec3(vertices_ws_[triangle[i]].position);
    const auto& [a, b, c] = hit.corners_ws;
    const glm::dvec3 scaled_normal = glm::cross(b - a, c - a);
    const double volume = glm::dot(scaled_normal, ray.direction);
    double u = static_cast<double>(query.hit.u);
    double v = static_cast<double>(query.hit.v);
    if (volume != 0) {
        const glm::dvec3 q = glm::cross(ray.origin - a, ray.direction);
        u = glm::dot(c - a, q) / -volume;
        v = glm::dot(b - a, q) / volume;
    }

    // A ray that Embree caught just outside the triangle is put on its border.
    u = glm::clamp(u, 0.0, 1.0);
    v = glm::clamp(v, 0.0, 1.0 - u);
    hit.position_ws = a * (1 - u - v) + b * u + c * v;
    const auto normal_at = [&](int i) { return glm::dvec3(vertices_ws_[triangle[i]].normal); };
    hit.normal_ws = unit(normal_at(0) * (1 - u - v) + normal_at(1) * u + normal_at(2) * v);
    hit.geometric_normal_ws = unit(scaled_normal);
    return hit;
}

bool EmbreeScene::blocked(const Ray& ray) const {
    RTCRay query = float_ray(ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(handles_->scene.get(), &context, &query);
    return query.tfar < 0;
}

}  // namespace gnomon::scenes
