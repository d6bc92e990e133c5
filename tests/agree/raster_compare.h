// What tests of rasterisers share: on which drivers, and how differences are told.
#pragma once

#include "tests/agree/driver_models.h"
#include "tests/agree/raster_cases.h"
#include "tests/peer/device_tests.h"
#include "tests/peer/frame.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::agree {

inline constexpr ColorFormat kColorFormats[] = {ColorFormat::Rgba8, ColorFormat::Rgba16Unorm, ColorFormat::Rgba16f,
                                                ColorFormat::Rgba32f};
std::string_view name_of(ColorFormat format);

/// Every installed driver that there is a model of.
void on_each_driver(const std::function<void(RasterPeer&, Driver)>& check_on);

std::string text(const ClipTriangle& triangle);
std::string text(const std::vector<CoveredPixel>& pixels);
std::string text(const Codes& codes);
/// Of one blend: the state's equations, the source and what was there.
std::string text(const BlendState& state, const BlendCase& blended);

/// Counts what differs and describes the first few.
class Differences {
public:
    void add(const std::function<std::string()>& describe);
    /// Fails where there are some.
    void report(const std::string& what, std::size_t of) const;

private:
    std::size_t count_ = 0;
    std::string first_;
};

/// All of a scene as it is seen from a view.
DepthDraw scene_depth(const scenes::Scene& scene, const scenes::View& view, int width, int height);
/// Random triangles in a target of 97 x 61 pixels; some runs have a bias.
DepthDraw random_depth(TriangleKind kind, std::uint64_t run, DepthFormat format, int samples);

/// The same, but that one NaN is as good as another.
bool same(ColorFormat format, const Codes& a, const Codes& b);

}  // namespace gnomon::agree
