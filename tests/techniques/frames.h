// Small frames for tests: a built-in scene under a technique, its visibility and the maps it was read from.
#pragma once

#include "scenes/procedural.h"
#include "techniques/frame.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::testing {

/// Made once per program.
inline const scenes::Scene& scene_of(std::string_view name) {
    static std::map<std::string, scenes::Scene, std::less<>> made;
    const auto at = made.find(name);
    if (at != made.end()) return at->second;
    for (const scenes::ProceduralScene& scene : scenes::procedural_scenes())
        if (scene.name == name) return made.emplace(name, scene.make()).first->second;
    FAIL("no scene " << name);
    return made.begin()->second;
}

struct Shot {
    std::vector<float> visibility;             // techniques::Frame::kNoSurface where nothing was drawn
    std::vector<std::vector<std::byte>> maps;  // level 0, slice by slice
};

struct ShotOptions {
    std::string_view scene = "car";
    std::string profile = "d3d11";
    int width = 160;  // pixels
    int height = 120;
};

inline std::vector<float> floats_of(const std::vector<std::byte>& bytes) {
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

inline Shot shoot(std::string_view technique_name, const techniques::TechniqueRequest& request,
                  const ShotOptions& options = {}) {
    const techniques::Technique& technique = techniques::find_technique(technique_name);
    Device device(load_profile(options.profile), 2);
    techniques::Frame frame(device, scene_of(options.scene),
                            {.width = options.width,
                             .height = options.height,
                             .technique = technique,
                             .settings = techniques::resolve_settings(technique, request, device.profile())});
    techniques::PassTimer timer(device);
    frame.render(timer);
    Shot shot{.visibility = floats_of(device.texture(frame.visibility()).level_bytes(0)), .maps = {}};
    for (const TextureId map : frame.maps())
        for (int slice = 0; slice < device.texture(map).desc().layers; ++slice)
            shot.maps.push_back(device.texture(map).level_bytes(0, slice));
    return shot;
}

}  // namespace gnomon::testing
