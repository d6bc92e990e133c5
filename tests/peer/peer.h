// The same scenes and passes on GPUs written by others: one headless Vulkan renderer, for speed ratios and bit comparisons.
//
//     peer::expose_drivers();
//     for (const peer::PeerDevice& device : peer::list_devices()) {
//         peer::Peer machine(device);
//         peer::FrameRenderer renderer(machine, frame);
//         const peer::FrameImages images = renderer.render();
//         const std::vector<double> ms = renderer.time_frames(5, 50);
//     }
#pragma once

#include "tests/peer/environment.h"
#include "tests/peer/frame.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::peer {

class Device;  // device.h

enum class DeviceKind { Cpu, IntegratedGpu, DiscreteGpu, VirtualGpu, Other };

/// "cpu", "integrated gpu", ...
std::string_view kind_name(DeviceKind kind);

/// What a driver says of its precision and abilities.
struct DeviceLimits {
    std::uint32_t sub_pixel_bits = 0;
    std::uint32_t sub_texel_bits = 0;
    std::uint32_t mipmap_bits = 0;
    float max_anisotropy = 1;
    bool filters_rg32f = false;  // linear filtering of sampled images
    bool filters_rg16f = false;
    bool filters_d32f = false;
    std::uint32_t color_samples = 1;  // bit mask of the sample counts

    bool operator==(const DeviceLimits&) const = default;
};

/// One physical device of the loader, as a value.
struct PeerDevice {
    std::uint32_t index = 0;  // in the loader's order under the current environment
    std::string name;         // "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string driver;       // "llvmpipe", "SwiftShader driver"
    std::string driver_info;  // "Mesa 22.3.6 (LLVM 15.0.6)"
    std::string api_version;  // "1.3.230"
    DeviceKind kind = DeviceKind::Other;
    DeviceLimits limits;
    std::string unusable;  // why a Peer cannot run on it; empty when it can

    bool operator==(const PeerDevice&) const = default;
};

/// The devices of every driver the environment names; empty where no Vulkan driver is installed.
std::vector<PeerDevice> list_devices();

/// Throws Error where the device filters with less anisotropy, or with none (Vulkan 1.3, samplerAnisotropy is optional).
void check_anisotropy(const PeerDevice& device, float max_anisotropy);

struct PeerOptions {
    bool validate = false;  // with the Khronos validation layer where it is installed; slow, never for timings
};

/// Ownership of one Vulkan device. Throws Error where the device is unusable or has changed since it was listed.
class Peer {
public:
    explicit Peer(const PeerDevice& device, const PeerOptions& options = {});
    ~Peer();
    Peer(Peer&&) noexcept;
    Peer& operator=(Peer&&) noexcept;

    [[nodiscard]] const PeerDevice& description() const;
    [[nodiscard]] bool validates() const;  // asked for, and the layer was found
    /// Every warning and error of the validation layer so far, one line each.
    [[nodiscard]] std::vector<std::string> validation_messages() const;

private:
    friend class FrameRenderer;
    friend class RawPassRenderer;
    std::unique_ptr<Device> device_;
};

/// One frame, ready to be rendered again and again: everything is created and uploaded by the constructor, and the commands
/// are recorded once. Throws Error where the device lacks a format or filter that the technique needs. The Peer must outlive
/// it.
class FrameRenderer {
public:
    FrameRenderer(const Peer& peer, const Frame& frame);
    ~FrameRenderer();
    FrameRenderer(FrameRenderer&&) noexcept;
    FrameRenderer& operator=(FrameRenderer&&) noexcept;

    /// Renders once and reads everything back.
    FrameImages render();

    /// Renders `warmup` frames, then `frames` timed ones: wall-clock milliseconds around submit and fence wait, in order.
    /// The map is rendered (blurred, mipped) anew in each; nothing is read back.
    std::vector<double> time_frames(int warmup, int frames);

private:
    struct Resources;
    std::unique_ptr<Resources> resources_;
};

struct TimeSummary {
    double median_ms = 0;
    double min_ms = 0;
};

/// Throws Error when there is none.
TimeSummary summarize(std::vector<double> times_ms);

}  // namespace gnomon::peer
