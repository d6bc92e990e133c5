// The blend equation on lanes. D3D11.3 17.1, 17.5, 17.6
#pragma once

#include "pipeline/state.h"
#include "sim/double_lanes.h"
#include "sim/vec.h"
#include "texunit/format.h"

namespace gnomon {

/// The range that colours, factors and results are clamped to. D3D11.3 17.5
enum class BlendRange { Unorm, Snorm, Float };
BlendRange blend_range(ComponentType type);

/// What a blend reads, all clamped to the target's range by blend() itself.
template <class Real>
struct BlendInput {
    Vec4<Real> src;
    Vec4<Real> src1;  // second colour, where a factor asks for it
    Vec4<Real> dst;
    Vec4<Real> constant;
};

/// The colour to store, before it is clamped and rounded to the format. Products are rounded, then the sum: D3D11.3 17.5 counts
/// float blends as fused, which leaves the number of roundings open.
template <class Real>
Vec4<Real> blend(const BlendInput<Real>& input, const BlendState& state, BlendRange range);

/// Whether the state needs the second colour of the functor.
bool uses_second_color(const BlendState& state);

extern template Vec4<Float> blend(const BlendInput<Float>&, const BlendState&, BlendRange);
extern template Vec4<Double> blend(const BlendInput<Double>&, const BlendState&, BlendRange);

}  // namespace gnomon
