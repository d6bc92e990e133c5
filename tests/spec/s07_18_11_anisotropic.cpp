// D3D11.3 7.18.11: anisotropy, from the specification's pseudo-code; the rules of EXT_texture_filter_anisotropic and Vulkan 1.3
// 16.6.7; and the probes that a filter makes of the ratio and the line.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/aniso.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

struct Vector {
    long double u = 0;
    long double v = 0;
};
long double square(long double x) { return x * x; }
long double length(const Vector& a) { return std::hypot(a.u, a.v); }
long double area(const Vector& a, const Vector& b) { return std::fabs(a.u * b.v - a.v * b.u); }

/// Derivatives of one pixel, texels of level 0.
struct Pair {
    Vector x, y;
};

/// 7.18.11, "the ideal transformation", with its caveats. sgn(0) is taken as 1: with 0, axes along u and v would vanish.
Pair ellipse(const Pair& d) {
    const bool finite = std::isfinite(d.x.u + d.x.v + d.y.u + d.y.v);
    const bool skipped =
        !finite || length(d.x) == 0 || length(d.y) == 0 || area(d.x, d.y) == 0 || d.x.u * d.y.u + d.x.v * d.y.v == 0;
    if (skipped) return d;
    const long double a = square(d.x.v) + square(d.y.v);
    const long double b = -2 * (d.x.u * d.x.v + d.y.u * d.y.v);
    const long double c = square(d.x.u) + square(d.y.u);
    const long double f = square(d.x.u * d.y.v - d.y.u * d.x.v);
    const long double p = a - c;
    const long double q = a + c;
    const long double t = std::sqrt(p * p + b * b);
    const long double sgn = b < 0 ? -1 : 1;
    const Pair axes{{std::sqrt(f * (t + p) / (t * (q + t))), std::sqrt(f * (t - p) / (t * (q + t))) * sgn},
                    {std::sqrt(f * (t - p) / (t * (q - t))) * -sgn, std::sqrt(f * (t + p) / (t * (q - t)))}};
    return std::isfinite(axes.x.u + axes.x.v + axes.y.u + axes.y.v) ? axes : d;
}

/// How far rounding may carry a result computed in steps of `epsilon`: the area of two vectors is a difference of products, the
/// direction of an ellipse's axes the quotient of two. Where an axis is much longer than the other, the literal formulas above
/// lose digits of q - t, which is f / (q + t).
struct Condition {
    long double of_area = 1;
    long double of_direction = 1;
    long double of_reference = 0;
};
Condition condition(const Pair& d) {
    const long double a = square(d.x.v) + square(d.y.v);
    const long double b = -2 * (d.x.u * d.x.v + d.y.u * d.y.v);
    const long double c = square(d.x.u) + square(d.y.u);
    return {length(d.x) * length(d.y) / area(d.x, d.y), (a + c) / std::hypot(a - c, b),
            16 * square((a + c) / area(d.x, d.y)) * std::numeric_limits<long double>::epsilon()};
}

struct Anisotropy {
    Vector line;  // end to end, texels
    long double ratio = 1;
    long double lod = 0;
    bool limited = false;
    bool magnified = false;
};

/// The pseudo-code of 7.18.11 for ComputeAnisotropicLOD, line by line.
Anisotropy anisotropic(const Pair& d, long double max_aniso, bool clamps_to_top) {
    const long double squared_length_x = square(d.x.u) + square(d.x.v);
    const long double squared_length_y = square(d.y.u) + square(d.y.v);
    const long double determinant = area(d.x, d.y);
    const bool is_major_x = squared_length_x > squared_length_y;
    const long double squared_length_major = is_major_x ? squared_length_x : squared_length_y;
    const long double length_major = std::sqrt(squared_length_major);
    Anisotropy output{.line = is_major_x ? d.x : d.y, .ratio = squared_length_major / determinant};
    long double length_minor = 0;
    if (output.ratio > max_aniso) {
        output.limited = true;
        output.ratio = max_aniso;
        length_minor = length_major / output.ratio;
    } else {
        length_minor = determinant / length_major;
    }
    if (length_minor < 1) {
        output.magnified = true;
        output.ratio = std::max(1.0L, output.ratio * length_minor);
        if (clamps_to_top) length_minor = 1;  // "part of the D3D10 spec until 8/17/2009"
    }
    output.lod = std::log2(length_minor);
    return output;
}

