// Our rasteriser and output merger with the profiles `llvmpipe` and `swiftshader` against those drivers, bit for bit; and,
// where no driver is, against fewer cases of their models.
#include "tests/agree/gnomon_raster.h"
#include "tests/agree/raster_compare.h"
#include "tests/peer/test_scenes.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <span>

namespace gnomon::agree {
namespace {

Profile profile_of(Driver driver) { return load_profile(driver == Driver::Llvmpipe ? "llvmpipe" : "swiftshader"); }

/// Who says what is right.
struct Reference {
    std::function<std::vector<TriangleCoverage>(const CoverageOptions&, std::span<const ClipTriangle>)> coverage;
    std::function<bool(DepthFormat, int samples)> has_depth;
    std::function<std::vector<std::uint32_t>(const DepthDraw&)> depth;
    std::function<std::vector<Color>(const ClipTriangle&, int width, int height, Interpolation)> attributes;
    std::function<std::vector<Codes>(ColorFormat, const BlendState&, std::span<const BlendCase>)> blend;
    std::function<std::vector<Codes>(ColorFormat, std::span<const SampleCodes>)> resolve;
};

Reference driver_reference(RasterPeer& machine) {
    return {
        .coverage = [&](const auto& options, auto triangles) { return machine.coverage(options, triangles); },
        .has_depth = [&](DepthFormat format, int samples) { return machine.supports(format, samples); },
        .depth = [&](const DepthDraw& draw) { return machine.depth(draw); },
        .attributes = [&](const ClipTriangle& triangle, int width, int height,
                          Interpolation how) { return machine.attributes(triangle, width, height, how); },
        .blend = [&](ColorFormat format, const BlendState& state, auto cases) { return machine.blend(format, state, cases); },
        .resolve = [&](ColorFormat format, auto pixels) { return machine.resolve(format, pixels, ResolveBy::Command); }};
}

Reference model_reference(Driver driver) {
    return {.coverage =
                [=](const CoverageOptions& options, std::span<const ClipTriangle> triangles) {
                    std::vector<TriangleCoverage> covered;
                    for (std::size_t i = 0; i < triangles.size(); ++i) {
                        const Viewport viewport = coverage_viewport(options, i);
                        covered.push_back({viewport, model_coverage(driver, triangles[i], viewport, options)});
                    }
                    return covered;
                },
            .has_depth = [=](DepthFormat format, int) { return driver == Driver::Llvmpipe || format != DepthFormat::D24; },
            .depth = [=](const DepthDraw& draw) { return model_depth(driver, draw); },
            .attributes = [=](const ClipTriangle& triangle, int width, int height,
                              Interpolation how) { return model_attributes(driver, triangle, {0, 0, width, height}, how); },
            .blend =
                [=](ColorFormat format, const BlendState& state, std::span<const BlendCase> cases) {
                    std::vector<Codes> blended;
                    for (const BlendCase& one : cases) blended.push_back(model_blend(driver, format, state, one));
                    return blended;
                },
            .resolve =
                [=](ColorFormat format, std::span<const SampleCodes> pixels) {
                    std::vector<Codes> resolved;
                    for (const SampleCodes& samples : pixels) resolved.push_back(model_resolve(driver, format, samples));
                    return resolved;
                }};
}

/// Every driver and our device in its likeness.
void on_each_pair(const std::function<void(const Reference&, GnomonRaster&)>& check_on) {
    on_each_driver([&](RasterPeer& machine, Driver driver) {
        GnomonRaster ours(profile_of(driver));
        check_on(driver_reference(machine), ours);
    });
}

void check_coverage(const Reference& reference, GnomonRaster& ours, TriangleKind kind, int width, int height,
                    std::size_t count) {
    const auto triangles = random_triangles(kind, count, width, height, 1 + static_cast<std::uint64_t>(kind));
    for (const int samples : {1, 4}) {
        const CoverageOptions options{.width = width, .height = height, .samples = samples};
        const auto expected = reference.coverage(options, triangles);
        const auto covered = ours.coverage(options, triangles);
        REQUIRE(covered.size() == expected.size());
        Differences differences;
        std::size_t not_empty = 0;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            if (!expected[i].pixels.empty()) ++not_empty;
            if (covered[i] == expected[i]) continue;
            differences.add([&] {
                return fmt::format("triangle {}{} in {},{}\n ours{}\n expected{}", i, text(triangles[i]),
                                   expected[i].viewport.x, expected[i].viewport.y, text(covered[i].pixels),
                                   text(expected[i].pixels));
            });
        }
        differences.report(fmt::format("{}, {} x {}, {} samples", name_of(kind), width, height, samples), triangles.size());
        CHECK(not_empty * 100 > triangles.size());
    }
}

TEST_CASE("coverage of a hundred thousand triangles agrees", "[agree][device][coverage]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) {
        for (const TriangleKind kind : kTriangleKinds) check_coverage(reference, ours, kind, 32, 32, 12'500);
    });
}

