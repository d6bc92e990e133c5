// The texture unit's instructions. D3D11.3 22.4
//
// Every lane reads valid memory whatever its coordinates are, so helper lanes need no mask.
#pragma once

#include "sim/double_lanes.h"
#include "sim/lanes.h"
#include "sim/profile.h"
#include "sim/vec.h"
#include "texunit/sampler.h"
#include "texunit/texture.h"

namespace gnomon {

/// Filtered texel at normalised coordinates. `lod` is the level of detail before bias and clamp (implicit_lod, or the
/// shader's own). D3D11.3 22.4.15, 22.4.18
template <class Real>
Vec4<Real> sample(const Texture& texture, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                  const Real& lod);

/// Filtered result of `reference OP texel`, 0 or 1 per texel. D3D11.3 22.4.19
template <class Real>
Real sample_compare(const Texture& texture, const Sampler& sampler, const Profile& profile, const Vec2<Real>& uv,
                    const Real& reference, const Real& lod);

/// One texel of one level, unfiltered; coordinates outside the level read as 0. D3D11.3 22.4.6 (ld)
template <class Real>
Vec4<Real> load_texel(const Texture& texture, Int x, Int y, int level);

/// Texels that one lane of such a sample reads: 1 or 4, twice where two levels are mixed.
template <class Real>
int texels_per_lane(const Sampler& sampler, const Real& lod, const Texture& texture, const Profile& profile, int lane);

extern template Vec4<Float> sample(const Texture&, const Sampler&, const Profile&, const Vec2<Float>&, const Float&);
extern template Vec4<Double> sample(const Texture&, const Sampler&, const Profile&, const Vec2<Double>&, const Double&);
extern template Float sample_compare(const Texture&, const Sampler&, const Profile&, const Vec2<Float>&, const Float&,
                                     const Float&);
extern template Double sample_compare(const Texture&, const Sampler&, const Profile&, const Vec2<Double>&, const Double&,
                                      const Double&);

}  // namespace gnomon
