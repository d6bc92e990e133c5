// [Lauritzen08] 4.1: step and layer warps (equations 4.1 and 4.2), what a layer resolves exactly, overlaps, one layer and many.
#include "scenes/procedural.h"
#include "scenes/reference.h"
#include "scenes/shapes.h"
#include "techniques/frame.h"
#include "techniques/layers.h"
#include "tests/oracle/random.h"
#include "tests/techniques/frames.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

struct Rendered {
    std::vector<float> visibility;
    std::vector<std::byte> map;

    bool operator==(const Rendered&) const = default;
};

constexpr int kWidth = 320;
constexpr int kHeight = 240;

Rendered render(const scenes::Scene& scene, std::string_view name, const TechniqueRequest& request) {
    Device device(Profile{}, 2);
    const Technique& technique = find_technique(name);
    Frame frame(device, scene,
                {.width = kWidth, .height = kHeight, .technique = technique, .settings = resolve_settings(technique, request)});
    PassTimer timer(device);
    frame.render(timer);
    const auto bytes = device.texture(frame.visibility()).level_bytes(0);
    Rendered rendered{std::vector<float>(bytes.size() / 4), device.texture(frame.maps().front()).level_bytes(0)};
    std::memcpy(rendered.visibility.data(), bytes.data(), bytes.size());
    return rendered;
}

/// Chebyshev's bound in one layer over depths of equal weight.
double layer_bound(const DepthLayers& layers, int layer, const std::vector<double>& depths, double t) {
    double m1 = 0;
    double m2 = 0;
    for (const double depth : depths) {
        const auto m = moments_of_depth(layers.warp(Double(depth), layer));
        m1 += lane(m.first, 0) / static_cast<double>(depths.size());
        m2 += lane(m.second, 0) / static_cast<double>(depths.size());
    }
    return lane(chebyshev_upper_bound(Moments<Double>{Double(m1), Double(m2)}, layers.warp(Double(t), layer), Double(0.0)), 0);
}

}  // namespace

TEST_CASE("[Lauritzen08] eq. 4.1: the step warp at C leaves no light on C and no shadow on B", "[lauritzen08][4.1]") {
    const double a = 0.2;
    const double b = 0.5;
    const double c = 0.7;
    const auto warp = [&](double x) { return step_warp(Double(x), Double(c)); };
    CHECK(lane(warp(a), 0) == 0);
    CHECK(lane(warp(b), 0) == 0);
    CHECK(lane(warp(c), 0) == 1);
    const auto ma = moments_of_depth(warp(a));
    const auto mb = moments_of_depth(warp(b));
    const Moments<Double> m{(ma.first + mb.first) * Double(0.5), (ma.second + mb.second) * Double(0.5)};
    CHECK(lane(variance(m), 0) == 0);
    CHECK(lane(chebyshev_upper_bound(m, warp(b), Double(0.0)), 0) == 1);
    CHECK(lane(chebyshev_upper_bound(m, warp(c), Double(0.0)), 0) == 0);
}

TEST_CASE("[Lauritzen08] eq. 4.2: the warp of a layer", "[lauritzen08][4.2]") {
    const DepthLayers layers = make_layers(std::vector{0.25, 0.5}, 0.0);
    CHECK(layers.count == 3);
    for (const auto& [depth, warped] :
         {std::pair{0.0, 0.0}, std::pair{0.25, 0.0}, std::pair{0.3125, 0.25}, std::pair{0.375, 0.5}, std::pair{0.5, 1.0},
          std::pair{0.75, 1.0}, std::pair{1.0, 1.0}}) {
        INFO("depth " << depth);
        CHECK(lane(layers.warp(Double(depth), 1), 0) == warped);
    }
    // The ends of the range belong to the first and the last layer.
    CHECK(lane(layers.warp(Double(0.0), 0), 0) == 0);
    CHECK(lane(layers.warp(Double(1.0), 2), 0) == 1);
    // Depths rise from layer to layer of any splits, and never fall within one.
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        oracle::Random random(seed);
        std::vector<double> splits;
        for (int i = 0; i < 7; ++i) splits.push_back(static_cast<double>(random.unit()));
        std::ranges::sort(splits);
        const DepthLayers some = make_layers(splits, 0.01);
        const auto x = static_cast<double>(random.unit());
        const auto y = x + (1 - x) * static_cast<double>(random.unit());
        for (int i = 0; i < some.count; ++i) REQUIRE(lane(some.warp(Double(x), i), 0) <= lane(some.warp(Double(y), i), 0));
    }
}

