// One run of a pixel functor over a wave: interpolation, the functor, its results. Compiled once per program; all around it is
// not (tile_raster.h). D3D11.3 chapter 16
#pragma once

#include "pipeline/fragment.h"
#include "pipeline/interpolate.h"
#include "pipeline/peer_planes.h"
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
    const Primitive<typename Real::Scalar>* primitive = nullptr;
    const Wave* wave = nullptr;
    const SamplePattern& pattern;
    PixelSystemValues system;
    SamplePosition depth_at;     // where depth is taken: the pixel centre, or the sample
    std::uint32_t counting = 0;  // lanes whose results are wanted
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

/// Varyings and w as renderers with planes of their own have them.
template <class Varyings, class Real>
[[gnu::noinline]] Varyings peer_varyings(const PixelJob<Real>& job, Real& w) {
    const PixelLanes centre{Int(kSubpixels / 2), Int(kSubpixels / 2)};
    PeerPositions positions{centre, centre, centre};
    if (job.system.samples > 1) positions.centroid = centroid_position(*job.wave, job.pattern, job.system.sample_mask);
    if (job.system.sample >= 0) {
        const SamplePosition& at = job.pattern.at[static_cast<std::size_t>(job.system.sample)];
        positions.sample = {Int(at.x * kSampleGrid), Int(at.y * kSampleGrid)};
    }
    const auto interpolate = [&](std::span<const Interpolation> modes, Real* values) {
        interpolate_as_peer(*job.primitive->peer_planes, modes, job.wave->pixels, positions, job.primitive->flat, values, w);
    };
    if constexpr (std::is_empty_v<Varyings>) {
        interpolate({}, nullptr);
        return {};
    } else {
        static constexpr auto kModes = interpolations<Varyings, Real>();
        std::array<Real, kModes.size()> values;
        interpolate(kModes, values.data());
        return std::bit_cast<Varyings>(values);
    }
}

/// Where a run evaluates: the centre, and what the modes of the varyings ask for besides. Centre and centroid are those of the
/// pixel in runs per sample too. D3D11.3 3.5.4.1.1
template <class Varyings, bool kPerSample, class Real>
GNOMON_INLINE Varyings interpolate_job(const PixelJob<Real>& job, Real& w) {
    constexpr bool kCentroid = any_interpolation<Varyings, Real>(is_centroid);
    const auto& primitive = *job.primitive;
    const Wave& wave = *job.wave;
    const std::int32_t x0 = primitive.x0;
    const std::int32_t y0 = primitive.y0;
    const EvaluationPoint<Real> centre = evaluation_point(primitive, centre_offset<Real>(wave.pixels, x0, y0));
    w = centre.perspective.w;
    if constexpr (!kCentroid && !kPerSample) {
        return interpolate_varyings<Varyings>(primitive, centre, centre, centre);
    } else {
        EvaluationPoint<Real> centroid = centre;
        EvaluationPoint<Real> sample = centre;
        if (kCentroid && job.system.samples > 1) {
            const PixelLanes on = centroid_position(wave, job.pattern, job.system.sample_mask);
            centroid = evaluation_point(primitive, pixel_offset<Real>(wave.pixels, on.x, on.y, x0, y0));
        }
        if constexpr (kPerSample) {
            const SamplePosition& at = job.pattern.at[static_cast<std::size_t>(job.system.sample)];
            sample = evaluation_point(primitive, sample_offset<Real>(wave.pixels, at, x0, y0));
            w = sample.perspective.w;
        }
        return interpolate_varyings<Varyings>(primitive, centre, centroid, sample);
    }
}

template <class Real, class VertexFunctor, class PixelFunctor>
void shade_wave(const void* functor, const PixelJob<Real>& job, PixelResult<Real>& result) {
    using Varyings = typename VertexFunctor::template Varyings<Real>;
    constexpr bool kPerSample = pixel_traits<VertexFunctor, PixelFunctor>().per_sample;
    const Wave& wave = *job.wave;
    Real w;  // at the sample, or at the centre where the functor runs for the whole pixel
    Varyings varyings;
    if (job.primitive->peer_planes == nullptr) [[likely]] {
        varyings = interpolate_job<Varyings, kPerSample>(job, w);
    } else {
        Real peer_w;
        varyings = peer_varyings<Varyings>(job, peer_w);
        w = peer_w;
    }
    const SamplePosition at = kPerSample ? job.pattern.at[static_cast<std::size_t>(job.system.sample)] : SamplePosition{};
    const Vec4<Real> position{
        Real(wave.pixels.x) + Real(static_cast<float>(at.x) / kSampleGrid),
        Real(wave.pixels.y) + Real(static_cast<float>(at.y) / kSampleGrid),
        fragment_depth<Real>(*job.primitive, wave.pixels, job.depth_at, job.environment.profile->plane_equations), w};

    // The functor. In a run for one sample the lanes without it are helpers. D3D11.3 3.5.4, 16.13
    const bool one_of_several = kPerSample && job.system.samples > 1;
    LaneFlow flow{.covered = one_of_several ? wave.samples.covered[static_cast<std::size_t>(job.system.sample)] : wave.covered,
                  .counting = job.counting};
    result.causes = {};
    const FragmentContextOf<Real, VertexFunctor, PixelFunctor> context(varyings, position, job.system, wave, job.environment,
                                                                       flow, result.causes, job.tally);
    const auto output = (*static_cast<const PixelFunctor*>(functor))(context);
    const auto& colors = as_array(output);
    for (std::size_t i = 0; i < colors.size(); ++i) result.colors[i] = colors[i];
    if constexpr (requires { output.depth; }) result.depth = output.depth;
    if constexpr (requires { output.coverage; }) result.coverage = output.coverage;
    result.killed = flow.killed;
}

}  // namespace gnomon
