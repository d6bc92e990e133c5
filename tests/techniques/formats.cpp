// What formats, depth metrics, filters and resolves make of a frame. [Donnelly06] 5.3; [Lauritzen08] 3.4, 4.1.3
#include "pipeline/program.h"
#include "techniques/common/depth_map.h"
#include "techniques/common/filtered_map.h"
#include "techniques/common/light_bleeding.h"
#include "tests/oracle/random.h"
#include "tests/techniques/frames.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

/// What the pixels that `truth` has in full light lack of it, on average; and what those that it has in full shadow show.
struct Errors {
    double missing = 0;
    double leaked = 0;
    std::size_t lit = 0;
    std::size_t dark = 0;
};

Errors errors_of(const std::vector<float>& visibility, const std::vector<float>& truth) {
    Errors errors;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        REQUIRE((visibility[i] == Frame::kNoSurface) == (truth[i] == Frame::kNoSurface));
        if (truth[i] == 1.0f) {
            ++errors.lit;
            errors.missing += 1.0 - static_cast<double>(visibility[i]);
        }
        if (truth[i] == 0.0f) {
            ++errors.dark;
            errors.leaked += static_cast<double>(visibility[i]);
        }
    }
    REQUIRE(errors.lit > 1000);
    REQUIRE(errors.dark > 300);
    errors.missing /= static_cast<double>(errors.lit);
    errors.leaked /= static_cast<double>(errors.dark);
    return errors;
}

/// Comparisons over four texels, far enough from the surfaces that these do not shadow themselves.
std::vector<float> compared(std::string_view scene, int map_size = 256) {
    return shoot("pcf-bilinear", {.map_size = map_size, .slope_bias = 6.0f, .set = {{"taps", "2"}}}, {.scene = scene})
        .visibility;
}

}  // namespace

namespace {

/// vsm under a bilinear filter.
struct Vsm {
    Format format = Format::Rg32Float;
    const char* min_variance = "0";
    const char* depth = "plane";
    const char* profile = "d3d11";
};

Errors errors_of(const Vsm& vsm, std::string_view scene, const std::vector<float>& truth) {
    const TechniqueRequest request{.map_size = 256,
                                   .format = vsm.format,
                                   .filter = MapFilter::Bilinear,
                                   .set = {{"min-variance", vsm.min_variance}, {"depth", vsm.depth}}};
    return errors_of(shoot("vsm", request, {.scene = scene, .profile = vsm.profile}).visibility, truth);
}

/// The light that a format takes from lit surfaces: more than is missing in double from 32-bit moments. What is missing there
/// is the technique's own: slopes within the filter.
double acne(const Vsm& vsm, std::string_view scene, const std::vector<float>& truth) {
    Vsm ideal = vsm;
    ideal.format = Format::Rg32Float;
    ideal.profile = "ideal";
    return errors_of(vsm, scene, truth).missing - errors_of(ideal, scene, truth).missing;
}

}  // namespace

TEST_CASE("[Donnelly06] 5.3: acne of formats", "[donnelly06][5.3]") {
    // "Artifacts were sometimes visible when using a 16-bit floating point shadow map, but never with 32-bit floating point
    // values"; splitting moments in two "largely eliminates" them. Without any least variance whatever rounding is left shows:
    // in car and bench fp16 is 166 and 24 times as bad as fp32, split moments 6 and 2.4 times better than fp16. The smallest
    // variance that a user would set, 1e-8, hides what is left of split moments: 600 and 2000 times better.
    for (const char* scene : {"car", "bench"}) {
        const std::vector<float> truth = compared(scene);
        for (const char* variance : {"0", "1e-8"}) {
            const auto of = [&](Format format) { return acne({.format = format, .min_variance = variance}, scene, truth); };
            const double fp32 = of(Format::Rg32Float);
            const double split = of(Format::Rgba16Float);
            const double fp16 = of(Format::Rg16Float);
            const double unorm16 = of(Format::Rg16Unorm);
            const double unorm8 = of(Format::Rg8Unorm);
            INFO(fmt::format("{}, least {}\nrg32f {:.6f}, rgba16f {:.6f}\nrg16unorm {:.6f}, rg16f {:.6f}, rg8unorm {:.6f}",
                             scene, variance, fp32, split, unorm16, fp16, unorm8));
            const bool is_bare = variance == std::string("0");
            CHECK(fp16 > 0.01);
            CHECK(fp16 > 10 * fp32);
            CHECK(fp16 > (is_bare ? 2 : 100) * split);
            CHECK(fp16 > 1.3 * unorm16);  // 2^-10 of a number against 2^-17
            CHECK(split > fp32);
        }
        // Steps of 1/255 of depth: no least variance below 1e-6 hides them, and shadows are lost where variance is rounded up.
        const Errors unorm8 = errors_of(Vsm{.format = Format::Rg8Unorm, .min_variance = "1e-7"}, scene, truth);
        const Errors unorm16 = errors_of(Vsm{.format = Format::Rg16Unorm, .min_variance = "1e-7"}, scene, truth);
        INFO(fmt::format("{}: rg8unorm {:.4f} {:.4f}, rg16unorm {:.4f} {:.4f}", scene, unorm8.missing, unorm8.leaked,
                         unorm16.missing, unorm16.leaked));
        CHECK(unorm8.missing > 5 * unorm16.missing);
        CHECK(unorm8.leaked > 1.3 * unorm16.leaked);
    }
}

