// Derivative provenance: which lanes fed a derivative is counted exactly and drawn into the report. pipeline/derivatives.h
#include "pipeline/program.h"
#include "tests/oracle/random.h"
#include "tests/oracle/samples.h"
#include "tests/unit/output_programs.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

enum class Where { Straight, AfterDiscard, InsideBranch, ImplicitLod, ImplicitSlice, ImplicitComparison, PerSample };

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
        if constexpr (kWhere == Where::ImplicitSlice) {
            const Sampler sampler{.mip = MipFilter::Linear};
            sum = f.sample(texture, sampler, Vec3<Real>{f.in.a, f.in.b, f.in.a}).x;
            (void)f.sample_level(texture, sampler, Vec3<Real>{f.in.a, f.in.b, f.in.a}, Real(0.0f));  // takes none
        }
        if constexpr (kWhere == Where::ImplicitComparison) {
            const Sampler sampler{.max_anisotropy = 16};
            sum = f.sample_compare_quad(texture, sampler, Vec2<Real>{f.in.a, f.in.b}, Real(0.5f));
            (void)f.sample_compare_quad(texture, {}, Vec2<Real>{f.in.a, f.in.b}, Real(0.5f));  // takes none
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
    // Column 14 reads it along the row, and not along its own column.
    CHECK(outcome.counters.derivatives == 2 * 15 * 16);
    CHECK(outcome.counters.derivatives_helper == 16);
    CHECK(outcome.counters.invalid_derivatives == 16);
    CHECK(outcome.counters.lanes_helper == 16);
    check_report(outcome, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
}

TEST_CASE("discarded lanes are counted and shown", "[derivatives][counters][discard]") {
    // Every fourth column from 1 on is discarded before the derivatives: its neighbour in the row knows.
    const Outcome outcome = run(program<Where::AfterDiscard>(), {.period = 4, .column = 1}, {{0, 0, 64, 64}});
    CHECK(outcome.counters.lanes_discarded == 4 * 16);
    CHECK(outcome.counters.derivatives == 2 * 12 * 16);
    CHECK(outcome.counters.derivatives_killed == 4 * 16);
    CHECK(outcome.counters.derivatives_helper == 0);
    CHECK(outcome.counters.derivatives_inactive == 0);
    CHECK(outcome.counters.invalid_derivatives == 4 * 16);
    check_report(outcome, [](int x, int) { return x % 4 == 1 ? kUntouched : x % 4 == 0 ? std::uint32_t{kFromKilled} : 0u; });
}

TEST_CASE("lanes outside a branch are counted and shown", "[derivatives][counters]") {
    const Outcome outcome = run(program<Where::InsideBranch>(), {.period = 4, .column = 2}, {{0, 0, 64, 64}});
    CHECK(outcome.counters.derivatives == 2 * 12 * 16);
    CHECK(outcome.counters.derivatives_inactive == 4 * 16);
    CHECK(outcome.counters.derivatives_killed == 0);
    CHECK(outcome.counters.derivatives_helper == 0);
    CHECK(outcome.counters.invalid_derivatives == 4 * 16);
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
    // The coarse ones read the upper row, in which there is no helper; the fine ones of row 14 their own column.
    CHECK(killed.counters.derivatives_killed == 8 * 15);
    CHECK(killed.counters.derivatives_helper == 8);
    CHECK(killed.counters.invalid_derivatives == 8 * 15 + 8);
    check_report(killed, [](int x, int y) {
        return y == 15 || x % 2 == 1 ? kUntouched
               : y == 14             ? std::uint32_t{kFromHelper | kFromKilled}
                                     : std::uint32_t{kFromKilled};
    });
    // Column 15 is of helpers and would be discarded: column 14 has helpers beside it and nothing discarded.
    const Outcome edge = run(program<Where::AfterDiscard>(), {.period = 16, .column = 15}, {{-4096, -4096, 15, 256}});
    CHECK(edge.counters.lanes_discarded == 0);
    CHECK(edge.counters.derivatives_helper == 16);
    CHECK(edge.counters.derivatives_killed == 0);
    check_report(edge, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
    const Outcome outside = run(program<Where::InsideBranch>(), {.period = 16, .column = 15}, {{-4096, -4096, 15, 256}});
    CHECK(outside.counters.derivatives_inactive == 0);
    CHECK(outside.counters.derivatives_helper == 16);
}

TEST_CASE("implicit levels of detail are derivatives, explicit ones are not", "[derivatives][counters]") {
    for (const Program* instruction :
         {&program<Where::ImplicitLod>(), &program<Where::ImplicitSlice>(), &program<Where::ImplicitComparison>()}) {
        const Outcome outcome = run(*instruction, {}, {{-4096, -4096, 15, 256}});
        CHECK(outcome.counters.texture_instructions == 2 * 15 * 16);
        CHECK(outcome.counters.derivatives == 15 * 16);
        CHECK(outcome.counters.derivatives_helper == 16);
        CHECK(outcome.counters.invalid_derivatives == 16);
        check_report(outcome, [](int x, int) { return x == 15 ? kUntouched : x == 14 ? std::uint32_t{kFromHelper} : 0u; });
    }
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
    CHECK(counters.derivatives_killed == 4 * 16);
    const auto report = codes_of(canvas.device.texture(draw.derivative_report));
    for (std::size_t i = 0; i < report.size(); ++i) {
        INFO("pixel " << i);
        CHECK(report[i] == (i % 4 == 0 ? std::uint32_t{kFromKilled} : 0u));
    }
}

namespace {

enum class Kind { DdxFine, DdyFine, DdxCoarse, DdyCoarse, Lod };
constexpr std::array kKinds{Kind::DdxFine, Kind::DdyFine, Kind::DdxCoarse, Kind::DdyCoarse, Kind::Lod};

// Pixels that are discarded, and pixels outside of the branch.
template <class Number>
auto is_killed(Number x, Number y, Number period) {
    return ((x * Number(3) + y * Number(5)) & (period - Number(1))) == Number(2);
}
template <class Number>
auto is_inactive(Number x, Number y, Number period) {
    return ((x * Number(5) + y * Number(7)) & (period - Number(1))) == Number(4);
}

/// One derivative of one kind, inside a branch and after a discard.
template <Kind kKind, bool kPerSample>
struct TakesOne {
    int period = 8;
    TextureId texture;
    static constexpr bool discards = true;
    static constexpr bool per_sample = kPerSample;
    static constexpr auto fields() {
        return std::tuple{Field{"period", &TakesOne::period}, Field{"texture", &TakesOne::texture}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Int y = truncate_to_int(f.position.y);
        f.discard(is_killed(x, y, Int(period)));
        Real taken(0.0f);
        f.branch(!is_inactive(x, y, Int(period)), [&] {
            if constexpr (kKind == Kind::DdxFine) taken = f.ddx_fine(f.in.a);
            if constexpr (kKind == Kind::DdyFine) taken = f.ddy_fine(f.in.a);
            if constexpr (kKind == Kind::DdxCoarse) taken = f.ddx_coarse(f.in.a);
            if constexpr (kKind == Kind::DdyCoarse) taken = f.ddy_coarse(f.in.a);
            if constexpr (kKind == Kind::Lod)
                taken = f.sample(texture, {.mip = MipFilter::Linear}, Vec2<Real>{f.in.a, f.in.b}).x;
        });
        return Vec4<Real>{taken, taken, taken, taken};
    }
};

const Program& program_taking(Kind kind, bool per_sample) {
    static const auto make = []<bool kPerSample>() {
        return std::array{
            make_program<Screen, TakesOne<Kind::DdxFine, kPerSample>>(kPerSample ? "test.each.0" : "test.one.0"),
            make_program<Screen, TakesOne<Kind::DdyFine, kPerSample>>(kPerSample ? "test.each.1" : "test.one.1"),
            make_program<Screen, TakesOne<Kind::DdxCoarse, kPerSample>>(kPerSample ? "test.each.2" : "test.one.2"),
            make_program<Screen, TakesOne<Kind::DdyCoarse, kPerSample>>(kPerSample ? "test.each.3" : "test.one.3"),
            make_program<Screen, TakesOne<Kind::Lod, kPerSample>>(kPerSample ? "test.each.4" : "test.one.4")};
    };
    static const auto once = make.operator()<false>();
    static const auto per = make.operator()<true>();
    return (per_sample ? per : once)[static_cast<std::size_t>(kind)];
}

struct Pixel {
    int x, y;
};

/// The pixels that the derivative of pixel `p` is a difference of.
std::vector<Pixel> pixels_read(Kind kind, const Pixel& p, const Profile& profile) {
    const Pixel quad{p.x & ~1, p.y & ~1};
    const int corner_y =
        profile.derivative_corner == DerivativeCorner::BottomLeft || profile.derivative_corner == DerivativeCorner::BottomRight
            ? quad.y + 1
            : quad.y;
    const int corner_x =
        profile.derivative_corner == DerivativeCorner::TopRight || profile.derivative_corner == DerivativeCorner::BottomRight
            ? quad.x + 1
            : quad.x;
    const auto row = [&](int y) { return std::vector<Pixel>{{quad.x, y}, {quad.x + 1, y}}; };
    const auto column = [&](int x) { return std::vector<Pixel>{{x, quad.y}, {x, quad.y + 1}}; };
    const auto both = [](std::vector<Pixel> a, const std::vector<Pixel>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    switch (kind) {
        case Kind::DdxFine: return row(p.y);
        case Kind::DdyFine: return column(p.x);
        case Kind::DdxCoarse: return row(corner_y);
        case Kind::DdyCoarse: return column(corner_x);
        case Kind::Lod:
            if (profile.lod_sharing == LodSharing::Quad) return both(row(corner_y), column(corner_x));
            return both(row(p.y), column(p.x));
    }
    __builtin_unreachable();
}

struct ProvenanceCase {
    Kind kind;
    Profile profile;
    int samples;
    bool per_sample;
    std::uint32_t sample_mask;
    float right, bottom;  // the pixels and samples of [0, right) x [0, bottom) are covered
    int period;
};

/// Counts and report, pixel by pixel and run by run.
Outcome expected_of(const ProvenanceCase& c) {
    Outcome expected;
    expected.report.assign(kSize * kSize, kUntouched);
    const oracle::SamplePattern pattern = oracle::standard_pattern(c.samples);
    const auto covers = [&](const Pixel& p, int s) {
        const oracle::Point at = pattern.at(p.x, p.y, s);  // 1/256 pixel
        return (c.sample_mask >> s & 1u) != 0 && static_cast<float>(at.x) < c.right * 256.0f &&
               static_cast<float>(at.y) < c.bottom * 256.0f;
    };
    const auto in_run = [&](const Pixel& p, int run) {
        if (c.per_sample) return covers(p, run);
        for (int s = 0; s < c.samples; ++s)
            if (covers(p, s)) return true;
        return false;
    };
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            for (int run = 0; run < (c.per_sample ? c.samples : 1); ++run) {
                if (!in_run({x, y}, run)) continue;
                const bool killed = is_killed(x, y, c.period);
                auto& texel = expected.report[static_cast<std::size_t>(y * kSize + x)];
                if (killed) continue;
                if (texel == kUntouched) texel = 0;
                if (is_inactive(x, y, c.period)) continue;
                std::uint32_t causes = 0;
                for (const Pixel& p : pixels_read(c.kind, {x, y}, c.profile)) {
                    if (!in_run(p, run)) {
                        causes |= kFromHelper;
                        continue;
                    }
                    if (is_killed(p.x, p.y, c.period)) causes |= kFromKilled;
                    if (is_inactive(p.x, p.y, c.period)) causes |= kFromInactive;
                }
                texel |= causes;
                ++expected.counters.derivatives;
                expected.counters.derivatives_helper += (causes & kFromHelper) != 0;
                expected.counters.derivatives_killed += (causes & kFromKilled) != 0;
                expected.counters.derivatives_inactive += (causes & kFromInactive) != 0;
                expected.counters.invalid_derivatives += causes != 0;
            }
    return expected;
}

Outcome outcome_of(const ProvenanceCase& c) {
    Canvas canvas(c.profile, kSize, kSize, c.samples);
    const Setup setup{.period = c.period,
                      .texture = canvas.device.create_texture("texture", {.width = 8, .height = 8, .levels = 4})};
    // Reaches far up and left, so that its diagonal does not pass the target.
    const auto v = canvas.corners({-4096, -4096, c.right, c.bottom}, 0.5f);
    Draw draw = make_draw(program_taking(c.kind, c.per_sample), upload(canvas.device, v), 0, 6);
    const TakesOne<Kind::Lod, false> constants{.period = setup.period, .texture = setup.texture};
    draw.pixel_constants = constants_of(constants);
    draw.color[0] = canvas.target(Format::Rgba8Unorm);
    draw.output.sample_mask = c.sample_mask;
    draw.derivative_report =
        canvas.device.create_texture("report", {.format = Format::R32Uint, .width = kSize, .height = kSize});
    canvas.device.execute(ClearColor{draw.derivative_report, glm::vec4(99.0f)});
    canvas.device.enable_counters(true);
    canvas.device.execute(draw);
    return {canvas.device.take_counters(), codes_of(canvas.device.texture(draw.derivative_report))};
}

void check_provenance(const ProvenanceCase& c) {
    const Outcome expected = expected_of(c);
    const Outcome got = outcome_of(c);
    INFO("kind " << static_cast<int>(c.kind) << ", corner " << name_of(c.profile.derivative_corner) << ", "
                 << name_of(c.profile.lod_sharing) << ", " << c.samples << " samples, per sample " << c.per_sample << ", mask "
                 << c.sample_mask << ", to " << c.right << ", " << c.bottom << ", period " << c.period);
    CHECK(got.counters.derivatives == expected.counters.derivatives);
    CHECK(got.counters.derivatives_helper == expected.counters.derivatives_helper);
    CHECK(got.counters.derivatives_killed == expected.counters.derivatives_killed);
    CHECK(got.counters.derivatives_inactive == expected.counters.derivatives_inactive);
    CHECK(got.counters.invalid_derivatives == expected.counters.invalid_derivatives);
    for (std::size_t i = 0; i < got.report.size(); ++i) {
        if (got.report[i] == expected.report[i]) continue;
        FAIL("pixel " << i % kSize << ", " << i / kSize << ": " << got.report[i] << ", expected " << expected.report[i]);
    }
}

}  // namespace

TEST_CASE("each kind of derivative answers for the lanes that it reads and no others", "[derivatives][counters][22.5]") {
    oracle::Random random(7);
    for (const auto& [corner, corner_name] : kEnumNames<DerivativeCorner>)
        for (const LodSharing sharing : {LodSharing::Quad, LodSharing::Pixel})
            for (const Kind kind : kKinds)
                for (const int samples : {1, 4}) {
                    Profile profile = load_profile("d3d11");
                    profile.derivative_corner = corner;
                    profile.lod_sharing = sharing;
                    const float right = static_cast<float>(random.integer(16, 240)) / 16.0f;
                    const float bottom = static_cast<float>(random.integer(16, 240)) / 16.0f;
                    const int period = random.chance(2) ? 8 : 64;
                    check_provenance({kind, profile, samples, false, ~0u, right, bottom, period});
                    check_provenance({kind, profile, samples, true, ~0u, right, bottom, period});
                    check_provenance({kind, profile, samples, true, 0b0110, right, bottom, period});
                }
}

TEST_CASE("in a run for one sample the lanes without it are helpers", "[derivatives][counters][msaa][3.5.4][16.13]") {
    // The edge at x = 1.5 goes through column 1: samples 0 and 2 of it (at 6/16 and 2/16) are inside, 1 and 3 are not. In the
    // runs for the latter column 1 is outside, and column 0 reads it.
    ProvenanceCase c{Kind::DdxFine, load_profile("d3d11"), 4, true, ~0u, 1.5f, 256.0f, 1 << 20};
    const Outcome got = outcome_of(c);
    CHECK(got.counters.lanes_shaded == 16 * 4 + 16 * 2);
    CHECK(got.counters.lanes_helper == 16 * 2);
    CHECK(got.counters.derivatives == 16 * 4 + 16 * 2);
    CHECK(got.counters.derivatives_helper == 16 * 2);
    check_provenance(c);
    // Once per pixel both columns are pixels of the primitive.
    c.per_sample = false;
    CHECK(outcome_of(c).counters.derivatives_helper == 0);
}

namespace {

/// Column 15 goes into a branch and comes out with another value, of which the derivative is taken afterwards.
struct BranchesBefore {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Mask last = truncate_to_int(f.position.x) == Int(15);
        Real value(1.0f);
        f.branch(last, [&] { value = select(last, Real(6.0f), value); });
        const Real slope = f.ddx_fine(value);
        return Vec4<Real>{slope, slope, slope, slope};
    }
};

}  // namespace

TEST_CASE("helper lanes go into branches, whatever pixels share their wave", "[derivatives][16.13]") {
    static const Program program = make_program<Screen, BranchesBefore>("test.branches-before");
    const BranchesBefore constants;
    for (const float right : {15.0f, 16.0f}) {
        Canvas canvas(load_profile("d3d11"), kSize, kSize);
        Draw draw = make_draw(program, upload(canvas.device, canvas.corners({-4096, -4096, right, 256}, 0.5f)), 0, 6);
        draw.pixel_constants = constants_of(constants);
        draw.color[0] = canvas.target(Format::R32Float);
        canvas.device.execute(draw);
        for (std::size_t y = 0; y < kSize; ++y) CHECK(canvas.value(draw.color[0].texture, y * kSize + 14) == 5.0f);
    }
}
