// What a sample did: level of detail, probes, levels, taps and partial sums of one lane, as plain values.
//
// record_sample runs the very templates that filter pictures, with an observer that copies each value as the filter consumes
// it; a test holds its result against sample() bit by bit.
#pragma once

#include "sim/profile.h"
#include "texunit/sampler.h"
#include "texunit/view.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

/// Per pixel, in the units of the coordinate; the third counts for cubes only.
struct SampleGradient {
    std::array<double, 3> dx{};
    std::array<double, 3> dy{};
};

/// One sample instruction of one lane. Numbers are taken to the profile's arithmetic first.
struct SampleRequest {
    std::array<double, 3> coordinate{};  // u, v, slice of an array; or the direction into a cube
    using Gradient = SampleGradient;
    std::optional<Gradient> gradient{};  // sample_d, D3D11.3 22.4.17; without it sample_l at `lod`, 22.4.18
    double lod = 0;
    double lod_bias = 0;                // of the instruction, sample_b. D3D11.3 22.4.16
    std::optional<double> reference{};  // sample_c, D3D11.3 22.4.19: compared with the sampler's operator
    glm::ivec2 offset{0, 0};            // texels, [-8, 7]. D3D11.3 22.4.15
};

/// One texel under a filter.
struct TapRecord {
    int level = 0;  // of the texture, not of the view
    int layer = 0;  // slice, or cube face
    int x = 0;      // texels, address mode applied
    int y = 0;
    bool border = false;                 // the border colour stands for it
    bool corner = false;                 // the missing texel at a cube's corner: the mean of its neighbours
    std::array<std::uint32_t, 4> raw{};  // component codes as stored; 0 for border and corner
    std::array<double, 4> value{};       // what the filter saw: the number, or the result of the comparison
    double weight = 0;                   // within its level, [0, 1]
};

/// One level under one probe.
struct LevelRecord {
    int level = 0;
    double weight = 1;  // within its probe
    std::vector<TapRecord> taps;
    std::array<double, 4> sum{};
};

/// One position along the line of anisotropy; isotropic filters have one.
struct ProbeRecord {
    double u = 0;  // normalised, before range reduction
    double v = 0;
    double weight = 1;
    std::vector<LevelRecord> levels;
    std::array<double, 4> sum{};
};

struct SampleRecord {
    double lod = 0;          // from the gradients, or the instruction's own
    double clamped_lod = 0;  // biased, clamped, at the profile's precision
    bool magnified = false;  // clamped_lod <= 0: the mag filter
    double ratio = 1;        // of anisotropy, after its limit
    std::vector<ProbeRecord> probes;
    double scale =
        1;  // of the sums: formats filtered as codes are scaled to numbers at the end (UnormDecode::Late, UnormFilter)
    std::array<double, 4> result{};  // components the format lacks are 0, alpha 1; comparisons repeat theirs
};

/// Throws Error for what no instruction can do: an offset or level out of range, comparison of a format of integers, filters
/// other than nearest on one.
SampleRecord record_sample(const TextureView& view, const Sampler& sampler, const Profile& profile,
                           const SampleRequest& request);

/// The same samples by the path that pictures take, many lanes at a time.
struct SampleResult {
    double lod = 0;  // as in SampleRecord
    std::array<double, 4> color{};
};
std::vector<SampleResult> sample_all(const TextureView& view, const Sampler& sampler, const Profile& profile,
                                     std::span<const SampleRequest> requests);

}  // namespace gnomon
