// Textures, points and searches that the measurements share.
#pragma once

#include "tests/agree/measure.h"

#include <functional>

namespace gnomon::agree {

/// Every component of texel (x, y) of a level is value(level, x, y): unorms take the nearest code.
Levels made_levels(TexelFormat format, std::array<int, 2> size, int levels, const std::function<float(int, int, int)>& value);

/// Bilinear with clamped coordinates.
SamplerState clamped(Filter filter, Mip mip = Mip::Base);

/// The first components of samples; empty, with the reason in `refused`, where the source refuses.
std::vector<float> try_samples(const Source& source, const Levels& texture, const SamplerState& sampler,
                               Instruction instruction, std::span<const Point> points, std::string& refused);

StepTable step_table(std::span<const float> values);

/// The largest code of a unorm format, 1 for others.
float largest_code(TexelFormat format);

/// For each pair of positive floats below and above, the least float between them (the last included) where the samples that
/// `points` asks for reach its threshold: the sampled values must not fall on the way.
struct Search {
    float below = 0;
    float above = 0;
    float threshold = 0;
};
std::vector<float> find_thresholds(std::span<const Search> searches,
                                   const std::function<std::vector<float>(std::span<const float>)>& sample_at);

/// A reproducible sequence in [0, 1).
class Sequence {
public:
    double next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 11) * 0x1p-53;
    }

private:
    std::uint64_t state_ = 1;
};

}  // namespace gnomon::agree
