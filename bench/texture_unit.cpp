// What a sample costs: Gnomon's texture unit by filter and format, beside the other GPUs of this machine at the same
// coordinates and beside the bare gathers that the same texels take. One thread, in turns.
#include "sim/denormals.h"
#include "tests/agree/adapter.h"
#include "tests/agree/generated_texture.h"
#include "tests/agree/sampling.h"
#include "texunit/aniso.h"
#include "texunit/sample.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

using namespace gnomon;

namespace {

constexpr int kSide = 512;  // pixels and texels

struct Workload {
    std::string name;
    agree::TexelFormat format = agree::TexelFormat::Rg32f;
    agree::Filter filter = agree::Filter::Linear;
    agree::Mip mip = agree::Mip::Base;
    float anisotropy = 1;
    bool compares = false;
};

std::vector<Workload> make_workloads() {
    using agree::TexelFormat;
    const auto nearest = agree::Filter::Nearest;
    const auto linear = agree::Filter::Linear;
    std::vector<Workload> list{{"rg32f nearest", TexelFormat::Rg32f, nearest}};
    for (const auto& [name, format] :
         {std::pair{"r32f", TexelFormat::R32f}, std::pair{"rg32f", TexelFormat::Rg32f}, std::pair{"rg16f", TexelFormat::Rg16f},
          std::pair{"rg16unorm", TexelFormat::Rg16Unorm}, std::pair{"rgba8", TexelFormat::Rgba8}}) {
        list.push_back({fmt::format("{} bilinear", name), format, linear});
        list.push_back({fmt::format("{} trilinear", name), format, linear, agree::Mip::Linear});
    }
    list.push_back({"rg32f aniso 16x", TexelFormat::Rg32f, linear, agree::Mip::Linear, 16});
    list.push_back({"rg16f aniso 16x", TexelFormat::Rg16f, linear, agree::Mip::Linear, 16});
    list.push_back({"d32f compare nearest", TexelFormat::D32f, nearest, agree::Mip::Base, 1, true});
    list.push_back({"d32f compare bilinear", TexelFormat::D32f, linear, agree::Mip::Base, 1, true});
    return list;
}

/// A ground plane towards the horizon in quads of pixels: ratios of anisotropy from 1 up, coordinates as a picture has them.
std::vector<agree::Point> plane_points(bool steep) {
    std::vector<agree::Point> points;
    const auto uv = [&](int x, int y) {
        const float distance = steep ? 1.0f / (0.03f + static_cast<float>(y) / 2600.0f) : 1.0f;
        const float across = (static_cast<float>(x) - kSide / 2) / kSide;
        const float along = steep ? distance * 0.3f : static_cast<float>(y) / kSide * 1.3f;
        const float u = across * (steep ? distance * 0.11f : 1.3f);
        return std::pair{u * 0.96f + along * 0.28f, along * 0.96f - u * 0.28f};  // turned a little
    };
    for (int y = 0; y < kSide; y += 2) {
        for (int x = 0; x < kSide; x += 2) {
            const auto [u, v] = uv(x, y);
            const auto [ux, vx] = uv(x + 1, y);
            const auto [uy, vy] = uv(x, y + 1);
            for (int i = 0; i < 4; ++i) {
                const auto [u_i, v_i] = uv(x + i % 2, y + i / 2);
                points.push_back(
                    {.u = u_i, .v = v_i, .dudx = ux - u, .dvdx = vx - v, .dudy = uy - u, .dvdy = vy - v, .reference = 0.5f});
            }
        }
    }
    return points;
}

/// Points as lanes load them.
struct LanePoints {
    std::vector<float> u, v, dudx, dvdx, dudy, dvdy;