TEST_CASE("depth metrics: sensible frames all; z/w loses precision", "[techniques][depth]") {
    for (const char* scene : {"car", "bench"}) {
        const std::vector<float> truth = compared(scene);
        for (const Format format : {Format::Rg32Float, Format::Rg16Unorm})
            for (const char* depth : {"plane", "distance", "perspective"}) {
                const Errors errors = errors_of({.format = format, .min_variance = "1e-5", .depth = depth}, scene, truth);
                INFO(scene << " " << name_of(format) << " " << depth << ": " << errors.missing << " " << errors.leaked);
                CHECK(errors.missing < 0.02);
                CHECK(errors.leaked < 0.04);
            }
        // z/w crowds depths near 1, where numbers are largest and their differences smallest. The lights' planes are only 1 to
        // 3 apart: 4.8 and 3.5 times the acne in fp32 and, under a variance of 1e-8, 4.8 and 2.4 times in fp16.
        const auto of = [&](Format format, const char* variance, const char* depth) {
            return acne({.format = format, .min_variance = variance, .depth = depth}, scene, truth);
        };
        const double plane32 = of(Format::Rg32Float, "0", "plane");
        const double perspective32 = of(Format::Rg32Float, "0", "perspective");
        const double plane16 = of(Format::Rg16Float, "1e-8", "plane");
        const double perspective16 = of(Format::Rg16Float, "1e-8", "perspective");
        INFO(fmt::format("{}: plane, z/w: fp32 {:.6f} {:.6f}, fp16 {:.6f} {:.6f}", scene, plane32, perspective32, plane16,
                         perspective16));
        CHECK(perspective32 > 2 * plane32);
        CHECK(perspective16 > 1.5 * plane16);
    }
}

namespace {

/// Texels at places that the pixel decides, through a MapLookup.
struct LookupProbe {
    MapLookup map{};
    float step_u = 0.0f;
    float step_v = 0.0f;
    int slices = 0;  // 0: a flat texture