/// One set of derivatives per lane.
template <class Real>
LevelOfDetail<Real> detail_of(const std::vector<Pair>& pairs, const TextureView& view, const Sampler& sampler,
                              const Profile& profile) {
    const auto field = [&](auto get, int size) {
        std::array<typename Real::Scalar, kLanes> values;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<typename Real::Scalar>(get(pairs[std::min(i, pairs.size() - 1)]) / size);
        return Real::load(values.data());
    };
    const Gradients<Real> gradients{
        {field([](const Pair& p) { return p.x.u; }, view.width()), field([](const Pair& p) { return p.x.v; }, view.height())},
        {field([](const Pair& p) { return p.y.u; }, view.width()), field([](const Pair& p) { return p.y.v; }, view.height())}};
    return level_of_detail(gradients, view, sampler, profile);
}

template <class Real>
Anisotropy got_in(const LevelOfDetail<Real>& lod, const TextureView& view, int i) {
    return {.line = {static_cast<long double>(lane(lod.major.x, i)) * view.width(),
                     static_cast<long double>(lane(lod.major.y, i)) * view.height()},
            .ratio = static_cast<long double>(lane(lod.ratio, i)),
            .lod = static_cast<long double>(lane(lod.lod, i))};
}

/// What binary32 or binary64 can hold, so that the reference sees the same numbers.
template <class Real>
Vector representable(long double u, long double v) {
    using Scalar = typename Real::Scalar;
    return {static_cast<long double>(static_cast<Scalar>(u)), static_cast<long double>(static_cast<Scalar>(v))};
}

template <class Real>
Pair random_pair(oracle::Random& random) {
    const auto component = [&] { return std::ldexp(static_cast<long double>(random.in(-2.0f, 2.0f)), random.integer(-5, 5)); };
    const Vector x = representable<Real>(component(), component());
    Vector y = representable<Real>(component(), component());
    if (random.chance(3)) {  // thin: nearly parallel
        const long double k = static_cast<long double>(random.in(-3.0f, 3.0f));
        const long double off = static_cast<long double>(random.in(-0.1f, 0.1f));
        y = representable<Real>(k * x.u - off * x.v, k * x.v + off * x.u);
    }
    return {x, y};
}

std::string text(const Pair& d) {
    return fmt::format("dX ({:a}, {:a}) dY ({:a}, {:a})", static_cast<double>(d.x.u), static_cast<double>(d.x.v),
                       static_cast<double>(d.y.u), static_cast<double>(d.y.v));
}
std::string text(const Anisotropy& a) {
    return fmt::format("lod {:a} ratio {:a} line ({:a}, {:a})", static_cast<double>(a.lod), static_cast<double>(a.ratio),
                       static_cast<double>(a.line.u), static_cast<double>(a.line.v));
}

/// Roundings along the longest chain from derivatives to results: products, sums, roots and quotients.
constexpr long double kRoundings = 16;

template <class Real>
constexpr long double epsilon() {
    return std::is_same_v<Real, Float> ? 0x1p-24L : 0x1p-53L;
}

/// Error of log2 (sim/math.h): below 1.3 ULP of the larger of 1 and the result in binary32, below 2^-48 in double.
template <class Real>
long double log2_error(long double lod) {
    return std::is_same_v<Real, Float> ? 1.3L * 0x1p-23L * std::max(1.0L, std::fabs(lod)) : 0x1p-47L;
}

template <class Real>
bool agrees(const Anisotropy& got, const Anisotropy& expected, const Condition& c, bool transformed) {
    const long double step = kRoundings * epsilon<Real>() + (transformed ? c.of_reference : 0);
    const long double of_length = step * c.of_area;
    const long double of_line = step * (1 + (transformed ? c.of_direction : 0)) * length(expected.line);
    const auto line_error = [&](long double sign) {
        return std::hypot(got.line.u - sign * expected.line.u, got.line.v - sign * expected.line.v);
    };
    return std::fabs(got.lod - expected.lod) <= of_length / std::log(2.0L) + log2_error<Real>(expected.lod) &&
           std::fabs(got.ratio - expected.ratio) <= of_length * expected.ratio &&
           std::min(line_error(1), line_error(-1)) <= of_line;
}

