// The rasterisers and output mergers of other people's drivers: coverage, depth, interpolated attributes, blending and resolve
// of what is drawn, and the bits that come back. Plain values.
//
//     peer::expose_drivers();
//     for (const peer::PeerDevice& device : peer::list_devices()) {
//         agree::RasterPeer machine(device);
//         const auto covered = machine.coverage({.samples = 4}, triangles);
//     }
//
// Pixel (0, 0) is the top left one, y points down; sample i is the device's sample i. Vulkan 1.3 26.4 table 30 gives the
// positions of four: (3, 1) (7, 3) (1, 5) (5, 7) eighths.
#pragma once

#include "tests/peer/peer.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gnomon::agree {

using Color = std::array<float, 4>;

/// A position in clip space (x, y, z, w), handed on by the vertex shader as it is, and an attribute.
struct ClipVertex {
    std::array<float, 4> clip{0, 0, 0, 1};
    Color color{};

    bool operator==(const ClipVertex&) const = default;
};
using ClipTriangle = std::array<ClipVertex, 3>;

/// In pixels of the target. Depths are mapped to [0, 1].
struct Viewport {
    int x = 0, y = 0;
    int width = 0, height = 0;

    bool operator==(const Viewport&) const = default;
};

/// Each triangle alone in a viewport of its own.
struct CoverageOptions {
    int width = 32;  // of the viewport, 1..4096
    int height = 32;
    int samples = 1;  // 1 or 4
    int inset = 0;    // pixels by which the scissor is smaller than the viewport on each side
};
struct CoveredPixel {
    int x = 0, y = 0;        // from the viewport's corner
    std::uint32_t mask = 0;  // bit i: sample i

    bool operator==(const CoveredPixel&) const = default;
};
struct TriangleCoverage {
    Viewport viewport{};
    std::vector<CoveredPixel> pixels{};  // row by row

    bool operator==(const TriangleCoverage&) const = default;
};

/// Where `coverage` draws triangle `index`: drivers transform into the target, so that their roundings depend on the place.
Viewport coverage_viewport(const CoverageOptions& options, std::size_t index);

enum class DepthFormat { D16, D24, D32f };

/// An indexed triangle list over a target of its own, cleared to 1, with compare function less.
struct DepthDraw {
    int width = 64;
    int height = 64;
    int samples = 1;  // 1 or 4
    DepthFormat format = DepthFormat::D32f;
    float bias_constant = 0;
    float bias_slope = 0;
    std::vector<ClipVertex> vertices{};
    std::vector<std::uint32_t> indices{};
};

enum class Interpolation { Perspective, Linear };

enum class ColorFormat { Rgba8, Rgba16Unorm, Rgba16f, Rgba32f };
/// Channels as they are stored: unorm codes, the bits of halves or floats.
using Codes = std::array<std::uint32_t, 4>;

enum class BlendFactor {
    Zero,
    One,
    SourceColor,
    InverseSourceColor,
    DestinationColor,
    InverseDestinationColor,
    SourceAlpha,
    InverseSourceAlpha,
    DestinationAlpha,
    InverseDestinationAlpha,
    ConstantColor,
    InverseConstantColor,
    ConstantAlpha,
    InverseConstantAlpha,
    SourceAlphaSaturate,
};
inline constexpr int kBlendFactorCount = 15;
enum class BlendOperation { Add, Subtract, ReverseSubtract, Min, Max };
inline constexpr int kBlendOperationCount = 5;

struct BlendEquation {
    BlendFactor source = BlendFactor::One;
    BlendFactor destination = BlendFactor::Zero;
    BlendOperation operation = BlendOperation::Add;

    bool operator==(const BlendEquation&) const = default;
};
struct BlendState {
    bool enabled = true;
    BlendEquation color{};
    BlendEquation alpha{};
    Color constant{};

    bool operator==(const BlendState&) const = default;
};
struct BlendCase {
    Color source{};
    Codes destination{};
};

using SampleCodes = std::array<Codes, 4>;
/// Both are one operation to Vulkan, but not to every driver.
enum class ResolveBy { Command, Attachment };

/// Ownership of one Vulkan device. Throws Error where the device is unusable or has changed since it was listed, on malformed
/// values, and on what the device does not support.
class RasterPeer {
public:
    explicit RasterPeer(const peer::PeerDevice& device, const peer::PeerOptions& options = {});
    ~RasterPeer();
    RasterPeer(RasterPeer&&) noexcept;
    RasterPeer& operator=(RasterPeer&&) noexcept;

    [[nodiscard]] const peer::PeerDevice& description() const;
    [[nodiscard]] bool validates() const;
    [[nodiscard]] std::vector<std::string> validation_messages() const;

    /// Four samples of d24 are refused: a device only shows them as floats, which 24 bits do not survive.
    [[nodiscard]] bool supports(DepthFormat format, int samples) const;
    [[nodiscard]] bool supports(ColorFormat format) const;  // as a target that blends, with one sample and with four

    /// Front and back faces alike, clipped by the driver. One entry per triangle, with what is covered in the viewport.
    std::vector<TriangleCoverage> coverage(const CoverageOptions& options, std::span<const ClipTriangle> triangles);

    /// The target row by row, the samples of a pixel one after the other: unorm codes, or the bits of floats.
    std::vector<std::uint32_t> depth(const DepthDraw& draw);

    /// The attribute at the centre of each covered pixel of one triangle, in a target of width x height pixels; elsewhere 0.
    std::vector<Color> attributes(const ClipTriangle& triangle, int width, int height, Interpolation interpolation);

    /// One texel per case.
    std::vector<Codes> blend(ColorFormat format, const BlendState& state, std::span<const BlendCase> cases);

    /// One texel per pixel of four samples.
    std::vector<Codes> resolve(ColorFormat format, std::span<const SampleCodes> pixels, ResolveBy by);

private:
    struct Machine;
    std::unique_ptr<Machine> machine_;
};

}  // namespace gnomon::agree
