// One pass and nothing around it: a mesh through one matrix into depth, or into depth and a colour, with a texture or without,
// with one sample per pixel or several that are resolved. Plain values, and the renderer for other people's GPUs.
#pragma once

#include "tests/peer/peer.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace gnomon::peer {

/// 5 interleaved floats.
struct RawVertex {
    glm::vec3 position;
    glm::vec2 uv;
};

struct RawMesh {
    std::vector<RawVertex> vertices;
    std::vector<std::uint32_t> indices;  // a triangle list
    glm::mat4 clip_from_mesh{1.0f};      // y up, depths 0 to 1
};

enum class RawShading {
    DepthOnly,  // no pixel shader, no colour
    Plain,      // (u, v, 0.5, 1)
    Bilinear,   // rgba8, the finest level
    Trilinear,  // all levels
};

inline constexpr int kRawTextureSize = 512;  // texels per side

/// Depth d32f, test less, cleared to 1; colour rgba8, cleared to 0, resolved to one sample where there are more.
struct RawPass {
    RawMesh mesh;
    RawShading shading = RawShading::Plain;
    int samples = 1;  // 1 or 4; depth alone has 1
    int width = 1024;
    int height = 768;
};

/// The texels of one level, 4 bytes each: the same picture for everyone.
std::vector<std::uint8_t> raw_texels(int level);

/// What came out, to see that all drew the same.
struct RawImage {
    std::size_t covered = 0;  // pixels that were drawn on
    double mean = 0;          // of their depths, or of the sum of their channels in 0 to 1
};
/// From d32f or rgba8 texels, as the pass has them.
RawImage raw_image(const RawPass& pass, const std::vector<std::byte>& texels);

/// One pass, ready to run again and again. Throws Error where the device lacks something. The Peer must outlive it.
class RawPassRenderer {
public:
    RawPassRenderer(const Peer& peer, const RawPass& pass);
    ~RawPassRenderer();
    RawPassRenderer(RawPassRenderer&&) noexcept;
    RawPassRenderer& operator=(RawPassRenderer&&) noexcept;

    /// Wall-clock milliseconds around submit and fence wait.
    double time_once();
    /// Runs once and reads back.
    RawImage render();

private:
    struct Resources;
    std::unique_ptr<Resources> resources_;
};

}  // namespace gnomon::peer