    explicit LanePoints(const std::vector<agree::Point>& points) {
        for (const agree::Point& p : points) {
            u.push_back(p.u);
            v.push_back(p.v);
            dudx.push_back(p.dudx);
            dvdx.push_back(p.dvdx);
            dudy.push_back(p.dudy);
            dvdy.push_back(p.dvdy);
        }
    }
};

double seconds(const std::chrono::steady_clock::time_point& begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

class GnomonSampler {
public:
    GnomonSampler(const Workload& workload, const agree::Levels& levels, const agree::SamplerState& state,
                  const LanePoints& points, const std::string& profile)
        : compares_(workload.compares),
          texture_(agree::texture_of(levels)),
          sampler_(agree::sampler_of(state)),
          profile_(load_profile(profile)),
          points_(points) {}

    /// Seconds for every point once.
    double time() {
        const DenormalScope denormals(profile_.flush_denormals);
        const auto begin = std::chrono::steady_clock::now();
        Float sum(0.0f);
        for (std::size_t i = 0; i < points_.u.size(); i += kLanes) sum += sample_wave(i);
        total_ += lane(sum, 0);
        return seconds(begin);
    }
    SampleCost cost() {
        SampleCost cost;
        const TextureView view(texture_);
        for (std::size_t i = 0; i < points_.u.size(); i += kLanes) {
            const Vec3<Float> at{Float::load(&points_.u[i]), Float::load(&points_.v[i]), Float(0.0f)};
            const SampleCost wave = sample_cost(view, sampler_, profile_, at, lod(i), {}, kAllLanes);
            cost.probes += wave.probes;
            cost.texels += wave.texels;
        }
        return cost;
    }

private:
    LevelOfDetail<Float> lod(std::size_t i) const {
        if (sampler_.mip == MipFilter::Base) return LevelOfDetail<Float>(Float(0.0f));
        const Gradients<Float> gradients{{Float::load(&points_.dudx[i]), Float::load(&points_.dvdx[i])},
                                         {Float::load(&points_.dudy[i]), Float::load(&points_.dvdy[i])}};
        return level_of_detail(gradients, TextureView(texture_), sampler_, profile_);
    }
    Float sample_wave(std::size_t i) const {
        const Vec2<Float> uv{Float::load(&points_.u[i]), Float::load(&points_.v[i])};
        const TextureView view(texture_);
        if (compares_) return sample_compare(view, sampler_, profile_, uv, Float(0.5f), lod(i));
        const Vec4<Float> color = sample(view, sampler_, profile_, uv, lod(i));
        return color.x + color.y;
    }

    bool compares_;
    Texture texture_;
    Sampler sampler_;
    Profile profile_;
    const LanePoints& points_;
    float total_ = 0;
};

/// The bare gathers of a bilinear sample, four pairs of words per lane at the very texels, nothing else: what the load ports
/// and the caches allow.
double time_gathers(const LanePoints& points) {
    static const Texture texture({.format = Format::Rg32Float, .width = kSide, .height = kSide});
    std::vector<std::int32_t> offsets(points.u.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const auto texel = [](float c) { return static_cast<std::int32_t>((c - std::floor(c)) * (kSide - 2)); };
        offsets[i] = (texel(points.v[i]) * kSide + texel(points.u[i])) * 8;
    }
    const auto begin = std::chrono::steady_clock::now();
    Int sum(0);
    for (std::size_t i = 0; i < offsets.size(); i += kLanes) {
        const Int offset = Int::load(&offsets[i]);
        for (const int tap : {0, 8, kSide * 8, kSide * 8 + 8}) {
            const IntPair pair = gather_pairs(texture.data() + tap, offset);
            sum = (sum ^ pair.first) + pair.second;
        }
    }
    const double elapsed = seconds(begin);
    return lane(sum, 0) == 1 ? elapsed + 1e-12 : elapsed;
}

struct Options {
    int rounds = 9;
    std::string profile = "d3d11";
};

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Nanoseconds per sample of Gnomon's texture unit and of the other GPUs on this machine, one thread.");
    app.add_option("--rounds", options.rounds, "turns each contender gets")->capture_default_str()->check(CLI::Range(1, 1000));
    app.add_option("--profile", options.profile, "Gnomon's profile")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    peer::limit_threads(1);
    peer::expose_drivers();
    std::vector<agree::SamplingPeer> peers;
    for (const peer::PeerDevice& device : peer::list_devices()) {
        if (device.unusable.empty()) peers.emplace_back(device);
    }

    const std::vector<agree::Point> flat = plane_points(false);
    const std::vector<agree::Point> steep = plane_points(true);
    const auto count = static_cast<double>(flat.size());
    fmt::print("{} points in quads of pixels, {}x{} texels, 1 thread, Gnomon with {} lanes and profile {}\n", flat.size(),
               kSide, kSide, kLanes, options.profile);
    fmt::print(
        "ns per sample; a peer's figure is sampling less reading the points, which overlap, so the true cost is above it\n\n");
    fmt::print("{:<24} {:>8} {:>9} {:>9} {:>9}", "filter", "Gnomon", "per probe", "gathers", "probes");
    for (const auto& peer : peers) fmt::print(" {:>16}", peer.description().name.substr(0, 16));
    fmt::print("\n");
    for (const Workload& workload : make_workloads()) {
        const std::vector<agree::Point>& points = workload.anisotropy > 1 ? steep : flat;
        const LanePoints lanes(points);
        const int levels = workload.mip == agree::Mip::Base ? 1 : agree::full_levels(kSide, kSide);
        const agree::Levels texture = agree::random_levels(workload.format, kSide, kSide, levels, 1);
        agree::SamplerState state{.min = workload.filter, .mag = workload.filter, .mip = workload.mip};
        state.max_anisotropy = workload.anisotropy;
        if (workload.compares) state.compare = agree::Compare::LessEqual;
        const auto instruction = workload.mip == agree::Mip::Base ? agree::Instruction::Lod : agree::Instruction::Gradient;

        GnomonSampler own(workload, texture, state, lanes, options.profile);
        const SampleCost cost = own.cost();
        std::vector<double> own_times;
        std::vector<double> gather_times;
        std::vector<std::vector<double>> peer_times(peers.size());
        (void)own.time();
        for (int round = 0; round < options.rounds; ++round) {
            own_times.push_back(own.time());
            gather_times.push_back(time_gathers(lanes));
            for (std::size_t p = 0; p < peers.size(); ++p)
                if (peers[p].supports(texture, state))
                    peer_times[p].push_back(peers[p].nanoseconds_per_sample(texture, state, instruction, points, 1));
        }
        const double ns = median(own_times) * 1e9 / count;
        const double bilinear_probes =
            static_cast<double>(cost.texels) / (workload.filter == agree::Filter::Linear ? 4.0 : 1.0);
        fmt::print("{:<24} {:>8.2f} {:>9.2f} {:>9.2f} {:>9.2f}", workload.name, ns, ns * count / bilinear_probes,
                   median(gather_times) * 1e9 / count, static_cast<double>(cost.probes) / count);
        for (const auto& times : peer_times) fmt::print(" {:>16}", times.empty() ? "-" : fmt::format("{:.2f}", median(times)));
        fmt::print("\n");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "gnomon_bench_texture_unit: {}\n", error.what());
        return 2;
    }
}
