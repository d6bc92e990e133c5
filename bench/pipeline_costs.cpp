// What each feature of the pipeline costs on Gnomon: the same scene drawn plainly and with one thing more, in turns. The issue
// of "model only what a scene requires": what is not asked for should cost nothing.
#include "bench/pass_cases.h"
#include "pipeline/device.h"
#include "scenes/procedural.h"
#include "sim/profile.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <utility>

using namespace gnomon;

namespace {

constexpr TextureId kPicture{1};  // every device makes it first

template <class Real>
struct RawInput {
    Vec3<Real> position;
    Vec2<Real> uv;
};

template <class Real, std::size_t kCount>
struct Values {
    std::array<Real, kCount> at;
};

/// kCount varyings: the coordinates, and sums of them.
template <std::size_t kCount>
struct WideVertex {
    template <class Real>
    using Input = RawInput<Real>;
    template <class Real>
    using Varyings = Values<Real, kCount>;

    glm::mat4 clip_from_mesh{1.0f};

    static constexpr auto fields() { return std::tuple{Field{"clip_from_mesh", &WideVertex::clip_from_mesh}}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        Values<Real, kCount> values;
        for (std::size_t i = 0; i < kCount; ++i)
            values.at[i] = i % 2 == 0 ? v.in.uv.x + Real(static_cast<float>(i)) : v.in.uv.y;
        return VertexOutput{transform_point(clip_from_mesh, v.in.position), values};
    }
};
template <>
struct WideVertex<0> {
    template <class Real>
    using Input = RawInput<Real>;
    template <class Real>
    using Varyings = NoVaryings<Real>;

    glm::mat4 clip_from_mesh{1.0f};

    static constexpr auto fields() { return std::tuple{Field{"clip_from_mesh", &WideVertex::clip_from_mesh}}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{transform_point(clip_from_mesh, v.in.position), NoVaryings<typename V::Real>{}};
    }
};

/// The sum of its varyings, in kTargets colours.
template <std::size_t kCount, std::size_t kTargets = 1>
struct SumPixel {
    float scale = 0.125f;

    static constexpr auto fields() { return std::tuple{Field{"scale", &SumPixel::scale}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        Real sum(scale);
        if constexpr (kCount > 0)
            for (std::size_t i = 0; i < kCount; ++i) sum = sum + f.in.at[i] * Real(scale);
        std::array<Vec4<Real>, kTargets> colors;
        for (auto& color : colors) color = {sum, Real(scale), sum, Real(0.5f)};
        return colors;
    }
};

/// The same, for every sample.
struct PerSamplePixel : SumPixel<2> {
    static constexpr bool per_sample = true;

    template <class F>
    auto operator()(const F& f) const {
        return SumPixel<2>::operator()(f);
    }
};

/// The same, discarding nothing that the scene shows.
struct DiscardPixel : SumPixel<2> {
    static constexpr bool discards = true;

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        f.discard(f.in.at[0] < Real(-1e6f));
        return SumPixel<2>::operator()(f);
    }
};

/// The same, with the depth that it has anyway.
struct DepthPixel : SumPixel<2> {
    template <class F>
    auto operator()(const F& f) const {
        return DepthOutput{SumPixel<2>::operator()(f), f.position.z};
    }
};

struct TexturedPixel {
    TextureId texture = kPicture;
    Sampler sampler{};

