#include "tests/agree/profile_source.h"

#include "sim/denormals.h"
#include "tests/agree/adapter.h"
#include "texunit/sample.h"

namespace gnomon::agree {
namespace {

std::vector<Sample> gathered(const gnomon::Texture& texture, const Sampler& sampler, const Profile& profile,
                             std::span<const Point> points) {
    const DenormalScope denormals(profile.flush_denormals);
    std::vector<Sample> samples;
    for (const Point& point : points) {
        const auto texels =
            gather<Float>(texture, sampler, profile, Vec3<Float>{Float(point.u), Float(point.v), Float(0.0f)}, 0);
        samples.push_back({lane(texels.x, 0), lane(texels.y, 0), lane(texels.z, 0), lane(texels.w, 0)});
    }
    return samples;
}

}  // namespace

Source profile_source(const Profile& profile) {
    return [profile](const Levels& levels, const SamplerState& state, Instruction instruction, std::span<const Point> points) {
        const bool compares = state.compare != Compare::None;
        if (compares && levels.format != TexelFormat::D32f) fail("comparison of a format that is not d32f");
        if (instruction == Instruction::Gather) {
            if (compares) fail("gathered comparisons are not adapted");
            return gathered(texture_of(levels), sampler_of(state), profile, points);
        }
        return sample_by(profile, levels, state, instruction, points);
    };
}

}  // namespace gnomon::agree
