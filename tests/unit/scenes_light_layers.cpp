// What a light meets one behind the other in the scenes of many overlapping shadows. [Lauritzen08] 3.4, 4.1.4
#include "scenes/embree_scene.h"
#include "scenes/procedural.h"
#include "scenes/view.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
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

/// A surface that faces the light, on one ray from it.
struct Layer {
    double depth_ls = 0;  // metres along the light's axis
    glm::dvec3 position_ws{0.0};
};

/// The surfaces along the ray through the middle of each texel of a map of `size` texels per side, nearest first, at most
/// `most`.
std::vector<std::vector<Layer>> peel(const Scene& scene, const EmbreeScene& traced, int size, std::size_t most) {
    const View light = light_view(scene.light, scene.bounds());
    const glm::dmat3 world_from_light(glm::transpose(glm::dmat3(light.view_from_world)));
    const glm::dvec3 eye(light.position_ws);
    std::vector<std::vector<Layer>> texels;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            // With a depth of 1 along the axis, the parameter of the ray is the depth.
            const double u = ((x + 0.5) / size * 2 - 1) / static_cast<double>(light.clip_from_view[0][0]);
            const double v = ((y + 0.5) / size * 2 - 1) / static_cast<double>(light.clip_from_view[1][1]);
            const glm::dvec3 direction = world_from_light * glm::dvec3(u, v, -1);
            std::vector<Layer>& layers = texels.emplace_back();
            double near_t = 0;
            while (layers.size() < most) {
                const auto hit = traced.nearest({eye, direction, near_t, 1000.0});
                if (!hit) break;
                const double depth = glm::dot(hit->position_ws - eye, direction) / glm::dot(direction, direction);
                if (glm::dot(hit->geometric_normal_ws, direction) < 0) layers.push_back({depth, hit->position_ws});
                near_t = std::max(depth, near_t) + 1e-4;
            }
        }
    }
    return texels;
}

/// Is the point in the 4:3 picture, with nothing before it?
bool camera_sees(const Scene& scene, const EmbreeScene& traced, const glm::dvec3& point_ws) {
    const View camera = camera_view(scene.camera, 4.0f / 3.0f);
    const glm::dvec4 clip = glm::dmat4(camera.clip_from_world()) * glm::dvec4(point_ws, 1.0);
    if (std::fabs(clip.x) > clip.w || std::fabs(clip.y) > clip.w) return false;
    return !traced.blocked({glm::dvec3(camera.position_ws), point_ws - glm::dvec3(camera.position_ws), 0, 1 - 1e-4});
}

}  // namespace

TEST_CASE("windmill and overlap lie inside the frustum of their light", "[scenes]") {
    for (const char* name : {"windmill", "overlap"}) {
        INFO(name);
        const Scene scene = scene_named(name);
        const View light = light_view(scene.light, scene.bounds());
        int outside = 0;
        for (const Instance& instance : scene.instances) {
            for (const Vertex& vertex : scene.meshes[instance.mesh].vertices) {
                const glm::vec4 clip = light.clip_from_world() * instance.world_from_object * glm::vec4(vertex.position, 1.0f);
                outside += !(std::fabs(clip.x) <= clip.w && std::fabs(clip.y) <= clip.w && clip.z >= 0 && clip.z <= clip.w);
            }
        }
        CHECK(outside == 0);
    }
}

TEST_CASE("windmill: 10,000 to 30,000 triangles, and many rays of the light cross several surfaces", "[scenes][Lauritzen08]") {
    const Scene scene = scene_named("windmill");
    CHECK(scene.triangle_count() >= 10000);
    CHECK(scene.triangle_count() <= 30000);
    const EmbreeScene traced(scene);
    const auto texels = peel(scene, traced, 256, 8);
    const auto with_layers = [&](std::size_t layers) {
        return std::ranges::count_if(texels, [&](const auto& ray) { return ray.size() >= layers; });
    };
    INFO(fmt::format("rays with 1, 2, 3, 4, 5, 6 surfaces and more: {} {} {} {} {} {}", with_layers(1), with_layers(2),
                     with_layers(3), with_layers(4), with_layers(5), with_layers(6)));
    CHECK(with_layers(2) * 5 > with_layers(1));
    CHECK(with_layers(3) * 20 > with_layers(1));
    CHECK(with_layers(5) > 100);
}

TEST_CASE("overlap: Delta x / Delta y is above 50 in many places that the camera sees", "[scenes][Lauritzen08]") {
    const Scene scene = scene_named("overlap");
    const EmbreeScene traced(scene);
    constexpr int kSize = 384;
    constexpr double kFarEndOfA = 10.0;  // what hangs before the light ends here; the yard begins beyond 20 m
    const auto texels = peel(scene, traced, kSize, 2);

    // Where the light meets B and then C, and A in a texel beside it: the filter region of figure 3.4.
    std::set<std::pair<int, int>> places;  // squares of 1 m
    std::set<int> heights_cm;
    std::vector<double> ratios;
    for (int y = 1; y + 1 < kSize; ++y) {
        for (int x = 1; x + 1 < kSize; ++x) {
            const auto& here = texels[static_cast<std::size_t>(y * kSize + x)];
            if (here.size() < 2 || here[0].depth_ls < kFarEndOfA) continue;
            const auto& [b, c] = std::pair(here[0], here[1]);
            double a = b.depth_ls;
            for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
                const auto& beside = texels[static_cast<std::size_t>((y + dy) * kSize + x + dx)];
                if (!beside.empty() && beside[0].depth_ls < kFarEndOfA) a = beside[0].depth_ls;
            }
            if (a == b.depth_ls || !camera_sees(scene, traced, c.position_ws)) continue;
            const double ratio = (b.depth_ls - a) / (c.depth_ls - b.depth_ls);
            ratios.push_back(ratio);
            if (ratio < 50) continue;
            places.insert({static_cast<int>(std::floor(c.position_ws.x)), static_cast<int>(std::floor(c.position_ws.z))});
            heights_cm.insert(static_cast<int>(std::lround(100 * c.position_ws.y)));
        }
    }
    REQUIRE(!ratios.empty());
    std::ranges::sort(ratios);
    const auto quantile = [&](std::size_t percent) { return ratios[(ratios.size() - 1) * percent / 100]; };
    INFO(fmt::format("{} texels, ratio {:.0f} to {:.0f}, deciles {:.0f}, {:.0f}, {:.0f}; {} places, {} heights", ratios.size(),
                     quantile(0), quantile(100), quantile(10), quantile(50), quantile(90), places.size(), heights_cm.size()));
    CHECK(quantile(50) > 50);
    CHECK(quantile(90) > 100);
    CHECK(places.size() >= 40);
    for (const int height : {0, 35, 70, 140}) CHECK(heights_cm.contains(height));  // terraces and plinth
    CHECK(heights_cm.size() >= 7);                                                 // and boards above boards
}
