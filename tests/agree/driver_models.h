// What llvmpipe 22.3 and SwiftShader compute where a rasteriser or an output merger has a choice: independent models, to be
// compared with the drivers bit for bit. They share no code with pipeline/.
//
// Both snap, test edges exactly and fill by the top-left rule. They differ in how a vertex comes to its grid point, in
// clipping, in where depth planes start, in blending and in resolve; the comments of driver_models_*.cpp say how.
#pragma once

#include "tests/agree/rastering.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::agree {

enum class Driver { Llvmpipe, SwiftShader };
/// By the device's name.
std::optional<Driver> driver_of(const peer::PeerDevice& device);

/// As RasterPeer::coverage, for one triangle, with the viewport that it was given.
std::vector<CoveredPixel> model_coverage(Driver driver, const ClipTriangle& triangle, const Viewport& viewport,
                                         const CoverageOptions& options);
/// As RasterPeer::depth.
std::vector<std::uint32_t> model_depth(Driver driver, const DepthDraw& draw);
/// As RasterPeer::attributes.
std::vector<Color> model_attributes(Driver driver, const ClipTriangle& triangle, const Viewport& viewport,
                                    Interpolation interpolation);
/// As RasterPeer::blend, for one case.
Codes model_blend(Driver driver, ColorFormat format, const BlendState& state, const BlendCase& blended);
/// As RasterPeer::resolve, for one pixel.
Codes model_resolve(Driver driver, ColorFormat format, const SampleCodes& samples);

}  // namespace gnomon::agree
