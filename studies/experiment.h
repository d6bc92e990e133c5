// One scene under one camera, rendered by one technique or all of them, and measured against ray-traced truth. No files.
#pragma once

#include "scenes/gltf.h"
#include "scenes/reference.h"
#include "sim/profile.h"
#include "sim/progress.h"
#include "studies/images.h"
#include "studies/map_statistics.h"
#include "studies/metrics.h"
#include "techniques/frame.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::studies {

/// What a shadow is compared with.
enum class Truth {
    None,
    Center,  // one ray per pixel centre
    Area,    // many rays over the pixel footprint
};

}  // namespace gnomon::studies

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<studies::Truth>{
    EnumName{studies::Truth::None, "none"}, EnumName{studies::Truth::Center, "center"}, EnumName{studies::Truth::Area, "area"}};
}  // namespace gnomon

namespace gnomon::studies {

/// What a user asks for. Names are checked when the Experiment is made.
struct RenderRequest {
    std::string scene = "car";           // a built-in scene by name, or a glTF file
    scenes::GltfOptions file_options{};  // for files: a ground plane, a view chosen anew
    std::string technique = "vsm";       // or "all"
    techniques::TechniqueRequest choices;
    int width = 1024;  // pixels, 1 to kMaxTextureSize
    int height = 768;
    std::string profile = "d3d11";  // a preset by name, or a JSON file
    Truth truth = Truth::Center;
    std::uint64_t seed = 1;    // of the rays in Truth::Area
    int threads = 0;           // 0: all processors; changes no result
    bool derivatives = false;  // whether to render the picture of derivatives too; changes no other result
};

/// One technique with all its choices made.
struct PlannedRun {
    techniques::Technique technique;
    techniques::TechniqueSettings settings;
};

struct PassResult {
    std::string name;  // each name once
    double milliseconds = 0;
    Counters counters;
    std::vector<ResourceTraffic> traffic;  // in the order of creation, textures first; only what the pass touched
};

/// xxh3-128 of the raw bytes of level 0, as 32 hexadecimal digits.
struct Hashes {
    std::string visibility;
    std::string depth;
    std::string color;
    std::string map;  // the textures that receivers sample, one after the other
};

/// Where it ran: nothing here may change a result.
struct Host {
    int threads = 0;
    int lanes = 0;       // pixels per wave
    std::string target;  // instruction set
    std::string compiler;
};

struct SceneSize {
    std::size_t triangles = 0;
    std::size_t meshes = 0;
    std::size_t instances = 0;
};

struct RenderResult {
    RenderRequest request;  // technique is the one that ran
    techniques::TechniqueSettings settings;
    Profile profile;
    SceneSize scene;
    Host host;
    ByteImage color;
    FloatImage visibility;                   // techniques::Frame::kNoSurface where nothing was drawn
    std::vector<std::uint32_t> derivatives;  // DerivativeCause bits per pixel, row by row; empty unless asked for
    std::optional<Metrics> metrics;
    std::vector<PassResult> passes;
    double frame_ms = 0;  // sum over the passes
    double truth_ms = 0;  // ray tracing; shared by all techniques of an experiment
    Hashes hashes;
    MapStatistics map;
    double bytes_per_texel = 0;  // of the map: techniques::storage_per_texel
};

class Experiment {
public:
    /// Loads scene and profile, settles every choice, and makes sure that the textures can be had. Throws Error.
    ///
    /// With technique "all", a choice that one technique does not offer leaves that technique's default; a choice that no
    /// technique offers is an error.
    explicit Experiment(const RenderRequest& request);

    [[nodiscard]] std::span<const PlannedRun> runs() const { return runs_; }
    [[nodiscard]] const scenes::Scene& scene() const { return scene_; }
    [[nodiscard]] const Profile& profile() const { return profile_; }

    /// The truth, traced once; null with Truth::None. Throws Stopped through `progress`.
    const scenes::ReferenceImage* truth(const Progress& progress);

    /// The truth as another camera sees it, traced anew; not with Truth::None. Throws Stopped through `progress`.
    [[nodiscard]] scenes::ReferenceImage trace(const scenes::View& camera, const Progress& progress) const;

    /// Renders and measures. `on_command` sees the commands that create the resources and then those of one frame. Throws
    /// Stopped through `progress`, at the latest before the next command of the device.
    RenderResult run(const PlannedRun& plan, const Progress& progress,
                     const std::function<void(const Command&)>& on_command = {});

private:
    RenderRequest request_;
    Profile profile_;
    scenes::Scene scene_;
    std::vector<PlannedRun> runs_;
    std::optional<scenes::ReferenceImage> truth_;
    double truth_ms_ = 0;
};

/// The built-in scene of this name, or the glTF file at this path. Throws Error that lists the names.
scenes::Scene find_scene(const std::string& name_or_path, const scenes::GltfOptions& options);

/// The techniques that a request means, with their settings for a machine. Throws Error as Experiment does.
std::vector<PlannedRun> plan_runs(const RenderRequest& request, const Profile& profile);

}  // namespace gnomon::studies