TEST_CASE("coverage in large and odd viewports agrees", "[agree][device][coverage]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(reference, ours, kind, 37, 21, 600);
            check_coverage(reference, ours, kind, 700, 500, 25);
        }
    });
}

void check_attributes(const Reference& reference, GnomonRaster& ours, std::size_t count) {
    for (const TriangleKind kind : kTriangleKinds)
        for (const Interpolation how : {Interpolation::Perspective, Interpolation::Linear}) {
            // How a clipped triangle's attributes are cut without perspective is not modelled.
            if (how == Interpolation::Linear && kind >= TriangleKind::Large) continue;
            Differences differences;
            std::size_t total = 0;
            for (const ClipTriangle& triangle : random_triangles(kind, count, 80, 50, 7)) {
                const auto expected = reference.attributes(triangle, 80, 50, how);
                const auto colors = ours.attributes(triangle, 80, 50, how);
                REQUIRE(colors.size() == expected.size());
                total += colors.size();
                for (std::size_t i = 0; i < colors.size(); ++i)
                    if (std::bit_cast<Codes>(colors[i]) != std::bit_cast<Codes>(expected[i]))
                        differences.add([&] {
                            return fmt::format("pixel {}: ours {} expected {}", i, text(std::bit_cast<Codes>(colors[i])),
                                               text(std::bit_cast<Codes>(expected[i])));
                        });
            }
            differences.report(fmt::format("{}, interpolation {}", name_of(kind), static_cast<int>(how)), total);
        }
}

/// Adds the number of samples that something was drawn to.
void compare_depth(const Reference& reference, GnomonRaster& ours, const DepthDraw& draw, Differences& differences,
                   std::size_t& compared) {
    const auto expected = reference.depth(draw);
    const auto codes = ours.depth(draw);
    REQUIRE(codes.size() == expected.size());
    const std::uint32_t far = *std::ranges::max_element(expected);
    compared += static_cast<std::size_t>(std::ranges::count_if(expected, [=](std::uint32_t code) { return code != far; }));
    for (std::size_t i = 0; i < codes.size(); ++i) {
        if (codes[i] == expected[i]) continue;
        differences.add([&] {
            const std::size_t pixel = i / static_cast<std::size_t>(draw.samples);
            const auto width = static_cast<std::size_t>(draw.width);
            return fmt::format("pixel {},{} sample {}: ours {:x} expected {:x}", pixel % width, pixel / width,
                               i % static_cast<std::size_t>(draw.samples), codes[i], expected[i]);
        });
    }
}

/// The formats and sample counts that the driver shows.
void on_each_depth_format(const Reference& reference, const std::function<void(DepthFormat, int)>& check_on) {
    for (const DepthFormat format : {DepthFormat::D32f, DepthFormat::D16, DepthFormat::D24})
        for (const int samples : {1, 4})
            if (reference.has_depth(format, samples)) check_on(format, samples);
}

void check_depth(const Reference& reference, GnomonRaster& ours, std::uint64_t runs) {
    on_each_depth_format(reference, [&](DepthFormat format, int samples) {
        for (const TriangleKind kind : kTriangleKinds) {
            Differences differences;
            std::size_t compared = 0;
            for (std::uint64_t run = 0; run < runs; ++run)
                compare_depth(reference, ours, random_depth(kind, run, format, samples), differences, compared);
            CHECK(compared > 0);
            differences.report(fmt::format("{}, depth format {}, {} samples", name_of(kind), static_cast<int>(format), samples),
                               compared);
        }
    });
}

TEST_CASE("depth of triangles agrees", "[agree][device][depth]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) { check_depth(reference, ours, 12); });
}

TEST_CASE("depth of scenes agrees", "[agree][device][depth]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) {
        for (const scenes::Scene& scene : {peer::boxes(), peer::two_planes()}) {
            const peer::Frame frame = peer::scene_frame(scene, 320, 240);
            for (const scenes::View& view : {frame.camera, frame.light})
                on_each_depth_format(reference, [&](DepthFormat format, int samples) {
                    DepthDraw draw = scene_depth(scene, view, 320, 240);
                    draw.format = format;
                    draw.samples = samples;
                    draw.bias_slope = samples == 1 ? 0.0f : 2.0f;
                    draw.bias_constant = format == DepthFormat::D32f ? 0.0f : 1.0f;
                    Differences differences;
                    std::size_t compared = 0;
                    compare_depth(reference, ours, draw, differences, compared);
                    CHECK(compared > 1000);
                    differences.report(
                        fmt::format("{}, depth format {}, {} samples", scene.name, static_cast<int>(format), samples),
                        compared);
                });
        }
    });
}

