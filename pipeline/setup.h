// From three clip-space vertices to a Triangle: divide, viewport, snap, cull, depth bias, planes. D3D11.3 15.5 to 15.11, 3.4
#pragma once

#include "pipeline/clip.h"
#include "pipeline/command.h"
#include "pipeline/triangle.h"
#include "pipeline/triangulate.h"
#include "sim/profile.h"
#include "texunit/format.h"

#include <array>
#include <optional>

namespace gnomon {

/// What setup needs to know of a draw.
struct SetupState {
    RasterState raster;
    PixelRect viewport;                                 // inside the target
    int subpixel_bits = kSubpixelBits;                  // of the profile
    ComponentType depth_type = ComponentType::Depth24;  // scale of the constant depth bias; UNORM without a depth target
};

/// The guard band that keeps positions inside the signed 16.8 range. D3D11.3 3.4.1, 15.4
template <class Scalar>
GuardBand<Scalar> guard_band(const PixelRect& viewport);

/// Where a clip-space vertex lands on the 16.8 grid; nothing if a coordinate is not a number.
template <class Scalar>
std::optional<GridPoint> snap_vertex(const Scalar* vertex, const SetupState& state);

enum class SetupResult { Drawn, Culled };

/// `vertices` point at clip x, y, z, w and the varyings behind them.
template <class Scalar>
SetupResult set_up_triangle(const std::array<const Scalar*, 3>& vertices, const SetupState& state, Triangle<Scalar>& triangle);

extern template GuardBand<float> guard_band(const PixelRect&);
extern template GuardBand<double> guard_band(const PixelRect&);
extern template std::optional<GridPoint> snap_vertex(const float*, const SetupState&);
extern template std::optional<GridPoint> snap_vertex(const double*, const SetupState&);
extern template SetupResult set_up_triangle(const std::array<const float*, 3>&, const SetupState&, Triangle<float>&);
extern template SetupResult set_up_triangle(const std::array<const double*, 3>&, const SetupState&, Triangle<double>&);

}  // namespace gnomon
