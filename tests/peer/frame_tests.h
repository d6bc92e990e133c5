// What the tests of whole frames share: a check on each device, a small frame, and where a position falls in it.
#pragma once

#include "tests/peer/device_tests.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>

namespace gnomon::peer {

/// Runs a check on each device, with the validation layer where it is installed; the layer must have nothing to say.
void on_each_device(const std::function<void(const Peer&)>& check_on);

/// 320x240 pixels through the scene's own camera.
FrameImages render(const Peer& peer, const scenes::Scene& scene, const TechniqueOptions& technique);

/// The texel that a world position falls on in an image seen through `view`, y down; and its depth.
struct Place {
    std::size_t index = 0;
    float depth = 0;
};
Place place_of(const glm::vec3& position_ws, const scenes::View& view, std::uint32_t width, std::uint32_t height);

}  // namespace gnomon::peer
