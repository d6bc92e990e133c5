// Built-in scenes, generated, the same bytes everywhere. docs/scenes.md says what each is for.
#pragma once

#include "scenes/scene.h"

#include <span>
#include <string>
#include <string_view>

namespace gnomon::scenes {

struct ProceduralScene {
    std::string_view name;
    std::string_view summary;  // one line, with its source
    Scene (*make)();
};

/// All of them, in the order of `gnomon list scenes`.
std::span<const ProceduralScene> procedural_scenes();

}  // namespace gnomon::scenes
