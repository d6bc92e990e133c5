// One run of a pixel functor over a wave: interpolation, the functor, its results. Compiled once per program; all around it is
// not (tile_raster.h). D3D11.3 chapter 16
#pragma once

#include "pipeline/fragment.h"
#include "pipeline/interpolate.h"
#include "pipeline/vertex_stage.h"

#include <array>
#include <type_traits>

namespace gnomon {

/// The pixel functor of a depth-only program.
struct NoPixelFunctor {};

/// What a pixel functor may return instead of one Vec4 or an array of them: colours (either), and a depth that replaces the
/// interpolated one. D3D11.3 16.9.2
template <class Real, class Colors>
struct DepthOutput {
    Colors color;
    Real depth;  // clamped to the viewport's range afterwards
};
/// Colours, and a mask that is ANDed with the coverage. D3D11.3 16.9.4
template <class Colors>
struct CoverageOutput {
    Colors color;
    Int coverage;  // bit s: sample s
};
template <class Real, class Colors>
DepthOutput(Colors, Real) -> DepthOutput<Real, Colors>;
template <class Colors>
CoverageOutput(Colors, Int) -> CoverageOutput<Colors>;

/// Colours a pixel functor returns: one Vec4, or an array of them.
template <class Real>
std::array<Vec4<Real>, 1> as_array(const Vec4<Real>& color) {
    return {color};
}
template <class Real, std::size_t kCount>
const std::array<Vec4<Real>, kCount>& as_array(const std::array<Vec4<Real>, kCount>& colors) {
    return colors;
}
template <class Output>
    requires requires(const Output& output) { output.color; }
auto as_array(const Output& output) {
    return as_array(output.color);
}

/// One run.
template <class Real>
struct PixelJob {
    const Primitive<typename Real::Scalar>& primitive;
    const Wave& wave;
    const SamplePattern& pattern;
    PixelSystemValues system;
    Real depth;              // at the pixel centre, or at the sample
    std::uint32_t counting;  // lanes whose results are wanted
    const PixelEnvironment& environment;
    Tally* tally;
};

template <class Real>
struct PixelResult {
    std::array<Vec4<Real>, kMaxTargets> colors;
    Real depth;
    Int coverage;
    std::uint32_t killed = 0;
    DerivativeCauses causes;
};

template <class Real>
using ShadeWave = void (*)(const void* functor, const PixelJob<Real>& job, PixelResult<Real>& result);

/// What a pixel functor does, from its type.
struct PixelTraits {
    int targets = 0;
    bool discards = false;
    bool writes_depth = false;
    bool writes_coverage = false;
    bool per_sample = false;   // D3D11.3 3.5.4.1
    bool force_early = false;  // D3D11.3 16.12.1
};

/// Whether a pixel functor says that it discards.
template <class PixelFunctor>
constexpr bool discards() {
    if constexpr (requires { PixelFunctor::discards; }) {
        return PixelFunctor::discards;
    } else {
        return false;
    }
}

template <class Real, class VertexFunctor, class PixelFunctor>
using FragmentContextOf = FragmentContext<Real, typename VertexFunctor::template Varyings<Real>, discards<PixelFunctor>()>;

template <class Real, class VertexFunctor, class PixelFunctor>
void shade_wave(const void* functor, const PixelJob<Real>& job, PixelResult<Real>& result) {
    using Varyings = typename VertexFunctor::template Varyings<Real>;
    constexpr bool kCentroid = any_interpolation<Varyings, Real>(is_centroid);
    constexpr bool kSample = any_interpolation<Varyings, Real>(is_at_sample);
    const auto& primitive = job.primitive;
    const bool per_sample = job.system.sample >= 0;
    const std::int32_t x0 = primitive.x0;
    const std::int32_t y0 = primitive.y0;

    // Where to evaluate: the centre, and what the modes of the varyings ask for besides. Centre and centroid are those of the
    // pixel in runs per sample too. D3D11.3 3.5.4.1.1
    const EvaluationPoint<Real> centre = evaluation_point(primitive, centre_offset<Real>(job.wave.pixels, x0, y0));
    const SamplePosition at = per_sample ? job.pattern.at[static_cast<std::size_t>(job.system.sample)] : SamplePosition{};
    const auto centroid_point = [&]() -> EvaluationPoint<Real> {
        if (!kCentroid || job.system.samples == 1) return centre;
        return evaluation_point(primitive, centroid_offset<Real>(job.wave, job.pattern, job.system.sample_mask, x0, y0));
    };
    const auto sample_point = [&]() -> EvaluationPoint<Real> {
        if (!kSample && !per_sample) return centre;
        return evaluation_point(primitive, sample_offset<Real>(job.wave.pixels, at, x0, y0));
    };
    const EvaluationPoint<Real> centroid = centroid_point();
    const EvaluationPoint<Real> sample = sample_point();
    const auto varyings = interpolate_varyings<Varyings>(primitive, centre, centroid, sample);
    const Real& w = sample.perspective.w;  // the centre's where it runs for the whole pixel
    const Vec4<Real> position{Real(job.wave.pixels.x) + Real(static_cast<float>(at.x) / kSampleGrid),
                              Real(job.wave.pixels.y) + Real(static_cast<float>(at.y) / kSampleGrid), job.depth, w};

    // The functor.
    LaneFlow flow{.covered = job.wave.covered, .counting = job.counting};
    result.causes = {};
    const FragmentContextOf<Real, VertexFunctor, PixelFunctor> context(varyings, position, job.system, job.wave,
                                                                       job.environment, flow, result.causes, job.tally);
    const auto output = (*static_cast<const PixelFunctor*>(functor))(context);
    const auto& colors = as_array(output);
    for (std::size_t i = 0; i < colors.size(); ++i) result.colors[i] = colors[i];
    if constexpr (requires { output.depth; }) result.depth = output.depth;
    if constexpr (requires { output.coverage; }) result.coverage = output.coverage;
    result.killed = flow.killed;
}

template <class VertexFunctor, class PixelFunctor>
constexpr PixelTraits pixel_traits() {
    PixelTraits traits;
    if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>) {
        using Varyings = typename VertexFunctor::template Varyings<Float>;
        using Context = FragmentContextOf<Float, VertexFunctor, PixelFunctor>;
        using Result = decltype(std::declval<const PixelFunctor&>()(std::declval<const Context&>()));
        using Colors = std::remove_cvref_t<decltype(as_array(std::declval<const Result&>()))>;
        static_assert(std::tuple_size_v<Colors> <= std::size_t{kMaxTargets});
        traits.targets = static_cast<int>(std::tuple_size_v<Colors>);
        traits.discards = discards<PixelFunctor>();
        if constexpr (requires { PixelFunctor::per_sample; }) traits.per_sample = PixelFunctor::per_sample;
        if constexpr (requires { PixelFunctor::force_early; }) traits.force_early = PixelFunctor::force_early;
        traits.writes_depth = requires(const Result& result) { result.depth; };
        traits.writes_coverage = requires(const Result& result) { result.coverage; };
        traits.per_sample = traits.per_sample || any_interpolation<Varyings, Float>(is_at_sample);
    }
    return traits;
}

}  // namespace gnomon
