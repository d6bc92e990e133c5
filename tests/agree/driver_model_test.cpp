// The models of driver_models.h against the drivers themselves, bit for bit.
#include "tests/agree/raster_compare.h"
#include "tests/peer/test_scenes.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>

namespace gnomon::agree {
namespace {

struct CoverageCase {
    int width, height;
    std::size_t count;
    int inset = 0;
};

void check_coverage(RasterPeer& machine, Driver driver, TriangleKind kind, const CoverageCase& c) {
    const auto triangles = random_triangles(kind, c.count, c.width, c.height, 1 + static_cast<std::uint64_t>(kind));
    for (const int samples : {1, 4}) {
        const CoverageOptions options{.width = c.width, .height = c.height, .samples = samples, .inset = c.inset};
        const auto covered = machine.coverage(options, triangles);
        Differences differences;
        std::size_t not_empty = 0;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const auto expected = model_coverage(driver, triangles[i], covered[i].viewport, options);
            if (!expected.empty()) ++not_empty;
            if (expected == covered[i].pixels) continue;
            differences.add([&] {
                return fmt::format("triangle {}{} in {},{}\n model{}\n driver{}", i, text(triangles[i]), covered[i].viewport.x,
                                   covered[i].viewport.y, text(expected), text(covered[i].pixels));
            });
        }
        differences.report(fmt::format("{}, {} x {} less {}, {} samples", name_of(kind), c.width, c.height, c.inset, samples),
                           triangles.size());
        CHECK(not_empty * 100 > triangles.size());
    }
}

TEST_CASE("coverage of triangles", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) check_coverage(machine, driver, kind, {32, 32, 1000});
    });
}

TEST_CASE("coverage of a hundred thousand triangles", "[.full][agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) check_coverage(machine, driver, kind, {32, 32, 12'500});
    });
}

TEST_CASE("coverage in large and odd viewports", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(machine, driver, kind, {37, 21, 300});
            check_coverage(machine, driver, kind, {700, 500, 10});
        }
    });
}

TEST_CASE("coverage in a scissor inside of the viewport", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(machine, driver, kind, {32, 32, 1000, 5});
            check_coverage(machine, driver, kind, {150, 200, 50, 11});
        }
    });
}

TEST_CASE("coverage of many more", "[.stress][agree][device]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(machine, driver, kind, {1, 1, 20'000});
            check_coverage(machine, driver, kind, {33, 64, 100'000});
            check_coverage(machine, driver, kind, {1024, 1024, 1000});
            check_coverage(machine, driver, kind, {4096, 2048, 40});
        }
    });
}

TEST_CASE("depth of triangles", "[agree][device][depth]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds)
            for (const DepthFormat format : {DepthFormat::D32f, DepthFormat::D16, DepthFormat::D24})
                for (const int samples : {1, 4}) {
                    if (!machine.supports(format, samples)) continue;
                    Differences differences;
                    std::size_t total = 0;
                    for (std::uint64_t run = 0; run < 20; ++run) {
                        const DepthDraw draw = random_depth(kind, run, format, samples);
                        const auto codes = machine.depth(draw);
                        const auto expected = model_depth(driver, draw);
                        REQUIRE(codes.size() == expected.size());
                        total += codes.size();
                        for (std::size_t i = 0; i < codes.size(); ++i)
                            if (codes[i] != expected[i])
                                differences.add([&] {
                                    return fmt::format("run {} sample {}: model {:x} driver {:x}", run, i, expected[i],
                                                       codes[i]);
                                });
                    }
                    differences.report(
                        fmt::format("{}, depth format {}, {} samples", name_of(kind), static_cast<int>(format), samples),
                        total);
                }
    });
}

