// gnomon_peer_render: one frame on one Vulkan device, as a PPM picture and as milliseconds.
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/peer/peer.h"
#include "tests/peer/techniques.h"
#include "tests/peer/test_scenes.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace gnomon::peer {
namespace {

struct Options {
    std::string scene = "two-planes";
    std::string technique = "shadow-map";
    std::string device;
    std::string picture;
    std::string visibility_picture;
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    std::uint32_t map_size = 512;
    int frames = 0;
    int threads = 0;
    bool validate = false;
};

scenes::Scene scene_named(const std::string& name) {
    if (name == "two-planes") return two_planes();
    if (name == "boxes") return boxes();
    for (const scenes::ProceduralScene& known : scenes::procedural_scenes())
        if (known.name == name) return known.make();
    fail("unknown scene '{}'", name);
}

std::vector<NamedTechnique> chosen_techniques(const std::string& name) {
    if (name == "all") return named_techniques();
    return {{name, technique_named(name)}};
}

bool is_chosen(const PeerDevice& device, const std::string& wanted) {
    return device.unusable.empty() &&
           (device.name.find(wanted) != std::string::npos || device.driver.find(wanted) != std::string::npos);
}

// Binary PPM; `rgb(i)` writes three bytes for pixel i.
template <class Rgb>
void write_ppm(const std::string& path, const FrameImages& images, Rgb rgb) {
    std::ofstream file(path, std::ios::binary);
    file << "P6\n" << images.width << ' ' << images.height << "\n255\n";
    const std::size_t pixels = std::size_t{images.width} * images.height;
    for (std::size_t i = 0; i < pixels; ++i)
        for (const std::uint8_t byte : rgb(i)) file.put(static_cast<char>(byte));
    if (!file.flush()) fail("cannot write {}", path);
}

void write_pictures(const Options& options, const FrameImages& images) {
    if (!options.picture.empty())
        write_ppm(options.picture, images, [&](std::size_t i) {
            return std::array{images.color[4 * i], images.color[4 * i + 1], images.color[4 * i + 2]};
        });
    if (!options.visibility_picture.empty())
        write_ppm(options.visibility_picture, images, [&](std::size_t i) {
            const auto level = static_cast<std::uint8_t>(std::max(images.visibility[i], 0.0f) * 255.0f + 0.5f);
            return std::array{level, level, level};
        });
}

void run(const Options& options, const scenes::Scene& scene, const PeerDevice& device) {
    const Peer peer(device, {.validate = options.validate});
    for (const auto& [name, technique] : chosen_techniques(options.technique)) {
        Frame frame = scene_frame(scene, options.width, options.height);
        frame.technique = technique;
        frame.technique.map_size = options.map_size;
        FrameRenderer renderer(peer, frame);
        write_pictures(options, renderer.render());
        if (options.frames > 0) {
            const TimeSummary times = summarize(renderer.time_frames(5, options.frames));
            fmt::print("{:<30} {:<30} median {:8.2f} ms  min {:8.2f} ms\n", device.name.substr(0, 30), name, times.median_ms,
                       times.min_ms);
        }
    }
    for (const std::string& message : peer.validation_messages()) fmt::print(stderr, "validation: {}\n", message);
}

int run_all(const Options& options) {
    if (options.threads > 0) limit_threads(options.threads);
    expose_drivers();
    const scenes::Scene scene = scene_named(options.scene);
    int rendered = 0;
    for (const PeerDevice& device : list_devices())
        if (is_chosen(device, options.device)) {
            run(options, scene, device);
            ++rendered;
        }
    if (rendered == 0) fail("no usable Vulkan device matches '{}'", options.device);
    return 0;
}

}  // namespace
}  // namespace gnomon::peer

int main(int argc, char** argv) {
    gnomon::peer::Options options;
    CLI::App app{"Renders one frame on other people's GPUs"};
    app.add_option("--scene", options.scene, "two-planes, boxes, or a built-in scene of Gnomon");
    app.add_option("--technique", options.technique, "a technique's name, or all");
    app.add_option("--device", options.device, "part of a device's or driver's name; all devices without it");
    app.add_option("--out", options.picture, "write the last frame's colours here (PPM)");
    app.add_option("--visibility", options.visibility_picture, "write the last frame's visibility here (PPM)");
    app.add_option("--width", options.width, "pixels");
    app.add_option("--height", options.height, "pixels");
    app.add_option("--map", options.map_size, "texels along each side of the map");
    app.add_option("--frames", options.frames, "time this many frames");
    app.add_option("--threads", options.threads, "threads of the software devices");
    app.add_flag("--validate", options.validate, "with the validation layer");
    CLI11_PARSE(app, argc, argv);
    try {
        return gnomon::peer::run_all(options);
    } catch (const gnomon::Error& error) {
        fmt::print(stderr, "gnomon_peer_render: {}\n", error.what());
        return 2;
    }
}