/// Constant alpha as constant colour, which is what we have.
BlendState with_constant_color(BlendState state) {
    for (BlendFactor* factor : {&state.color.source, &state.color.destination, &state.alpha.source, &state.alpha.destination}) {
        if (*factor == BlendFactor::ConstantAlpha) *factor = BlendFactor::ConstantColor;
        if (*factor == BlendFactor::InverseConstantAlpha) *factor = BlendFactor::InverseConstantColor;
    }
    return state;
}

void check_blending(const Reference& reference, GnomonRaster& ours, std::uint64_t runs) {
    for (const ColorFormat format : kColorFormats) {
        Differences differences;
        std::size_t total = 0;
        for (std::uint64_t run = 0; run < runs; ++run) {
            oracle::Random random(run * 4 + static_cast<std::uint64_t>(format));
            BlendState state = with_constant_color(random_blend_state(random, format));
            if (run == 0) state.enabled = false;
            const auto cases = random_blend_cases(random, format, 512);
            const auto expected = reference.blend(format, state, cases);
            const auto blended = ours.blend(format, state, cases);
            total += cases.size();
            for (std::size_t i = 0; i < cases.size(); ++i)
                if (!same(format, blended[i], expected[i]))
                    differences.add([&] {
                        return fmt::format("run {} case {}: {}: ours {}, expected {}", run, i, text(state, cases[i]),
                                           text(blended[i]), text(expected[i]));
                    });
        }
        differences.report(fmt::format("{}", name_of(format)), total);
    }
}

TEST_CASE("blending of random states agrees", "[agree][device][blend]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) { check_blending(reference, ours, 100); });
}

/// SwiftShader tells NaN samples by their sign when it resolves halves; our targets hold no sign of a NaN (texunit/codec.h).
void drop_nan_signs(ColorFormat format, std::vector<SampleCodes>& pixels) {
    if (format != ColorFormat::Rgba16f) return;
    for (SampleCodes& samples : pixels)
        for (Codes& codes : samples)
            for (std::uint32_t& code : codes)
                if ((code & 0x7fffu) > 0x7c00u) code &= 0x7fffu;
}

void check_resolve(const Reference& reference, GnomonRaster& ours, std::size_t count) {
    for (const ColorFormat format : kColorFormats) {
        oracle::Random random(31 + static_cast<std::uint64_t>(format));
        auto pixels = random_samples(random, format, count);
        drop_nan_signs(format, pixels);
        const auto expected = reference.resolve(format, pixels);
        const auto resolved = ours.resolve(format, pixels);
        Differences differences;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            if (!same(format, resolved[i], expected[i]))
                differences.add([&] {
                    return fmt::format("pixel {}: samples {} | {} | {} | {}: ours {}, expected {}", i, text(pixels[i][0]),
                                       text(pixels[i][1]), text(pixels[i][2]), text(pixels[i][3]), text(resolved[i]),
                                       text(expected[i]));
                });
        differences.report(fmt::format("{}", name_of(format)), pixels.size());
    }
}

TEST_CASE("resolve of random samples agrees", "[agree][device][resolve]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) { check_resolve(reference, ours, 50'000); });
}

TEST_CASE("without drivers their models agree", "[agree][model]") {
    for (const Driver driver : {Driver::Llvmpipe, Driver::SwiftShader}) {
        INFO("driver " << static_cast<int>(driver));
        const Reference reference = model_reference(driver);
        GnomonRaster ours(profile_of(driver));
        for (const TriangleKind kind : kTriangleKinds) check_coverage(reference, ours, kind, 32, 32, 500);
        check_depth(reference, ours, 3);
        check_attributes(reference, ours, 4);
        check_blending(reference, ours, 12);
        check_resolve(reference, ours, 5000);
    }
}

TEST_CASE("varyings of triangles agree", "[agree][device][attributes]") {
    on_each_pair([](const Reference& reference, GnomonRaster& ours) { check_attributes(reference, ours, 40); });
}

/// Each field is needed: with the specification's choice something is drawn differently.
TEST_CASE("with a guard band or other planes they differ", "[agree][model]") {
    for (const Driver driver : {Driver::Llvmpipe, Driver::SwiftShader}) {
        INFO("driver " << static_cast<int>(driver));
        const Reference reference = model_reference(driver);
        Profile profile = profile_of(driver);
        profile.clipping = Clipping::GuardBand;
        GnomonRaster guarded(profile);
        const auto triangles = random_triangles(TriangleKind::Large, 1000, 32, 32, 1);
        CHECK(guarded.coverage({}, triangles) != reference.coverage({}, triangles));

        profile = profile_of(driver);
        profile.plane_equations = PlaneEquations::Barycentric;
        GnomonRaster barycentric(profile);
        const DepthDraw draw = random_depth(TriangleKind::Any, 0, DepthFormat::D32f, 1);
        CHECK(barycentric.depth(draw) != reference.depth(draw));
    }
}

}  // namespace
}  // namespace gnomon::agree
