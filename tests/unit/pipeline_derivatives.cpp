// Derivative provenance: which lanes fed a derivative is counted exactly and drawn into the report. pipeline/derivatives.h
#include "pipeline/program.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

enum class Where { Straight, AfterDiscard, InsideBranch, ImplicitLod, PerSample };

struct Screen {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    struct Varyings {
        Real a, b;
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{v.in.position, Varyings<Real>{v.in.a, v.in.b}};
    }
};

/// Takes two derivatives; pixels whose column modulo `period` is `column` are the odd ones out.
template <Where kWhere>
struct Takes {
    int period = 1;
    int column = -1;
    TextureId texture;
    static constexpr bool discards = kWhere == Where::AfterDiscard || kWhere == Where::PerSample;
    static constexpr bool per_sample = kWhere == Where::PerSample;
    static constexpr auto fields() {
        return std::tuple{Field{"period", &Takes::period}, Field{"column", &Takes::column}, Field{"texture", &Takes::texture}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Mask odd = (x & Int(period - 1)) == Int(column);
        Real sum(0.0f);
        const auto take = [&] { sum = f.ddx(f.in.a) + f.ddy_fine(f.in.b); };
        if constexpr (kWhere == Where::Straight) take();
        if constexpr (kWhere == Where::AfterDiscard) {
            f.discard(odd);
            take();
        }
        if constexpr (kWhere == Where::InsideBranch) f.branch((x & Int(period - 1)) != Int(column), take);
        if constexpr (kWhere == Where::ImplicitLod) {
            const Sampler sampler{.mip = MipFilter::Linear};
            sum = f.sample(texture, sampler, Vec2<Real>{f.in.a, f.in.b}).x;
            (void)f.sample_level(texture, sampler, Vec2<Real>{f.in.a, f.in.b}, Real(0.0f));  // takes none
        }
        if constexpr (kWhere == Where::PerSample) {
            if (f.sample_index() == 1) f.discard(odd);
            take();
        }
        return Vec4<Real>{sum, sum, sum, Real(1.0f)};
    }
};

struct Setup {
    int period = 1;
    int column = -1;
    TextureId texture = TextureId::None;
};

template <Where kWhere>
const Program& program() {
    static const std::string name = fmt::format("test.takes.{}", static_cast<int>(kWhere));
    static const Program made = make_program<Screen, Takes<kWhere>>(name);
    return made;
}

constexpr int kSize = 16;

/// What the pixel (x, y) reports, from what every pixel of its quad is.
using Expected = std::function<std::uint32_t(int x, int y)>;

struct Outcome {
    Counters counters;
    std::vector<std::uint32_t> report;
};

Outcome run(const Program& program, Setup setup, const std::vector<Box>& boxes, int threads = 1) {
    Canvas canvas(load_profile("d3d11"), kSize, kSize, 1, threads);
    setup.texture = canvas.device.create_texture("texture", {.width = 8, .height = 8, .levels = 4});
    std::vector<TestVertex> v;
    for (const Box& box : boxes)
        for (const TestVertex& vertex : canvas.corners(box, 0.5f)) v.push_back(vertex);
    Draw draw = make_draw(program, upload(canvas.device, v), 0, static_cast<std::uint32_t>(v.size()));
    draw.pixel_constants = constants_of(setup);
    draw.color[0] = canvas.target(Format::R32Float);
    draw.derivative_report = canvas.target(Format::R32Uint);
    canvas.device.execute(ClearColor{draw.derivative_report, glm::vec4(99.0f)});
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    return {canvas.device.take_counters(), codes_of(canvas.device.texture(draw.derivative_report))};
}

void check_report(const Outcome& outcome, const Expected& expected) {
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            INFO("pixel " << x << ", " << y);
            CHECK(outcome.report[static_cast<std::size_t>(y * kSize + x)] == expected(x, y));
        }
}

constexpr std::uint32_t kUntouched = 99;

}  // namespace