Texture square_texture() { return Texture({.format = Format::R32Float, .width = 64, .height = 64, .levels = 7}); }

}  // namespace

TEMPLATE_TEST_CASE("the ellipse transform gives the specification's vectors", "[7.18.11]", Float, Double) {
    oracle::Random random(1);
    for (int round = 0; round < 40000; ++round) {
        const Pair d = random_pair<TestType>(random);
        const Condition c = condition(d);
        if (!(c.of_area < 1e4L && c.of_direction < 1e3L)) continue;
        const auto real = [](long double x) { return TestType(static_cast<typename TestType::Scalar>(x)); };
        const Axes<TestType> axes = ellipse_axes(Axes<TestType>{{real(d.x.u), real(d.x.v)}, {real(d.y.u), real(d.y.v)}});
        const auto back = [](const TestType& x) { return static_cast<long double>(lane(x, 0)); };
        const Pair got{{back(axes.x.x), back(axes.x.y)}, {back(axes.y.x), back(axes.y.y)}};
        const Pair expected = ellipse(d);
        const long double of_x = length(expected.x) * (c.of_area + c.of_direction);
        const long double of_y = length(expected.y) * (1 + c.of_direction);
        const long double step = kRoundings * epsilon<TestType>() + c.of_reference;
        if (std::hypot(got.x.u - expected.x.u, got.x.v - expected.x.v) > step * of_x ||
            std::hypot(got.y.u - expected.y.u, got.y.v - expected.y.v) > step * of_y)
            FAIL(fmt::format("round {} {}: {}, expected {}", round, text(d), text(got), text(expected)));
    }
}

TEMPLATE_TEST_CASE("the new vectors are orthogonal and span the same ellipse", "[7.18.11]", Float, Double) {
    oracle::Random random(2);
    for (int round = 0; round < 20000; ++round) {
        Pair d = random_pair<TestType>(random);
        if (round % 4 == 0) d = {{d.x.u, d.x.u}, {2 * d.x.u, -d.x.u / 2}};  // B is 0: axes along u and v
        const Condition c = condition(d);
        if (!(c.of_area < 1e4L)) continue;
        const auto real = [](long double x) { return TestType(static_cast<typename TestType::Scalar>(x)); };
        const Axes<TestType> axes = ellipse_axes(Axes<TestType>{{real(d.x.u), real(d.x.v)}, {real(d.y.u), real(d.y.v)}});
        const auto back = [](const TestType& x) { return static_cast<long double>(lane(x, 0)); };
        const Pair n{{back(axes.x.x), back(axes.x.y)}, {back(axes.y.x), back(axes.y.y)}};
        const auto scale = square(length(d.x)) + square(length(d.y));
        const long double step = kRoundings * epsilon<TestType>();
        const auto differs = [&](auto coefficient) { return std::fabs(coefficient(n) - coefficient(d)) > step * scale * 2; };
        const bool wrong = std::fabs(n.x.u * n.y.u + n.x.v * n.y.v) > step * length(n.x) * length(n.y) * 2 ||
                           differs([](const Pair& p) { return square(p.x.v) + square(p.y.v); }) ||
                           differs([](const Pair& p) { return -2 * (p.x.u * p.x.v + p.y.u * p.y.v); }) ||
                           differs([](const Pair& p) { return square(p.x.u) + square(p.y.u); }) ||
                           std::fabs(area(n.x, n.y) - area(d.x, d.y)) > step * area(d.x, d.y) * c.of_area;
        if (wrong) FAIL(fmt::format("round {} {} became {}", round, text(d), text(n)));
    }
}

