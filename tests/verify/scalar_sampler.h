// A small sampler in double arithmetic by the rules of D3D11.3 7.18, right or with one defect: what the verifier is tried on.
#pragma once

#include "tests/verify/lookup_verifier.h"

#include <array>

namespace verify {

enum class Defect {
    None,
    FourBitWeights,        // weights of a filter in 1/16
    CentreOffByHalf,       // a linear filter without the half texel of D3D11.3 7.18.8
    WrapsAtLastTexel,      // clamping finds the first texel past the last one
    Brilinear,             // levels within 1/8 of a whole one snap to it: D3D11.3 7.18.10 calls it cheating
    LodOffByHalf,          // half a level too coarse
    SwappedWeights,        // u's weight down, v's across
    MirrorSkipsEdge,       // mirroring about the centre of the edge texel, which so is not repeated
    BorderIgnored,         // the edge texel in its place
    EqualityInverted,      // comparisons answer wrongly for equal values
    OffsetAtLevel0Only,    // other levels without the offset
    WeightsTruncatedTo64,  // weights of a filter cut to 1/64
    MipWeightsExchanged,   // w for the finer level, 1 - w for the coarser
    CentredProbes,         // probes at (k + 1/2) / N of the major axis instead of the declared (k + 1) / (N + 1)
    MinorAxis,             // probes along the minor axis
    PointSampledMip,       // one level where two are asked for
    CoordinatesTruncated,  // to 1/256 instead of rounded
    LodLimitsIgnored,
    MipTruncated,      // nearest level: floor(lod)
    EllipseIgnored,    // the two derivative vectors as they are
    ReductionIgnored,  // the mean instead of minimum or maximum
    OneCodeTooBright,  // 1/255 added
};

/// All defects, without None.
inline constexpr std::array kDefects{
    Defect::FourBitWeights,   Defect::CentreOffByHalf,    Defect::WrapsAtLastTexel,     Defect::Brilinear,
    Defect::LodOffByHalf,     Defect::SwappedWeights,     Defect::MirrorSkipsEdge,      Defect::BorderIgnored,
    Defect::EqualityInverted, Defect::OffsetAtLevel0Only, Defect::WeightsTruncatedTo64, Defect::MipWeightsExchanged,
    Defect::CentredProbes,    Defect::MinorAxis,          Defect::PointSampledMip,      Defect::CoordinatesTruncated,
    Defect::LodLimitsIgnored, Defect::MipTruncated,       Defect::EllipseIgnored,       Defect::ReductionIgnored,
    Defect::OneCodeTooBright};

const char* name_of(Defect defect);

/// Coordinates and levels of detail in 8-bit fixed point, ceil(ratio) probes at (k + 1) / (N + 1) of the major axis.
Color sample(const Image& image, const gnomon::Sampler& sampler, const gnomon::SampleRequest& request, Defect defect);

}  // namespace verify
