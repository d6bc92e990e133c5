// Probe targets and back.
#include "studies/seams/probe.h"

#include <cstring>

namespace gnomon::studies {

namespace {

/// Level 0 of a texture whose bytes are an array of these.
template <class Value>
std::vector<Value> values_of(const Texture& texture) {
    const std::vector<std::byte> bytes = texture.level_bytes(0);
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

}  // namespace

ProbeTargets::ProbeTargets(Device& device, int width, int height) : device_(device) {
    for (TargetView& color : colors_)
        color = device.create_texture("probe", {.format = Format::Rgba32Float, .width = width, .height = height});
    derivatives_ = device.create_texture("probe derivatives", {.format = Format::R32Uint, .width = width, .height = height});
}

SeamImage ProbeTargets::read() const {
    const Texture& first = device_.texture(colors_[0].texture);
    SeamImage image{.width = first.width(0), .height = first.height(0), .pixels = {}, .derivatives = {}, .counters = {}};
    std::array<std::vector<std::array<float, 4>>, kProbeTargets> targets;
    for (std::size_t i = 0; i < kProbeTargets; ++i)
        targets[i] = values_of<std::array<float, 4>>(device_.texture(colors_[i].texture));
    image.pixels.reserve(targets[0].size());
    for (std::size_t i = 0; i < targets[0].size(); ++i) {
        const auto& [own, used, lod, smooth_lod] = targets[0][i];
        const auto& [exact_lod, level, probes, flags] = targets[1][i];
        image.pixels.push_back(
            {own, used, lod, smooth_lod, exact_lod, level, probes, flags, targets[2][i][0], targets[2][i][1]});
    }
    image.derivatives = values_of<std::uint32_t>(device_.texture(derivatives_));
    return image;
}

}  // namespace gnomon::studies
