// Devices in turn, frames and places.
#include "tests/peer/frame_tests.h"

#include <catch2/catch.hpp>

namespace gnomon::peer {

void on_each_device(const std::function<void(const Peer&)>& check_on) {
    for (const PeerDevice& device : usable_devices()) {
        INFO("device " << device.name);
        const Peer peer(device, {.validate = true});
        check_on(peer);
        for (const std::string& message : peer.validation_messages()) FAIL_CHECK(message);
    }
}

FrameImages render(const Peer& peer, const scenes::Scene& scene, const TechniqueOptions& technique) {
    Frame frame = scene_frame(scene, 320, 240);
    frame.technique = technique;
    return FrameRenderer(peer, frame).render();
}

Place place_of(const glm::vec3& position_ws, const scenes::View& view, std::uint32_t width, std::uint32_t height) {
    const glm::vec4 clip = view.clip_from_world() * glm::vec4(position_ws, 1);
    const float x_px = (clip.x / clip.w + 1) * 0.5f * static_cast<float>(width);
    const float y_px = (1 - clip.y / clip.w) * 0.5f * static_cast<float>(height);
    return {static_cast<std::size_t>(y_px) * width + static_cast<std::size_t>(x_px), clip.z / clip.w};
}

}  // namespace gnomon::peer
