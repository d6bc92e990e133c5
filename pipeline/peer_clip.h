// Triangles clipped to the whole view volume as llvmpipe and SwiftShader do it, in binary32, operation by operation.
// Mesa 22.3.6 draw_pipe_clip.c; SwiftShader Clipper.cpp. Neither has a guard band (D3D11.3 15.4 leaves it open).
#pragma once

#include "pipeline/clip.h"
#include "sim/profile_choices.h"

#include <array>
#include <span>
#include <vector>

namespace gnomon {

/// What is left of a triangle; nothing where fewer than three corners are.
template <class Scalar>
struct ClippedTriangle {
    std::vector<Scalar> records;  // corners of `stride` numbers each
    std::vector<char> made;       // [corner]: by clipping

    /// `planes`: bits of ClipCode that a corner is outside of. `linear` as ClipPolygon has it; `clipping` is not GuardBand.
    ClippedTriangle(const std::array<const Scalar*, 3>& corners, std::size_t stride, unsigned planes,
                    std::span<const std::uint8_t> linear, Clipping clipping);
};

extern template struct ClippedTriangle<float>;
extern template struct ClippedTriangle<double>;

}  // namespace gnomon
