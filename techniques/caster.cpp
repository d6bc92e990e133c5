#include "techniques/caster.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

const Program& depth_program() {
    static const Program program = make_program<DepthVertex>("depth");
    return program;
}

void draw_depth_map(Device& device, std::span<const SceneDraw> scene, const scenes::View& light, TextureId depth,
                    const RasterState& raster) {
    device.execute(ClearDepth{depth, 1.0f});
    const glm::mat4 clip_from_world = light.clip_from_world();
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

}  // namespace gnomon::techniques
