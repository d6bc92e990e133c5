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

    /// Renders maps and image anew.
    void render(PassTimer& timer);
    /// The same, and fills derivatives().
    void render_derivatives();

    /// Draws the scene from the camera once more, with another program (a ReceiverVertex and a pixel functor) into targets of
    /// the image's size, as the last render() left the maps. The targets are cleared to kNoSurface; depth is drawn anew.
    void draw_with(const Program& program, std::span<const std::byte> constants, std::span<const TargetView> targets,
                   TextureId derivative_report = TextureId::None);

    /// Another place to look from, for the next render().
    void set_camera(const scenes::Camera& camera);

    [[nodiscard]] const scenes::View& camera() const { return camera_; }
    [[nodiscard]] const scenes::View& light() const { return light_; }
    [[nodiscard]] TextureId color() const { return color_; }            // rgba8unorm, encoded with gamma 2
    [[nodiscard]] TextureId visibility() const { return visibility_; }  // r32f, [0, 1]; kNoSurface where nothing was drawn
    [[nodiscard]] TextureId depth() const { return depth_; }            // d32f
    [[nodiscard]] std::vector<TextureId> maps() const { return passes_->maps(); }  // what receivers sample
    /// Splits of the last render(); null where the technique has one map.
    [[nodiscard]] const Cascades* cascades() const { return passes_->cascades(); }
    /// r32ui, per pixel what the derivatives of the fragment in front were taken over (DerivativeCause); None before
    /// render_derivatives().
    [[nodiscard]] TextureId derivatives() const { return derivatives_; }

    static constexpr float kNoSurface = -1.0f;

private:
    void render_maps(PassTimer& timer);
    void draw_receivers(TextureId derivative_report);
    /// The vertex functor of an object in a camera pass.
    [[nodiscard]] ReceiverVertex receiver_vertex(const SceneDraw& object) const;

    Device& device_;
    scenes::Light scene_light_;
    float aspect_;  // of the image, width / height
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
