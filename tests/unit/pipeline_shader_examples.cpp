// The shader functors that docs/shaders.md quotes, drawn with. A test (check_quotes.cmake) compares the page with this file.
#include "pipeline/compute.h"
#include "pipeline/device.h"
#include "pipeline/program.h"

#include <catch2/catch.hpp>

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <vector>

using namespace gnomon;

namespace {

struct Flat2d {
    glm::vec2 scale{1.0f};

    template <class Real>
    struct Input {
        Vec2<Real> position;
        Vec2<Real> uv;
    };
    template <class Real>
    struct Varyings {
        Vec2<Real> uv;
    };
    static constexpr auto fields() { return std::tuple{Field{"scale", &Flat2d::scale}}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> position{v.in.position.x * Real(scale.x), v.in.position.y * Real(scale.y), Real(0.5f), Real(1.0f)};
        return VertexOutput{position, Varyings<Real>{v.in.uv}};
    }
};

struct Cutout {
    static constexpr bool discards = true;
    float threshold = 0.5f;
    static constexpr auto fields() { return std::tuple{Field{"threshold", &Cutout::threshold}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real slope = f.ddx(f.in.uv.x);  // before the discard: sound
        f.discard(f.in.uv.x < Real(threshold));
        return Vec4<Real>{f.in.uv.x, slope, Real(0.0f), Real(1.0f)};
    }
};

struct BranchOnU {
    float threshold = 0.5f;
    static constexpr auto fields() { return std::tuple{Field{"threshold", &BranchOnU::threshold}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        Real value(0.0f);
        const Mask right = f.in.uv.x > Real(threshold);
        f.branch(right, [&] { value = select(right, f.ddx(f.in.uv.x), value); });
        return Vec4<Real>{value, value, value, Real(1.0f)};
    }
};

struct Bump {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec4<Real> color{f.in.uv.x, f.in.uv.y, Real(0.0f), Real(1.0f)};
        return DepthOutput{color, f.position.z + Real(0.25f) * f.in.uv.x};
    }
};

struct ScreenDoor {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec4<Real> color{Real(1.0f), Real(1.0f), Real(1.0f), Real(1.0f)};
        return CoverageOutput{color, select(f.in.uv.x > Real(0.5f), Int(0xf), Int(0x5))};
    }
};

struct Striped {
    static constexpr bool per_sample = true;
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real index(static_cast<float>(f.sample_index()));
        return Vec4<Real>{f.position.x, f.position.y, index, Real(1.0f)};
    }
};

