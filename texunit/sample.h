// The texture unit's instructions. D3D11.3 22.4
//
// Every lane reads valid memory whatever its coordinates are, so helper lanes need no mask.
#pragma once

#include "sim/profile.h"
#include "sim/vec.h"
#include "texunit/lod.h"
#include "texunit/sampler.h"
#include "texunit/view.h"

#include <glm/vec2.hpp>

namespace gnomon {

/// The operands of an instruction besides coordinates and level of detail.
template <class Real>
struct SampleOperands {
    glm::ivec2 offset{0, 0};  // texels of whichever level is read, [-8, 7], gather [-32, 31]; not for cubes. D3D11.3 22.4.15
    Real lod_bias{0.0f};      // [-16, 15.99]. D3D11.3 22.4.16
};

/// Filtered texel at normalised coordinates (u, v, slice of an array) or in a direction of a cube. `lod` comes from
/// level_of_detail, or is the shader's own before bias and clamp. Formats of unsigned integers are read as numbers, unfiltered.
/// D3D11.3 22.4.15, 22.4.16, 22.4.17, 22.4.18
template <class Real>
Vec4<Real> sample(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                  const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands = {});

/// Filtered result of `reference OP red`, 0 or 1 per texel. D3D11.3 22.4.19, at level 0 22.4.20
template <class Real>
Real sample_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                    const Real& reference, const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands = {});

/// One component (0 to 3) of the four texels under a bilinear filter of the view's finest level, unfiltered and to the bit:
/// (left, lower), (right, lower), (right, upper), (left, upper). D3D11.3 22.4.2, 22.4.4
template <class Real>
Vec4<Real> gather(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                  int component, const glm::ivec2& offset = {0, 0});

/// The comparison of each. D3D11.3 22.4.3, 22.4.5
template <class Real>
Vec4<Real> gather_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                          const Real& reference, const glm::ivec2& offset = {0, 0});

/// One texel of one level of a layer, unfiltered; outside the level components read as 0, missing ones as their default.
/// D3D11.3 22.4.6 (ld)
template <class Real>
Vec4<Real> load_texel(const Texture& texture, Int x, Int y, int level, int layer = 0);

/// The same texel's codes, as stored; outside the level as load_texel. D3D11.3 22.4.6 (ld), 19.1.4
Vec4<Int> load_codes(const Texture& texture, Int x, Int y, int level, int layer = 0);

/// The codes of the texel that a nearest filter takes, as stored: what formats of unsigned integers are for.
/// D3D11.3 22.4.15, 19.1.4
template <class Real>
Vec4<Int> sample_codes(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                       const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands = {});

/// What a sample reads, over the lanes of `active` (bit i is lane i).
struct SampleCost {
    std::uint64_t probes = 0;
    std::uint64_t texels = 0;
};
template <class Real>
SampleCost sample_cost(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec3<Real>& coordinate,
                       const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands, std::uint32_t active);

/// Gradients on a cube's face from those of the direction. D3D11.3 7.18.11
template <class Real>
Gradients<Real> cube_gradients(const Vec3<Real>& direction, const Vec3<Real>& dx, const Vec3<Real>& dy);

/// The same at coordinates of a 2D texture.
template <class Real>
Vec4<Real> sample(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                  const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands = {}) {
    return sample(view, sampler, profile, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, lod, operands);
}
template <class Real>
Real sample_compare(const TextureView& view, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                    const Real& reference, const LevelOfDetail<Real>& lod, const SampleOperands<Real>& operands = {}) {
    return sample_compare(view, sampler, profile, Vec3<Real>{uv.x, uv.y, Real(0.0f)}, reference, lod, operands);
}

}  // namespace gnomon
