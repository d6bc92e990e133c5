// The procedural scenes: sizes, sound meshes, views that hold what they should.
#include "scenes/auto_view.h"
#include "scenes/procedural.h"
#include "scenes/view.h"

#include <catch2/catch.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

using namespace gnomon;
using namespace gnomon::scenes;

namespace {

Scene scene_named(std::string_view name) {
    for (const ProceduralScene& source : procedural_scenes())
        if (source.name == name) return source.make();
    FAIL("no scene " << name);
    return {};
}

using Point = std::tuple<float, float, float>;
Point key(const glm::vec3& p) { return {p.x, p.y, p.z}; }

/// Directed edges that are not matched by their reverse, positions welded.
int open_edges(const Mesh& mesh) {
    std::map<std::pair<Point, Point>, int> balance;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Point a = key(mesh.vertices[mesh.indices[i + k]].position);
            const Point b = key(mesh.vertices[mesh.indices[i + (k + 1) % 3]].position);
            if (a < b) {
                ++balance[{a, b}];
            } else {
                --balance[{b, a}];
            }
        }
    }
    int open = 0;
    for (const auto& [edge, count] : balance) open += count != 0;
    return open;
}

}  // namespace

TEST_CASE("procedural scenes are sound: indices in range, finite, unit normals that agree with the winding", "[scenes]") {
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene scene = source.make();
        INFO(source.name);
        CHECK(scene.triangle_count() > 0);
        CHECK(scene.name == source.name);
        for (const Mesh& mesh : scene.meshes) {
            INFO(mesh.name);
            REQUIRE(mesh.indices.size() % 3 == 0);
            int against = 0;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                for (std::size_t k = 0; k < 3; ++k) REQUIRE(mesh.indices[i + k] < mesh.vertices.size());
                const Vertex& a = mesh.vertices[mesh.indices[i]];
                const Vertex& b = mesh.vertices[mesh.indices[i + 1]];
                const Vertex& c = mesh.vertices[mesh.indices[i + 2]];
                const glm::vec3 face = glm::cross(b.position - a.position, c.position - a.position);
                against += glm::dot(face, a.normal + b.normal + c.normal) < 0;
            }
            CHECK(against == 0);
            for (const Vertex& vertex : mesh.vertices) {
                const float length2 = glm::dot(vertex.normal, vertex.normal);
                if (!(std::fabs(length2 - 1) < 1e-4f)) FAIL_CHECK("normal of length^2 " << length2);
            }
        }
    }
}

TEST_CASE("the car scene has about 10,000 triangles, and making a scene twice gives the same bytes", "[scenes]") {
    CHECK(scene_named("car").triangle_count() >= 9500);
    CHECK(scene_named("car").triangle_count() <= 10500);
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene a = source.make();
        const Scene b = source.make();
        REQUIRE(a.meshes.size() == b.meshes.size());
        for (std::size_t m = 0; m < a.meshes.size(); ++m) {
            CHECK(a.meshes[m].vertices == b.meshes[m].vertices);
            CHECK(a.meshes[m].indices == b.meshes[m].indices);
        }
    }
}

TEST_CASE("the solid parts of the scenes are closed", "[scenes]") {
    // Everything but grounds, planes and leaves bounds a volume.
    int solids = 0;
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene scene = source.make();
        for (const Mesh& mesh : scene.meshes) {
            if (mesh.name == "ground" || mesh.name == "leaves" || mesh.name == "foliage" || source.name == "planes") continue;
            INFO(source.name << " " << mesh.name);
            CHECK(open_edges(mesh) == 0);
            ++solids;
        }
    }
    CHECK(solids >= 4);
}

