#include "techniques/vsm.h"

#include "pipeline/program.h"
#include "techniques/caster.h"
#include "techniques/gaussian.h"

namespace gnomon::techniques {

namespace {

constexpr std::array kMapFormats{Format::Rg32Float, Format::Rg16Float, Format::Rg16Unorm};
constexpr std::array kMapFilters{MapFilter::Trilinear, MapFilter::Bilinear, MapFilter::Nearest};

class VsmPasses final : public ShadowPasses {
public:
    VsmPasses(Device& device, const TechniqueSettings& settings) : device_(device), settings_(settings) {
        check_filter(device.profile(), settings);
        const int size = settings.map_size;
        const int levels = settings.filter == MapFilter::Trilinear ? full_level_count(size, size) : 1;
        moments_ =
            device.create_texture("moments", {.format = settings.format, .width = size, .height = size, .levels = levels});
        depth_ = device.create_texture("light depth", {.format = Format::D32Float, .width = size, .height = size});
        if (settings.blur > 1) {
            scratch_ = device.create_texture("blur scratch", {.format = settings.format, .width = size, .height = size});
            blur_.emplace(device, settings.blur);
        }
        const TexelFilter filter = settings.filter == MapFilter::Nearest ? TexelFilter::Nearest : TexelFilter::Linear;
        receiver_.map = moments_;
        receiver_.sampler = {.min = filter, .mag = filter, .mip = levels > 1 ? MipFilter::Linear : MipFilter::Base};
        receiver_.min_variance = settings.min_variance;
    }

    void render_map(std::span<const SceneDraw> scene, const scenes::View& light, PassTimer& timer) override {
        timer.pass("light", [&] { draw_moments(scene, light); });
        if (blur_) timer.pass("blur", [&] { blur_->run(device_, moments_, scratch_); });
        if (device_.texture(moments_).desc().levels > 1) timer.pass("mips", [&] { device_.execute(GenerateMips{moments_}); });
    }

    [[nodiscard]] const Program& receiver_program() const override {
        static const Program program = make_program<ReceiverVertex, VsmReceiver>("vsm.receive");
        return program;
    }
    std::span<const std::byte> receiver_constants(const Lighting& lighting) override {
        receiver_.lighting = lighting;
        return constants_of(receiver_);
    }
    [[nodiscard]] TextureId map() const override { return moments_; }

private:
    void draw_moments(std::span<const SceneDraw> scene, const scenes::View& light) {
        static const Program program = make_program<CasterVertex, VsmCaster>("vsm.cast");
        // Nothing there is as far as can be: both moments of depth 1.
        device_.execute(ClearColor{moments_, {1.0f, 1.0f, 0.0f, 1.0f}});
        device_.execute(ClearDepth{depth_, 1.0f});
        const glm::mat4 clip_from_world = light.clip_from_world();
        for (const SceneDraw& object : scene) {
            const CasterVertex vertex{.clip_from_object = clip_from_world * object.world_from_object,
                                      .light = make_light_space(light, object.world_from_object)};
            const VsmCaster pixel;
            Draw draw{.label = object.label,
                      .program = &program,
                      .vertex_constants = constants_of(vertex),
                      .pixel_constants = constants_of(pixel),
                      .vertices = object.vertices,
                      .indices = object.indices,
                      .count = object.count,
                      .raster = {.depth_bias = settings_.depth_bias, .slope_scaled_depth_bias = settings_.slope_bias},
                      .depth = depth_};
            draw.color[0] = moments_;
            device_.execute(draw);
        }
    }

    Device& device_;
    TechniqueSettings settings_;
    TextureId moments_ = TextureId::None;
    TextureId depth_ = TextureId::None;
    TextureId scratch_ = TextureId::None;
    std::optional<GaussianPass> blur_;
    VsmReceiver receiver_;
};

}  // namespace

const Technique kVsm{.name = "vsm",
                     .summary = "variance shadow maps: filtered moments and Chebyshev's bound",
                     .source = "[Donnelly06] sections 3 and 4",
                     .formats = kMapFormats,
                     .filters = kMapFilters,
                     .default_taps = 0,
                     .max_blur = kMaxBlurTaps,
                     .default_min_variance = 1e-5f,
                     .make = [](Device& device, const TechniqueSettings& settings) -> std::unique_ptr<ShadowPasses> {
                         return std::make_unique<VsmPasses>(device, settings);
                     }};

}  // namespace gnomon::techniques
