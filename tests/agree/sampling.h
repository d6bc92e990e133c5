// The texture units of other people's drivers: samples at given coordinates, and the bits that come back. Plain values.
//
//     peer::expose_drivers();
//     for (const peer::PeerDevice& device : peer::list_devices()) {
//         agree::SamplingPeer machine(device);
//         if (machine.supports(texture, sampler))
//             const auto values = machine.sample(texture, sampler, agree::Instruction::Gradient, points);
//     }
//
// Seen in the drivers of the day:
// - log2 of a gradient's footprint is piecewise linear between halves of a level in llvmpipe 22.3 (at 2^0.25 texels the LOD is
//   0.207), between quarters in SwiftShader (at 2^0.125 texels 0.104). An explicit LOD is taken as it is.
// - llvmpipe filters rgba8 in 8 bits, unless GALLIVM_PERF=no_aos_sampling is set before the first device is listed.
// - llvmpipe's anisotropic filter needs as_quads(), and takes its footprint from the quad for explicit LODs too.
#pragma once

#include "tests/peer/peer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gnomon::agree {

enum class TexelFormat { R32f, Rg32f, Rg16f, Rgba8, Rg16Unorm, D32f };  // little endian, red first
enum class Filter { Nearest, Linear };
enum class Mip { Base, Nearest, Linear };  // Base: only level 0 is in the view
enum class Address { Wrap, Mirror, Clamp, Border, MirrorOnce };
enum class Compare { None, Never, Less, Equal, LessEqual, Greater, NotEqual, GreaterEqual, Always };  // reference < texel, ...
/// textureGrad, textureLod, textureGather of component 0; with a comparison their forms for shadow samplers.
enum class Instruction { Gradient, Lod, Gather };

/// One 2D texture. Level i is max(1, width >> i) by max(1, height >> i) texels, its rows tightly packed, the top one first.
struct Levels {
    TexelFormat format = TexelFormat::R32f;
    int width = 1;
    int height = 1;
    std::vector<std::vector<std::byte>> levels{};  // level 0 first; at least one, a full chain at most. D32f: within [0, 1]

    bool operator==(const Levels&) const = default;
};

std::size_t texel_bytes(TexelFormat format);
/// Texels of one side at `level`.
int level_size(int size, int level);
int full_levels(int width, int height);

struct SamplerState {
    Filter min = Filter::Nearest;
    Filter mag = Filter::Nearest;
    Mip mip = Mip::Base;
    Address address_u = Address::Wrap;
    Address address_v = Address::Wrap;
    float lod_bias = 0;
    float min_lod = 0;
    float max_lod = 1000;      // VK_LOD_CLAMP_NONE; below 0.25 or so nothing is ever minified
    float max_anisotropy = 1;  // 1: off
    Compare compare = Compare::None;
    int border = 0;  // 0: transparent black, 1: opaque black, 2: opaque white

    bool operator==(const SamplerState&) const = default;
};

/// Texture coordinates in [0, 1] across the image, their screen-space derivatives, an explicit LOD, a comparison's reference.
/// What an instruction does not take it ignores.
struct Point {
    float u = 0, v = 0;
    float dudx = 0, dvdx = 0, dudy = 0, dvdy = 0;
    float lod = 0;
    float reference = 0;

    bool operator==(const Point&) const = default;
};

/// Four points for each: itself, one pixel along x, one along y, one along both. They run in neighbouring lanes, as a quad of
/// pixels does. llvmpipe 22.3's anisotropic filter takes its footprint from the coordinates of such a quad and ignores the
/// explicit gradients (lp_build_pmin); sampled so and every fourth sample kept, it sees the footprint that other drivers see.
std::vector<Point> as_quads(std::span<const Point> points);

using Sample = std::array<float, 4>;

/// Wall-clock time of dispatches over the same points, submit and wait included.
struct SampleTiming {
    /// The median over the repeats of (sampling - reading), divided by the number of points. Where the two overlap inside the
    /// processor this is less than a sample's latency; sampling alone bounds it from above.
    double ns_per_sample = 0;
    /// One per repeat: each point is read and sampled, the sample plus a value derived from the point is written.
    std::vector<double> sampling_ns{};
    /// One per repeat: each point is read, the derived value is written.
    std::vector<double> reading_ns{};
};

/// Ownership of one Vulkan device. Throws Error where the device is unusable or has changed since it was listed.
class SamplingPeer {
public:
    explicit SamplingPeer(const peer::PeerDevice& device, const peer::PeerOptions& options = {});
    ~SamplingPeer();
    SamplingPeer(SamplingPeer&&) noexcept;
    SamplingPeer& operator=(SamplingPeer&&) noexcept;

    [[nodiscard]] const peer::PeerDevice& description() const;
    [[nodiscard]] bool validates() const;  // asked for, and the layer was found
    /// Every warning and error of the validation layer so far, one line each.
    [[nodiscard]] std::vector<std::string> validation_messages() const;

    /// Why this device cannot sample such a texture (its texels do not matter) by such a sampler; empty when it can.
    [[nodiscard]] std::string unsupported_because(const Levels& texture, const SamplerState& sampler) const;
    [[nodiscard]] bool supports(const Levels& texture, const SamplerState& sampler) const;

    /// One sample per point, as the driver returned it. A comparison's result is in all four components, but for Gather, which
    /// has one per texel: (i0, j1), (i1, j1), (i1, j0), (i0, j0). Vulkan leaves open the components that a format lacks.
    /// Throws Error on malformed values and on what the device does not support.
    std::vector<Sample> sample(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                               std::span<const Point> points);

    /// `repeats` pairs of dispatches, after one of each that is not counted. At most kMaxTimedPoints points.
    SampleTiming time_samples(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                              std::span<const Point> points, int repeats);
    double nanoseconds_per_sample(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                                  std::span<const Point> points, int repeats);
    static constexpr std::size_t kMaxTimedPoints = std::size_t{1} << 20;

private:
    struct Machine;
    std::unique_ptr<Machine> machine_;
};

}  // namespace gnomon::agree
