// A map of plain depths as seen from the light, and the receivers that compare with it.
#pragma once

#include "techniques/common/caster.h"
#include "techniques/common/full_screen.h"
#include "techniques/common/map_passes.h"

namespace gnomon::techniques {

/// What becomes of a texel's depths where the light pass has several samples: a comparison needs one. Vulkan 1.3, Multisample
/// Resolve Operations (VK_RESOLVE_MODE_SAMPLE_ZERO, MIN, MAX, AVERAGE)
enum class DepthResolve { First, Nearest, Farthest, Mean };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::DepthResolve>{
    EnumName{techniques::DepthResolve::First, "first"}, EnumName{techniques::DepthResolve::Nearest, "nearest"},
    EnumName{techniques::DepthResolve::Farthest, "farthest"}, EnumName{techniques::DepthResolve::Mean, "mean"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// The parameters that every technique on a DepthMap takes: depth-resolve.
std::vector<Parameter> depth_map_parameters();

/// The sampler of comparisons: nearest or bilinear, with probes along the footprint where anisotropy is asked for.
Sampler compare_sampler(const TechniqueSettings& settings);

/// Depth texture of the light pass, resolved to one sample.
class DepthMap {
public:
    DepthMap(Device& device, const TechniqueSettings& settings);

    void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) const;
    [[nodiscard]] TextureId id() const { return map_; }

private:
    void resolve() const;

    Device& device_;
    RasterState raster_;
    DepthResolve how_;
    TextureId map_ = TextureId::None;
    TextureId samples_ = TextureId::None;  // None: the map itself is rendered to
    FullScreen full_screen_;
};

/// `Receiver` has a member map, a TextureId.
template <class Receiver>
class DepthMapPasses final : public MapPasses<Receiver> {
public:
    DepthMapPasses(Device& device, const TechniqueSettings& settings, const Receiver& receiver)
        : map_(device, settings), receiver_(receiver) {
        receiver_.map = map_.id();
    }

    void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) override {
        map_.render(scene, view, timer);
    }
    [[nodiscard]] const Receiver& receiver() const override { return receiver_; }
    [[nodiscard]] std::vector<TextureId> maps() const override { return {map_.id()}; }

private:
    DepthMap map_;
    Receiver receiver_;
};

/// The passes of a technique whose maps hold plain depths.
template <class Receiver>
std::unique_ptr<ShadowPasses> make_depth_map_passes(Device& device, const TechniqueSettings& settings,
                                                    const ReceiverPrograms& programs, const Receiver& receiver) {
    return make_shadow_passes<Receiver>(device, settings, programs, [&](const TechniqueSettings& of_map) {
        return std::make_unique<DepthMapPasses<Receiver>>(device, of_map, receiver);
    });
}

}  // namespace gnomon::techniques