TEST_CASE("[Lauritzen08] 4.1: a layer is exact where all occluders lie at or before it", "[lauritzen08][4.1]") {
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        oracle::Random random(seed);
        const double p = 0.1 + 0.8 * static_cast<double>(random.unit());
        const DepthLayers layers = make_layers(std::vector{p}, 0.0);
        const double start = static_cast<double>(layers.begin[1]);  // p as the shader has it
        std::vector<double> depths;
        for (int i = 0; i < 8; ++i) depths.push_back(start * static_cast<double>(random.unit()));
        depths.front() = start;
        const double t = start + (1 - start) * (0.01 + 0.99 * static_cast<double>(random.unit()));
        INFO("seed " << seed << " p " << p << " t " << t);
        REQUIRE(layer_bound(layers, 1, depths, t) == 0);

        // ... and with the receiver in the filter, too: the rest of it is the occluders' cutout before one plane (4.1).
        const int lit = 1 + static_cast<int>(seed % 7);
        for (int i = 0; i < lit; ++i) depths[static_cast<std::size_t>(i)] = t;
        REQUIRE(std::fabs(layer_bound(layers, 1, depths, t) - lit / 8.0) < 1e-9);

        // The layers beyond say nothing; those before only more light.
        REQUIRE(layer_bound(layers, 0, depths, t) >= lit / 8.0 - 1e-9);
    }
    const DepthLayers three = make_layers(std::vector{0.3, 0.6}, 0.0);
    CHECK(layer_bound(three, 2, {0.1, 0.2}, 0.5) == 1);
}

TEST_CASE("[Lauritzen08] 4.1.1: layers reach past their splits, not past the ends", "[lauritzen08][4.1.1]") {
    const DepthLayers layers = make_layers(std::vector{0.25, 0.5, 0.75}, 0.125);
    const std::array<float, 4> begin{0.0f, 0.125f, 0.375f, 0.625f};
    const std::array<float, 4> width{0.375f, 0.5f, 0.5f, 0.375f};
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(layers.begin[i] == begin[i]);
        CHECK(layers.inverse[i] == 1.0f / width[i]);
    }
    CHECK(layers.splits[0] == 0.0f);
    CHECK(layers.splits[4] == 1.0f);
    // Splits that fall together leave finite warps.
    const DepthLayers thin = make_layers(std::vector{0.5, 0.5}, 0.0);
    CHECK(std::isfinite(thin.inverse[1]));
    CHECK(uniform_splits(4) == std::vector{0.25, 0.5, 0.75});
    CHECK(uniform_splits(1).empty());
}

TEST_CASE("[Lauritzen08] 4.1: one layer is a variance shadow map, bit for bit", "[lauritzen08][4.1]") {
    const std::array formats{std::pair{Format::Rgba32Float, Format::Rg32Float},
                             std::pair{Format::Rgba16Float, Format::Rg16Float},
                             std::pair{Format::Rgba16Unorm, Format::Rg16Unorm}};
    for (const char* name : {"car", "overlap"}) {
        const scenes::Scene& scene = testing::scene_of(name);
        for (const auto& [layered, plain] : formats) {
            TechniqueRequest vsm{.map_size = 200, .map_samples = 4, .format = plain, .anisotropy = 8};
            vsm.set = {{"blur", "3"}, {"depth", "distance"}, {"bleed-reduction", "0.1"}};
            TechniqueRequest lvsm = vsm;
            lvsm.format = layered;
            lvsm.set.emplace_back("layers", "1");
            INFO(name << " " << name_of(layered));
            CHECK(render(scene, "vsm", vsm) == render(scene, "lvsm", lvsm));
            lvsm.map_samples = vsm.map_samples = 1;
            lvsm.filter = vsm.filter = MapFilter::Nearest;
            lvsm.anisotropy = vsm.anisotropy = 1;
            lvsm.set.emplace_back("source", "depth");
            CHECK(render(scene, "vsm", vsm) == render(scene, "lvsm", lvsm));
        }
    }
}

TEST_CASE("[Lauritzen08] 4.1.3: layers warped from a map of depths are those that the light pass draws", "[lauritzen08][4.1]") {
    const scenes::Scene& scene = testing::scene_of("bench");
    for (const char* layers : {"2", "3", "5", "16"}) {
        TechniqueRequest request{.map_size = 128, .format = Format::Rgba32Float, .set = {{"layers", layers}}};
        const Rendered casters = render(scene, "lvsm", request);
        request.set.emplace_back("source", "depth");
        INFO(layers << " layers");
        CHECK(casters == render(scene, "lvsm", request));
    }
}

