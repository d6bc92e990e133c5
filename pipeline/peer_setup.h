// Where llvmpipe and SwiftShader put vertices, and the depth planes and biases they make of them: binary32, operation by
// operation, whatever the profile's arithmetic. docs/profiles.md (Rasterisers of llvmpipe and SwiftShader)
//
// Sources: Mesa 22.3.6 draw_llvm.c, lp_setup_tri.c, lp_state_setup.c; SwiftShader VertexRoutine.cpp, SetupRoutine.cpp.
// Both have y down in clip space; ours is up (D3D11.3 15.6), and changes its sign first.
#pragma once

#include "pipeline/setup.h"

#include <array>

namespace gnomon {

/// Divide, viewport and snapping as `state.viewport_arithmetic` says. `made`: clipping made the vertex.
template <class Scalar>
ScreenVertex<Scalar> project(const Scalar* clip_position, const Viewport& viewport, const SetupState& state, bool made = false);

/// The sense in which SwiftShader takes a triangle to turn on the screen: by an area in binary32, of all three vertices as they
/// are, clipped or not.
template <class Scalar>
bool turns_counter_clockwise(const std::array<const Scalar*, 3>& clip_positions, const Viewport& viewport,
                             const SetupState& state);

/// The vertices of a triangle in the order in which SwiftShader makes planes of them: the one of largest w first, among equals
/// what a rotation for the smallest y left first.
struct SwiftShaderVertices {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::array<std::array<float, 4>, 3> clip{};         // x, y, z, w with y down
    std::array<std::array<std::int32_t, 2>, 3> grid{};  // in steps of the profile's grid
    std::array<float, 3> over_w{};
    GridPoint origin;  // of the first vertex, 1/256 pixel

    /// From the first vertex; differences wrap as the hardware's do.
    [[nodiscard]] float steps(std::size_t i, std::size_t axis) const {
        const auto difference = static_cast<std::uint32_t>(grid[i][axis]) - static_cast<std::uint32_t>(grid[0][axis]);
        return static_cast<float>(static_cast<std::int32_t>(difference));
    }
};
template <class Scalar>
SwiftShaderVertices swiftshader_vertices(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                                         const SetupState& state);

/// Depth as a plane over the screen.
struct DepthPlane {
    float z0 = 0;  // at the origin
    GridPoint origin;
    float dx = 0;  // per pixel
    float dy = 0;
    std::array<float, 3> z{};  // of the vertices, in the order that the bias looks at them
    float slope = 0;           // the larger of both, as the bias takes it
};

/// By `state.plane_equations`, which are not Barycentric.
template <class Scalar>
DepthPlane driver_depth_plane(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                              const SetupState& state);

/// By `state.bias_arithmetic`, which is not D3d11.
float driver_depth_bias(const std::array<float, 3>& z, float slope, const SetupState& state);

}  // namespace gnomon
