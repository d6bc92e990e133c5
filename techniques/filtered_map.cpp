#include "techniques/filtered_map.h"

namespace gnomon::techniques {

std::vector<Parameter> filtered_map_parameters() {
    return {word("depth", DepthMetric::Plane,
                 "what is stored as depth: distance from the light's near plane, from the light, or z/w"),
            odd("blur", 1, 1, kMaxBlurTaps, "taps per axis of the Gaussian blur of the map; 1 is none")};
}

FilteredMap::FilteredMap(Device& device, const TechniqueSettings& settings, int slices)
    : device_(device),
      settings_(settings),
      kernel_(gaussian_kernel(settings.parameters.whole("blur"))),
      slices_(slices),
      full_screen_(device) {
    const int size = settings.map_size;
    TextureDesc desc{.format = settings.format,
                     .width = size,
                     .height = size,
                     .levels = settings.filter == MapFilter::Trilinear ? full_level_count(size, size) : 1,
                     .kind = slices > 1 ? TextureKind::Array : TextureKind::Flat,
                     .layers = slices};
    map_ = device.create_texture("map", desc);
    desc.levels = 1;
    desc.samples = settings.map_samples;
    if (settings.map_samples > 1) samples_ = device.create_texture("map samples", desc);
    depth_ = device.create_texture(
        "light depth", {.format = Format::D32Float, .width = size, .height = size, .samples = settings.map_samples});
    if (kernel_.taps > 1)
        scratch_ = device.create_texture("blur scratch", {.format = settings.format, .width = size, .height = size});
}

MapLookup FilteredMap::lookup() const {
    const bool linear = settings_.filter == MapFilter::Bilinear || settings_.filter == MapFilter::Trilinear;
    const TexelFilter filter = linear ? TexelFilter::Linear : TexelFilter::Nearest;
    return {.texture = map_,
            .sampler = {.min = filter,
                        .mag = filter,
                        .mip = settings_.filter == MapFilter::Trilinear ? MipFilter::Linear : MipFilter::Base,
                        .max_anisotropy = settings_.anisotropy},
            .in_shader = settings_.filter == MapFilter::ShaderBilinear ? 1 : 0};
}

void FilteredMap::render(std::span<const SceneDraw> scene, const scenes::View& light, const FilteredMapContent& content,
                         PassTimer& timer) const {
    const TextureId target = samples_ == TextureId::None ? map_ : samples_;
    timer.pass("light", [&] {
        std::vector<TargetView> colors;
        for (int slice = 0; slice < slices_; ++slice) {
            const TargetView view(target, 0, slice);
            device_.execute(ClearColor{view, content.nothing[static_cast<std::size_t>(slice)]});
            colors.push_back(view);
        }
        device_.execute(ClearDepth{depth_, 1.0f});
        draw_casters(device_, scene, light,
                     {.programs = content.programs,
                      .constants = content.constants,
                      .euclidean = content.euclidean,
                      .colors = colors,
                      .depth = depth_,
                      .raster = settings_.light_raster()});
    });
    if (samples_ == TextureId::None) return;
    timer.pass("resolve", [&] {
        for (int slice = 0; slice < slices_; ++slice)
            device_.execute(Resolve{TargetView(samples_, 0, slice), TargetView(map_, 0, slice)});
    });
}

void FilteredMap::filter(PassTimer& timer) const {
    if (scratch_ != TextureId::None)
        timer.pass("blur", [&] {
            for (int slice = 0; slice < slices_; ++slice) blur(full_screen_, kernel_, TargetView(map_, 0, slice), scratch_);
        });
    if (device_.texture(map_).desc().levels > 1) timer.pass("mips", [&] { device_.execute(GenerateMips{map_}); });
}

}  // namespace gnomon::techniques
