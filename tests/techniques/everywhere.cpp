// Every technique with every built-in scene, several map sizes, samples and limits of anisotropy: it runs, and what it shows
// are visibilities. How good they are is measured elsewhere.
#include "tests/techniques/frames.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

constexpr std::array kSizes{64, 190, 512};
constexpr std::array kSamples{1, 4, 8};
constexpr std::array kAnisotropies{1, 2, 16};

/// Pixels that lack some light, and those that have some.
struct Shades {
    std::size_t surface = 0;
    std::size_t dark = 0;
    std::size_t lit = 0;
};

/// Fails for anything but a visibility.
Shades shades_of(const std::vector<float>& visibility) {
    Shades shades;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        const float v = visibility[i];
        if (v == Frame::kNoSurface) continue;
        if (!(v >= 0.0f && v <= 1.0f)) FAIL(fmt::format("pixel ({}, {}): {:a}", i % 64, i / 64, v));
        ++shades.surface;
        shades.dark += v < 0.875f;
        shades.lit += v > 0.125f;
    }
    return shades;
}

Shades shades_in(std::string_view technique, std::string_view scene, const TechniqueRequest& request) {
    return shades_of(shoot(technique, request, {.scene = scene, .width = 64, .height = 48}).visibility);
}

}  // namespace

TEST_CASE("every technique in every scene", "[techniques][everywhere]") {
    int scene_index = 0;
    for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
        const Shades expected = shades_in("pcf", scene.name, {.map_size = 512});
        int technique_index = 0;
        for (const Technique& technique : all_techniques()) {
            // A Latin square per pair of choices: over scenes and techniques each size meets each number of samples and limit.
            for (std::size_t i = 0; i < kSizes.size(); ++i) {
                const int samples = kSamples[(i + static_cast<std::size_t>(scene_index)) % kSamples.size()];
                const int anisotropy = kAnisotropies[(i + static_cast<std::size_t>(technique_index)) % kAnisotropies.size()];
                const TechniqueRequest request{.map_size = kSizes[i], .map_samples = samples, .anisotropy = anisotropy};
                INFO(technique.name << " in " << scene.name << ", map " << kSizes[i] << ", samples " << samples << ", aniso "
                                    << anisotropy);
                const Shades shades = shades_in(technique.name, scene.name, request);
                CHECK(shades.surface == expected.surface);
                // The slope bias of a coarse map lifts the ground by more than the fence is high.
                const bool may_be_unshadowed = scene.name == "fence" && kSizes[i] < 512;
                if (expected.dark > 40 && !may_be_unshadowed) CHECK(shades.dark > 10);
                if (expected.lit > 40) CHECK(shades.lit > 10);
            }
            ++technique_index;
        }
        ++scene_index;
    }
}

TEST_CASE("every parameter of every technique at its ends, and with every word", "[techniques][everywhere]") {
    for (const Technique& technique : all_techniques())
        for (const Parameter& parameter : technique.parameters) {
            std::vector<std::string> texts{text_of(parameter, parameter.low), text_of(parameter, parameter.high)};
            if (parameter.kind == ParameterKind::Word) texts.assign(parameter.words.begin(), parameter.words.end());
            for (const std::string& text : texts) {
                INFO(technique.name << " --set " << parameter.name << "=" << text);
                const TechniqueRequest request{.map_size = 64, .map_samples = 2, .set = {{std::string(parameter.name), text}}};
                const Shades shades = shades_in(technique.name, "planes", request);
                CHECK(shades.surface > 1000);
            }
        }
}

TEST_CASE("every technique with one to eight splits, and every parameter of splits at its ends", "[techniques][everywhere]") {
    int index = 0;
    for (const Technique& technique : all_techniques()) {
        const int cascades = 1 + index++ % kMaxCascades;
        for (const char* scene : {"fence", "city"}) {
            INFO(technique.name << ", " << cascades << " splits, " << scene);
            CHECK(shades_in(technique.name, scene, {.map_size = 64, .cascades = cascades}).surface > 1000);
        }
    }
    for (const Parameter& parameter : cascade_parameters()) {
        std::vector<std::string> texts{text_of(parameter, parameter.low), text_of(parameter, parameter.high)};
        if (parameter.kind == ParameterKind::Word) texts.assign(parameter.words.begin(), parameter.words.end());
        for (const std::string& text : texts)
            for (const char* technique : {"pssm", "psvsm", "pcf-footprint", "savsm", "lvsm"}) {
                INFO(technique << " --set " << parameter.name << "=" << text);
                const Shades shades = shades_in(technique, "fence",
                                                {.map_size = 64, .cascades = 3, .set = {{std::string(parameter.name), text}}});
                CHECK(shades.surface > 1000);
                CHECK(shades.lit > 0);
            }
    }
}

TEST_CASE("every technique with a map of 4096 texels", "[.][large]") {
    for (const Technique& technique : all_techniques()) {
        INFO(technique.name);
        const Shades shades = shades_in(technique.name, "planes", {.map_size = 4096});
        CHECK(shades.dark > 0);
        CHECK(shades.lit > 0);
    }
}
