// The models of driver_models.h against the drivers themselves, bit for bit.
#include "tests/agree/device_tests.h"
#include "tests/agree/driver_models.h"
#include "tests/agree/raster_cases.h"
#include "tests/peer/frame.h"
#include "tests/peer/test_scenes.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace gnomon::agree {
namespace {

constexpr ColorFormat kColorFormats[] = {ColorFormat::Rgba8, ColorFormat::Rgba16Unorm, ColorFormat::Rgba16f,
                                         ColorFormat::Rgba32f};

std::string_view name_of(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return "rgba8";
        case ColorFormat::Rgba16Unorm: return "rgba16unorm";
        case ColorFormat::Rgba16f: return "rgba16f";
        case ColorFormat::Rgba32f: return "rgba32f";
    }
    return "?";
}

void on_each_driver(const std::function<void(RasterPeer&, Driver)>& check_on) {
    for (const peer::PeerDevice& device : usable_devices()) {
        const std::optional<Driver> driver = driver_of(device);
        if (!driver) continue;
        INFO("device " << device.name);
        RasterPeer machine(device);
        check_on(machine, *driver);
    }
}

std::string text(const ClipTriangle& triangle) {
    std::string all;
    for (const ClipVertex& v : triangle)
        all += fmt::format(" ({:a} {:a} {:a} {:a})", v.clip[0], v.clip[1], v.clip[2], v.clip[3]);
    return all;
}
std::string text(const std::vector<CoveredPixel>& pixels) {
    std::string all;
    for (const CoveredPixel& p : pixels) all += fmt::format(" {},{}:{:x}", p.x, p.y, p.mask);
    return all.substr(0, 400);
}
std::string text(const Codes& codes) { return fmt::format("{:x} {:x} {:x} {:x}", codes[0], codes[1], codes[2], codes[3]); }

// Counts what differs and describes the first few.
class Differences {
public:
    void add(const std::function<std::string()>& describe) {
        if (++count_ <= 3) first_ += describe() + "\n";
    }
    void report(const std::string& what, std::size_t of) const {
        INFO(fmt::format("{}: {} of {} differ\n{}", what, count_, of, first_));
        CHECK(count_ == 0);
    }

private:
    std::size_t count_ = 0;
    std::string first_;
};

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

TEST_CASE("coverage of a hundred thousand triangles", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) check_coverage(machine, driver, kind, {32, 32, 12'500});
    });
}

TEST_CASE("coverage in large and odd viewports", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(machine, driver, kind, {37, 21, 600});
            check_coverage(machine, driver, kind, {700, 500, 25});
        }
    });
}

TEST_CASE("coverage in a scissor inside of the viewport", "[agree][device][coverage]") {
    on_each_driver([](RasterPeer& machine, Driver driver) {
        for (const TriangleKind kind : kTriangleKinds) {
            check_coverage(machine, driver, kind, {32, 32, 2000, 5});
            check_coverage(machine, driver, kind, {150, 200, 100, 11});
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
                        DepthDraw draw{.width = 97, .height = 61, .samples = samples, .format = format};
                        if (run % 4 == 1) draw.bias_constant = 3;
                        if (run % 4 == 2) draw.bias_slope = 1.5f;
                        for (const ClipTriangle& triangle : random_triangles(kind, 12, 97, 61, 100 + run))
                            for (const ClipVertex& vertex : triangle) {
                                draw.indices.push_back(static_cast<std::uint32_t>(draw.vertices.size()));
                                draw.vertices.push_back(vertex);
                            }
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

// All of a scene as it is seen from a view.
DepthDraw scene_depth(const scenes::Scene& scene, const scenes::View& view, int width, int height) {
    DepthDraw draw{.width = width, .height = height};
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& mesh = scene.meshes[instance.mesh];
        const glm::mat4 clip_from_object = view.clip_from_world() * instance.world_from_object;
        const auto first = static_cast<std::uint32_t>(draw.vertices.size());
        for (const scenes::Vertex& vertex : mesh.vertices) {
            const glm::vec4 clip = clip_from_object * glm::vec4(vertex.position, 1.0f);
            draw.vertices.push_back({.clip = {clip.x, clip.y, clip.z, clip.w}});
        }
        for (const std::uint32_t index : mesh.indices) draw.indices.push_back(first + index);
    }
    return draw;
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

bool is_nan(ColorFormat format, std::uint32_t code) {
    if (format == ColorFormat::Rgba16f) return (code & 0x7fffu) > 0x7c00u;
    return format == ColorFormat::Rgba32f && (code & 0x7fffffffu) > 0x7f800000u;
}

// The same, but that one NaN is as good as another.
bool same(ColorFormat format, const Codes& a, const Codes& b) {
    for (std::size_t c = 0; c < 4; ++c)
        if (a[c] != b[c] && !(is_nan(format, a[c]) && is_nan(format, b[c]))) return false;
    return true;
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
                        const auto equation = [](const BlendEquation& e) {
                            return fmt::format("{}*s {}*d op {}", static_cast<int>(e.source), static_cast<int>(e.destination),
                                               static_cast<int>(e.operation));
                        };
                        const Color& s = cases[i].source;
                        return fmt::format(
                            "run {} case {}: color {}, alpha {}, source {:a} {:a} {:a} {:a}, destination {}: model {}, driver "
                            "{}",
                            run, i, equation(state.color), equation(state.alpha), s[0], s[1], s[2], s[3],
                            text(cases[i].destination), text(expected), text(blended[i]));
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