    static constexpr auto fields() {
        return std::tuple{Field{"texture", &TexturedPixel::texture}, Field{"sampler", &TexturedPixel::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        return f.sample(texture, sampler, {f.in.at[0], f.in.at[1]});
    }
};

template <class Functor>
std::vector<std::byte> bytes_of(const Functor& functor) {
    const auto bytes = constants_of(functor);
    return {bytes.begin(), bytes.end()};
}

/// One way of drawing the scene.
struct Way {
    std::string name;
    const Program* program = nullptr;
    std::vector<std::byte> pixel_constants{};
    int samples = 1;
    Format depth = Format::D32Float;
    BlendState blend{};
    StencilState stencil{};
    bool counts = false;
    bool reports_derivatives = false;
    std::string profile = "d3d11";
};
/// The first is what the others are compared with.
struct Group {
    std::string name;
    std::vector<Way> ways;
};

template <std::size_t kVaryings, class Pixel>
Way way(const std::string& name, const Pixel& pixel) {
    static const Program program = make_program<WideVertex<kVaryings>, Pixel>("bench.cost");
    return {.name = name, .program = &program, .pixel_constants = bytes_of(pixel)};
}
Way plain(const std::string& name = "plain") { return way<2>(name, SumPixel<2>{}); }

Way textured(const std::string& name, const Sampler& how) {
    Sampler sampler = how;
    sampler.address_u = sampler.address_v = AddressMode::Wrap;
    return way<2>(name, TexturedPixel{.sampler = sampler});
}

Way with(Way way, const auto& change) {
    change(way);
    return way;
}

Group sample_group() {
    Group group{"samples", {}};
    for (const int samples : {1, 2, 4, 8, 16})
        group.ways.push_back(with(plain(fmt::format("{}", samples)), [&](Way& w) { w.samples = samples; }));
    group.ways.push_back(with(way<2>("4, functor per sample", PerSamplePixel{}), [](Way& w) { w.samples = 4; }));
    return group;
}

Group target_group() {
    return {"targets",
            {way<2>("1", SumPixel<2, 1>{}), way<2>("2", SumPixel<2, 2>{}), way<2>("4", SumPixel<2, 4>{}),
             way<2>("8", SumPixel<2, 8>{})}};
}

Group varying_group() {
    return {
        "varyings",
        {way<0>("0", SumPixel<0>{}), way<4>("4", SumPixel<4>{}), way<8>("8", SumPixel<8>{}), way<16>("16", SumPixel<16>{})}};
}

Group texture_group() {
    Group group{"texture", {plain("none")}};
    group.ways.push_back(textured("nearest", {.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest}));
    group.ways.push_back(textured("bilinear", {}));
    group.ways.push_back(textured("trilinear", {.mip = MipFilter::Linear}));
    return group;
}

Group anisotropy_group() {
    Group group{"anisotropy", {}};
    for (const int most : {1, 2, 4, 8, 16})
        group.ways.push_back(textured(fmt::format("{}", most), {.mip = MipFilter::Linear, .max_anisotropy = most}));
    return group;
}

Group output_group() {
    const auto blended = [](BlendFactor src, BlendFactor dst) {
        return [src, dst](Way& w) { w.blend = {.enable = true, .src = src, .dst = dst, .src_alpha = src, .dst_alpha = dst}; };
    };
    const StencilFace count{.pass = StencilOp::IncrementSaturate};
    return {"output merger",
            {plain(), with(plain("blend, add"), blended(BlendFactor::One, BlendFactor::One)),
             with(plain("blend, over"), blended(BlendFactor::SrcAlpha, BlendFactor::InvSrcAlpha)),
             with(plain("two channels written"), [](Way& w) { w.blend.write_mask = 3; }),
             with(plain("depth and stencil format"), [](Way& w) { w.depth = Format::D32FloatS8; }),
             with(plain("stencil test and count"),
                  [&](Way& w) {
                      w.depth = Format::D32FloatS8;
                      w.stencil = {.test = true, .front = count, .back = count};
                  }),
             with(plain("d16 instead of d32f"), [](Way& w) { w.depth = Format::D16; }), way<2>("may discard", DiscardPixel{}),
             way<2>("writes depth (late test)", DepthPixel{})}};
}

Group watch_group() {
    const Sampler trilinear{.mip = MipFilter::Linear};
    return {"watching (trilinear)",
            {textured("nothing", trilinear), with(textured("counters", trilinear), [](Way& w) { w.counts = true; }),
             with(textured("derivative report", trilinear), [](Way& w) { w.reports_derivatives = true; })}};
}

Group arithmetic_group() {
    const auto ideal = [](Way& w) { w.profile = "ideal"; };
    return {"arithmetic", {plain(), with(plain("fp64"), ideal)}};
}

struct Options {
    std::string scene = "car";
    int width = 1024;
    int height = 768;
    int threads = 2;
    int rounds = 15;
    std::string only;
};

/// One way on a device of its own.
class CostPass {
public:
    CostPass(const Way& way, const peer::RawMesh& mesh, const Options& options)
        : way_(way),
          vertex_{.clip_from_mesh = mesh.clip_from_mesh},
          device_(std::make_unique<Device>(load_profile(way.profile), options.threads)),
          corners_(static_cast<std::uint32_t>(mesh.indices.size())) {
        make_picture();
        vertices_ = device_->create_buffer("vertices", std::as_bytes(std::span(mesh.vertices)));
        indices_ = device_->create_buffer("indices", std::as_bytes(std::span(mesh.indices)));
        const auto target = [&](std::string_view label, Format format, int samples) {
            return device_->create_texture(
                label, {.format = format, .width = options.width, .height = options.height, .samples = samples});
        };
        depth_ = target("depth", way.depth, way.samples);
        for (int i = 0; i < way.program->targets(); ++i) color_.push_back(target("color", Format::Rgba8Unorm, way.samples));
        if (way.samples > 1) resolved_ = target("resolved", Format::Rgba8Unorm, 1);
        if (way.reports_derivatives) report_ = target("report", Format::R32Uint, 1);
        device_->enable_counters(way.counts);
    }

    void run() {
        device_->execute(ClearDepth{depth_, 1.0f});
        for (const TextureId color : color_) device_->execute(ClearColor{color, glm::vec4(0.0f)});
        Draw draw{.label = "cost",
                  .program = way_.program,
                  .vertex_constants = constants_of(vertex_),
                  .pixel_constants = way_.pixel_constants,
                  .vertices = vertices_,
                  .indices = indices_,
                  .count = corners_,
                  .stencil = way_.stencil,
                  .depth = depth_,
                  .derivative_report = report_};
        for (std::size_t i = 0; i < color_.size(); ++i) {
            draw.color[i] = color_[i];
            draw.output.blend[i] = way_.blend;
        }
        device_->execute(draw);
        if (resolved_ != TextureId::None) device_->execute(Resolve{color_.front(), resolved_});
    }

private:
    void make_picture() {
        const int levels = full_level_count(peer::kRawTextureSize, peer::kRawTextureSize);
        const TextureId picture = device_->create_texture(
            "picture",
            {.format = Format::Rgba8Unorm, .width = peer::kRawTextureSize, .height = peer::kRawTextureSize, .levels = levels});
        GNOMON_CHECK_EQ(static_cast<int>(picture), static_cast<int>(kPicture));
        for (int level = 0; level < levels; ++level) {
            const auto texels = peer::raw_texels(level);
            device_->execute(WriteTexture{.id = picture, .level = level, .data = std::as_bytes(std::span(texels))});
        }
    }

    Way way_;
    WideVertex<0> vertex_;  // all of them hold one matrix
    std::unique_ptr<Device> device_;
    std::uint32_t corners_;
    BufferId vertices_ = BufferId::None;
    BufferId indices_ = BufferId::None;
    TextureId depth_ = TextureId::None;
    std::vector<TextureId> color_;
    TextureId resolved_ = TextureId::None;
    TextureId report_ = TextureId::None;
};

/// Processor time of all threads so far, ms.
double cpu_ms() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

void compare(const Group& group, const peer::RawMesh& mesh, const Options& options) {
    struct Timed {
        CostPass pass;
        std::vector<double> times{};
        std::vector<double> cpu_times{};
    };
    std::vector<Timed> timed;
    timed.reserve(group.ways.size());
    for (const Way& way : group.ways) timed.push_back({CostPass(way, mesh, options)});
    for (int round = -1; round < options.rounds; ++round) {
        for (Timed& t : timed) {
            const double cpu_begin = cpu_ms();
            const auto begin = std::chrono::steady_clock::now();
            t.pass.run();
            const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
            if (round < 0) continue;  // warms up
            t.times.push_back(elapsed.count());
            t.cpu_times.push_back(cpu_ms() - cpu_begin);
        }
    }
    const auto cpu = [](const Timed& t) { return peer::summarize(t.cpu_times).median_ms; };
    for (std::size_t i = 0; i < timed.size(); ++i) {
        fmt::print("{:<22} {:<26} {:9.3f} {:9.3f} {:9.2f}\n", group.name, group.ways[i].name,
                   peer::summarize(timed[i].times).median_ms, cpu(timed[i]), cpu(timed[i]) / cpu(timed.front()));
    }
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("What each feature of the pipeline costs, as a ratio to the same pass without it.");
    app.add_option("--scene", options.scene, "procedural scene")->capture_default_str();
    app.add_option("--width", options.width, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--height", options.height, "pixels")->capture_default_str()->check(CLI::Range(1, kMaxTextureSize));
    app.add_option("--threads", options.threads, "threads")->capture_default_str()->check(CLI::Range(1, 256));
    app.add_option("--rounds", options.rounds, "turns of each way")->capture_default_str()->check(CLI::Range(1, 1000));
    app.add_option("--only", options.only, "groups whose names contain this");
    CLI11_PARSE(app, argc, argv);

    peer::limit_threads(options.threads);
    const auto sources = scenes::procedural_scenes();
    const auto source = std::ranges::find(sources, options.scene, &scenes::ProceduralScene::name);
    if (source == sources.end()) fail("--scene {}: no such scene", options.scene);
    const scenes::Scene scene = source->make();
    const peer::RawMesh mesh = bench::scene_mesh(scene, options.width, options.height);

    fmt::print("{} ({} triangles), {}x{} pixels, {} threads, {} lanes\n\n", options.scene, scene.triangle_count(),
               options.width, options.height, options.threads, kLanes);
    fmt::print("{:<22} {:<26} {:>9} {:>9} {:>9}\n", "feature", "way", "median", "cpu", "cpu ratio");
    for (const Group& group : {sample_group(), target_group(), varying_group(), texture_group(), anisotropy_group(),
                               output_group(), watch_group(), arithmetic_group()})
        if (group.name.find(options.only) != std::string::npos) compare(group, mesh, options);
    fmt::print("\nmedians in ms; cpu is the processor time of all threads, the ratio is to the first way of the group\n");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_bench_pipeline_costs: {}\n", error.what());
        return 2;
    }
}
