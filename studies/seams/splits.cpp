// The camera pass once more, with a pixel functor that reports what its sample does at the borders of splits.
#include "studies/seams/splits.h"

#include "pipeline/program.h"
#include "sim/error.h"
#include "studies/seams/probe.h"
#include "techniques/common/cascades.h"
#include "techniques/frame.h"

namespace gnomon::studies {

namespace {

using techniques::Cascades;
using techniques::GradientPosition;
using techniques::SeamCure;

struct ProbedMap {
    TextureId texture = TextureId::None;

    static constexpr auto fields() { return std::tuple{Field{"texture", &ProbedMap::texture}}; }
};

/// The derivatives of s/q and t/q at the pixel's centre: s, t and q over w are linear on the screen, so that differences over
/// the quad are their derivatives, and (s/q)' = (S' - (s/q) Q') / Q with S = s/w, Q = q/w.
template <class F, class Real = typename F::Real>
Gradients<Real> exact_gradients(const F& f) {
    const auto& light = f.in.light;
    const Real inv_w = f.rcp(f.position.w);
    const Real s = light.x * inv_w;
    const Real t = light.y * inv_w;
    const Real q = light.w * inv_w;
    const Real inv_q = f.rcp(q);
    const Real u = s * inv_q;
    const Real v = t * inv_q;
    const Real qx = f.ddx_fine(q);
    const Real qy = f.ddy_fine(q);
    return {{(f.ddx_fine(s) - u * qx) * inv_q, (f.ddx_fine(t) - v * qx) * inv_q},
            {(f.ddy_fine(s) - u * qy) * inv_q, (f.ddy_fine(t) - v * qy) * inv_q}};
}

/// Takes the split, the position and the level of detail that a receiver takes, by the same functions, and those that it would
/// have taken without a seam.
struct SplitProbe {
    Cascades cascades{};
    std::array<ProbedMap, techniques::kMaxCascades> maps{};
    Sampler sampler{};

    static constexpr auto fields() {
        using S = SplitProbe;
        return std::tuple{Field{"cascades", &S::cascades}, Field{"maps", &S::maps}, Field{"sampler", &S::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto at = map_position(f);
        const Real own = cascades.split_of(f.position.w);
        const Real used = cascades.chosen_split(f, own);
        const GradientPosition<Real> in_map = cascades.position(f, at, used);
        const Gradients<Real> exact = exact_gradients(f);
        SeamLanes<Real> lanes{own, used, {Real(0.0f), Real(0.0f), Int(1)}, Real(0.0f), Real(0.0f), outside(in_map), Real(0.0f)};
        for (int i = 0; i < cascades.count; ++i) {
            const auto split = static_cast<std::size_t>(i);
            const Mask here = used == Real(static_cast<float>(i));
            const Vec2<Real> uv = cascades.coordinates_in(at.uv, i);
            const TextureId map = maps[split].texture;
            const SampledLevel<Real> smooth =
                in_map.has_gradients ? f.lod(map, sampler, shader_gradients(f, uv.x, uv.y)) : f.lod(map, sampler, uv);
            const Real exactly =
                f.lod(map, sampler, scaled(exact, Vec2<Real>{Real(cascades.scale_u[split]), Real(cascades.scale_v[split])}))
                    .unclamped;
            lanes.smooth_lod = select(here, smooth.unclamped, lanes.smooth_lod);
            lanes.exact_lod = select(here, exactly, lanes.exact_lod);
            if (cascades.is(SeamCure::SampleAll)) {
                take(here, smooth, lanes.sampled);
            } else {
                f.branch(here, [&] {
                    take(here, in_map.has_gradients ? f.lod(map, sampler, in_map.gradients) : f.lod(map, sampler, in_map.uv),
                         lanes.sampled);
                });
            }
        }
        return probe_colors(f, lanes);
    }

private:
    template <class Real>
    static Mask outside(const GradientPosition<Real>& at) {
        const Real zero(0.0f);
        const Real one(1.0f);
        const Mask in_map = (at.uv.x >= zero) & (at.uv.x <= one) & (at.uv.y >= zero) & (at.uv.y <= one);
        return at.inside & !in_map;
    }
    template <class Real>
    static void take(Mask here, const SampledLevel<Real>& from, SampledLevel<Real>& to) {
        to.clamped = select(here, from.clamped, to.clamped);
        to.unclamped = select(here, from.unclamped, to.unclamped);
        to.probes = select(here, from.probes, to.probes);
    }
};

/// Over the maps of a frame, with the filter that mipmaps and anisotropy ask for: of techniques that take no derivatives, what
/// one that does would have read there. A format that the profile does not filter has levels of detail all the same.
SplitProbe make_probe(const Device& device, const techniques::Frame& frame, const techniques::TechniqueSettings& settings) {
    SplitProbe probe{.cascades = *frame.cascades()};
    const std::vector<TextureId> maps = frame.maps();
    GNOMON_CHECK_EQ(maps.size(), static_cast<std::size_t>(probe.cascades.count));
    const bool filters = filters_format(device.texture(maps.front()).info(), device.profile());
    const TexelFilter filter = filters ? TexelFilter::Linear : TexelFilter::Nearest;
    probe.sampler = {.min = filter,
                     .mag = filter,
                     .mip = filters ? MipFilter::Linear : MipFilter::Nearest,
                     .max_anisotropy = filters ? settings.anisotropy : 1};
    for (std::size_t i = 0; i < probe.maps.size(); ++i) probe.maps[i].texture = maps[std::min(i, maps.size() - 1)];
    return probe;
}

const techniques::PassRecord& camera_pass(const techniques::PassTimer& timer) { return timer.records().back(); }

}  // namespace

std::vector<std::string_view> split_cures() {
    std::vector<std::string_view> names;
    names.reserve(kEnumNames<SeamCure>.size());
    for (const auto& entry : kEnumNames<SeamCure>) names.push_back(entry.name);
    return names;
}

SeamImage draw_split_seams(const scenes::Scene& scene, const Profile& profile, const RenderRequest& request,
                           const PlannedRun& plan, std::string_view cure, const Progress& progress) {
    static const Program program = make_program<techniques::ReceiverVertex, SplitProbe>("seam.splits");
    techniques::TechniqueSettings settings = plan.settings;
    if (settings.cascades == 0) fail("--cascades 0: {} has no splits to look at; expected 1 to 8", plan.technique.name);
    settings.parameters.settle("cure", static_cast<double>(enum_from_name<SeamCure>(std::string(cure), "--cure")));

    Device device(profile, request.threads);
    device.set_stop(progress.stop);
    device.set_observer([&](const Command&) { progress.step(cure, 0, 0); });
    techniques::Frame frame(
        device, scene, {.width = request.width, .height = request.height, .technique = plan.technique, .settings = settings});
    techniques::PassTimer counted(device);
    device.enable_counters(true);
    frame.render(counted);
    device.enable_counters(false);
    techniques::PassTimer timed(device);
    frame.render(timed);

    const ProbeTargets targets(device, request.width, request.height);
    frame.draw_with(program, constants_of(make_probe(device, frame, settings)), targets.colors(), targets.derivatives());
    SeamImage image = targets.read();
    image.counters = camera_pass(counted).counters;
    image.milliseconds = camera_pass(timed).milliseconds;
    const FloatImage visibility = float_image(device.texture(frame.visibility()));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i].value = visibility.values[i];
    return image;
}

}  // namespace gnomon::studies
