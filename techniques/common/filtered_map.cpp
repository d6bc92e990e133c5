// Light pass in bands, resolve, blur and mips. [Donnelly06] section 4, steps 1 to 3
#include "techniques/common/filtered_map.h"

#include "pipeline/program.h"

#include <algorithm>

namespace gnomon::techniques {

namespace {

/// What the samples of a light pass may take; larger maps are drawn band by band. Lanes reach 2 GiB of one texture.
constexpr std::int64_t kSampleBytes = 1ll << 28;

int rows_per_band(const TechniqueSettings& settings, int slices) {
    if (settings.map_samples == 1) return settings.map_size;
    const std::int64_t row =
        std::int64_t{settings.map_size} * settings.map_samples * slices * format_info(settings.format).bytes_per_texel;
    return static_cast<int>(std::clamp<std::int64_t>(kSampleBytes / row, 1, settings.map_size));
}

/// Texels of a band to where they belong.
struct CopyRows {
    TextureId source = TextureId::None;
    int slice = 0;
    int first_row = 0;  // of the target that the source begins with

    static constexpr auto fields() {
        using C = CopyRows;
        return std::tuple{Field{"source", &C::source}, Field{"slice", &C::slice}, Field{"first_row", &C::first_row}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const Vec2<Int> at = pixel_of(f);
        return f.load(source, at.x, at.y - Int(first_row), {.level = 0, .layer = slice});
    }
};

}  // namespace

std::vector<Parameter> filtered_map_parameters() {
    return {word("depth", DepthMetric::Plane,
                 "what is stored as depth: distance from the light's near plane, from the light, or z/w"),
            odd("blur", 1, 1, kMaxBlurTaps, "taps per axis of the Gaussian blur of the map; 1 is none")};
}

FilteredMap::FilteredMap(Device& device, const TechniqueSettings& settings, int slices, const MomentSplit& split)
    : device_(device),
      settings_(settings),
      blur_(settings.parameters.whole("blur")),
      split_(split),
      slices_(slices),
      band_rows_(rows_per_band(settings, slices)),
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
    desc.height = band_rows_;
    if (band_rows_ < size) resolved_ = device.create_texture("map band", desc);
    desc.samples = settings.map_samples;
    if (settings.map_samples > 1) samples_ = device.create_texture("map samples", desc);
    depth_ = device.create_texture(
        "light depth", {.format = Format::D32Float, .width = size, .height = band_rows_, .samples = settings.map_samples});
    if (blur_ > 1) scratch_ = device.create_texture("blur scratch", {.format = settings.format, .width = size, .height = size});
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

void FilteredMap::draw(std::span<const SceneDraw> scene, const MapView& view, const FilteredMapContent& content,
                       const LightTarget& target) const {
    std::vector<TargetView> colors;
    colors.reserve(static_cast<std::size_t>(slices_));
    for (int slice = 0; slice < slices_; ++slice) {
        colors.emplace_back(target.color, 0, slice);
        device_.execute(ClearColor{colors.back(), content.nothing[static_cast<std::size_t>(slice)]});
    }
    device_.execute(ClearDepth{depth_, 1.0f});
    const auto size = static_cast<float>(settings_.map_size);
    draw_casters(device_, scene, view,
                 {.programs = content.programs,
                  .constants = content.constants,
                  .euclidean = content.euclidean,
                  .colors = colors,
                  .depth = depth_,
                  .raster = settings_.light_raster(),
                  .viewport = {.y = static_cast<float>(-target.first_row), .width = size, .height = size}});
}

void FilteredMap::resolve(int first_row) const {
    static const Program program = make_program<FullScreenVertex, CopyRows>("copy-rows");
    const TextureId target = resolved_ == TextureId::None ? map_ : resolved_;
    const int end = std::min(first_row + band_rows_, settings_.map_size);
    for (int slice = 0; slice < slices_; ++slice) {
        device_.execute(Resolve{TargetView(samples_, 0, slice), TargetView(target, 0, slice)});
        if (target == map_) continue;
        const CopyRows pixel{.source = target, .slice = slice, .first_row = first_row};
        full_screen_.run_inside("copy band", program, pixel, TargetView(map_, 0, slice),
                                {.y0 = first_row, .x1 = settings_.map_size, .y1 = end});
    }
}

void FilteredMap::render(std::span<const SceneDraw> scene, const MapView& view, const FilteredMapContent& content,
                         PassTimer& timer) const {
    if (samples_ == TextureId::None) {
        timer.pass("light", [&] { draw(scene, view, content, {.color = map_}); });
        return;
    }
    if (resolved_ == TextureId::None) {
        timer.pass("light", [&] { draw(scene, view, content, {.color = samples_}); });
        timer.pass("resolve", [&] { resolve(0); });
        return;
    }
    timer.pass("light and resolve", [&] {
        for (int row = 0; row < settings_.map_size; row += band_rows_) {
            draw(scene, view, content, {.color = samples_, .first_row = row});
            resolve(row);
        }
    });
}

void FilteredMap::filter(const MapView& view, PassTimer& timer) const {
    if (scratch_ != TextureId::None) {
        const BlurKernels kernels = zoomed_kernels(blur_, view.texel_zoom());
        timer.pass("blur", [&] {
            for (int slice = 0; slice < slices_; ++slice)
                blur(full_screen_, kernels, TargetView(map_, 0, slice), scratch_, split_);
        });
    }
    if (device_.texture(map_).desc().levels > 1) timer.pass("mips", [&] { device_.execute(GenerateMips{map_}); });
}

}  // namespace gnomon::techniques
