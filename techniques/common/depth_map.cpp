// Light pass of a map of depths, and one depth out of several samples.
#include "techniques/common/depth_map.h"

#include "pipeline/program.h"

namespace gnomon::techniques {

namespace {

/// One depth out of the samples of a texel.
struct ResolveDepth {
    MultisampledTexture source{};
    int how = 0;  // DepthResolve

    static constexpr auto fields() {
        return std::tuple{Field{"source", &ResolveDepth::source}, Field{"how", &ResolveDepth::how}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const int samples = f.samples(source);
        Real depth = f.load(source, at.x, at.y, 0).x;
        for (int s = 1; s < samples; ++s) {
            if (how == static_cast<int>(DepthResolve::First)) break;
            const Real next = f.load(source, at.x, at.y, s).x;
            if (how == static_cast<int>(DepthResolve::Nearest)) depth = min(depth, next);
            if (how == static_cast<int>(DepthResolve::Farthest)) depth = max(depth, next);
            if (how == static_cast<int>(DepthResolve::Mean)) depth = depth + next;
        }
        if (how == static_cast<int>(DepthResolve::Mean)) depth = depth * Real(1.0f / static_cast<float>(samples));
        return DepthOutput{std::array<Vec4<Real>, 0>{}, depth};
    }
};

}  // namespace

std::vector<Parameter> depth_map_parameters() {
    return {word("depth-resolve", DepthResolve::First, "which depth of a texel with several samples (--map-samples) counts")};
}

Sampler compare_sampler(const TechniqueSettings& settings) {
    const TexelFilter filter = settings.filter == MapFilter::Nearest ? TexelFilter::Nearest : TexelFilter::Linear;
    return {.min = filter, .mag = filter, .max_anisotropy = settings.anisotropy};
}

DepthMap::DepthMap(Device& device, const TechniqueSettings& settings)
    : device_(device),
      raster_(settings.light_raster()),
      how_(settings.parameters.word<DepthResolve>("depth-resolve")),
      full_screen_(device) {
    const TextureDesc desc{.format = settings.format, .width = settings.map_size, .height = settings.map_size};
    map_ = device.create_texture("shadow map", desc);
    if (settings.map_samples == 1) return;
    TextureDesc multisampled = desc;
    multisampled.samples = settings.map_samples;
    samples_ = device.create_texture("shadow map samples", multisampled);
}

void DepthMap::render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) const {
    timer.pass("light", [&] {
        draw_depth_map(device_, scene, view.clip_from_world(), samples_ == TextureId::None ? map_ : samples_, raster_);
    });
    if (samples_ != TextureId::None) timer.pass("resolve", [&] { resolve(); });
}

void DepthMap::resolve() const {
    static const Program program = make_program<FullScreenVertex, ResolveDepth>("resolve-depth");
    const ResolveDepth pixel{.source = {samples_}, .how = static_cast<int>(how_)};
    full_screen_.run_depth("resolve depth", program, pixel, map_);
}

}  // namespace gnomon::techniques
