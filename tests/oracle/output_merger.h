// The output merger for one sample, in scalar double rounded after every operation: blending, conversion to the format,
// stencil. Shares no code with the pipeline. D3D11.3 17.1, 17.5, 17.6, 17.12, 3.2.2, 3.2.3
#pragma once

#include "pipeline/state.h"
#include "sim/profile.h"
#include "texunit/format.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace oracle {

using Color = std::array<double, 4>;

/// Component c of a texel as stored, in the lower bits; and back into it.
std::uint32_t stored_code(gnomon::Format format, const std::byte* texel, int component);
void store_code(gnomon::Format format, std::byte* texel, int component, std::uint32_t code);

/// The code of a number in component c of a format. D3D11.3 3.2.2, 3.2.3.4, 3.2.3.6, 3.2.3.8
std::uint32_t component_code(gnomon::Format format, const gnomon::Profile& profile, double value, int component);

/// What enters the blender beside the stored colour.
struct BlendSources {
    Color src;
    Color src1;
    Color constant;
};

/// The result before it is converted to the format; `stored` is the target's colour as numbers. D3D11.3 17.1, 17.5
Color blend(const BlendSources& sources, const Color& stored, const gnomon::BlendState& state, gnomon::Format format,
            const gnomon::Profile& profile);

/// One stencil value after one fragment. D3D11.3 17.12
struct StencilOutcome {
    bool passes;  // both tests
    int stored;
};
StencilOutcome stencil(const gnomon::StencilState& state, bool front, bool depth_passes, int stored);

}  // namespace oracle