TEST_CASE("city: 57,000 to 59,000 triangles in 250 to 350 m, from 2 m before the camera to beyond 200 m",
          "[scenes][Lefohn07]") {
    const Scene scene = scene_named("city");
    CHECK(scene.triangle_count() >= 57000);
    CHECK(scene.triangle_count() <= 59000);
    std::set<std::tuple<float, float, float>> colors;
    for (const Mesh& mesh : scene.meshes) colors.insert(key(mesh.base_color));
    CHECK(colors.size() >= 20);
    const Bounds bounds = scene.bounds();
    const float extent = bounds.upper.z - bounds.lower.z;
    CHECK(extent > 250);
    CHECK(extent < 350);

    // What the camera holds reaches over two orders of magnitude of depth, and its eye is at the height of a street.
    CHECK(scene.camera.world_from_camera[3].y > 2);
    CHECK(scene.camera.world_from_camera[3].y < 6);
    const View camera = camera_view(scene.camera, 4.0f / 3.0f);
    float nearest = scene.camera.zfar;
    float farthest = 0;
    int below_near = 0;
    for (const Instance& instance : scene.instances) {
        for (const Vertex& vertex : scene.meshes[instance.mesh].vertices) {
            const glm::vec4 clip = camera.clip_from_world() * instance.world_from_object * glm::vec4(vertex.position, 1.0f);
            if (std::fabs(clip.x) > clip.w || std::fabs(clip.y) > clip.w) continue;
            below_near += clip.z < 0;
            nearest = std::min(nearest, clip.w);
            farthest = std::max(farthest, clip.w);
        }
    }
    CHECK(below_near == 0);
    CHECK(nearest > 1.5f);
    CHECK(nearest < 3);
    CHECK(farthest > 270);
    CHECK(farthest < scene.camera.zfar);

    // The sun stands 48 degrees high; a map of 1024 texels has texels of 0.35 by 0.22 m.
    CHECK(scene.light.kind == LightKind::Directional);
    const View light = light_view(scene.light, bounds);
    CHECK(-light.direction_ws.y == Approx(std::sin(48 * std::acos(-1.0) / 180)).epsilon(1e-6));
    CHECK(2 / light.clip_from_view[0][0] / 1024 > 0.3f);
    CHECK(2 / light.clip_from_view[1][1] / 1024 > 0.2f);
}

TEST_CASE("city: faces that look the same way in one plane do not overlap where anybody could see them", "[scenes]") {
    // The halves of boxes' sides, as their rectangles in planes of constant x, y or z.
    struct Rectangle {
        glm::vec2 lower;
        glm::vec2 upper;
        std::string mesh;
    };
    struct Triangle {
        glm::vec3 a, b, c;
    };
    std::map<std::tuple<int, int, long>, std::vector<Rectangle>> planes;
    std::vector<Triangle> triangles;
    const Scene scene = scene_named("city");
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        if (instance.world_from_object != glm::mat4(1.0f)) continue;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const glm::vec3 a = mesh.vertices[mesh.indices[i]].position;
            const glm::vec3 b = mesh.vertices[mesh.indices[i + 1]].position;
            const glm::vec3 c = mesh.vertices[mesh.indices[i + 2]].position;
            triangles.push_back({a, b, c});
            const glm::vec3 low = glm::min(a, glm::min(b, c));
            const glm::vec3 high = glm::max(a, glm::max(b, c));
            for (int axis = 0; axis < 3; ++axis) {
                const int u = (axis + 1) % 3;
                const int v = (axis + 2) % 3;
                const auto at_corner = [&](const glm::vec3& p) {
                    return (p[u] == low[u] || p[u] == high[u]) && (p[v] == low[v] || p[v] == high[v]);
                };
                if (high[axis] - low[axis] > 1e-5f || !at_corner(a) || !at_corner(b) || !at_corner(c)) continue;
                const Rectangle next{{low[u], low[v]}, {high[u], high[v]}, mesh.name};
                auto& plane = planes[{axis, glm::cross(b - a, c - a)[axis] > 0 ? 1 : -1, std::lround(low[axis] * 2000)}];
                if (!plane.empty() && plane.back().lower == next.lower && plane.back().upper == next.upper) continue;
                plane.push_back(next);
            }
        }
    }
    // Inside a solid or under the ground, a ray upwards leaves more surfaces than it enters.
    const auto hidden = [&](const glm::vec3& p) {
        int left = 0;
        for (const auto& [a, b, c] : triangles) {
            const auto edge = [&](const glm::vec3& from, const glm::vec3& to) {
                return (to.z - from.z) * (p.x - from.x) - (to.x - from.x) * (p.z - from.z);
            };
            const float ab = edge(a, b);
            const float bc = edge(b, c);
            const float ca = edge(c, a);
            const bool front = ab > 0 && bc > 0 && ca > 0;
            if (!front && !(ab < 0 && bc < 0 && ca < 0)) continue;
            if ((bc * a.y + ca * b.y + ab * c.y) / (ab + bc + ca) > p.y) left += front ? 1 : -1;
        }
        return left > 0;
    };
    int rectangles_seen = 0;
    int overlaps = 0;
    for (const auto& [plane, rectangles] : planes) {
        const auto& [axis, sign, at] = plane;
        rectangles_seen += static_cast<int>(rectangles.size());
        for (std::size_t i = 0; i < rectangles.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                const glm::vec2 low = glm::max(rectangles[i].lower, rectangles[k].lower);
                const glm::vec2 high = glm::min(rectangles[i].upper, rectangles[k].upper);
                if (high.x - low.x < 0.005f || high.y - low.y < 0.005f) continue;
                ++overlaps;
                const glm::vec2 inside = low + glm::vec2(0.43f, 0.59f) * (high - low);
                glm::vec3 p;
                p[axis] = static_cast<float>(at) / 2000 + 0.002f * static_cast<float>(sign);
                p[(axis + 1) % 3] = inside.x;
                p[(axis + 2) % 3] = inside.y;
                INFO(rectangles[i].mesh << " and " << rectangles[k].mesh << " before (" << p.x << ", " << p.y << ", " << p.z
                                        << ")");
                if (!hidden(p)) FAIL_CHECK("axis " << axis << ", " << high.x - low.x << " x " << high.y - low.y << " m");
            }
        }
    }
    CHECK(rectangles_seen > 10000);
    CHECK(overlaps > 0);  // the buried ends of piers: the test sees overlaps
}

