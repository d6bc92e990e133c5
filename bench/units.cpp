// Single units with Google Benchmark: the texture unit per lane, conversions per value, the rasteriser per pixel.
#include "pipeline/program.h"
#include "sim/half.h"
#include "sim/math.h"
#include "techniques/common/gaussian.h"
#include "texunit/aniso.h"
#include "texunit/mipmap.h"
#include "texunit/sample.h"

#include <benchmark/benchmark.h>

using namespace gnomon;

namespace {

/// A texture of harmless numbers: all bytes below 0x3c, so that every format reads finite values.
Texture make_texture(Format format, int size) {
    Texture texture({.format = format, .width = size, .height = size, .levels = full_level_count(size, size)});
    std::uint32_t state = 1;
    for (int level = 0; level < texture.desc().levels; ++level) {
        auto bytes = texture.level_bytes(level);
        for (std::byte& byte : bytes) byte = static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 27);
        texture.set_level_bytes(level, bytes.data(), bytes.size());
    }
    return texture;
}

/// One sample instruction per wave over coherent coordinates; the rate is lanes per second.
void sample_texture(benchmark::State& state, Format format, MipFilter mip, bool compare) {
    const Texture texture = make_texture(format, 512);
    const TextureView view(texture);
    const Sampler sampler{.mip = mip, .address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap};
    const Profile profile = profile_presets().front();
    float origin = 0;
    Float sum(0.0f);
    for (auto _ : state) {
        origin += 1.0f / 640.0f;
        const Vec2<Float> uv{Float(origin) + Float(lane_index()) * Float(1.0f / 700.0f), Float(origin * 0.7f)};
        LevelOfDetail<Float> lod(Float(0.0f));
        if (mip != MipFilter::Base) {
            lod = level_of_detail(quad_gradients(uv, profile), view, sampler, profile);
            lod.lod = lod.lod + Float(0.5f);
        }
        sum +=
            compare ? sample_compare(view, sampler, profile, uv, Float(0.5f), lod) : sample(view, sampler, profile, uv, lod).x;
    }
    benchmark::DoNotOptimize(lane(sum, 0));
    state.SetItemsProcessed(state.iterations() * kLanes);
}
BENCHMARK_CAPTURE(sample_texture, rg32f_bilinear, Format::Rg32Float, MipFilter::Base, false);
BENCHMARK_CAPTURE(sample_texture, rg32f_trilinear, Format::Rg32Float, MipFilter::Linear, false);
BENCHMARK_CAPTURE(sample_texture, rg16f_trilinear, Format::Rg16Float, MipFilter::Linear, false);
BENCHMARK_CAPTURE(sample_texture, rg16unorm_trilinear, Format::Rg16Unorm, MipFilter::Linear, false);
BENCHMARK_CAPTURE(sample_texture, rgba8unorm_trilinear, Format::Rgba8Unorm, MipFilter::Linear, false);
BENCHMARK_CAPTURE(sample_texture, d32f_compare_bilinear, Format::D32Float, MipFilter::Base, true);

template <class Function>
void run_function(benchmark::State& state, const Function& function) {
    Float x(1.1f);
    Float sum(0.0f);
    for (auto _ : state) {
        sum += function(x);
        x += Float(1e-6f);
    }
    benchmark::DoNotOptimize(lane(sum, 0));
    state.SetItemsProcessed(state.iterations() * kLanes);
}
void float_exp2(benchmark::State& state) {
    run_function(state, [](Float x) { return exp2(x); });
}
BENCHMARK(float_exp2);
void float_log2(benchmark::State& state) {
    run_function(state, [](Float x) { return log2(x); });
}
BENCHMARK(float_log2);
void float_half_float(benchmark::State& state) {
    run_function(state, [](Float x) { return float_from_half_bits(half_bits_from_float(x, Narrowing::TowardZero)); });
}
BENCHMARK(float_half_float);

void mip_chain(benchmark::State& state, Format format) {
    Texture texture = make_texture(format, 512);
    Workers workers(1);
    for (auto _ : state) generate_mips(texture, profile_presets().front(), workers);
    state.SetItemsProcessed(state.iterations() * 512 * 512);
}
BENCHMARK_CAPTURE(mip_chain, rg32f, Format::Rg32Float);
BENCHMARK_CAPTURE(mip_chain, rg16f, Format::Rg16Float);

/// Depth-only triangles of about `range(0)` pixels a side over a 1024x1024 target; the rate is covered pixels per second.
void fill_depth(benchmark::State& state) {
    static const Program program = make_program<techniques::FullScreenVertex>("bench.depth");
    Device device(profile_presets().front(), 1);
    const TextureId depth = device.create_texture("depth", {.format = Format::D32Float, .width = 1024, .height = 1024});
    const int side = static_cast<int>(state.range(0));
    const float step = 2.0f * static_cast<float>(side) / 1024.0f;
    std::vector<float> corners;
    for (int y = 0; y < 1024 / side; ++y) {
        for (int x = 0; x < 1024 / side; ++x) {
            const float left = -1.0f + static_cast<float>(x) * step;
            const float top = 1.0f - static_cast<float>(y) * step;
            corners.insert(corners.end(), {left, top, left + step, top, left, top - step});
            corners.insert(corners.end(), {left + step, top, left + step, top - step, left, top - step});
        }
    }
    const BufferId vertices = device.create_buffer("triangles", std::as_bytes(std::span(corners)));
    const techniques::FullScreenVertex vertex{.depth = 0.5f};
    for (auto _ : state) {
        device.execute(Draw{.label = "fill",
                            .program = &program,
                            .vertex_constants = constants_of(vertex),
                            .vertices = vertices,
                            .count = static_cast<std::uint32_t>(corners.size() / 2),
                            .depth_state = {.compare = CompareOp::Always},
                            .depth = depth});
    }
    state.SetItemsProcessed(state.iterations() * 1024 * 1024);
}
BENCHMARK(fill_depth)->Arg(4)->Arg(16)->Arg(64)->Arg(1024)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