TEMPLATE_TEST_CASE("ratio, line and level of detail are the pseudo-code's", "[7.18.11]", Float, Double) {
    const Texture texture = square_texture();
    const TextureView view(texture);
    oracle::Random random(3);
    int limited = 0;
    int magnified = 0;
    int plain = 0;
    for (int round = 0; round < 4000; ++round) {
        const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = random.integer(2, 16)};
        Profile profile;
        profile.ellipse_transform = random.chance(2);
        profile.aniso_clamps_to_top = random.chance(2);
        std::vector<Pair> pairs;
        for (int i = 0; i < kLanes; ++i) pairs.push_back(random_pair<TestType>(random));
        const LevelOfDetail<TestType> lod = detail_of<TestType>(pairs, view, sampler, profile);
        REQUIRE(lod.anisotropic);
        for (int i = 0; i < kLanes; ++i) {
            const Pair& d = pairs[static_cast<std::size_t>(i)];
            const Condition c = condition(d);
            if (!(c.of_area < 1e4L && c.of_direction < 1e3L)) continue;
            const Pair axes = profile.ellipse_transform ? ellipse(d) : d;
            if (std::fabs(length(axes.x) - length(axes.y)) < 1e-3L * length(axes.x)) continue;  // either may be the longer
            const Anisotropy expected = anisotropic(axes, sampler.max_anisotropy, profile.aniso_clamps_to_top);
            const Anisotropy got = got_in(lod, view, i);
            if (!agrees<TestType>(got, expected, c, profile.ellipse_transform))
                FAIL(fmt::format("round {} lane {} {} max {} transform {} top {}: {}, expected {}", round, i, text(d),
                                 sampler.max_anisotropy, profile.ellipse_transform, profile.aniso_clamps_to_top, text(got),
                                 text(expected)));
            limited += expected.limited;
            magnified += expected.magnified;
            plain += !expected.limited && !expected.magnified;
            // Ceil: the next whole number, unless rounding decides it.
            const long double slack = (kRoundings * epsilon<TestType>() + c.of_reference) * c.of_area * expected.ratio;
            const int probes = lane(lod.probes, i);
            if (probes < std::ceil(expected.ratio - slack) || probes > std::ceil(expected.ratio + slack))
                FAIL(fmt::format("round {} lane {} {}: {} probes, ratio {:a}", round, i, text(d), probes,
                                 static_cast<double>(expected.ratio)));
        }
    }
    CHECK(limited > 1000);
    CHECK(magnified > 1000);
    CHECK(plain > 1000);
}

TEST_CASE("derivatives scale by the size of the view's finest level", "[7.18.11]") {
    const Texture texture({.format = Format::R32Float, .width = 200, .height = 48, .levels = 5});
    const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = 16};
    Profile profile;
    profile.ellipse_transform = false;
    for (const int base : {0, 1, 3}) {
        const TextureView view(texture, base, 5 - base);
        const int width = 200 >> base;
        // 12 texels along u, 3 along v, in normalised coordinates.
        const std::vector<Pair> pairs{{{12, 0}, {0, 3}}};
        const LevelOfDetail<Double> lod = detail_of<Double>(pairs, view, sampler, profile);
        CHECK(lane(lod.ratio, 0) == Approx(4.0).epsilon(1e-12));
        CHECK(lane(lod.lod, 0) == Approx(std::log2(3.0)).epsilon(1e-12));
        CHECK(lane(lod.major.x, 0) == Approx(12.0 / width).epsilon(1e-12));
        CHECK(lane(lod.major.y, 0) == 0.0);
    }
}

TEMPLATE_TEST_CASE("vectors without an ellipse are taken as they are", "[7.18.11]", Float, Double) {
    const Texture texture = square_texture();
    const TextureView view(texture);
    Profile profile;
    REQUIRE(profile.ellipse_transform);
    // Zero length, parallel, perpendicular: the transform is skipped, the rest is the pseudo-code on exact numbers.
    const std::vector<Pair> cases{{{0, 0}, {8, 0}},    {{0, 8}, {0, 0}},      {{16, 0}, {16, 0}},        {{12, 4}, {24, 8}},
                                  {{12, 4}, {-6, -2}}, {{0, 5}, {0, -40}},    {{16, 0}, {0, 4}},         {{0, 2}, {32, 0}},
                                  {{3, 4}, {-8, 6}},   {{0.5L, 0}, {0, 2}},   {{0.25L, 0}, {0, 0.125L}}, {{0.25L, 0}, {0, 0}},
                                  {{4, 4}, {-4, 4}},   {{0, 0}, {0.5L, 0.5L}}};
    for (const Pair& d : cases)
        for (const int limit : {2, 3, 16})
            for (const bool top : {false, true}) {
                profile.aniso_clamps_to_top = top;
                const LevelOfDetail<TestType> lod =
                    detail_of<TestType>({d}, view, Sampler{.mip = MipFilter::Linear, .max_anisotropy = limit}, profile);
                const Anisotropy expected = anisotropic(d, limit, top);
                const Anisotropy got = got_in(lod, view, 0);
                INFO(text(d) << " max " << limit << " top " << top << ": " << text(got) << ", expected " << text(expected));
                CHECK(agrees<TestType>(got, expected, {}, false));
                CHECK(lane(lod.probes, 0) == static_cast<int>(std::ceil(expected.ratio - 1e-5L)));
            }
}