TEST_CASE("depth of scenes", "[agree][device][depth]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const scenes::Scene& scene : {peer::boxes(), peer::two_planes()}) {
            const peer::Frame frame = peer::scene_frame(scene, 320, 240);
            for (const scenes::View& view : {frame.camera, frame.light})
                for (const DepthFormat format : {DepthFormat::D32f, DepthFormat::D16, DepthFormat::D24})
                    for (const int samples : {1, 4}) {
                        if (!machine.supports(format, samples)) continue;
                        DepthDraw draw = scene_depth(scene, view, 320, 240);
                        draw.format = format;
                        draw.samples = samples;
                        draw.bias_slope = samples == 1 ? 0.0f : 2.0f;
                        const auto codes = machine.depth(draw);
                        const auto expected = model_depth(driver, draw);
                        Differences differences;
                        for (std::size_t i = 0; i < codes.size(); ++i)
                            if (codes[i] != expected[i])
                                differences.add(
                                    [&] { return fmt::format("sample {}: model {:x} driver {:x}", i, expected[i], codes[i]); });
                        const auto far = static_cast<std::size_t>(std::count(codes.begin(), codes.end(), codes[0]));
                        CHECK(far < codes.size());
                        differences.report(
                            fmt::format("{}, depth format {}, {} samples", scene.name, static_cast<int>(format), samples),
                            codes.size());
                    }
        }
    });
}

TEST_CASE("attributes of triangles", "[agree][device][attributes]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds)
            for (const Interpolation interpolation : {Interpolation::Perspective, Interpolation::Linear}) {
                // How a clipped triangle's attributes are cut without perspective is not modelled.
                if (interpolation == Interpolation::Linear && kind >= TriangleKind::Large) continue;
                Differences differences;
                std::size_t total = 0;
                for (const ClipTriangle& triangle : random_triangles(kind, 40, 80, 50, 7)) {
                    const auto colors = machine.attributes(triangle, 80, 50, interpolation);
                    const auto expected = model_attributes(driver, triangle, {0, 0, 80, 50}, interpolation);
                    total += colors.size();
                    for (std::size_t i = 0; i < colors.size(); ++i)
                        if (std::bit_cast<Codes>(colors[i]) != std::bit_cast<Codes>(expected[i]))
                            differences.add([&] {
                                return fmt::format("pixel {}: model {} driver {}", i, text(std::bit_cast<Codes>(expected[i])),
                                                   text(std::bit_cast<Codes>(colors[i])));
                            });
                }
                differences.report(fmt::format("{}, interpolation {}", name_of(kind), static_cast<int>(interpolation)), total);
            }
    });
}

TEST_CASE("blending of random states", "[agree][device][blend]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const ColorFormat format : kColorFormats) {
            Differences differences;
            std::size_t total = 0;
            for (std::uint64_t run = 0; run < 150; ++run) {
                oracle::Random random(run * 4 + static_cast<std::uint64_t>(format));
                BlendState state = random_blend_state(random, format);
                if (run == 0) state.enabled = false;
                const auto cases = random_blend_cases(random, format, 512);
                const auto blended = machine.blend(format, state, cases);
                total += cases.size();
                for (std::size_t i = 0; i < cases.size(); ++i) {
                    const Codes expected = model_blend(driver, format, state, cases[i]);
                    if (same(format, blended[i], expected)) continue;
                    differences.add([&] {
                        return fmt::format("run {} case {}: {}: model {}, driver {}", run, i, text(state, cases[i]),
                                           text(expected), text(blended[i]));
                    });
                }
            }
            differences.report(fmt::format("{}", name_of(format)), total);
        }
    });
}

TEST_CASE("resolve of random samples", "[agree][device][resolve]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const ColorFormat format : kColorFormats)
            for (const ResolveBy by : {ResolveBy::Command, ResolveBy::Attachment}) {
                oracle::Random random(31 + static_cast<std::uint64_t>(format));
                const auto pixels = random_samples(random, format, 50'000);
                const auto resolved = machine.resolve(format, pixels, by);
                Differences differences;
                for (std::size_t i = 0; i < pixels.size(); ++i) {
                    const Codes expected = model_resolve(driver, format, pixels[i]);
                    if (same(format, resolved[i], expected)) continue;
                    differences.add([&] {
                        return fmt::format("pixel {}: samples {} | {} | {} | {}: model {}, driver {}", i, text(pixels[i][0]),
                                           text(pixels[i][1]), text(pixels[i][2]), text(pixels[i][3]), text(expected),
                                           text(resolved[i]));
                    });
                }
                differences.report(fmt::format("{}, by {}", name_of(format), static_cast<int>(by)), pixels.size());
            }
    });
}

}  // namespace
}  // namespace gnomon::agree
