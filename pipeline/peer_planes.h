// Varyings as llvmpipe and SwiftShader carry them: one plane over the screen for each, in binary32, operation by operation.
//
// Sources: Mesa 22.3.6 lp_state_setup.c, lp_bld_interp.c; SwiftShader SetupRoutine.cpp, PixelRoutine.cpp.
#pragma once

#include "pipeline/interpolate.h"
#include "pipeline/setup.h"

#include <array>
#include <span>

namespace gnomon {

/// A value over the screen, from an origin that is kept elsewhere.
struct PeerPlane {
    float start = 0;
    float dx = 0;  // per pixel
    float dy = 0;
};

/// What the planes of one triangle are made from.
template <class Scalar>
struct PeerPlanes {
    PlaneEquations equations = PlaneEquations::Llvmpipe;
    std::array<const Scalar*, 3> varyings{};  // at the vertices, in the driver's order
    std::array<float, 3> over_w{};            // 1 / w there
    std::array<float, 3> w{};
    GridPoint origin;  // 1/256 pixel
    // llvmpipe: from the vertex to the origin, and the differences of positions over the area.
    float x0 = 0, y0 = 0, dx01 = 0, dy01 = 0, dx20 = 0, dy20 = 0, over_area = 0;
    std::array<PeerPlane, 3> share{};  // SwiftShader: of each vertex, over w
    PeerPlane inverse_w;

    /// Through values at the vertices: SwiftShader's are divided by w in it.
    [[nodiscard]] PeerPlane through(const std::array<float, 3>& values) const;
};

/// By `state.plane_equations`, which are not Barycentric.
template <class Scalar>
PeerPlanes<Scalar> make_peer_planes(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                                    const SetupState& state);

/// Where the varyings of a wave are taken, in 1/256 of each pixel.
struct PeerPositions {
    PixelLanes centre, centroid, sample;
};

/// All varyings of a wave, one per mode, and w at the sample. `flat` are those of the provoking vertex.
template <class Real>
void interpolate_as_peer(const PeerPlanes<typename Real::Scalar>& planes, std::span<const Interpolation> modes,
                         const PixelLanes& pixels, const PeerPositions& positions, const typename Real::Scalar* flat,
                         Real* varyings, Real& w);

}  // namespace gnomon