namespace {

/// A ground under slanting light that fills the range of depth, half of it below a large board.
scenes::Scene slanting_ground() {
    scenes::Scene scene;
    scene.name = "slanting ground";
    const auto add = [&](std::string name, const glm::dvec3& origin, const glm::dvec3& u, const glm::dvec3& v) {
        scenes::Mesh mesh{.name = std::move(name), .vertices = {}, .indices = {}};
        scenes::append(mesh, scenes::grid(origin, u, v, 1, 1), scenes::kFlat);
        scene.instances.push_back({.mesh = static_cast<std::uint32_t>(scene.meshes.size())});
        scene.meshes.push_back(std::move(mesh));
    };
    add("ground", {-8, 0, 4}, {12, 0, 0}, {0, 0, -8});
    add("board", {0, 3, 4}, {4, 0, 0}, {0, 0, -8});
    scene.camera.world_from_camera = scenes::looking_at({-4, 9, 5}, {-3, 0, 0});
    scene.camera.yfov_rad = 0.8f;
    scene.light.kind = scenes::LightKind::Directional;
    scene.light.world_from_light = scenes::looking_at({7, 5, 0}, {0, 0, 0});
    return scene;
}

struct Seams {
    double lit = 0;     // most light where there is none
    double shaded = 0;  // most missing light where there is no shadow
};

/// The largest errors on pixels that a ray finds fully lit or shadowed, far from any edge of a shadow.
Seams measure_seams(const Rendered& rendered, const scenes::ReferenceImage& truth) {
    Seams seams;
    constexpr int kMargin = 12;  // pixels; a texel of the map is about three
    for (int y = kMargin; y < kHeight - kMargin; ++y)
        for (int x = kMargin; x < kWidth - kMargin; ++x) {
            bool even = true;
            const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * kWidth + i); };
            for (int j = -kMargin; j <= kMargin && even; j += kMargin / 3)
                for (int i = -kMargin; i <= kMargin && even; i += kMargin / 3)
                    even = truth.weight[at(x + i, y + j)] == 1.0f &&
                           truth.visibility[at(x + i, y + j)] == truth.visibility[at(x, y)];
            if (!even) continue;
            const double seen = static_cast<double>(rendered.visibility[at(x, y)]);
            if (truth.visibility[at(x, y)] == 0.0f) seams.lit = std::max(seams.lit, seen);
            if (truth.visibility[at(x, y)] == 1.0f) seams.shaded = std::max(seams.shaded, 1 - seen);
        }
    return seams;
}

}  // namespace

TEST_CASE("[Lauritzen08] 4.1.1, Figure 4.1: seams at the borders of layers, and overlaps that close them",
          "[lauritzen08][4.1.1]") {
    const scenes::Scene scene = slanting_ground();
    const scenes::View camera = scenes::camera_view(scene.camera, static_cast<float>(kWidth) / kHeight);
    const scenes::ReferenceImage truth =
        scenes::trace_reference(scene, camera, scenes::light_view(scene.light, scene.bounds()), kWidth, kHeight, {});
    const auto seams = [&](const char* overlap, const char* transition) {
        const TechniqueRequest request{
            .map_size = 128,
            .set = {
                {"layers", "4"}, {"overlap", overlap}, {"transition", transition}, {"blur", "7"}, {"min-variance", "1e-3"}}};
        return measure_seams(render(scene, "lvsm", request), truth);
    };
    const Seams open = seams("0", "off");
    const Seams closed = seams("0.03", "off");
    const Seams blended = seams("0.03", "on");
    CAPTURE(open.lit, open.shaded, closed.lit, closed.shaded, blended.lit, blended.shaded);
    CHECK(open.lit > 0.9);
    CHECK(open.shaded > 0.1);
    // Right behind a split a receiver lies delta / (1/4 + 2 delta) into its layer, and the least variance v lets through
    // v / (v + that squared); all occluders are at 0.
    const double within = 0.03 / (0.25 + 2 * 0.03);
    CHECK(closed.lit <= 1e-3 / (1e-3 + within * within) + 1e-3);
    CHECK(closed.shaded < 1e-3);
    CHECK(blended.lit <= closed.lit);
    CHECK(blended.shaded < 0.02);
}

TEST_CASE("[Lauritzen08] 4.1.3: a transition runs from one layer into the next without a step", "[lauritzen08][4.1.3]") {
    // Layers of any width, narrower than two overlaps too, each with a visibility of its own; depth in steps of 2^-16.
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        oracle::Random random(seed);
        const int count = random.integer(2, kMaxDepthLayers);
        std::vector<double> splits;
        for (int i = 1; i < count; ++i) splits.push_back((i + 0.8 * static_cast<double>(random.unit()) - 0.4) / count);
        const DepthLayers layers = make_layers(splits, 0.001 + 0.249 * static_cast<double>(random.unit()));
        std::vector<double> visibility;
        for (int i = 0; i < count; ++i) visibility.push_back(static_cast<double>(random.unit()));
        float steepest = 0.0f;
        for (const float fade : layers.fade) steepest = std::max(steepest, fade);

        double before = 0;
        for (int step = 0; step <= 1 << 16; ++step) {
            const auto chosen = choose_layers(layers, Double(step * 0x1p-16));
            const auto of = [&](const Double& layer) { return visibility[static_cast<std::size_t>(lane(layer, 0))]; };
            const double share = lane(chosen.share, 0);
            REQUIRE((share >= 0 && share <= 0.5));
            const double seen = of(chosen.layer) + (of(chosen.neighbour) - of(chosen.layer)) * share;
            // Visibilities differ by at most 1, and a share moves by at most the fade times a step.
            if (step > 0 && std::fabs(seen - before) > static_cast<double>(steepest) * 0x1p-16 + 1e-12)
                FAIL(fmt::format("seed {} depth {:a}: {:a} after {:a}", seed, step * 0x1p-16, seen, before));
            before = seen;
        }
    }
}
