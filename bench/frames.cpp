// Whole frames on Gnomon and on every other GPU this machine has, in turns, so that the noise of a shared machine hits all
// alike. Prints the median time of a frame per technique and how many times longer Gnomon takes than each peer.
#include "scenes/procedural.h"
#include "techniques/frame.h"
#include "tests/peer/peer.h"
#include "tests/peer/techniques.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

using namespace gnomon;

namespace {

struct Options {
    std::string scene = "car";
    int width = 1024;
    int height = 768;
    int map = 512;
    int threads = 2;
    int rounds = 15;
    int frames = 4;  // per round and contender
};

/// One row of the table: the same technique said to Gnomon and to the peers.
struct Workload {
    std::string name;
    std::string technique;
    techniques::TechniqueRequest request;
    std::optional<peer::TechniqueOptions> peer;  // none: Gnomon alone
    std::string profile = "d3d11";
};

std::vector<Workload> make_workloads(int map) {
    using techniques::MapFilter;
    const auto size = static_cast<std::uint32_t>(map);
    const auto depth = [&](peer::Technique technique, peer::MapFilter filter, int taps) {
        return peer::TechniqueOptions{.technique = technique, .map_size = size, .filter = filter, .taps = taps};
    };
    const auto vsm = [&](peer::MomentFormat format, peer::MapFilter filter, int blur) {
        return peer::TechniqueOptions{.technique = peer::Technique::Vsm,
                                      .map_size = size,
                                      .filter = filter,
                                      .moment_format = format,
                                      .blur_kernel = blur > 1 ? peer::gaussian_kernel(blur) : std::vector<float>{}};
    };
    const auto named = [&](std::string_view name) {
        peer::TechniqueOptions options = peer::technique_named(name);
        options.map_size = size;
        return options;
    };
    using peer::MomentFormat;
    const auto nearest = peer::MapFilter::Nearest;
    const auto bilinear = peer::MapFilter::Bilinear;
    const auto trilinear = peer::MapFilter::Trilinear;
    return {
        {"shadow-map nearest", "shadow-map", {.map_size = map}, depth(peer::Technique::ShadowMap, nearest, 1)},
        {"pcf hardware bilinear", "pcf-hw", {.map_size = map}, depth(peer::Technique::Pcf, bilinear, 1)},
        {"pcf 3x3 nearest", "pcf", {.map_size = map}, depth(peer::Technique::Pcf, nearest, 3)},
        {"pcf 3x3 bilinear", "pcf-bilinear", {.map_size = map}, depth(peer::Technique::Pcf, bilinear, 3)},
        {"vsm rg32f bilinear", "vsm", {.map_size = map, .filter = MapFilter::Bilinear}, vsm(MomentFormat::Rg32f, bilinear, 1)},
        {"vsm rg32f trilinear", "vsm", {.map_size = map}, vsm(MomentFormat::Rg32f, trilinear, 1)},
        {"vsm rg16f trilinear", "vsm", {.map_size = map, .format = Format::Rg16Float}, vsm(MomentFormat::Rg16f, trilinear, 1)},
        {"vsm rg32f trilinear, blur 3",
         "vsm",
         {.map_size = map, .set = {{"blur", "3"}}},
         vsm(MomentFormat::Rg32f, trilinear, 3)},
        {"vsm rg32f trilinear, ideal", "vsm", {.map_size = map}, std::nullopt, "ideal"},
        {"vsm rg32f 16x", "vsm", {.map_size = map, .anisotropy = 16}, named("vsm-rg32f-16x")},
        {"vsm rg16f 16x", "vsm", {.map_size = map, .format = Format::Rg16Float, .anisotropy = 16}, named("vsm-rg16f-16x")},
        {"evsm4 rgba32f trilinear", "evsm4", {.map_size = map}, named("evsm4-rgba32f-trilinear")},
        {"evsm4 rgba16f trilinear",
         "evsm4",
         {.map_size = map, .format = Format::Rgba16Float},
         named("evsm4-rgba16f-trilinear")},
        {"evsm4 rgba32f trilinear, blur 3",
         "evsm4",
         {.map_size = map, .set = {{"blur", "3"}}},
         named("evsm4-rgba32f-trilinear-blur-3x3")},
        {"evsm4 rgba32f 16x", "evsm4", {.map_size = map, .anisotropy = 16}, named("evsm4-rgba32f-16x")},
    };
}

/// Every technique alone as it comes, and with blurs of 3x3 and 5x5 where it has one.
std::vector<Workload> make_own_workloads(int map) {
    std::vector<Workload> workloads;
    for (const techniques::Technique& technique : techniques::all_techniques()) {
        const std::string name(technique.name);
        workloads.push_back({name, name, {.map_size = map}, std::nullopt});
        if (std::ranges::find(technique.parameters, "blur", &techniques::Parameter::name) == technique.parameters.end())
            continue;
        for (const char* taps : {"3", "5"})
            workloads.push_back(
                {fmt::format("{}, blur {}", name, taps), name, {.map_size = map, .set = {{"blur", taps}}}, std::nullopt});
    }
    return workloads;
}

/// Someone who can render a workload; `time` gives milliseconds of so many frames.
struct Contender {
    std::string name;
    std::function<std::vector<double>(int frames)> time;
    std::vector<double> times;
};

Contender gnomon_contender(const scenes::Scene& scene, const Workload& workload, const Options& options) {
    struct State {
        State(const std::string& profile, int threads) : device(load_profile(profile), threads) {}
        Device device;
        std::optional<techniques::Frame> frame{};
    };
    auto state = std::make_shared<State>(workload.profile, options.threads);
    techniques::FrameDesc desc{
        .width = options.width, .height = options.height, .technique = techniques::find_technique(workload.technique)};
    desc.settings = techniques::resolve_settings(desc.technique, workload.request);
    state->frame.emplace(state->device, scene, desc);
    return {"Gnomon",
            [state](int frames) {
                std::vector<double> times;
                for (int i = 0; i < frames; ++i) {
                    techniques::PassTimer timer(state->device);
                    const auto begin = std::chrono::steady_clock::now();
                    state->frame->render(timer);
                    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
                    times.push_back(elapsed.count());
                }
                return times;
            },
            {}};
}

void compare(const scenes::Scene& scene, const Workload& workload, std::vector<std::pair<std::string, peer::Peer>>& peers,
             const Options& options) {
    std::vector<Contender> contenders{gnomon_contender(scene, workload, options)};
    for (auto& [name, machine] : peers) {
        if (!workload.peer) break;
        peer::Frame frame =
            peer::scene_frame(scene, static_cast<std::uint32_t>(options.width), static_cast<std::uint32_t>(options.height));
        frame.technique = *workload.peer;
        try {
            auto renderer = std::make_shared<peer::FrameRenderer>(machine, frame);
            contenders.push_back({name, [renderer](int frames) { return renderer->time_frames(0, frames); }, {}});
        } catch (const Error& error) {
            fmt::print(stderr, "{} on {}: left out: {}\n", workload.name, name, error.what());
        }
    }

    // Warm up, then take turns.
    for (Contender& contender : contenders) contender.time(2);
    for (int round = 0; round < options.rounds; ++round) {
        for (Contender& contender : contenders) {
            const auto times = contender.time(options.frames);
            contender.times.insert(contender.times.end(), times.begin(), times.end());
        }
    }

    const double own = peer::summarize(contenders.front().times).median_ms;
    for (const Contender& contender : contenders) {
        const auto [median, least] = peer::summarize(contender.times);
        fmt::print("{:<32} {:<28} {:8.2f} {:8.2f} {:8.2f}\n", workload.name, contender.name, median, least, own / median);
    }
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Frame times of Gnomon and of the other GPUs on this machine, side by side.");
    app.add_option("--scene", options.scene, "procedural scene")->capture_default_str();
    app.add_option("--width", options.width, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--height", options.height, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--map", options.map, "shadow map texels per side")
        ->capture_default_str()
        ->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--threads", options.threads, "threads for everyone")->capture_default_str()->check(CLI::Range(1, 256));
    app.add_option("--rounds", options.rounds, "turns each contender gets")->capture_default_str()->check(CLI::Range(1, 1000));
    app.add_option("--frames", options.frames, "frames per turn")->capture_default_str()->check(CLI::Range(1, 1000));
    CLI11_PARSE(app, argc, argv);

    peer::limit_threads(options.threads);
    peer::expose_drivers();
    const auto sources = scenes::procedural_scenes();
    const auto source = std::ranges::find(sources, options.scene, &scenes::ProceduralScene::name);
    if (source == sources.end()) fail("--scene {}: no such scene", options.scene);
    const scenes::Scene scene = source->make();

    std::vector<std::pair<std::string, peer::Peer>> peers;
    for (const peer::PeerDevice& device : peer::list_devices()) {
        if (!device.unusable.empty()) {
            fmt::print(stderr, "{}: left out: {}\n", device.name, device.unusable);
            continue;
        }
        peers.emplace_back(device.name.substr(0, 28), peer::Peer(device));
    }
    if (peers.empty()) fmt::print(stderr, "no Vulkan driver found: Gnomon alone\n");

    fmt::print("{} ({} triangles), {}x{} pixels, {}x{} map, {} threads, Gnomon with {} lanes\n\n", options.scene,
               scene.triangle_count(), options.width, options.height, options.map, options.map, options.threads, kLanes);
    fmt::print("{:<32} {:<28} {:>8} {:>8} {:>8}\n", "technique", "machine", "median", "least", "Gnomon/");
    for (const Workload& workload : make_workloads(options.map)) compare(scene, workload, peers, options);
    peers.clear();
    fmt::print("\nevery technique alone\n");
    for (const Workload& workload : make_own_workloads(options.map)) compare(scene, workload, peers, options);
    fmt::print("\ntimes in ms per frame; the last column is Gnomon's median over the machine's, so below 1 Gnomon is faster\n");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_bench_frames: {}\n", error.what());
        return 2;
    }
}
