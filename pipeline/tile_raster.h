// One tile of one draw: primitives in order, blocks, quads, depth and stencil, pixel functor, targets.
//
// The code is the same for every program: the functor is called through one pointer per wave, so that a program brings only its
// own arithmetic and a draw runs only the stages that its state asks for.
#pragma once

#include "pipeline/binning.h"
#include "pipeline/output.h"
#include "pipeline/program.h"

#include <span>

namespace gnomon {

/// When depth and stencil are tested. D3D11.3 16.12
enum class DepthOrder {
    Early,      // test and write before the functor
    EarlyTest,  // test before, write after: discards alone cannot make a failing sample pass
    Late,       // test and write after
};

/// What every tile of a draw shares.
struct TileState {
    const Program* program = nullptr;
    const void* pixel_functor = nullptr;
    DepthOrder order = DepthOrder::Early;
    Texture* depth_texture = nullptr;  // null: no tests
    TargetView depth_view;
    DepthState depth;
    StencilState stencil;
    std::span<const ColorTarget> color;  // one per colour of the functor
    OutputState output;
    std::span<const ViewportTransform> viewports;
    SamplePattern pattern;
    SamplePattern depth_pattern;  // where depths are taken, by sample
    PixelRect depth_extent;       // of these, as SetupState has it
    PlaneEquations plane_equations = PlaneEquations::Barycentric;
    DepthRounding depth_rounding = DepthRounding::HalfUp;
    int layers = 1;
    int width = 0;  // of the targets
    int height = 0;
    TextureId derivative_report_id = TextureId::None;
    Texture* derivative_report = nullptr;
    PixelEnvironment environment;
};

/// Draws the pieces of one tile in order. `tally` is null unless the device counts.
template <class Real>
void raster_tile(const TileState& state, const BinnedPrimitives<typename Real::Scalar>& binned, std::uint32_t tile, int tiles_x,
                 Tally* tally);

extern template void raster_tile<Float>(const TileState&, const BinnedPrimitives<float>&, std::uint32_t, int, Tally*);
extern template void raster_tile<Double>(const TileState&, const BinnedPrimitives<double>&, std::uint32_t, int, Tally*);

}  // namespace gnomon