struct CountVisible {
    static constexpr bool force_early = true;
    static constexpr bool discards = true;
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        f.discard(f.in.uv.x < Real(0.5f));
        return Vec4<Real>{Real(1.0f), Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

struct ResolveNearest {
    MultisampledTexture depth;
    static constexpr auto fields() { return std::tuple{Field{"depth", &ResolveNearest::depth}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Int y = truncate_to_int(f.position.y);
        Real nearest(1.0f);
        for (int s = 0; s < f.samples(depth); ++s) nearest = min(nearest, f.load(depth, x, y, s).x);
        return Vec4<Real>{nearest, Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

struct Instanced {
    template <class Real>
    struct Input {
        Vec2<Real> position;
        Vec2<Real> uv;
    };
    template <class Real>
    struct Instance {
        Vec2<Real> offset;
        Real shade;
    };
    template <class Real>
    struct Varyings {
        Real shade;
        Vec2<Real> screen;
        static constexpr std::array interpolation{Interpolation::Flat, Interpolation::Linear, Interpolation::LinearCentroid};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> position{v.in.position.x + v.instance.offset.x, v.in.position.y + v.instance.offset.y, Real(0.5f),
                                  Real(1.0f)};
        return LayeredVertexOutput{position, Varyings<Real>{v.instance.shade, v.in.uv}, v.instance_id, Int(0)};
    }
};

struct Shade {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return std::array{Vec4<Real>{f.in.shade, f.in.screen.x, f.in.screen.y, Real(1.0f)},
                          Vec4<Real>{Real(static_cast<float>(f.layer())), Real(0.0f), Real(0.0f), Real(1.0f)}};
    }
};

struct FlatVertex {
    float x, y, u, v;
};

/// Covers all of a target of any size; u and v run from 0 to 1 over it.
constexpr std::array kFullScreen{FlatVertex{-1, 1, 0, 0}, FlatVertex{3, 1, 2, 0}, FlatVertex{-1, -3, 0, 2}};

/// A device with the full-screen triangle and square targets of 4 pixels a side, whose values it hands out.
class Canvas {
public:
    static constexpr int kSide = 4;

    TextureId target(Format format, int samples = 1, int layers = 1) {
        return device.create_texture("target", {.format = format,
                                                .width = kSide,
                                                .height = kSide,
                                                .kind = layers > 1 ? TextureKind::Array : TextureKind::Flat,
                                                .layers = layers,
                                                .samples = samples});
    }

    template <class Vertex, class Pixel>
    Draw draw(const Program& program, const Vertex& vertex, const Pixel& pixel) {
        Draw draw{.program = &program,
                  .vertex_constants = constants_of(vertex),
                  .pixel_constants = constants_of(pixel),
                  .vertices = triangle_,
                  .count = 3};
        return draw;
    }

    /// One component of a texture of 32-bit floats.
    float at(TextureId id, int x, int y, int component = 0, int layer = 0, int sample = 0) {
        const Texture& texture = device.texture(id);
        float value = 0;
        std::memcpy(&value, texture.row(0, y, layer, sample) + (x * texture.info().components + component) * int{sizeof(float)},
                    sizeof value);
        return value;
    }

    Device device{Profile{}, 1};

private:
    BufferId triangle_ = device.create_buffer("triangle", std::as_bytes(std::span(kFullScreen)));
};

// A whole draw: a square with a hole, 64 by 64 pixels, four bytes each.
std::vector<std::byte> square_with_a_hole() {
    Device device(load_profile("d3d11"));  // all processors; Device(profile, 1) is one thread, with the same bytes
    const std::array<float, 16> corners{-1, -1, 0, 0, 1, -1, 1, 0, -1, 1, 0, 1, 1, 1, 1, 1};  // x, y, u, v: Flat2d::Input
    const BufferId vertices = device.create_buffer("corners", std::as_bytes(std::span(corners)));
    const TextureId color = device.create_texture("color", {.format = Format::Rgba8Unorm, .width = 64, .height = 64});
    const TextureId depth = device.create_texture("depth", {.format = Format::D32Float, .width = 64, .height = 64});
    device.execute(ClearColor{color, glm::vec4(0.0f)});
    device.execute(ClearDepth{depth, 1.0f});

    static const Program program = make_program<Flat2d, Cutout>("example.square");
    const Flat2d vertex{.scale = glm::vec2(0.5f)};
    const Cutout pixel{.threshold = 0.25f};
    Draw draw{.label = "square",
              .program = &program,
              .vertex_constants = constants_of(vertex),
              .pixel_constants = constants_of(pixel),
              .topology = Topology::TriangleStrip,
              .vertices = vertices,
              .count = 4,
              .depth = depth};
    draw.color[0] = color;
    device.execute(draw);
    return device.texture(color).level_bytes(0);
}

/// Sums of 64 numbers each, by halves.
struct SumOf64 {
    static constexpr GroupSize kGroupSize{64, 1, 1};

    ReadBuffer<float> from;
    RwBuffer<float> to;

    static constexpr auto fields() { return std::tuple{Field{"from", &SumOf64::from}, Field{"to", &SumOf64::to}}; }

    template <class G>
    void operator()(G& g) const {
        const auto sums = g.shared_real(64);
        g.threads([&](const auto& t) { t.store(sums, t.index, t.load(from, t.id.x)); });
        for (int half = 32; half > 0; half /= 2) {
            g.threads(half, [&](const auto& t) {
                t.store(sums, t.index, t.load(sums, t.index) + t.load(sums, t.index + Int(half)));
            });
        }
        g.threads(1, [&](const auto& t) { t.store(to, Int(g.id.x), t.load(sums, Int(0))); });
    }
};

std::vector<float> sums_of(const std::vector<float>& numbers) {
    Device device(load_profile("d3d11"));
    const std::size_t groups = numbers.size() / 64;
    const BufferId from = device.create_buffer("numbers", std::as_bytes(std::span(numbers)));
    const BufferId to = device.create_zeroed_buffer("sums", groups * sizeof(float));
    static const ComputeProgram program = make_compute_program<SumOf64>("example.sum_of_64");
    const SumOf64 functor{.from = {from}, .to = {to}};
    device.execute(Dispatch{.label = "sums",
                            .program = &program,
                            .constants = constants_of(functor),
                            .groups_x = static_cast<std::uint32_t>(groups)});
    std::vector<float> sums(groups);
    std::memcpy(sums.data(), device.buffer(to).data.data(), groups * sizeof(float));
    return sums;
}

}  // namespace

TEST_CASE("example: discard", "[shaders][22.5.1]") {
    static const Program program = make_program<Flat2d, Cutout>("example.cutout");
    Canvas canvas;
    const Cutout pixel{.threshold = 0.5f};
    const Flat2d vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const TextureId color = canvas.target(Format::Rgba32Float);
    draw.color[0] = color;
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    CHECK(canvas.at(color, 1, 2) == 0.0f);
    CHECK(canvas.at(color, 2, 2) == 0.625f);
    CHECK(canvas.at(color, 2, 2, 1) == 0.25f);
    const Counters counters = canvas.device.take_counters();
    CHECK(counters.lanes_discarded == 8);
    CHECK(counters.invalid_derivatives == 0);
}

TEST_CASE("example: a derivative inside a branch, and its report", "[shaders][22.5]") {
    static const Program program = make_program<Flat2d, BranchOnU>("example.branch");
    Canvas canvas;
    // u is 1/8, 3/8, 5/8, 7/8: of the first quad of each row one column is outside of the branch.
    const BranchOnU pixel{.threshold = 0.3f};
    const Flat2d vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const TextureId color = canvas.target(Format::Rgba32Float);
    draw.color[0] = color;
    draw.derivative_report = canvas.device.create_texture("report", {.format = Format::R32Uint, .width = 4, .height = 4});
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    const Counters counters = canvas.device.take_counters();
    CHECK(counters.derivatives == 12);
    CHECK(counters.derivatives_helper == 0);
    std::uint64_t inactive = 0;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            std::uint32_t causes = 0;
            std::memcpy(&causes, canvas.device.texture(draw.derivative_report).row(0, y) + x * 4, 4);
            CHECK((causes & ~std::uint32_t{kFromInactive}) == 0);
            inactive += causes == kFromInactive ? 1 : 0;
        }
    }
    CHECK(inactive == counters.derivatives_inactive);
    CHECK(inactive == 4);
}

TEST_CASE("example: a depth of the functor's own", "[shaders][16.9.2]") {
    static const Program program = make_program<Flat2d, Bump>("example.bump");
    Canvas canvas;
    const Bump pixel;
    const Flat2d vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const TextureId depth = canvas.target(Format::D32Float);
    draw.color[0] = canvas.target(Format::Rgba32Float);
    draw.depth = depth;
    canvas.device.execute(ClearDepth{draw.depth, 1.0f});
    canvas.device.execute(draw);
    CHECK(canvas.at(depth, 0, 0) == 0.5f + 0.25f * 0.125f);
    CHECK(canvas.at(depth, 3, 0) == 0.5f + 0.25f * 0.875f);
}

TEST_CASE("example: a coverage mask of the functor's own, and its samples resolved by a functor", "[shaders][16.9.4]") {
    static const Program door = make_program<Flat2d, ScreenDoor>("example.screen_door");
    static const Program resolve = make_program<Flat2d, ResolveNearest>("example.resolve_nearest");
    Canvas canvas;
    const Flat2d vertex;
    const ScreenDoor pixel;
    Draw draw = canvas.draw(door, vertex, pixel);
    const TextureId color = canvas.target(Format::R32Float, 4);
    const TextureId depth = canvas.target(Format::D32Float, 4);
    draw.color[0] = color;
    draw.depth = depth;
    canvas.device.execute(ClearDepth{draw.depth, 1.0f});
    canvas.device.execute(draw);
    for (int s = 0; s < 4; ++s) {
        CHECK(canvas.at(color, 0, 0, 0, 0, s) == (s % 2 == 0 ? 1.0f : 0.0f));
        CHECK(canvas.at(color, 3, 0, 0, 0, s) == 1.0f);
    }

    const ResolveNearest nearest{.depth = {depth}};
    Draw pass = canvas.draw(resolve, vertex, nearest);
    const TextureId resolved = canvas.target(Format::R32Float);
    pass.color[0] = resolved;
    canvas.device.execute(pass);
    CHECK(canvas.at(resolved, 0, 0) == 0.5f);
    // Where no sample was drawn the far plane is left.
    canvas.device.execute(ClearDepth{depth, 0.75f});
    canvas.device.execute(pass);
    CHECK(canvas.at(resolved, 0, 0) == 0.75f);
}

TEST_CASE("example: once per sample", "[shaders][3.5.4]") {
    static const Program program = make_program<Flat2d, Striped>("example.striped");
    Canvas canvas;
    const Striped pixel;
    const Flat2d vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const TextureId color = canvas.target(Format::Rgba32Float, 4);
    draw.color[0] = color;
    canvas.device.execute(draw);
    for (int s = 0; s < 4; ++s) {
        const SamplePosition& at = kStandardSamples4[static_cast<std::size_t>(s)];
        CHECK(canvas.at(color, 1, 2, 0, 0, s) == 1.0f + static_cast<float>(at.x) / 16.0f);
        CHECK(canvas.at(color, 1, 2, 1, 0, s) == 2.0f + static_cast<float>(at.y) / 16.0f);
        CHECK(canvas.at(color, 1, 2, 2, 0, s) == static_cast<float>(s));
    }
}

TEST_CASE("example: early tests that a discard does not undo", "[shaders][16.12.1]") {
    static const Program program = make_program<Flat2d, CountVisible>("example.count_visible");
    Canvas canvas;
    const CountVisible pixel;
    const Flat2d vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const TextureId color = canvas.target(Format::Rgba32Float);
    const TextureId depth = canvas.target(Format::D32Float);
    draw.color[0] = color;
    draw.depth = depth;
    canvas.device.execute(ClearDepth{draw.depth, 1.0f});
    canvas.device.execute(draw);
    CHECK(canvas.at(color, 0, 0) == 0.0f);
    CHECK(canvas.at(color, 3, 0) == 1.0f);
    CHECK(canvas.at(depth, 0, 0) == 0.5f);  // discarded, and its depth written all the same
    CHECK(canvas.at(depth, 3, 0) == 0.5f);
}

TEST_CASE("example: instances into layers, flat and linear values", "[shaders][8.18][15.15]") {
    static const Program program = make_program<Instanced, Shade>("example.instanced");
    Canvas canvas;
    const Shade pixel;
    const Instanced vertex;
    Draw draw = canvas.draw(program, vertex, pixel);
    const std::array<float, 6> instances{0.0f, 0.0f, 0.25f, 1.0f, 0.0f, 0.75f};  // the second is half a target to the right
    draw.instances = canvas.device.create_buffer("instances", std::as_bytes(std::span(instances)));
    draw.instance_count = 2;
    const TextureId color = canvas.target(Format::Rgba32Float, 1, 2);
    const TextureId layer = canvas.target(Format::R32Float, 1, 2);
    draw.color[0] = TargetView(color, 0, 0, 2);
    draw.color[1] = TargetView(layer, 0, 0, 2);
    canvas.device.execute(draw);
    CHECK(canvas.at(color, 0, 0, 0, 0) == 0.25f);
    CHECK(canvas.at(color, 0, 0, 1, 0) == 0.125f);
    CHECK(canvas.at(color, 0, 0, 0, 1) == 0.0f);  // not reached
    CHECK(canvas.at(color, 3, 0, 0, 1) == 0.75f);
    CHECK(canvas.at(color, 3, 0, 1, 1) == 0.375f);
    CHECK(canvas.at(layer, 3, 0, 0, 1) == 1.0f);
}

TEST_CASE("example: a whole draw", "[shaders]") {
    const std::vector<std::byte> bytes = square_with_a_hole();
    REQUIRE(bytes.size() == 64 * 64 * 4);
    const auto alpha = [&](std::size_t x, std::size_t y) { return bytes[(y * 64 + x) * 4 + 3]; };
    CHECK(alpha(8, 32) == std::byte{0});     // outside
    CHECK(alpha(20, 32) == std::byte{0});    // u is below the threshold
    CHECK(alpha(30, 32) == std::byte{255});  // u is not
    CHECK(std::ranges::count(bytes, std::byte{255}) >= 32 * 24);
}

TEST_CASE("example: a dispatch", "[shaders][18.6]") {
    std::vector<float> numbers(256);
    std::iota(numbers.begin(), numbers.end(), 0.0f);
    CHECK(sums_of(numbers) == std::vector<float>{2016, 6112, 10208, 14304});
}
