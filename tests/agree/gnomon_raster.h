// The same questions as RasterPeer's (rastering.h), answered by our own device with a profile.
#pragma once

#include "pipeline/device.h"
#include "tests/agree/rastering.h"

#include <span>
#include <vector>

namespace gnomon::agree {

class GnomonRaster {
public:
    explicit GnomonRaster(const Profile& profile) : device_(profile, 1) {}

    std::vector<TriangleCoverage> coverage(const CoverageOptions& options, std::span<const ClipTriangle> triangles);
    std::vector<std::uint32_t> depth(const DepthDraw& draw);
    std::vector<Color> attributes(const ClipTriangle& triangle, int width, int height, Interpolation interpolation);
    /// Factors of constant alpha are taken as of constant colour: we have no others.
    std::vector<Codes> blend(ColorFormat format, const BlendState& state, std::span<const BlendCase> cases);
    std::vector<Codes> resolve(ColorFormat format, std::span<const SampleCodes> pixels);

private:
    Device device_;
};

}  // namespace gnomon::agree
