// Passes and parameters of layered variance shadow maps. [Lauritzen08] 4.1.3
#include "techniques/lvsm.h"

#include "pipeline/program.h"
#include "techniques/lloyd.h"
#include "techniques/vsm.h"

namespace gnomon::techniques {

/// How splits are placed. [Lauritzen08] 4.1.2
enum class LayerPlacement { Uniform, Lloyd };
/// Where layers come from. [Lauritzen08] 4.1.3
enum class LayerSource {
    Casters,  // the light pass draws them all, into as many targets
    Depth,    // the light pass draws depth, and a full-screen pass warps it
};
/// Which splits a frame of relaxation updates. [Lauritzen08] 4.1.3
enum class SplitUpdates { Two, All };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::LayerPlacement>{EnumName{techniques::LayerPlacement::Uniform, "uniform"},
                                                                   EnumName{techniques::LayerPlacement::Lloyd, "lloyd"}};
template <>
inline constexpr std::array kEnumNames<techniques::LayerSource>{EnumName{techniques::LayerSource::Casters, "casters"},
                                                                EnumName{techniques::LayerSource::Depth, "depth"}};
template <>
inline constexpr std::array kEnumNames<techniques::SplitUpdates>{EnumName{techniques::SplitUpdates::Two, "two"},
                                                                 EnumName{techniques::SplitUpdates::All, "all"}};
}  // namespace gnomon

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::Rgba16Unorm, Format::Rgba32Float, Format::Rgba16Float};
constexpr std::array kFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::ShaderBilinear, MapFilter::Nearest};

/// Variance that rounding alone can give two moments of 16-bit fixed point: half a step for M2, two halves for M1^2.
constexpr double kUnorm16Noise = 1.5 / 65535;

std::vector<Parameter> parameters() {
    return filtered_map_parameters() +
           std::vector{whole("layers", 4, 1, kMaxDepthLayers, "layers; two share a texel of four components"),
                       word("placement", LayerPlacement::Uniform, "where depth is split: evenly, or at second occluders"),
                       number("overlap", 0.01, 0, 0.25, "how far a layer reaches past its splits, depth in [0, 1]"),
                       word("transition", Switch::Off, "blend neighbouring layers over the overlap"),
                       word("source", LayerSource::Casters, "layers drawn by the light pass, or warped from a map of depths"),
                       number("min-variance", 1e-5, 0, 1, "least variance of warped depth, which is in [0, 1]")} +
           bleed_parameters() +
           std::vector{whole("frames", 60, 1, 1000, "placement lloyd: frames of relaxation, from uniform splits"),
                       word("updates", SplitUpdates::Two, "placement lloyd: splits that a frame updates"),
                       whole("latency", 0, 0, 100, "placement lloyd: frames until a result is read back"),
                       word("teleport", Switch::On, "placement lloyd: move splits of empty clusters"),
                       number("least-weight", kUnorm16Noise, 0, 1, "placement lloyd: variance that begins to weigh"),
                       number("most-weight", 1, 0, 1, "placement lloyd: largest weight")};
}

LloydOptions lloyd_options(const ParameterValues& chosen) {
    return {.frames = chosen.whole("frames"),
            .updates_all = chosen.word<SplitUpdates>("updates") == SplitUpdates::All,
            .latency = chosen.whole("latency"),
            .teleports = chosen.word<Switch>("teleport") == Switch::On,
            .least_weight = chosen.number("least-weight"),
            .most_weight = chosen.number("most-weight")};
}

/// One layer alone needs two components.
TechniqueSettings map_settings(TechniqueSettings settings) {
    if (settings.parameters.whole("layers") > 1) return settings;
    switch (settings.format) {
        case Format::Rgba16Unorm: settings.format = Format::Rg16Unorm; break;
        case Format::Rgba32Float: settings.format = Format::Rg32Float; break;
        default: settings.format = Format::Rg16Float; break;
    }
    return settings;
}

/// The map that relaxation looks at: moments of unwarped depth in 16-bit fixed point. [Lauritzen08] 4.1.3
TechniqueSettings unwarped_settings(TechniqueSettings settings) {
    settings.format = Format::Rg16Unorm;
    settings.filter = MapFilter::Bilinear;
    settings.anisotropy = 1;
    return settings;
}