TEST_CASE("planes: occluder and receiver each have one depth under the light", "[scenes][Donnelly06][3.1]") {
    const Scene scene = scene_named("planes");
    const View light = light_view(scene.light, scene.bounds());
    std::map<float, int> depths;
    for (const Instance& instance : scene.instances) {
        for (const Vertex& vertex : scene.meshes[instance.mesh].vertices) {
            const glm::vec4 view = light.view_from_world * instance.world_from_object * glm::vec4(vertex.position, 1.0f);
            const float depth = (-view.z - light.znear) / (light.zfar - light.znear);
            ++depths[std::round(depth * 1e5f) / 1e5f];
            CHECK(depth >= 0.0f);
            CHECK(depth <= 1.0f);
        }
    }
    CHECK(depths.size() == 2);
}

TEST_CASE("views: D3D clip space, near plane at depth 0, far plane at 1", "[scenes][15.4]") {
    Camera camera{.world_from_camera = looking_at({1, 2, 3}, {1, 2, -5}), .yfov_rad = 1.0f, .znear = 0.5f, .zfar = 20.0f};
    const View view = camera_view(camera, 2.0f);
    const auto ndc = [&](glm::vec3 world) {
        const glm::vec4 clip = view.clip_from_world() * glm::vec4(world, 1.0f);
        return glm::vec3(clip) / clip.w;
    };
    CHECK(ndc({1, 2, 2.5f}).z == Approx(0).margin(1e-6));
    CHECK(ndc({1, 2, -17}).z == Approx(1).margin(1e-6));
    const float half_height = 4.0f * std::tan(0.5f);
    CHECK(ndc({1, 2 + half_height, -1}).y == Approx(1).margin(1e-5));
    CHECK(ndc({1 + 2 * half_height, 2, -1}).x == Approx(1).margin(1e-5));
}

TEST_CASE("the automatic camera and light hold the model", "[scenes]") {
    const Bounds box{{-1, 0, -2}, {3, 2, 1}};
    const View camera = camera_view(automatic_camera(box), 4.0f / 3.0f);
    const View light = light_view(automatic_light(box), box);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec4 p((corner & 1) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                          (corner & 4) != 0 ? box.upper.z : box.lower.z, 1.0f);
        for (const View& view : {camera, light}) {
            const glm::vec4 clip = view.clip_from_world() * p;
            CHECK(std::fabs(clip.x) <= clip.w);
            CHECK(std::fabs(clip.y) <= clip.w);
            CHECK(clip.z >= 0);
            CHECK(clip.z <= clip.w);
        }
    }
    CHECK(light.direction_ws.y < -0.6f);
}
