// Level of detail, probes and their line, as far as declared precisions fix them. D3D11.3 7.18.11
#pragma once

#include "tests/verify/lookup_verifier.h"

#include <vector>

namespace verify {

struct Range {
    double lo = 0;
    double hi = 0;
};

/// One way in which an implementation may read a request.
struct Footprint {
    Range lod;           // before bias, clamps and fixed point
    int probes = 1;      // along the line
    double major_u = 0;  // the line from end to end, texels of level 0
    double major_v = 0;
    double major_error = 0;  // of each of the two, texels of level 0
    double extent_u = 0;     // half of the ellipse's bounding box, texels of level 0
    double extent_v = 0;
    bool any_weights = false;  // anything between the extremes of the texels in that box
    bool one_level = false;    // with any weights: the finer or the coarser of two, unmixed
    bool unbounded = false;    // gradients too close to parallel for the arithmetic: anything the image holds
};

/// Every way to read the request on a texture whose finest level has this size.
std::vector<Footprint> footprints(int width, int height, const gnomon::Sampler& sampler, const LookupPrecision& precision,
                                  const gnomon::SampleRequest& request);

}  // namespace verify
