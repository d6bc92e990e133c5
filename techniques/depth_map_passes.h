// Passes of the techniques whose map is a plain depth texture: a depth-only light pass, and a receiver that compares.
#pragma once

#include "techniques/caster.h"
#include "techniques/technique.h"

namespace gnomon::techniques {

/// `Receiver` has members lighting, map and sampler.
template <class Receiver>
class DepthMapPasses final : public ShadowPasses {
public:
    DepthMapPasses(Device& device, const TechniqueSettings& settings, const Program& program, const Receiver& receiver)
        : device_(device), settings_(settings), program_(program), receiver_(receiver) {
        receiver_.map = device.create_texture(
            "shadow map", {.format = settings.format, .width = settings.map_size, .height = settings.map_size, .levels = 1});
    }

    void render_map(std::span<const SceneDraw> scene, const scenes::View& light, PassTimer& timer) override {
        timer.pass("light", [&] {
            draw_depth_map(device_, scene, light, receiver_.map,
                           {.depth_bias = settings_.depth_bias, .slope_scaled_depth_bias = settings_.slope_bias});
        });
    }

    [[nodiscard]] const Program& receiver_program() const override { return program_; }
    std::span<const std::byte> receiver_constants(const Lighting& lighting) override {
        receiver_.lighting = lighting;
        return constants_of(receiver_);
    }
    [[nodiscard]] TextureId map() const override { return receiver_.map; }

private:
    Device& device_;
    TechniqueSettings settings_;
    const Program& program_;
    Receiver receiver_;
};

}  // namespace gnomon::techniques