TEMPLATE_TEST_CASE("derivatives that are zero or not finite sample isotropically", "[7.18.11]", Float, Double) {
    // DEVIATION(D3D11.3 7.18.11): the pseudo-code would make 0/0 of them and send them to the coarsest level (texunit/aniso.h).
    using Scalar = typename TestType::Scalar;
    const long double inf = std::numeric_limits<long double>::infinity();
    const long double nan = std::numeric_limits<long double>::quiet_NaN();
    const Texture texture = square_texture();
    const TextureView view(texture);
    const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = 16};
    struct Case {
        Pair d;
        long double lod;
    };
    // max and the logarithm follow 3.1: log2(0) is -inf, a NaN operand of max gives the other.
    const std::vector<Case> cases{{{{0, 0}, {0, 0}}, -inf},    {{{inf, 0}, {0, 1}}, inf}, {{{0, 1}, {0, -inf}}, inf},
                                  {{{inf, inf}, {0, 0}}, inf}, {{{nan, 0}, {0, 4}}, 2},   {{{0, 8}, {1, nan}}, 3},
                                  {{{nan, 0}, {inf, 0}}, inf}};
    for (const bool transform : {false, true}) {
        Profile profile;
        profile.ellipse_transform = transform;
        for (const AnisoRule rule : {AnisoRule::D3d11, AnisoRule::OpenGl, AnisoRule::Vulkan}) {
            profile.aniso_rule = rule;
            for (const Case& c : cases) {
                const LevelOfDetail<TestType> lod = detail_of<TestType>({c.d}, view, sampler, profile);
                INFO(name_of(rule) << " transform " << transform << " " << text(c.d));
                CHECK(lane(lod.lod, 0) == static_cast<Scalar>(c.lod));
                CHECK(lane(lod.ratio, 0) == Scalar(1));
                CHECK(lane(lod.probes, 0) == 1);
                CHECK(lane(lod.major.x, 0) == Scalar(0));
                CHECK(lane(lod.major.y, 0) == Scalar(0));
            }
        }
    }
}

TEST_CASE("no derivatives lead out of the limits", "[7.18.11]") {
    const Texture texture = square_texture();
    const TextureView view(texture);
    int anisotropic_lanes = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        oracle::Random random(seed);
        std::vector<Pair> pairs;
        for (int i = 0; i < kLanes; ++i) {
            const auto component = [&]() -> long double {
                const float any = random.any_float();
                switch (random.integer(0, 4)) {
                    case 0: return static_cast<long double>(any);
                    case 1: return static_cast<long double>(std::ldexp(random.in(-1.0f, 1.0f), random.integer(-149, 127)));
                    case 2: return 0;
                    default: return static_cast<long double>(random.in(-40.0f, 40.0f));
                }
            };
            pairs.push_back({{component(), component()}, {component(), component()}});
        }
        Profile profile;
        const std::array rules{AnisoRule::D3d11, AnisoRule::OpenGl, AnisoRule::Vulkan};
        profile.aniso_rule = rules[static_cast<std::size_t>(random.integer(0, 2))];
        profile.ellipse_transform = random.chance(2);
        profile.aniso_clamps_to_top = random.chance(2);
        profile.probe_count = random.chance(2) ? ProbeCount::Ceil : random.chance(2) ? ProbeCount::Round : ProbeCount::Steps;
        const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = random.integer(2, 16)};
        const DenormalScope denormals(random.chance(2));
        const LevelOfDetail<Float> lod = detail_of<Float>(pairs, view, sampler, profile);
        for (int i = 0; i < kLanes; ++i) {
            const float ratio = lane(lod.ratio, i);
            const int probes = lane(lod.probes, i);
            const bool fine = ratio >= 1 && ratio <= static_cast<float>(sampler.max_anisotropy) && probes >= 1 &&
                              probes <= sampler.max_anisotropy && std::isfinite(lane(lod.major.x, i)) &&
                              std::isfinite(lane(lod.major.y, i));
            if (!fine)
                FAIL(fmt::format("seed {} lane {} {}: ratio {:a} probes {} line ({:a}, {:a})", seed, i,
                                 text(pairs[static_cast<std::size_t>(i)]), ratio, probes, lane(lod.major.x, i),
                                 lane(lod.major.y, i)));
            anisotropic_lanes += probes > 1;
        }
    }
    CHECK(anisotropic_lanes > 10000);
}

