// From a camera, a light and the settings to the splits of a frame and the window of each: steps 1, 2a and 2b of [PSVSM].
#pragma once

#include "scenes/convex.h"
#include "techniques/common/cascades.h"
#include "techniques/common/depth_range.h"
#include "techniques/common/map_window.h"
#include "techniques/technique.h"

#include <optional>
#include <vector>

namespace gnomon::techniques {

/// What places the splits.
enum class SplitPlacement {
    Practical,  // the camera's planes. [Zhang06]
    MinMax,     // the nearest and the farthest surface in view, between them as Practical. [Lauritzen10]
    Histogram,  // as many pixels in each split. After [Lauritzen10]
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::SplitPlacement>{
    EnumName{techniques::SplitPlacement::Practical, "practical"}, EnumName{techniques::SplitPlacement::MinMax, "minmax"},
    EnumName{techniques::SplitPlacement::Histogram, "histogram"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// Throws Error for parameters of splits that do not go together.
void check_cascades(const TechniqueSettings& settings);

/// The part of the camera's frustum between two camera-space distances, world space.
scenes::Hexahedron frustum_slice(const scenes::View& camera, double nearest, double farthest);

/// The minimum bounding rectangle of what the light shines on in a slice of the camera's frustum; all of the light's projection
/// where it shines on nothing. [PSVSM] step 2a
MapWindow bounding_window(const scenes::Hexahedron& slice, const scenes::View& light);

/// Room around a window for filters that reach beyond it: so many texels on each side of a map of `map_size` texels.
MapWindow with_margin(const MapWindow& window, double texels, int map_size);

/// A window at least as large that moves by whole texels and whose size does not change while the camera moves: under a
/// directional light it holds the bounding sphere of the slice, under a spot its sides are rounded up to quarter octaves.
/// `map_size` texels, > 2.
MapWindow snapped_window(const MapWindow& window, const std::optional<glm::dvec2>& sphere_diameter, int map_size);

/// The diameter of the sphere around the slice, in texture coordinates of a directional light's projection. None under a spot.
std::optional<glm::dvec2> sphere_diameter(const scenes::View& camera, const scenes::View& light, double nearest,
                                          double farthest);

/// The splits of every frame.
class CascadeSetup {
public:
    CascadeSetup(Device& device, const TechniqueSettings& settings);

    /// Places splits and windows for a frame; where the depths in view say where, draws those first.
    void update(const FrameView& frame, PassTimer& timer);

    [[nodiscard]] const Cascades& constants() const { return constants_; }
    [[nodiscard]] const MapWindow& window(std::size_t cascade) const { return windows_[cascade]; }
    /// What the map of a cascade shows.
    [[nodiscard]] MapView view(std::size_t cascade, const scenes::View& light) const {
        return {.light = light, .window = windows_[cascade], .relative_size = relative_size(cascade)};
    }

private:
    [[nodiscard]] std::vector<double> distances(const FrameView& frame, PassTimer& timer);
    [[nodiscard]] double relative_size(std::size_t cascade) const {
        return static_cast<double>(sizes_[cascade]) / sizes_.front();
    }
    /// Texels around what a window must hold: how far filters reach at this zoom.
    [[nodiscard]] double margin(std::size_t cascade, const glm::dvec2& zoom) const;
    [[nodiscard]] MapWindow window_of(const FrameView& frame, std::size_t cascade, double nearest, double farthest) const;

    TechniqueSettings settings_;
    std::vector<int> sizes_;
    std::optional<DepthRange> depths_{};
    Cascades constants_{};
    std::vector<MapWindow> windows_;
};

}  // namespace gnomon::techniques
