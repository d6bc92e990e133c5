// At which distances the camera sees something: the depth buffer of a pass without colours, reduced to a histogram.
// [Lauritzen10]
#pragma once

#include "pipeline/device.h"
#include "scenes/view.h"
#include "techniques/common/scene_resources.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::techniques {

inline constexpr int kDistanceBins = 1024;

/// Camera-space distances of the pixels in view.
struct DistanceHistogram {
    double nearest = 0;  // of any pixel; 0 where nothing is in view
    double farthest = 0;
    std::vector<std::uint32_t> bins;  // kDistanceBins, from the near to the far plane, even in the logarithm
};

/// Draws and measures depths on a device.
class DepthRange {
public:
    explicit DepthRange(Device& device);

    /// Of an image of so many pixels: the same ones in every call.
    DistanceHistogram measure(std::span<const SceneDraw> scene, const scenes::View& camera, int width, int height);

private:
    Device& device_;
    TextureId depth_ = TextureId::None;  // None: before the first call
    BufferId counts_ = BufferId::None;   // kDistanceBins, then the bits of the nearest and of the farthest distance
};

}  // namespace gnomon::techniques