TEMPLATE_TEST_CASE("OpenGL and Vulkan divide the longer vector", "[7.18.11]", Float, Double) {
    const Texture texture = square_texture();
    const TextureView view(texture);
    oracle::Random random(5);
    for (int round = 0; round < 4000; ++round) {
        const Sampler sampler{.mip = MipFilter::Linear, .max_anisotropy = random.integer(2, 16)};
        Profile profile;
        profile.ellipse_transform = false;
        profile.aniso_rule = round % 2 == 0 ? AnisoRule::OpenGl : AnisoRule::Vulkan;
        std::vector<Pair> pairs;
        for (int i = 0; i < kLanes; ++i) pairs.push_back(random_pair<TestType>(random));
        const LevelOfDetail<TestType> lod = detail_of<TestType>(pairs, view, sampler, profile);
        for (int i = 0; i < kLanes; ++i) {
            const Pair& d = pairs[static_cast<std::size_t>(i)];
            const long double longest = std::max(length(d.x), length(d.y));
            const long double shortest = std::min(length(d.x), length(d.y));
            const long double quotient = longest / shortest;
            const long double slack = quotient * 8 * epsilon<TestType>();
            if (std::ceil(quotient - slack) != std::ceil(quotient + slack)) continue;  // rounding decides N
            // EXT_texture_filter_anisotropic: N = min(ceil(Pmax / Pmin), maxAniso), lambda = log2(Pmax / N).
            // Vulkan 1.3 (Scale Factor Operation): eta = min(rho_max / rho_min, maxAniso), N = ceil(eta), lambda = log2(rho_max
            // / eta).
            const long double whole = std::min<long double>(std::ceil(quotient), sampler.max_anisotropy);
            const long double eta = std::min<long double>(quotient, sampler.max_anisotropy);
            const long double divisor = profile.aniso_rule == AnisoRule::OpenGl ? whole : eta;
            const long double expected = std::log2(longest / divisor);
            const auto got = static_cast<long double>(lane(lod.lod, i));
            if (std::fabs(got - expected) >
                    kRoundings * epsilon<TestType>() / std::log(2.0L) + log2_error<TestType>(expected) ||
                lane(lod.probes, i) != static_cast<int>(whole))
                FAIL(fmt::format("round {} lane {} {} max {} {}: lod {:a} probes {}, expected {:a} and {}", round, i, text(d),
                                 sampler.max_anisotropy, name_of(profile.aniso_rule), static_cast<double>(got),
                                 lane(lod.probes, i), static_cast<double>(expected), static_cast<double>(whole)));
        }
    }
}

TEST_CASE("every ratio gets the number of probes its rule says", "[7.18.11]") {
    const Texture texture = square_texture();
    const TextureView view(texture);
    for (const ProbeCount rule : {ProbeCount::Ceil, ProbeCount::Round, ProbeCount::Steps})
        for (const AnisoLimits limits : {AnisoLimits::Any, AnisoLimits::Steps})
            for (int max_anisotropy = 2; max_anisotropy <= 16; ++max_anisotropy)
                for (int sixteenths = 16; sixteenths <= 20 * 16; ++sixteenths) {
                    Profile profile;
                    profile.probe_count = rule;
                    profile.aniso_limits = limits;
                    const double ratio = sixteenths / 16.0;
                    const std::vector<Pair> pairs{{{static_cast<long double>(2 * ratio), 0}, {0, 2}}};
                    const LevelOfDetail<Float> lod = detail_of<Float>(
                        pairs, view, Sampler{.mip = MipFilter::Linear, .max_anisotropy = max_anisotropy}, profile);

                    constexpr std::array kSteps{1, 2, 4, 6, 8, 10, 12, 16};
                    int limit = max_anisotropy;
                    if (limits == AnisoLimits::Steps)
                        for (const int step : kSteps)
                            if (step <= max_anisotropy) limit = step;
                    const double clamped = std::min(ratio, static_cast<double>(limit));
                    int expected = 0;
                    switch (rule) {
                        case ProbeCount::Ceil: expected = static_cast<int>(std::ceil(clamped)); break;
                        case ProbeCount::Round: expected = static_cast<int>(std::floor(clamped + 0.5)); break;
                        case ProbeCount::Steps:
                            for (const int step : kSteps)
                                if (expected < clamped) expected = step;
                            break;
                    }
                    expected = std::min(expected, max_anisotropy);
                    if (lane(lod.probes, 0) != expected || lane(lod.ratio, 0) != static_cast<float>(clamped))
                        FAIL(fmt::format("{} limits {} max {} ratio {}: {} probes at ratio {}, expected {} at {}",
                                         name_of(rule), name_of(limits), max_anisotropy, ratio, lane(lod.probes, 0),
                                         lane(lod.ratio, 0), expected, clamped));
                }
}

