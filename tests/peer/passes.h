// The passes of a frame, recorded into a command buffer: light, blur, mips, camera.
#pragma once

#include "tests/peer/bindings.h"
#include "tests/peer/pipelines.h"

#include <cstdint>
#include <vector>

namespace gnomon::peer {

/// Where a draw's indices lie in the shared buffers.
struct DrawRange {
    std::uint32_t index_count = 0;
    std::uint32_t first_index = 0;
    std::int32_t first_vertex = 0;
};

/// All meshes of a frame in one vertex and one index buffer, and one range per draw.
struct Geometry {
    Buffer vertices;
    Buffer indices;
    std::vector<DrawRange> draws;
};
Geometry make_geometry(const Device& device, const Frame& frame);

/// The images of a frame. Without a map, or without a blur, those images are empty.
struct Targets {
    Image color;
    Image visibility;
    Image depth;
    Image map;        // d32f, or moments with their mips
    Image map_depth;  // the depth buffer beside moments
    Image blur_temp;  // moments, blurred horizontally
};
Targets make_targets(const Device& device, const Frame& frame);

/// Everything the commands refer to.
struct PassInputs {
    const Frame& frame;
    const Geometry& geometry;
    const Targets& targets;
    const UniformBuffers& uniforms;
    const Sets& sets;
    const Pipelines& pipelines;
};

/// The whole frame. Afterwards color and visibility are kColorTarget, depth is kDepthTarget, and the map is kSampled.
void record_frame(VkCommandBuffer commands, const PassInputs& inputs);

}  // namespace gnomon::peer
