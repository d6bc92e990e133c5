#include "studies/experiment.h"

#include "sim/lanes.h"
#include "traces/hash.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace gnomon::studies {

namespace {

void check_size(int width, int height) {
    if (width < 1 || width > kMaxTextureSize || height < 1 || height > kMaxTextureSize)
        fail("--size {}x{}: expected 1 to {} pixels each way", width, height, kMaxTextureSize);
}

Host make_host(Device& device) {
    Host host{.threads = device.workers().threads(), .lanes = kLanes, .target = hwy::TargetName(HWY_TARGET), .compiler = {}};
#if defined(__clang__)
    host.compiler = "clang++ " __clang_version__;
#elif defined(__GNUC__)
    host.compiler = "g++ " __VERSION__;
#endif
    return host;
}

/// Passes with their names made unique: a second "blur" is "blur 2".
std::vector<PassResult> make_passes(const techniques::PassTimer& timed, const techniques::PassTimer& counted) {
    GNOMON_CHECK_EQ(timed.records().size(), counted.records().size());
    std::vector<PassResult> passes;
    for (std::size_t i = 0; i < timed.records().size(); ++i) {
        const techniques::PassRecord& record = timed.records()[i];
        const auto earlier = std::count_if(timed.records().begin(), timed.records().begin() + static_cast<std::ptrdiff_t>(i),
                                           [&](const techniques::PassRecord& other) { return other.name == record.name; });
        const std::string name = earlier == 0 ? record.name : fmt::format("{} {}", record.name, earlier + 1);
        passes.push_back({name, record.milliseconds, counted.records()[i].counters, counted.records()[i].traffic});
    }
    return passes;
}

std::string hash_of(const Texture& texture) { return traces::xxh3_128_hex(texture.level_bytes(0)); }

/// Level 0 of every slice of every map.
std::string hash_of_maps(const Device& device, const std::vector<TextureId>& maps) {
    std::vector<std::byte> all;
    for (const TextureId id : maps) {
        const Texture& texture = device.texture(id);
        for (int slice = 0; slice < texture.desc().layers; ++slice) {
            const std::vector<std::byte> bytes = texture.level_bytes(0, slice);
            all.insert(all.end(), bytes.begin(), bytes.end());
        }
    }
    return traces::xxh3_128_hex(all);
}

}  // namespace

Experiment::Experiment(const RenderRequest& request) : request_(request) {
    check_size(request.width, request.height);
    profile_ = load_profile(request.profile);
    runs_ = plan_runs(request, profile_);
    scene_ = find_scene(request.scene, request.file_options);

    // Find out now, not after minutes of other techniques, whether a map is too large.
    for (const PlannedRun& plan : runs_) {
        Device device(profile_, 1);
        (void)plan.technique.make(device, plan.settings);
    }
}

const scenes::ReferenceImage* Experiment::truth(const Progress& progress) {
    if (request_.truth == Truth::None) return nullptr;
    if (!truth_) {
        const auto begin = std::chrono::steady_clock::now();
        const float aspect = static_cast<float>(request_.width) / static_cast<float>(request_.height);
        truth_ = trace(scenes::camera_view(scene_.camera, aspect), progress);
        truth_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    }
    return &*truth_;
}

scenes::ReferenceImage Experiment::trace(const scenes::View& camera, const Progress& progress) const {
    GNOMON_CHECK(request_.truth != Truth::None);
    const scenes::ReferenceOptions options{
        .mode = request_.truth == Truth::Area ? scenes::ReferenceMode::Area : scenes::ReferenceMode::Center,
        .seed = request_.seed,
        .threads = request_.threads};
    return scenes::trace_reference(scene_, camera, scenes::light_view(scene_.light, scene_.bounds()), request_.width,
                                   request_.height, options, progress);
}

RenderResult Experiment::run(const PlannedRun& plan, const Progress& progress,
                             const std::function<void(const Command&)>& on_command) {
    // Every command and every tile of a draw is a chance to stop; commands of creation and of the first frame are also shown.
    Device device(profile_, request_.threads);
    device.set_stop(progress.stop);
    const std::string stage = fmt::format("rendering {}", plan.technique.name);
    bool showing = true;
    device.set_observer([&](const Command& command) {
        progress.step(stage, 0, 0);
        if (showing && on_command) on_command(command);
    });
    techniques::Frame frame(
        device, scene_,
        {.width = request_.width, .height = request_.height, .technique = plan.technique, .settings = plan.settings});

    // Counting costs time: count in one frame, which also warms the caches, and time the next.
    MapStatistics map;
    techniques::PassTimer counted(device, [&](std::string_view pass) {
        if (pass != "camera") map = worse(map, map_statistics(device, frame.maps()));  // a blur hides what the light pass wrote
    });
    device.enable_counters(true);
    frame.render(counted);
    device.enable_counters(false);
    showing = false;
    techniques::PassTimer timed(device);
    frame.render(timed);
    if (request_.derivatives) frame.render_derivatives();

    RenderResult result{.request = request_,
                        .settings = plan.settings,
                        .profile = profile_,
                        .scene = {scene_.triangle_count(), scene_.meshes.size(), scene_.instances.size()},
                        .host = make_host(device),
                        .color = color_image(device.texture(frame.color())),
                        .visibility = float_image(device.texture(frame.visibility())),
                        .derivatives = {},
                        .metrics = {},
                        .passes = make_passes(timed, counted),
                        .hashes = {.visibility = hash_of(device.texture(frame.visibility())),
                                   .depth = hash_of(device.texture(frame.depth())),
                                   .color = hash_of(device.texture(frame.color())),
                                   .map = hash_of_maps(device, frame.maps())},
                        .map = map,
                        .bytes_per_texel = techniques::storage_per_texel(device, frame.maps(), plan.settings)};
    result.request.technique = plan.technique.name;
    if (request_.derivatives) {
        const auto bytes = device.texture(frame.derivatives()).level_bytes(0);
        result.derivatives.resize(bytes.size() / sizeof(std::uint32_t));
        std::memcpy(result.derivatives.data(), bytes.data(), bytes.size());
    }
    for (const PassResult& pass : result.passes) result.frame_ms += pass.milliseconds;

    if (const scenes::ReferenceImage* reference = truth(progress))
        result.metrics = measure_judged(result.visibility, *reference);
    result.truth_ms = truth_ms_;
    return result;
}

}  // namespace gnomon::studies
