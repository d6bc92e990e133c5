// One frame: the technique's map, then the scene from the camera into colour and visibility.
#pragma once

#include "scenes/view.h"
#include "techniques/technique.h"

#include <memory>
#include <vector>

namespace gnomon::techniques {

struct FrameDesc {
    int width = 1024;  // pixels
    int height = 768;
    Technique technique{};
    TechniqueSettings settings{};
};

class Frame {
public:
    /// Uploads the scene and creates every target; render() may then be called any number of times.
    Frame(Device& device, const scenes::Scene& scene, const FrameDesc& desc);

    /// Renders map and image anew.
    void render(PassTimer& timer);
    /// The same, and fills derivatives().
    void render_derivatives();

    [[nodiscard]] const scenes::View& camera() const { return camera_; }
    [[nodiscard]] const scenes::View& light() const { return light_; }
    [[nodiscard]] TextureId color() const { return color_; }            // rgba8unorm, encoded with gamma 2
    [[nodiscard]] TextureId visibility() const { return visibility_; }  // r32f, [0, 1]; kNoSurface where nothing was drawn
    [[nodiscard]] TextureId depth() const { return depth_; }            // d32f
    [[nodiscard]] std::vector<TextureId> maps() const { return passes_->maps(); }  // what receivers sample
    /// r32ui, per pixel what the derivatives of the fragment in front were taken over (DerivativeCause); None before
    /// render_derivatives().
    [[nodiscard]] TextureId derivatives() const { return derivatives_; }

    static constexpr float kNoSurface = -1.0f;

private:
    void draw_receivers(TextureId derivative_report);

    Device& device_;
    scenes::Light scene_light_;
    scenes::View camera_;
    scenes::View light_;
    std::vector<SceneDraw> scene_;
    std::unique_ptr<ShadowPasses> passes_;
    TextureId color_ = TextureId::None;
    TextureId visibility_ = TextureId::None;
    TextureId depth_ = TextureId::None;
    TextureId derivatives_ = TextureId::None;
};

}  // namespace gnomon::techniques
