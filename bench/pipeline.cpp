// Single passes on Gnomon and on every other GPU this machine has, in turns, so that the noise of a shared machine hits all
// alike: depth alone, one texture, four samples, very many small triangles, a few large ones; and Gnomon on one thread.
#include "bench/gnomon_pass.h"
#include "bench/pass_cases.h"
#include "scenes/procedural.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>

using namespace gnomon;

namespace {

struct Options {
    std::string scene = "car";
    int width = 1024;
    int height = 768;
    int threads = 2;
    int rounds = 25;
    double turn_ms = 40;  // a turn repeats the pass until so much time is over
    std::string only;
    bool alone = false;
    std::string profile = "d3d11";
};

struct Case {
    std::string name;
    std::function<peer::RawMesh()> mesh;
    peer::RawShading shading = peer::RawShading::Plain;
    int samples = 1;
};

std::vector<Case> make_cases(const scenes::Scene& scene, const Options& options) {
    using peer::RawShading;
    const auto of_scene = [&scene, &options] { return bench::scene_mesh(scene, options.width, options.height); };
    const auto small = [&options] { return bench::small_triangles(1'000'000, 4.0f, options.width, options.height); };
    const auto large = [](bench::LargeOrder order) { return [order] { return bench::large_triangles(200, order); }; };
    const auto random = large(bench::LargeOrder::Random);
    const auto layered = large(bench::LargeOrder::BackToFront);
    return {{"depth only", of_scene, RawShading::DepthOnly},
            {"plain colour", of_scene, RawShading::Plain},
            {"one texture, bilinear", of_scene, RawShading::Bilinear},
            {"one texture, trilinear", of_scene, RawShading::Trilinear},
            {"4x MSAA", of_scene, RawShading::Plain, 4},
            {"1M small, depth only", small, RawShading::DepthOnly},
            {"1M small", small, RawShading::Plain},
            {"200 large, depth only", layered, RawShading::DepthOnly},
            {"200 large, back to front", layered, RawShading::Plain},
            {"200 large, random depth", random, RawShading::Plain}};
}

struct Contender {
    std::string name;
    std::function<double()> time_once;
    peer::RawImage image;
    std::vector<double> times{};
    std::vector<double> cpu_times{};
};

/// Processor time of all threads so far, ms: unlike the wall clock, what else runs on the machine hardly changes it.
double cpu_ms() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// An empty or foreign picture is no contender.
void check_images(const std::vector<Contender>& contenders, const Case& of) {
    const peer::RawImage& own = contenders.front().image;
    if (own.covered == 0) fail("{}: nothing was drawn", of.name);
    for (const Contender& contender : contenders) {
        const auto covered = static_cast<double>(contender.image.covered);
        const bool same = std::abs(covered / static_cast<double>(own.covered) - 1.0) < 0.005 &&
                          std::abs(contender.image.mean / own.mean - 1.0) < 0.005;
        if (!same)
            fail("{}: {} draws {} pixels of mean {}, Gnomon {} of mean {}", of.name, contender.name, contender.image.covered,
                 contender.image.mean, own.covered, own.mean);
    }
}

void compare(const Case& of, std::vector<std::pair<std::string, peer::Peer>>& peers, const Options& options) {
    const peer::RawPass pass{
        .mesh = of.mesh(), .shading = of.shading, .samples = of.samples, .width = options.width, .height = options.height};
    const Profile profile = load_profile(options.profile);
    std::vector<Contender> contenders;
    const auto add_gnomon = [&](const std::string& name, int threads) {
        auto own = std::make_shared<bench::GnomonPass>(pass, profile, threads);
        contenders.push_back({name, [own] { return own->time_once(); }, own->render()});
    };
    add_gnomon("Gnomon", options.threads);
    if (options.threads > 1 && !options.alone) add_gnomon("Gnomon, 1 thread", 1);
    for (auto& [name, machine] : peers) {
        auto renderer = std::make_shared<peer::RawPassRenderer>(machine, pass);
        contenders.push_back({name, [renderer] { return renderer->time_once(); }, renderer->render()});
    }
    check_images(contenders, of);

    // The first turn warms up.
    for (int round = -1; round < options.rounds; ++round) {
        for (Contender& contender : contenders) {
            double turn = 0;
            do {
                const double begin = cpu_ms();
                const double ms = contender.time_once();
                turn += ms;
                if (round < 0) continue;
                contender.times.push_back(ms);
                contender.cpu_times.push_back(cpu_ms() - begin);
            } while (turn < options.turn_ms);
        }
    }

    const double own = peer::summarize(contenders.front().times).median_ms;
    const double own_least = peer::summarize(contenders.front().times).min_ms;
    const double own_cpu = peer::summarize(contenders.front().cpu_times).median_ms;
    for (const Contender& contender : contenders) {
        const auto [median, least] = peer::summarize(contender.times);
        const double cpu = peer::summarize(contender.cpu_times).median_ms;
        fmt::print("{:<26} {:<28} {:9.3f} {:8.2f} {:9.3f} {:8.2f} {:9.3f} {:8.2f}\n", of.name, contender.name, median,
                   own / median, least, own_least / least, cpu, own_cpu / cpu);
    }
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Single passes on Gnomon and on the other GPUs of this machine, side by side.");
    app.add_option("--scene", options.scene, "procedural scene")->capture_default_str();
    app.add_option("--width", options.width, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--height", options.height, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--threads", options.threads, "threads for everyone")->capture_default_str()->check(CLI::Range(1, 256));
    app.add_option("--rounds", options.rounds, "turns each contender gets")->capture_default_str()->check(CLI::Range(1, 1000));
    app.add_option("--turn", options.turn_ms, "ms of a turn at least")->capture_default_str()->check(CLI::Range(0.0, 10000.0));
    app.add_option("--only", options.only, "cases whose names contain this");
    app.add_option("--profile", options.profile, "Gnomon's profile")->capture_default_str();
    app.add_flag("--alone", options.alone, "Gnomon with these threads and nobody else: for profilers");
    CLI11_PARSE(app, argc, argv);

    peer::limit_threads(options.threads);
    peer::expose_drivers();
    const auto sources = scenes::procedural_scenes();
    const auto source = std::ranges::find(sources, options.scene, &scenes::ProceduralScene::name);
    if (source == sources.end()) fail("--scene {}: no such scene", options.scene);
    const scenes::Scene scene = source->make();

    std::vector<std::pair<std::string, peer::Peer>> peers;
    if (!options.alone) {
        for (const peer::PeerDevice& device : peer::list_devices()) {
            if (!device.unusable.empty()) {
                fmt::print(stderr, "{}: left out: {}\n", device.name, device.unusable);
                continue;
            }
            peers.emplace_back(device.name.substr(0, 28), peer::Peer(device));
        }
        if (peers.empty()) fmt::print(stderr, "no Vulkan driver found: Gnomon alone\n");
    }

    fmt::print("{} ({} triangles), {}x{} pixels, {} threads, Gnomon with {} lanes, profile {}\n\n", options.scene,
               scene.triangle_count(), options.width, options.height, options.threads, kLanes, options.profile);
    fmt::print("{:<26} {:<28} {:>9} {:>8} {:>9} {:>8} {:>9} {:>8}\n", "pass", "machine", "median", "Gnomon/", "least",
               "Gnomon/", "cpu", "Gnomon/");
    for (const Case& of : make_cases(scene, options))
        if (of.name.find(options.only) != std::string::npos) compare(of, peers, options);
    fmt::print(
        "\ntimes in ms; the last column is Gnomon's median over the machine's, so below 1 Gnomon is faster, and beside one\n"
        "thread its inverse is what {} threads bring\n",
        options.threads);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_bench_pipeline: {}\n", error.what());
        return 2;
    }
}
