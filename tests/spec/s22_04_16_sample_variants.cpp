// D3D11.3 22.4.16, 22.4.17, 22.4.18, 22.4.20: bias per lane, the shader's own derivatives, its own level, comparison at level
// 0.
#include "tests/oracle/random.h"
#include "texunit/aniso.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;

namespace {

/// Levels 0 to 6 of 64x64 texels, each filled with its number.
Texture numbered(Format format) {
    Texture texture({.format = format, .width = 64, .height = 64, .levels = 7});
    for (int level = 0; level < 7; ++level) {
        const int side = texture.width(level);
        const std::vector<float> values(static_cast<std::size_t>(side * side), static_cast<float>(level) / 8.0f);
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

constexpr double kStep = 1.0 / 256;  // of the level of detail, D3D11.3 7.18.10

}  // namespace

TEST_CASE("the bias of the instruction is added lane by lane, before the clamp", "[22.4.16]") {
    const Texture texture = numbered(Format::R32Float);
    const Sampler sampler{.mip = MipFilter::Linear, .lod_bias = 0.5f, .min_lod = 0.75f, .max_lod = 5.0f};
    std::vector<SampleRequest> requests;
    for (int i = 0; i < 200; ++i) {
        SampleRequest request{.coordinate = {0.4, 0.6, 0}, .lod_bias = -4.0 + 0.05 * i};
        request.gradient = SampleGradient{.dx = {4.0 / 64, 0, 0}, .dy = {0, 1.0 / 64, 0}};  // level 2
        requests.push_back(request);
    }
    const auto results = sample_all(texture, sampler, load_profile("d3d11"), requests);
    double least = 10;
    double most = -10;
    for (std::size_t i = 0; i < results.size(); ++i) {
        const double expected = std::fmax(0.75, std::fmin(5.0, 2.0 + 0.5 + requests[i].lod_bias));
        const double got = results[i].color[0] * 8;
        INFO("bias " << requests[i].lod_bias << ": level " << got << ", expected " << expected);
        CHECK(std::fabs(got - expected) <= 0.5 * kStep + 1e-6);
        CHECK(results[i].lod == 2.0);  // before bias and clamp
        least = std::fmin(least, got);
        most = std::fmax(most, got);
    }
    CHECK(least == 0.75);
    CHECK(most == 5.0);
}

TEST_CASE("derivatives of the shader decide each lane's level alone", "[22.4.17]") {
    const Texture texture = numbered(Format::R32Float);
    const Sampler sampler{.mip = MipFilter::Linear};
    oracle::Random random(22);
    std::vector<SampleRequest> requests;
    for (int i = 0; i < 500; ++i) {
        SampleRequest request{.coordinate = {random.in(0.0f, 1.0f), random.in(0.0f, 1.0f), 0}};
        const auto texels = [&] { return static_cast<double>(std::ldexp(random.in(-1.0f, 1.0f), random.integer(0, 5))) / 64; };
        request.gradient = SampleGradient{.dx = {texels(), texels(), 0}, .dy = {texels(), texels(), 0}};
        requests.push_back(request);
    }
    const auto results = sample_all(texture, sampler, load_profile("d3d11"), requests);
    for (std::size_t i = 0; i < results.size(); ++i) {
        const auto& [dx, dy] = *requests[i].gradient;
        const double lod = std::log2(64 * std::fmax(std::hypot(dx[0], dx[1]), std::hypot(dy[0], dy[1])));
        const double expected = std::fmax(0.0, std::fmin(6.0, lod));
        INFO(fmt::format("request {}: {:a}", i, results[i].color[0]));
        CHECK(std::fabs(results[i].color[0] * 8 - expected) <= 0.5 * kStep + 1e-5);
    }
}

TEST_CASE("a level of the shader is isotropic whatever the sampler's anisotropy", "[22.4.18]") {
    const Texture texture = numbered(Format::R32Float);
    const Sampler anisotropic{.mip = MipFilter::Linear, .max_anisotropy = 16};
    for (const Profile& profile : profile_presets()) {
        if (!profile.filters_float32 || profile.address_arithmetic != AddressArithmetic::FixedPoint) continue;
        INFO(profile.name);
        for (const double lod : {-3.0, 0.0, 0.25, 1.0, 2.5, 6.0, 9.0}) {
            const SampleRecord record = record_sample(texture, anisotropic, profile, {.coordinate = {0.3, 0.3, 0}, .lod = lod});
            CHECK(record.probes.size() == 1);
            CHECK(record.ratio == 1.0);
            CHECK(record.magnified == (lod <= 0));
            CHECK(record.result[0] == std::fmax(0.0, std::fmin(6.0, lod)) / 8);
        }
    }
}

TEST_CASE("comparison at level zero takes bias and clamps of the sampler", "[22.4.20][7.18.3]") {
    const Texture texture = numbered(Format::D32Float);
    Sampler sampler{.mip = MipFilter::Nearest, .compare = CompareOp::Equal};
    const auto level_is = [&](double level) {
        return sample_all(texture, sampler, load_profile("d3d11"),
                          std::vector{SampleRequest{.coordinate = {0.5, 0.5, 0}, .reference = level / 8}})[0]
                   .color[0] == 1.0;
    };
    CHECK(level_is(0));
    CHECK_FALSE(level_is(1));
    sampler.lod_bias = 2.0f;
    CHECK(level_is(2));
    sampler.min_lod = 3.0f;
    CHECK(level_is(3));
    sampler.max_lod = 1.0f;  // min_lod takes precedence. D3D11.3 7.18.11
    CHECK(level_is(3));
}

TEST_CASE("a format that is not filtered has no anisotropy, in shaders as in records", "[22.4.15][7.18.11]") {
    const Profile nv40 = load_profile("nv40");
    const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = 16};
    const Gradients<Float> gradients{{Float(8.0f / 64), Float(0.0f)}, {Float(0.0f), Float(1.0f / 64)}};
    const Texture floats = numbered(Format::R32Float);
    const Texture halfs({.format = Format::R16Float, .width = 64, .height = 64, .levels = 7});
    CHECK_FALSE(level_of_detail(gradients, TextureView(floats), sampler, nv40).anisotropic);
    CHECK(level_of_detail(gradients, TextureView(halfs), sampler, nv40).anisotropic);
    CHECK(level_of_detail(gradients, TextureView(floats), sampler, load_profile("g80")).anisotropic);
}
