// The light pass as draws: depth alone, or what an encoding makes of it. [Donnelly06] section 4, step 1
#include "techniques/common/caster.h"

#include "pipeline/program.h"

#include <algorithm>

namespace gnomon::techniques {

const Program& depth_program() {
    static const Program program = make_program<DepthVertex>("depth");
    return program;
}

void draw_depth_map(Device& device, std::span<const SceneDraw> scene, const glm::mat4& clip_from_world, TextureId depth,
                    const RasterState& raster) {
    device.execute(ClearDepth{depth, 1.0f});
    for (const SceneDraw& object : scene) {
        const DepthVertex vertex{.clip_from_object = clip_from_world * object.world_from_object};
        device.execute(Draw{.label = object.label,
                            .program = &depth_program(),
                            .vertex_constants = constants_of(vertex),
                            .vertices = object.vertices,
                            .indices = object.indices,
                            .count = object.count,
                            .raster = raster,
                            .depth = depth});
    }
}

void draw_casters(Device& device, std::span<const SceneDraw> scene, const MapView& view, const CasterPass& pass) {
    const glm::mat4 clip_from_world = view.clip_from_world();
    for (const SceneDraw& object : scene) {
        const glm::mat4 clip_from_object = clip_from_world * object.world_from_object;
        const CasterVertex plane{.clip_from_object = clip_from_object,
                                 .light = make_light_space(view.light, object.world_from_object)};
        const DistanceCasterVertex distance{.clip_from_object = clip_from_object,
                                            .world_from_object = object.world_from_object};
        Draw draw{.label = object.label,
                  .program = pass.euclidean ? &pass.programs.distance : &pass.programs.plane,
                  .vertex_constants = pass.euclidean ? constants_of(distance) : constants_of(plane),
                  .pixel_constants = pass.constants,
                  .vertices = object.vertices,
                  .indices = object.indices,
                  .count = object.count,
                  .raster = pass.raster,
                  .viewport = pass.viewport,
                  .depth = pass.depth};
        std::ranges::copy(pass.colors, draw.color.begin());
        device.execute(draw);
    }
}

}  // namespace gnomon::techniques