TEST_CASE("probes lie on the line where the placement says, with weights that sum to one", "[7.18.11]") {
    Texture texture({.format = Format::R32Float, .width = 64, .height = 64, .levels = 7});
    oracle::Random random(6);
    for (int level = 0; level < 7; ++level) {
        std::vector<float> values(static_cast<std::size_t>(texture.width(level) * texture.height(level)));
        for (float& value : values) value = random.unit();
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    const TextureView view(texture);
    const std::array<double, 2> center{0.40625, 0.71875};
    for (const ProbePlacement placement : {ProbePlacement::Interior, ProbePlacement::Centred})
        for (int count = 1; count <= 16; ++count)
            for (const bool steep : {false, true}) {
                Profile profile;
                profile.probe_placement = placement;
                // Perpendicular derivatives of 2 count and 2 texels.
                const double major = 2.0 * count / 64.0;
                const double minor = 2.0 / 64.0;
                SampleRequest request{.coordinate = {center[0], center[1], 0}};
                request.gradient = steep ? SampleRequest::Gradient{.dx = {minor, 0, 0}, .dy = {0, major, 0}}
                                         : SampleRequest::Gradient{.dx = {major, 0, 0}, .dy = {0, minor, 0}};
                const Sampler sampler{.mip = MipFilter::Linear,
                                      .address_u = AddressMode::Wrap,
                                      .address_v = AddressMode::Wrap,
                                      .max_anisotropy = 16};
                const SampleRecord record = record_sample(view, sampler, profile, request);
                INFO(name_of(placement) << " count " << count << " steep " << steep);
                REQUIRE(record.probes.size() == static_cast<std::size_t>(count));
                CHECK(record.lod == 1.0);
                CHECK(record.ratio == count);
                double weights = 0;
                double sum = 0;
                for (int k = 0; k < count; ++k) {
                    const ProbeRecord& probe = record.probes[static_cast<std::size_t>(k)];
                    const double t = placement == ProbePlacement::Interior ? (k + 1.0) / (count + 1.0) - 0.5  // Vulkan 16.6.11
                                                                           : (k + 0.5) / count - 0.5;
                    CHECK(std::fabs(probe.u - (center[0] + (steep ? 0 : t * major))) <= 0x1p-23);
                    CHECK(std::fabs(probe.v - (center[1] + (steep ? t * major : 0))) <= 0x1p-23);
                    CHECK(std::fabs(probe.weight * count - 1) <= 0x1p-23);
                    weights += probe.weight;
                    sum += probe.weight * probe.sum[0];
                }
                CHECK(std::fabs(weights - 1) <= count * 0x1p-24);
                CHECK(std::fabs(sum - record.result[0]) <= count * 0x1p-22);  // a running mean: three roundings per probe
            }
}

TEST_CASE("an explicit level of detail is isotropic whatever the sampler's anisotropy", "[7.18.11]") {
    // "When anisotropic filtering, the ratio of anisotropy with sample_l is 1 (isotropic)."
    const Texture texture = square_texture();
    const SampleRecord record = record_sample(TextureView(texture), Sampler{.mip = MipFilter::Linear, .max_anisotropy = 16},
                                              Profile{}, SampleRequest{.coordinate = {0.5, 0.5, 0}, .lod = 2.5});
    CHECK(record.ratio == 1.0);
    CHECK(record.probes.size() == 1);
    CHECK(record.clamped_lod == 2.5);
}
