// Peer and FrameRenderer: the resources of a frame, rendering, reading back, timing.
#include "tests/peer/peer.h"

#include "sim/error.h"
#include "tests/peer/device.h"
#include "tests/peer/passes.h"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

namespace gnomon::peer {
namespace {

// Bytes as they are, e.g. as floats.
template <class T>
std::vector<T> as_values(const std::vector<std::byte>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

// Moments as floats. Widening a half is exact, so any unpacking does; a unorm is its quotient rounded once. D3D11.3 3.2.3.5
std::vector<float> moment_values(MomentFormat format, const std::vector<std::byte>& bytes) {
    const Encoding encoding = format_traits(format).encoding;
    if (encoding == Encoding::Float32) return as_values<float>(bytes);
    const std::vector<std::uint16_t> words = as_values<std::uint16_t>(bytes);
    std::vector<float> values(words.size());
    std::transform(words.begin(), words.end(), values.begin(), [encoding](std::uint16_t word) {
        return encoding == Encoding::Float16 ? glm::unpackHalf1x16(word) : static_cast<float>(word) / 65535.0f;
    });
    return values;
}

}  // namespace

void check_anisotropy(const PeerDevice& device, float max_anisotropy) {
    if (max_anisotropy <= device.limits.max_anisotropy) return;
    if (device.limits.max_anisotropy <= 1) fail("device '{}' has no anisotropic filtering", device.name);
    fail("device '{}' filters with anisotropy up to {}, not {}", device.name, device.limits.max_anisotropy, max_anisotropy);
}

Peer::Peer(const PeerDevice& device, const PeerOptions& options) : device_(std::make_unique<Device>(device, options)) {}
Peer::~Peer() = default;
Peer::Peer(Peer&&) noexcept = default;
Peer& Peer::operator=(Peer&&) noexcept = default;

const PeerDevice& Peer::description() const { return device_->description(); }
bool Peer::validates() const { return device_->instance().validates(); }
std::vector<std::string> Peer::validation_messages() const { return device_->instance().messages(); }

// Members are destroyed from the last to the first: the commands before what they refer to.
struct FrameRenderer::Resources {
    const Device& device;
    Frame frame;
    Geometry geometry;
    Targets targets;
    UniformBuffers uniforms;
    SetLayouts layouts;
    OwnedSampler map_sampler;
    OwnedSampler fetch_sampler;
    Sets sets;
    Pipelines pipelines;
    Commands commands;

    Resources(const Device& on, const Frame& of)
        : device(on),
          frame(of),
          geometry(make_geometry(on, of)),
          targets(make_targets(on, of)),
          uniforms(make_uniform_buffers(on, of)),
          layouts(make_set_layouts(on, static_cast<bool>(targets.map.image))),
          map_sampler(make_map_sampler(on, of.technique)),
          fetch_sampler(make_fetch_sampler(on)),
          sets(make_sets(on, layouts)),
          pipelines(make_pipelines(on, layouts, of.technique)) {
        bind();
        for (Draw& draw : frame.draws) draw.mesh = nullptr;  // uploaded; the mesh may go
        const PassInputs inputs{frame, geometry, targets, uniforms, sets, pipelines};
        commands = device.record([&inputs](VkCommandBuffer buffer) { record_frame(buffer, inputs); });
    }

    void bind() {
        bind_uniforms(device, sets.scene, uniforms);
        if (targets.map.image) bind_image(device, sets.scene, 2, targets.map.all_levels.get(), map_sampler.get());
        if (!targets.blur_temp.image) return;
        bind_image(device, sets.blur_map, 0, targets.map.level_0.get(), fetch_sampler.get());
        bind_image(device, sets.blur_temp, 0, targets.blur_temp.level_0.get(), fetch_sampler.get());
    }
};

FrameRenderer::FrameRenderer(const Peer& peer, const Frame& frame) {
    check_frame(frame);
    resources_ = std::make_unique<Resources>(*peer.device_, frame);
}
FrameRenderer::~FrameRenderer() = default;
FrameRenderer::FrameRenderer(FrameRenderer&&) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&&) noexcept = default;

FrameImages FrameRenderer::render() {
    const Device& device = resources_->device;
    const Frame& frame = resources_->frame;
    const Targets& targets = resources_->targets;
    device.run(resources_->commands);

    FrameImages images{.width = frame.width, .height = frame.height};
    images.color = as_values<std::uint8_t>(read_image(device, targets.color, kColorTarget));
    images.visibility = as_values<float>(read_image(device, targets.visibility, kColorTarget));
    images.depth = as_values<float>(read_image(device, targets.depth, kDepthTarget));
    if (!targets.map.image) return images;

    images.map_size = frame.technique.map_size;
    images.map_channels = map_channels(map_kind(frame.technique.technique));
    const std::vector<std::byte> map = read_image(device, targets.map, kSampled);
    images.map = images.map_channels == 1 ? as_values<float>(map) : moment_values(frame.technique.moment_format, map);
    return images;
}

std::vector<double> FrameRenderer::time_frames(int warmup, int frames) {
    using Clock = std::chrono::steady_clock;
    for (int i = 0; i < warmup; ++i) resources_->device.run(resources_->commands);
    std::vector<double> times_ms;
    for (int i = 0; i < frames; ++i) {
        const Clock::time_point start = Clock::now();
        resources_->device.run(resources_->commands);
        times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    }
    return times_ms;
}

TimeSummary summarize(std::vector<double> times_ms) {
    if (times_ms.empty()) fail("no frame was timed");
    std::sort(times_ms.begin(), times_ms.end());
    const std::size_t count = times_ms.size();
    return {.median_ms = (times_ms[(count - 1) / 2] + times_ms[count / 2]) / 2, .min_ms = times_ms.front()};
}

}  // namespace gnomon::peer
