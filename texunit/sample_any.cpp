// The filter core for every format behind one call, where sample.cpp has none inlined.
#include "texunit/instruction.h"

namespace gnomon {

template Vec4<Float> sample_observed<0>(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&,
                                        const LevelOfDetail<Float>&, const SampleOperands<Float>&, Unobserved&);
template Vec4<Double> sample_observed<0>(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&,
                                         const LevelOfDetail<Double>&, const SampleOperands<Double>&, Unobserved&);
template Float compare_observed(const TextureView&, const Sampler&, const Profile&, const Vec3<Float>&, const Float&,
                                const LevelOfDetail<Float>&, const SampleOperands<Float>&, Unobserved&);
template Double compare_observed(const TextureView&, const Sampler&, const Profile&, const Vec3<Double>&, const Double&,
                                 const LevelOfDetail<Double>&, const SampleOperands<Double>&, Unobserved&);

}  // namespace gnomon
