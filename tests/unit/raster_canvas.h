// A device with targets whose samples tell what drew them, read back as masks and compared with those of the oracle.
#pragma once

#include "pipeline/device.h"
#include "tests/oracle/coverage.h"
#include "tests/oracle/triangles.h"
#include "tests/unit/raster_programs.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::testing {

struct CanvasDesc {
    int width = 16;
    int height = 16;
    int samples = 1;
    int layers = 1;
    std::optional<Format> depth{};
    int threads = 1;
};

inline constexpr float kUntouched = -1.0f;  // every component of a cleared colour target

struct SampleAt {
    int x = 0;
    int y = 0;
    int sample = 0;
    int layer = 0;
};

/// The targets of one program.
class Canvas {
public:
    Canvas(const Program& program, const Profile& profile, const CanvasDesc& desc);

    [[nodiscard]] Device& device() { return device_; }
    [[nodiscard]] const CanvasDesc& desc() const { return desc_; }
    [[nodiscard]] oracle::PixelRect rect() const { return {0, 0, desc_.width, desc_.height}; }

    /// Colours to `color`, depth to 1, stencil to 0.
    void clear(float color = kUntouched);
    /// A draw of these vertices in order into all targets, depth test off. They stay until the next call.
    [[nodiscard]] Draw draw_of(const std::vector<RasterVertex>& vertices);
    void execute(const Draw& draw) { device_.execute(draw); }

    [[nodiscard]] float value(std::size_t target, int component, const SampleAt& at) const;
    [[nodiscard]] std::uint32_t depth_code(const SampleAt& at) const;
    /// Samples of a layer whose first component in target 0 is `mark`.
    [[nodiscard]] oracle::Masks masks(float mark, int layer = 0) const;

private:
    Device device_;
    const Program& program_;
    CanvasDesc desc_;
    std::vector<TextureId> color_;
    TextureId depth_ = TextureId::None;
    BufferId vertices_ = BufferId::None;
    std::size_t capacity_ = 0;
};

/// A vertex at a grid position of the target, exactly there.
RasterVertex vertex_at(const oracle::Point& wanted, const oracle::PixelRect& viewport, float a = 0, float layer = 0);
RasterVertex vertex_of(const oracle::PlacedVertex& placed, float a = 0, float layer = 0);

/// Nothing if both are equal; else the first pixel that differs.
std::string difference(const oracle::Masks& expected, const oracle::Masks& drawn);

std::string describe(const oracle::Point& p);
std::string describe(const oracle::SnappedTriangle& t);

}  // namespace gnomon::testing
