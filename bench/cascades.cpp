// What splits and the cures of their seams cost in the camera pass: each beside one map and beside no cure, in turns.
#include "scenes/procedural.h"
#include "sim/error.h"
#include "techniques/frame.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <vector>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

struct Options {
    std::string scene = "city";
    int width = 1024;
    int height = 768;
    int rounds = 15;
    int threads = 0;
};

/// One way to draw, on a device of its own.
struct Contestant {
    std::string label;
    std::unique_ptr<Device> device;
    std::unique_ptr<Frame> frame;
    Counters counters;
    std::vector<double> milliseconds;

    [[nodiscard]] double median() const {
        std::vector<double> sorted = milliseconds;
        std::ranges::sort(sorted);
        return sorted[sorted.size() / 2];
    }
};

Contestant make_contestant(const Options& options, const scenes::Scene& scene, int cascades, std::string_view cure) {
    Contestant contestant;
    contestant.label = cascades == 0 ? "one map" : fmt::format("{} splits, {}", cascades, cure);
    contestant.device = std::make_unique<Device>(Profile{}, options.threads);
    TechniqueRequest request{.map_size = 512, .cascades = cascades};
    if (cascades > 0) request.set = {{"cure", std::string(cure)}, {"lambda", "0.8"}};
    const Technique& technique = find_technique("psvsm");
    contestant.frame = std::make_unique<Frame>(*contestant.device, scene,
                                               FrameDesc{.width = options.width,
                                                         .height = options.height,
                                                         .technique = technique,
                                                         .settings = resolve_settings(technique, request)});
    PassTimer counted(*contestant.device);
    contestant.device->enable_counters(true);
    contestant.frame->render(counted);
    contestant.device->enable_counters(false);
    contestant.counters = counted.records().back().counters;
    return contestant;
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("What splits and the cures of their seams cost in the camera pass, in turns; medians and ratios of one run.");
    app.add_option("--scene", options.scene, "Built-in scene")->capture_default_str();
    app.add_option("--width", options.width)->check(CLI::Range(16, 16384))->capture_default_str();
    app.add_option("--height", options.height)->check(CLI::Range(16, 16384))->capture_default_str();
    app.add_option("--rounds", options.rounds, "Frames of each")->check(CLI::Range(3, 1000))->capture_default_str();
    app.add_option("--threads", options.threads, "0: all processors")->check(CLI::Range(0, 256))->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    const auto scenes = scenes::procedural_scenes();
    const auto source = std::ranges::find(scenes, options.scene, &scenes::ProceduralScene::name);
    if (source == scenes.end()) fail("--scene {}: expected a built-in scene", options.scene);
    const scenes::Scene scene = source->make();

    std::vector<Contestant> contestants;
    contestants.push_back(make_contestant(options, scene, 0, "none"));
    for (const int cascades : {2, 4, 8})
        for (const auto& cure : kEnumNames<SeamCure>)
            contestants.push_back(make_contestant(options, scene, cascades, cure.name));
    for (int round = 0; round < options.rounds; ++round)
        for (Contestant& contestant : contestants) {
            PassTimer timer(*contestant.device);
            contestant.frame->render(timer);
            contestant.milliseconds.push_back(timer.records().back().milliseconds);
        }

    fmt::print("{} {}x{}, psvsm 512, camera pass\n", options.scene, options.width, options.height);
    fmt::print("{:<34} {:>9} {:>9} {:>9} {:>12} {:>12} {:>12}\n", "", "ms", "/ one map", "/ none", "derivatives", "samples",
               "texels");
    const double one_map = contestants.front().median();
    double none = one_map;
    for (const Contestant& contestant : contestants) {
        if (contestant.label.ends_with("none")) none = contestant.median();
        const auto lanes = static_cast<double>(contestant.counters.lanes_shaded);
        const auto per_lane = [&](std::uint64_t count) { return static_cast<double>(count) / lanes; };
        fmt::print("{:<34} {:>9.2f} {:>9.2f} {:>9.2f} {:>12.2f} {:>12.2f} {:>12.2f}\n", contestant.label, contestant.median(),
                   contestant.median() / one_map, contestant.median() / none, per_lane(contestant.counters.derivatives),
                   per_lane(contestant.counters.texture_instructions), per_lane(contestant.counters.texels_fetched));
    }
    fmt::print("derivatives, samples and texels per pixel shaded\n");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_bench_cascades: {}\n", error.what());
        return 2;
    }
}