    static constexpr auto fields() {
        using P = LookupProbe;
        return std::tuple{Field{"map", &P::map}, Field{"step_u", &P::step_u}, Field{"step_v", &P::step_v},
                          Field{"slices", &P::slices}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const Vec2<Real> uv{Real(at.x) * Real(step_u) - Real(0.125f), Real(at.y) * Real(step_v) - Real(0.125f)};
        const MapPosition<Real> in_map{uv, Real(0.0f), Mask(true)};
        if (slices == 0) return map.sample(f, in_map);
        return map.sample_slice(f, in_map, Real((at.x + at.y) & Int(slices - 1)));
    }
};

std::vector<float> probe(Device& device, TextureId map, bool in_shader, int slices) {
    static const Program program = make_program<FullScreenVertex, LookupProbe>("lookup-probe");
    constexpr int kSize = 96;
    const TextureId target = device.create_texture("probe", {.format = Format::Rgba32Float, .width = kSize, .height = kSize});
    const TexelFilter filter = in_shader ? TexelFilter::Nearest : TexelFilter::Linear;
    const LookupProbe pixel{.map = {.texture = map, .sampler = {.min = filter, .mag = filter}, .in_shader = in_shader ? 1 : 0},
                            .step_u = 1.25f / kSize,  // from -1/8 to 9/8
                            .step_v = 1.2468f / kSize,
                            .slices = slices};
    const std::array<TargetView, 1> targets{target};
    FullScreen(device).run("probe", program, pixel, targets);
    return floats_of(device.texture(target).level_bytes(0));
}

}  // namespace

TEST_CASE("bilinear in the shader is the texture unit's but for its weights", "[techniques][shader-bilinear]") {
    for (const char* profile : {"d3d11", "ideal", "llvmpipe", "swiftshader"})
        for (const int slices : {0, 4})
            for (const auto& [width, height] : {std::pair{13, 7}, std::pair{64, 64}, std::pair{190, 190}, std::pair{1, 1}}) {
                Device device(load_profile(profile), 1);
                const TextureId map =
                    device.create_texture("map", {.format = Format::Rgba32Float,
                                                  .width = width,
                                                  .height = height,
                                                  .kind = slices == 0 ? TextureKind::Flat : TextureKind::Array,
                                                  .layers = std::max(1, slices)});
                oracle::Random random(static_cast<std::uint64_t>(width));
                for (int slice = 0; slice < std::max(1, slices); ++slice) {
                    std::vector<float> texels(static_cast<std::size_t>(width * height) * 4);
                    for (float& texel : texels) texel = random.unit();
                    device.execute(WriteTexture{map, 0, std::as_bytes(std::span(texels)), slice});
                }
                const std::vector<float> unit = probe(device, map, false, slices);
                const std::vector<float> shader = probe(device, map, true, slices);
                // Weights that round to 1/256 err by 1/512 per axis, times a difference of texels of at most 1. Without that,
                // the position rounds to fp32 twice, 2^-24 of up to 9/8 of the side each, in the texture unit and in the
                // shader; sums of four round six times each. In double it is the store to fp32 alone.
                const double side = std::max(width, height);
                const bool rounds_weights = profile == std::string("d3d11");
                const bool is_double = profile == std::string("ideal");
                const double allowed =
                    is_double ? 2 * 0x1p-24
                              : (rounds_weights ? 2.0 / 512 : 0.0) + 2 * 2 * 2 * 1.125 * side * 0x1p-24 + 12 * 0x1p-24;
                double worst = 0;
                for (std::size_t i = 0; i < unit.size(); ++i) {
                    const double error = std::fabs(static_cast<double>(unit[i]) - static_cast<double>(shader[i]));
                    worst = std::max(worst, error);
                    if (!(error <= allowed))
                        FAIL(fmt::format("{} {}x{} slices {} pixel ({}, {}) component {}: {:a} of the unit, {:a} of the shader",
                                         profile, width, height, slices, i / 4 % 96, i / 4 / 96, i % 4, unit[i], shader[i]));
                }
                if (rounds_weights && width > 1) CHECK(worst > 1.0 / 2048);
            }
}

TEST_CASE("a frame with bilinear in the shader is that of the texture unit, nearly", "[techniques][shader-bilinear]") {
    for (const char* name : {"vsm", "evsm4", "lvsm"}) {
        const auto visibility = [&](MapFilter filter, const std::string& profile) {
            return shoot(name, {.map_size = 128, .filter = filter}, {.profile = profile}).visibility;
        };
        const auto mean_difference = [](const std::vector<float>& a, const std::vector<float>& b) {
            double sum = 0;
            for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
            return sum / static_cast<double>(a.size());
        };
        const double ideal =
            mean_difference(visibility(MapFilter::Bilinear, "ideal"), visibility(MapFilter::ShaderBilinear, "ideal"));
        const double d3d11 =
            mean_difference(visibility(MapFilter::Bilinear, "d3d11"), visibility(MapFilter::ShaderBilinear, "d3d11"));
        INFO(name << ": ideal " << ideal << ", d3d11 " << d3d11);
        // In double both are the same sum but for its order, 2^-50 of moments whose variance is 2^-30 and more.
        CHECK(ideal < 1e-6);
        CHECK(d3d11 > 1e-6);
        CHECK(d3d11 < 0.01);
    }
}

TEST_CASE("bleed reduction: linstep stretches what is left, clamp leaves it", "[lauritzen08][3.4]") {
    const auto of = [](const char* amount, const char* cut) {
        const ParameterTexts texts{{"bleed-reduction", amount}, {"bleed-cut", cut}};
        return bleed_reduction(ParameterValues("vsm", bleed_parameters(), texts));
    };
    const auto reduced = [](const BleedReduction& bleed, float bound) { return lane(bleed(Float(bound)), 0); };
    for (const char* cut : {"linstep", "clamp"})
        for (const float p : {0.0f, 0.25f, 0.3f, 1.0f}) CHECK(reduced(of("0", cut), p) == p);
    // A quarter and a half are exact.
    CHECK(reduced(of("0.5", "linstep"), 0.5f) == 0.0f);
    CHECK(reduced(of("0.5", "linstep"), 0.75f) == 0.5f);
    CHECK(reduced(of("0.5", "linstep"), 1.0f) == 1.0f);
    CHECK(reduced(of("0.5", "linstep"), 0.25f) == 0.0f);
    CHECK(reduced(of("0.5", "clamp"), 0.75f) == 0.75f);
    CHECK(reduced(of("0.5", "clamp"), 0.5f) == 0.5f);
    CHECK(reduced(of("0.5", "clamp"), 0.49999997f) == 0.0f);
    CHECK(reduced(of("0.5", "clamp"), 1.0f) == 1.0f);
    for (const char* amount : {"0.1", "0.3", "0.9", "0.99"}) {
        const BleedReduction bleed = of(amount, "linstep");
        const double a = static_cast<double>(bleed.amount);
        float before = 0.0f;
        for (int i = 0; i <= 1024; ++i) {
            const float p = static_cast<float>(i) / 1024.0f;
            const float got = reduced(bleed, p);
            const double expected = std::clamp((static_cast<double>(p) - a) / (1 - a), 0.0, 1.0);
            // 1 - a, its reciprocal, the difference and the product round once each; 1 - a is exact for a >= 1/2.
            if (!(std::fabs(static_cast<double>(got) - expected) <= 4 * 0x1p-24 && got >= before))
                FAIL(fmt::format("{}: {:a} of {:a}, expected {:a}", amount, got, p, expected));
            before = got;
        }
    }
}

TEST_CASE("depth-resolve: nearest <= first, mean <= farthest", "[techniques][msaa]") {
    const auto map = [](const char* how) {
        return floats_of(
            shoot("shadow-map", {.map_size = 128, .map_samples = 4, .set = {{"depth-resolve", how}}}).maps.front());
    };
    const std::vector<float> nearest = map("nearest");
    const std::vector<float> farthest = map("farthest");
    const std::vector<float> first = map("first");
    const std::vector<float> mean = map("mean");
    std::size_t apart = 0;
    std::size_t first_between = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        // The mean's three sums round once each.
        const bool in_order = nearest[i] <= first[i] && first[i] <= farthest[i] &&
                              static_cast<double>(mean[i]) >= static_cast<double>(nearest[i]) * (1 - 3.01 * 0x1p-24) &&
                              static_cast<double>(mean[i]) <= static_cast<double>(farthest[i]) * (1 + 3.01 * 0x1p-24);
        if (!in_order)
            FAIL(fmt::format("texel {}: nearest {:a} first {:a} mean {:a} farthest {:a}", i, nearest[i], first[i], mean[i],
                             farthest[i]));
        apart += nearest[i] < mean[i] && mean[i] < farthest[i];
        first_between += nearest[i] < first[i] && first[i] < farthest[i];
    }
    CHECK(apart > 1000);
    CHECK(first_between > 100);
    // One sample: nothing to choose from.
    const auto single = [](const char* how) {
        return shoot("shadow-map", {.map_size = 128, .set = {{"depth-resolve", how}}}).maps.front();
    };
    CHECK(single("nearest") == single("mean"));
}

TEST_CASE("a map drawn in bands is the map drawn whole", "[techniques][msaa][bands]") {
    // 2048^2 texels of 8 samples of 8 bytes are 2^28 bytes: one band. Of 16 bytes they are two. Both hold the same moments.
    const auto map = [](const char* technique) {
        const TechniqueRequest request{
            .map_size = 2048, .map_samples = 8, .filter = MapFilter::Bilinear, .set = {{"positive", "20"}}};
        return floats_of(shoot(technique, request, {.scene = "planes", .width = 32, .height = 24}).maps.front());
    };
    const std::vector<float> whole = map("evsm2");
    const std::vector<float> bands = map("evsm4");
    REQUIRE(bands.size() == 2 * whole.size());
    std::size_t different = 0;
    std::size_t drawn = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const float in_band = bands[i / 2 * 4 + i % 2];
        different += std::bit_cast<std::uint32_t>(whole[i]) != std::bit_cast<std::uint32_t>(in_band);
        drawn += whole[i] != whole[i % 2];  // the corner is empty
    }
    CHECK(different == 0);
    CHECK(drawn > 100000);
}
