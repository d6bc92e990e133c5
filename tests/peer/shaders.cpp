// The only file that sees the generated headers.
#include "tests/peer/shaders.h"

#include "tests/peer/result.h"

namespace gnomon::peer {
namespace {

#include "peer_shaders/blur_2x0_frag.h"
#include "peer_shaders/blur_2x3_frag.h"
#include "peer_shaders/blur_2x5_frag.h"
#include "peer_shaders/blur_4x0_frag.h"
#include "peer_shaders/blur_4x3_frag.h"
#include "peer_shaders/blur_4x5_frag.h"
#include "peer_shaders/blur_vert.h"
#include "peer_shaders/caster_depth_vert.h"
#include "peer_shaders/caster_moments_frag.h"
#include "peer_shaders/caster_moments_vert.h"
#include "peer_shaders/caster_warped_frag.h"
#include "peer_shaders/raw_textured_0_frag.h"
#include "peer_shaders/raw_textured_1_frag.h"
#include "peer_shaders/raw_uv_0_vert.h"
#include "peer_shaders/raw_uv_1_vert.h"
#include "peer_shaders/receiver_depth_0_frag.h"
#include "peer_shaders/receiver_depth_1_frag.h"
#include "peer_shaders/receiver_depth_3_frag.h"
#include "peer_shaders/receiver_depth_5_frag.h"
#include "peer_shaders/receiver_depth_vert.h"
#include "peer_shaders/receiver_moments_frag.h"
#include "peer_shaders/receiver_moments_vert.h"
#include "peer_shaders/receiver_none_frag.h"
#include "peer_shaders/receiver_none_vert.h"
#include "peer_shaders/receiver_warped_frag.h"

std::span<const std::uint32_t> receiver_depth_frag(int taps) {
    if (taps == 1) return k_receiver_depth_1_frag;
    if (taps == 3) return k_receiver_depth_3_frag;
    if (taps == 5) return k_receiver_depth_5_frag;
    return k_receiver_depth_0_frag;
}

std::span<const std::uint32_t> blur_2_channels(int taps) {
    if (taps == 3) return k_blur_2x3_frag;
    if (taps == 5) return k_blur_2x5_frag;
    return k_blur_2x0_frag;
}

std::span<const std::uint32_t> blur_4_channels(int taps) {
    if (taps == 3) return k_blur_4x3_frag;
    if (taps == 5) return k_blur_4x5_frag;
    return k_blur_4x0_frag;
}

}  // namespace

ShaderPair caster_shaders(MapKind map) {
    switch (map) {
        case MapKind::None: return {};
        case MapKind::Depth: return {k_caster_depth_vert, {}};
        case MapKind::Moments: return {k_caster_moments_vert, k_caster_moments_frag};
        case MapKind::WarpedMoments: return {k_caster_moments_vert, k_caster_warped_frag};
    }
    return {};
}

ShaderPair receiver_shaders(MapKind map, int taps) {
    switch (map) {
        case MapKind::None: return {k_receiver_none_vert, k_receiver_none_frag};
        case MapKind::Depth: return {k_receiver_depth_vert, receiver_depth_frag(taps)};
        case MapKind::Moments: return {k_receiver_moments_vert, k_receiver_moments_frag};
        case MapKind::WarpedMoments: return {k_receiver_moments_vert, k_receiver_warped_frag};
    }
    return {};
}

ShaderPair blur_shaders(MapKind map, int taps) {
    return {k_blur_vert, map == MapKind::WarpedMoments ? blur_4_channels(taps) : blur_2_channels(taps)};
}

ShaderPair raw_shaders(RawFragments fragments) {
    switch (fragments) {
        case RawFragments::None: return {k_raw_uv_0_vert, {}};
        case RawFragments::Plain: return {k_raw_uv_1_vert, k_raw_textured_0_frag};
        case RawFragments::Textured: return {k_raw_uv_1_vert, k_raw_textured_1_frag};
    }
    return {};
}

OwnedShader make_shader(VkDevice device, std::span<const std::uint32_t> spirv) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    VkShaderModule shader{};
    check(vkCreateShaderModule(device, &info, nullptr, &shader), "creating a shader");
    return {device, shader};
}

}  // namespace gnomon::peer