/// Depth as it is, in one component.
struct PlainEncoding {
    static constexpr auto fields() { return std::tuple{}; }
    template <class Real>
    [[nodiscard]] Vec4<Real> encode(const Real& depth) const {
        return {depth, Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

/// The mean of what an encoding makes of every sample of a map of depths.
template <class Encoding>
struct EncodeDepthMap {
    MultisampledTexture source{};
    Encoding encoding{};

    static constexpr auto fields() {
        using E = EncodeDepthMap;
        return std::tuple{Field{"source", &E::source}, Field{"encoding", &E::encoding}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const int samples = f.samples(source);
        auto sum = encoding.encode(f.load(source, at.x, at.y, 0).x);
        for (int s = 1; s < samples; ++s) {
            const auto next = encoding.encode(f.load(source, at.x, at.y, s).x);
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] = {sum[i].x + next[i].x, sum[i].y + next[i].y, sum[i].z + next[i].z, sum[i].w + next[i].w};
        }
        const Real share(1.0f / static_cast<float>(samples));
        for (auto& c : sum) c = {c.x * share, c.y * share, c.z * share, c.w * share};
        return sum;
    }
};

/// `kSlices` RGBA textures hold up to 2 kSlices layers.
template <std::size_t kSlices>
class LvsmPasses final : public MapPasses<LvsmReceiver> {
public:
    using Encoding = LvsmEncoding<kSlices>;

    LvsmPasses(Device& device, const TechniqueSettings& settings)
        : device_(device),
          settings_(settings),
          metric_(settings.parameters.word<DepthMetric>("depth")),
          map_(device, map_settings(settings), (settings.parameters.whole("layers") + 1) / 2),
          full_screen_(device) {
        const ParameterValues& chosen = settings.parameters;
        if (chosen.word<LayerPlacement>("placement") == LayerPlacement::Lloyd) {
            unwarped_.emplace(device, unwarped_settings(settings));
            lloyd_.emplace(device, unwarped_->id(), lloyd_options(chosen));
        }
        if (chosen.word<LayerSource>("source") == LayerSource::Depth) make_depth_source();
        receiver_.map = map_.lookup();
        const bool blends = chosen.word<Switch>("transition") == Switch::On && chosen.number("overlap") > 0.0f;
        receiver_.blends = blends ? 1 : 0;
        receiver_.min_variance = chosen.number("min-variance");
        receiver_.bleed = bleed_reduction(chosen);
    }

    void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) override {
        receiver_.scale = make_depth_scale(metric_, view.light);
        const int count = settings_.parameters.whole("layers");
        const std::vector<double> splits = lloyd_ ? relaxed_splits(scene, view, timer) : uniform_splits(count);
        receiver_.layers = make_layers(splits, settings_.parameters.number("overlap"));
        const Encoding encoding{.layers = receiver_.layers};
        if (depth_source_ == TextureId::None) {
            draw_layers(scene, view, encoding, timer);
        } else {
            timer.pass("light", [&] { draw_depth_source(scene, view); });
            timer.pass("warp", [&] { warp_layers(encoding); });
        }
        map_.filter(view, timer);
    }

    [[nodiscard]] const LvsmReceiver& receiver() const override { return receiver_; }
    [[nodiscard]] std::vector<TextureId> maps() const override { return {map_.id()}; }

private:
    static std::string program_name(std::string_view part) { return fmt::format("lvsm.{}{}", part, 2 * kSlices); }

    std::vector<double> relaxed_splits(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) {
        static const CasterPrograms casters = make_caster_programs<VsmEncoding>("vsm.cast", "vsm.cast-distance");
        EncodedLightPass<VsmEncoding>{casters, receiver_.scale, {}}.render(*unwarped_, scene, view, timer);
        std::vector<double> splits;
        timer.pass("lloyd", [&] { splits = lloyd_->relax(settings_.parameters.whole("layers")); });
        return splits;
    }

    void draw_layers(std::span<const SceneDraw> scene, const MapView& view, const Encoding& encoding, PassTimer& timer) {
        static const std::array names{program_name("cast"), program_name("cast-distance")};
        static const CasterPrograms casters = make_caster_programs<Encoding>(names[0], names[1]);
        EncodedLightPass<Encoding>{casters, receiver_.scale, encoding}.render(map_, scene, view, timer);
    }

    void make_depth_source() {
        TextureDesc desc{.format = Format::R32Float,
                         .width = settings_.map_size,
                         .height = settings_.map_size,
                         .samples = settings_.map_samples};
        depth_source_ = device_.create_texture("unwarped depth", desc);
        desc.format = Format::D32Float;
        depth_test_ = device_.create_texture("unwarped light depth", desc);
    }

    void draw_depth_source(std::span<const SceneDraw> scene, const MapView& view) {
        static const CasterPrograms casters = make_caster_programs<PlainEncoding>("depth.cast", "depth.cast-distance");
        const DepthCaster<PlainEncoding> caster{.scale = receiver_.scale};
        const std::array<TargetView, 1> target{depth_source_};
        device_.execute(ClearColor{depth_source_, glm::vec4(1.0f)});
        device_.execute(ClearDepth{depth_test_, 1.0f});
        draw_casters(device_, scene, view,
                     {.programs = casters,
                      .constants = constants_of(caster),
                      .euclidean = caster.scale.euclidean != 0,
                      .colors = target,
                      .depth = depth_test_,
                      .raster = settings_.light_raster()});
    }

    void warp_layers(const Encoding& encoding) {
        static const std::string name = program_name("warp");
        static const Program program = make_program<FullScreenVertex, EncodeDepthMap<Encoding>>(name);
        const EncodeDepthMap<Encoding> pixel{.source = {depth_source_}, .encoding = encoding};
        const int slices = device_.texture(map_.id()).desc().layers;
        std::vector<TargetView> targets;
        targets.reserve(static_cast<std::size_t>(slices));
        for (int slice = 0; slice < slices; ++slice) targets.emplace_back(map_.id(), 0, slice);
        full_screen_.run("warp layers", program, pixel, targets);
    }

    Device& device_;
    TechniqueSettings settings_;
    DepthMetric metric_;
    FilteredMap map_;
    std::optional<FilteredMap> unwarped_{};
    std::optional<LloydPasses> lloyd_{};
    TextureId depth_source_ = TextureId::None;  // None: the light pass draws layers
    TextureId depth_test_ = TextureId::None;
    FullScreen full_screen_;
    LvsmReceiver receiver_{};
};

std::unique_ptr<MapPasses<LvsmReceiver>> make_map(Device& device, const TechniqueSettings& settings) {
    const int layers = settings.parameters.whole("layers");
    if (layers <= 2) return std::make_unique<LvsmPasses<1>>(device, settings);
    if (layers <= 4) return std::make_unique<LvsmPasses<2>>(device, settings);
    if (layers <= 8) return std::make_unique<LvsmPasses<4>>(device, settings);
    return std::make_unique<LvsmPasses<8>>(device, settings);
}

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs = make_receiver_programs<LvsmReceiver>("lvsm.receive", "lvsm.receive-cascades");
    return make_shadow_passes<LvsmReceiver>(device, settings, programs,
                                            [&](const TechniqueSettings& of_map) { return make_map(device, of_map); });
}

void settle(TechniqueSettings& settings) {
    const ParameterValues& chosen = settings.parameters;
    if (chosen.word<LayerPlacement>("placement") != LayerPlacement::Lloyd) return;
    if (chosen.whole("latency") >= chosen.whole("frames"))
        fail("--set latency={}: lvsm reads nothing back in {} frames; expected less", chosen.whole("latency"),
             chosen.whole("frames"));
}

}  // namespace

const Technique kLvsm{.name = "lvsm",
                      .summary = "layered variance shadow maps: depth in layers, each with moments of its own",
                      .source = "[Lauritzen08] 4.1",
                      .formats = kFormats,
                      .filters = kFilters,
                      .parameters = parameters(),
                      .settle = settle,
                      .make = make};

}  // namespace gnomon::techniques