TEST_CASE("derivatives of whole quads are sound", "[derivatives][counters]") {
    // [2, 10) x [4, 8) is made of quads, but its diagonal cuts some of them: both triangles have helpers there.
    const Outcome outcome = run(program<Where::Straight>(), {}, {{2, 4, 10, 8}});
    CHECK(outcome.counters.derivatives == 2 * 32);
    CHECK(outcome.counters.derivatives_killed == 0);
    CHECK(outcome.counters.derivatives_inactive == 0);
    CHECK(outcome.counters.derivatives_helper == outcome.counters.invalid_derivatives);
    // One triangle over everything has none.
    const Outcome whole = run(program<Where::Straight>(), {}, {{0, 0, 64, 64}});
    CHECK(whole.counters.derivatives == 2 * kSize * kSize);
    CHECK(whole.counters.invalid_derivatives == 0);
    CHECK(whole.counters.lanes_helper == 0);
    check_report(whole, [](int, int) { return 0u; });
}

TEST_CASE("helper lanes are counted and shown", "[derivatives][counters]") {
    // Column 15 is not covered: boxes reach far up and left, so that their diagonals do not pass the target.
    const Outcome outcome = run(program<Where::Straight>(), {}, {{-4096, -4096, 15, 256}});
    CHECK(outcome.counters.derivatives == 2 * 15 * 16);
    CHECK(outcome.counters.derivatives_helper == 2 * 16);
    CHECK(outcome.counters.invalid_derivatives == 2 * 16);
    CHECK(outcome.counters.lanes_helper == 16);
    check_report(outcome, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
}

TEST_CASE("discarded lanes are counted and shown", "[derivatives][counters][discard]") {
    // Every fourth column from 1 on is discarded before the derivatives: its neighbour in the quad knows.
    const Outcome outcome = run(program<Where::AfterDiscard>(), {.period = 4, .column = 1}, {{0, 0, 64, 64}});
    CHECK(outcome.counters.lanes_discarded == 4 * 16);
    CHECK(outcome.counters.derivatives == 2 * 12 * 16);
    CHECK(outcome.counters.derivatives_killed == 2 * 4 * 16);
    CHECK(outcome.counters.derivatives_helper == 0);
    CHECK(outcome.counters.derivatives_inactive == 0);
    CHECK(outcome.counters.invalid_derivatives == 2 * 4 * 16);
    check_report(outcome, [](int x, int) { return x % 4 == 1 ? kUntouched : x % 4 == 0 ? std::uint32_t{kFromKilled} : 0u; });
}

TEST_CASE("lanes outside a branch are counted and shown", "[derivatives][counters]") {
    const Outcome outcome = run(program<Where::InsideBranch>(), {.period = 4, .column = 2}, {{0, 0, 64, 64}});
    CHECK(outcome.counters.derivatives == 2 * 12 * 16);
    CHECK(outcome.counters.derivatives_inactive == 2 * 4 * 16);
    CHECK(outcome.counters.derivatives_killed == 0);
    CHECK(outcome.counters.derivatives_helper == 0);
    CHECK(outcome.counters.invalid_derivatives == 2 * 4 * 16);
    check_report(outcome, [](int x, int) { return x % 4 == 3 ? std::uint32_t{kFromInactive} : 0u; });
    // A branch that whole quads take or leave is sound.
    const Outcome quads = run(program<Where::InsideBranch>(), {.period = 1, .column = -1}, {{0, 0, 64, 64}});
    CHECK(quads.counters.derivatives == 2 * 256);
    CHECK(quads.counters.invalid_derivatives == 0);
}

TEST_CASE("a lane is a helper, discarded or outside, and one derivative counts once as invalid", "[derivatives][counters]") {
    // Rows 0 to 14: row 15 is of helpers. A helper that would be discarded, or stands outside, is a helper.
    const Outcome killed = run(program<Where::AfterDiscard>(), {.period = 2, .column = 1}, {{-4096, -4096, 256, 15}});
    CHECK(killed.counters.derivatives == 2 * 8 * 15);
    CHECK(killed.counters.derivatives_killed == 2 * 8 * 15);
    CHECK(killed.counters.derivatives_helper == 2 * 8);
    CHECK(killed.counters.invalid_derivatives == 2 * 8 * 15);
    check_report(killed, [](int x, int y) {
        return y == 15 || x % 2 == 1 ? kUntouched
               : y == 14             ? std::uint32_t{kFromHelper | kFromKilled}
                                     : std::uint32_t{kFromKilled};
    });
    // Column 15 is of helpers and would be discarded: column 14 has helpers beside it and nothing discarded.
    const Outcome edge = run(program<Where::AfterDiscard>(), {.period = 16, .column = 15}, {{-4096, -4096, 15, 256}});
    CHECK(edge.counters.lanes_discarded == 0);
    CHECK(edge.counters.derivatives_helper == 2 * 16);
    CHECK(edge.counters.derivatives_killed == 0);
    check_report(edge, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
    const Outcome outside = run(program<Where::InsideBranch>(), {.period = 16, .column = 15}, {{-4096, -4096, 15, 256}});
    CHECK(outside.counters.derivatives_inactive == 0);
    CHECK(outside.counters.derivatives_helper == 2 * 16);
}

TEST_CASE("implicit levels of detail are derivatives, explicit ones are not", "[derivatives][counters]") {
    const Outcome outcome = run(program<Where::ImplicitLod>(), {}, {{-4096, -4096, 15, 256}});
    CHECK(outcome.counters.texture_instructions == 2 * 15 * 16);
    CHECK(outcome.counters.derivatives == 15 * 16);
    CHECK(outcome.counters.derivatives_helper == 16);
    CHECK(outcome.counters.invalid_derivatives == 16);
    check_report(outcome, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
}

TEST_CASE("the report is the same without counters, and nothing is noted without a report", "[derivatives]") {
    for (const bool counting : {false, true}) {
        Canvas canvas(load_profile("d3d11"), kSize, kSize, 1, 3);
        const Setup setup{.period = 4, .column = 1, .texture = canvas.image(Image(canvas.pixels()))};
        Draw draw =
            make_draw(program<Where::AfterDiscard>(), upload(canvas.device, canvas.corners({0, 0, 64, 64}, 0.5f)), 0, 6);
        draw.pixel_constants = constants_of(setup);
        draw.color[0] = canvas.target(Format::R32Float);
        draw.derivative_report = canvas.target(Format::R32Uint);
        canvas.device.enable_counters(counting);
        canvas.device.execute(draw);
        for (std::size_t i = 0; i < canvas.pixels(); ++i)
            CHECK(canvas.code(draw.derivative_report, i) == (i % 4 == 0 ? std::uint32_t{kFromKilled} : 0u));
        CHECK((canvas.device.take_counters().derivatives_killed > 0) == counting);
    }
}

TEST_CASE("the report of a pixel shaded per sample has the causes of all of its runs", "[derivatives][msaa]") {
    // The run for sample 1 discards column 1 of 4; the last run has nothing to say.
    Canvas canvas(load_profile("d3d11"), kSize, kSize, 4, 1);
    const Setup setup{.period = 4, .column = 1, .texture = canvas.image(Image(canvas.pixels()))};
    Draw draw = make_draw(program<Where::PerSample>(), upload(canvas.device, canvas.corners({0, 0, 64, 64}, 0.5f)), 0, 6);
    draw.pixel_constants = constants_of(setup);
    draw.color[0] = canvas.target(Format::R32Float);
    draw.derivative_report =
        canvas.device.create_texture("report", {.format = Format::R32Uint, .width = kSize, .height = kSize});
    canvas.device.execute(ClearColor{draw.derivative_report, glm::vec4(99.0f)});
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    const Counters counters = canvas.device.take_counters();
    CHECK(counters.lanes_discarded == 4 * 16);
    CHECK(counters.derivatives == 2 * (4 * 256 - 4 * 16));
    CHECK(counters.derivatives_killed == 2 * 4 * 16);
    const auto report = codes_of(canvas.device.texture(draw.derivative_report));
    for (std::size_t i = 0; i < report.size(); ++i) {
        INFO("pixel " << i);
        CHECK(report[i] == (i % 4 == 0 ? std::uint32_t{kFromKilled} : 0u));
    }
}
