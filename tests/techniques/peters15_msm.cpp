// [Peters15]: four power moments, how 16 bits store them, and what the Hamburger and Hausdorff bounds promise.
#include "sim/fixed.h"
#include "sim/half.h"
#include "techniques/common/moments.h"
#include "techniques/frame.h"
#include "techniques/msm.h"
#include "tests/oracle/random.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

constexpr double kSingle = 0x1p-24;  // half an ULP of fp32, relative
constexpr double kDouble = 0x1p-53;

using Numbers = PowerMoments<double>;

/// Depths and their shares, which sum to 1.
struct Distribution {
    std::vector<double> depths;
    std::vector<double> shares;

    [[nodiscard]] Numbers moments() const {
        Numbers b{};
        for (std::size_t i = 0; i < depths.size(); ++i) {
            const double x = depths[i];
            b.first += shares[i] * x;
            b.second += shares[i] * (x * x);
            b.third += shares[i] * (x * x * x);
            b.fourth += shares[i] * (x * x * x * x);
        }
        return b;
    }
    /// P(x >= t).
    [[nodiscard]] double visibility(double t) const {
        double sum = 0;
        for (std::size_t i = 0; i < depths.size(); ++i) sum += depths[i] >= t ? shares[i] : 0;
        return sum;
    }
};

/// Depths anywhere in [0, 1], or within 1/16 of each other.
Distribution random_distribution(oracle::Random& random, int count) {
    const bool is_wide = random.chance(2);
    const float low = is_wide ? 0.0f : random.in(0.0f, 15.0f / 16);
    Distribution d;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        d.depths.push_back(static_cast<double>(random.in(low, is_wide ? 1.0f : low + 1.0f / 16)));
        d.shares.push_back(static_cast<double>(random.in(0x1p-10f, 1.0f)));
        sum += d.shares.back();
    }
    for (double& share : d.shares) share /= sum;
    return d;
}

/// A depth of the distribution, next to one, or any.
double random_receiver(oracle::Random& random, const Distribution& d) {
    const double depth = d.depths[static_cast<std::size_t>(random.integer(0, static_cast<int>(d.depths.size()) - 1))];
    if (random.chance(4)) return depth;
    if (random.chance(4)) return std::clamp(depth + static_cast<double>(random.in(-0.01f, 0.01f)), 0.0, 1.0);
    return static_cast<double>(random.unit());
}

template <class Real>
PowerMoments<Real> lanes_of(const Numbers& b) {
    using Scalar = typename Real::Scalar;
    const auto real = [](double x) { return Real(static_cast<Scalar>(x)); };
    return {real(b.first), real(b.second), real(b.third), real(b.fourth)};
}
template <class Real>
Numbers numbers_of(const PowerMoments<Real>& b) {
    const auto number = [](const Real& x) { return static_cast<double>(lane(x, 0)); };
    return {number(b.first), number(b.second), number(b.third), number(b.fourth)};
}
template <class Real>
double bound_of(MomentBound bound, const PowerMoments<Real>& b, double t) {
    const Real depth(static_cast<typename Real::Scalar>(t));
    return static_cast<double>(
        lane(bound == MomentBound::Hausdorff ? hausdorff_upper_bound(b, depth) : hamburger_upper_bound(b, depth), 0));
}
double chebyshev(const Numbers& b, double t) {
    return lane(chebyshev_upper_bound(Moments<Double>{Double(b.first), Double(b.second)}, Double(t), Double(0.0)), 0);
}

/// Coefficients of 1, x, ..., x^4.
using Polynomial = std::array<double, 5>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
    Polynomial out{};
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; i + j < 5; ++j) out[i + j] += a[i] * b[j];
    return out;
}

/// The polynomial p >= [x >= t] on the whole axis with the least E(p), from the depths that carry the bound: it meets the step
/// at t and touches it at the other two. Of any distribution P(x >= t) <= E(p).
Polynomial hamburger_majorant(double t, double z1, double z2) {
    if (t <= z1) return {1};
    const Polynomial below = product({-z1, 1}, {-z1, 1});
    if (t > z2) {
        const double at_t = (t - z1) * (t - z2);
        Polynomial p = product(below, product({-z2, 1}, {-z2, 1}));
        for (double& c : p) c /= at_t * at_t;
        return p;
    }
    const double h = z2 - z1;
    const double s = t - z1;
    const double bend = (h + 2 * s) / (s * s * h * h * h);
    return product(below, {1 / (h * h) + 2 * z2 / (h * h * h) + bend * z2 * z2, -2 / (h * h * h) - 2 * bend * z2, bend});
}

/// The same on [0, 1], where 0, t, z and 1 carry the bound.
Polynomial hausdorff_majorant(double t, double z) {
    if (z < t) {
        const double at_t = 1 / (t * (t - z) * (t - z));
        const double at_one = 1 / ((1 - z) * (1 - z));
        const double slope = t < 1 ? (at_one - at_t) / (1 - t) : 0;
        return product(product({0, 1}, product({-z, 1}, {-z, 1})), {at_t - slope * t, slope});
    }
    Polynomial p = product(product({1, -1}, product({-z, 1}, {-z, 1})), {1 / (z * z), -1 / (z * z * t)});
    for (double& c : p) c = -c;
    p[0] += 1;
    return p;
}

/// The majorant that belongs to a bound. Moments that err by e_i take it from a bound by at most the sum of |p_i| e_i:
/// P(x >= t) <= E(p) of the true moments, and the bound is E(p) of the others.
Polynomial majorant_of(MomentBound bound, const Numbers& b, double t) {
    const PowerMoments<Double> lanes = lanes_of<Double>(b);
    const auto z = depths_beside(lanes, Double(t));
    const double z1 = lane(z.lower, 0);
    const double z2 = lane(z.upper, 0);
    if (bound == MomentBound::Hamburger || (z1 >= 0 && z2 <= 1)) return hamburger_majorant(t, z1, z2);
    if (t <= 0) return {1};
    return hausdorff_majorant(t, lane(depth_within(lanes, Double(t)), 0));
}

double weighed(const Polynomial& p, const std::array<double, 4>& errors) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += std::fabs(p[i + 1]) * errors[i];
    return sum;
}

/// The first lane of each component.
template <class Real>
std::array<double, 4> numbers_of(const Vec4<Real>& v) {
    return {static_cast<double>(lane(v.x, 0)), static_cast<double>(lane(v.y, 0)), static_cast<double>(lane(v.z, 0)),
            static_cast<double>(lane(v.w, 0))};
}

constexpr std::array kBounds{MomentBound::Hamburger, MomentBound::Hausdorff};

}  // namespace

TEST_CASE("[Peters15]: the moments of one depth", "[peters15]") {
    oracle::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const float depth = random.unit();
        const double x = static_cast<double>(depth);
        const Numbers b = numbers_of(power_moments_of_depth(Float(depth)));
        REQUIRE(b.first == x);
        REQUIRE(b.second == static_cast<double>(depth * depth));
        // One rounding in x^2; it and another in x^3; it twice and another in x^4.
        REQUIRE(std::fabs(b.third - x * x * x) <= 2.001 * kSingle * x * x * x);
        REQUIRE(std::fabs(b.fourth - x * x * x * x) <= 3.001 * kSingle * x * x * x * x);
    }
}

TEST_CASE("[Peters15]: the optimised quantisation fills [0, 1] and can be taken back", "[peters15]") {
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            double sum = 0;
            for (std::size_t k = 0; k < 4; ++k) sum += kQuantisation[i][k] * kDequantisation[k][j];
            CHECK(std::fabs(sum - (i == j ? 1.0 : 0.0)) < 1e-13);
        }
    std::array<double, 4> least{1, 1, 1, 1};
    std::array<double, 4> most{};
    double transform_lsb = 0;
    for (int i = 0; i <= 1 << 20; ++i) {
        const double x = i * 0x1p-20;
        const auto exact = numbers_of(quantised(power_moments_of_depth(Double(x))));
        const auto single = numbers_of(quantised(power_moments_of_depth(Float(static_cast<float>(x)))));
        for (std::size_t c = 0; c < 4; ++c) {
            least[c] = std::min(least[c], exact[c]);
            most[c] = std::max(most[c], exact[c]);
            transform_lsb = std::max(transform_lsb, 65535 * std::fabs(exact[c] - single[c]));
        }
    }
    for (std::size_t c = 0; c < 4; ++c) {
        INFO("component " << c << " from " << least[c] << " to " << most[c]);
        CHECK(least[c] >= -1e-7);  // the matrix is published with ten decimals
        CHECK(most[c] <= 1 + 1e-7);
        CHECK(most[c] - least[c] > 0.999);
    }
    INFO("fp32 errs by " << transform_lsb << " of 1/65535");
    CHECK(transform_lsb < 1);
}

namespace {

/// What a texture of unorm16 makes of four numbers.
Vec4<Float> stored_in_unorm16(const Vec4<Float>& v) {
    const auto stored = [](const Float& x) { return Float(float_from_unorm(unorm_from_float(lane(x, 0), 16), 16)); };
    return {stored(v.x), stored(v.y), stored(v.z), stored(v.w)};
}

/// det B, which is 0 of one depth.
double hankel_determinant(const Numbers& b) {
    const double d22 = b.second - b.first * b.first;
    const double l = b.third - b.first * b.second;
    return d22 * (b.fourth - b.second * b.second) - l * l;
}

/// Sums of the magnitudes in the columns.
std::array<double, 4> column_sums(const Matrix4& m) {
    std::array<double, 4> sums{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) sums[j] += std::fabs(m[i][j]);
    return sums;
}

/// The most by which unorm16 and fp32 let each moment err. Half a step and the roundings of the way there, at most four of
/// terms that the largest column sums up, weighed by the inverse; and the roundings of the way back.
std::array<double, 4> errors_of_unorm16() {
    const double component = 0.5 / 65535 + 4 * kSingle * std::ranges::max(column_sums(kQuantisation));
    std::array<double, 4> errors = column_sums(kDequantisation);
    for (double& error : errors) error *= component + 6 * kSingle;
    return errors;
}

}  // namespace

TEST_CASE("[Peters15]: moments through 16 bits", "[peters15]") {
    const std::array<double, 4> allowed = errors_of_unorm16();
    std::array<double, 4> worst{};
    double determinant = 0;
    double plain_determinant = 0;
    for (int i = 0; i <= 1 << 18; ++i) {
        const double x = i * 0x1p-18;
        const auto b = power_moments_of_depth(Float(static_cast<float>(x)));
        const Numbers back = numbers_of(dequantised(stored_in_unorm16(quantised(b))));
        const Vec4<Float> plain = stored_in_unorm16({b.first, b.second, b.third, b.fourth});
        const std::array errors{back.first - x, back.second - x * x, back.third - x * x * x, back.fourth - x * x * x * x};
        for (std::size_t c = 0; c < 4; ++c) worst[c] = std::max(worst[c], std::fabs(errors[c]));
        determinant = std::max(determinant, std::fabs(hankel_determinant(back)));
        plain_determinant =
            std::max(plain_determinant,
                     std::fabs(hankel_determinant(numbers_of(PowerMoments<Float>{plain.x, plain.y, plain.z, plain.w}))));
    }
    INFO("errors in 1/65535: " << worst[0] * 65535 << " " << worst[1] * 65535 << " " << worst[2] * 65535 << " "
                               << worst[3] * 65535 << "; det B " << determinant << ", of plain moments " << plain_determinant);
    for (std::size_t c = 0; c < 4; ++c) CHECK(worst[c] <= allowed[c]);
    for (std::size_t c = 0; c < 4; ++c) CHECK(worst[c] < 1.0 / 65535);
    // What it is for: each moment errs as plain ones would, but together they stay near where distributions have them.
    CHECK(determinant * 32 < plain_determinant);
}

TEST_CASE("[Peters15] 4.1: the factors and the solution are those of the Hankel matrix", "[peters15]") {
    for (int i = 0; i < 5000; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const Numbers b = random_distribution(random, random.integer(3, 16)).moments();
        const double t = static_cast<double>(random.unit());
        const PowerMoments<Double> lanes = lanes_of<Double>(b);
        const HankelFactors<Double> hankel = hankel_factors(lanes);
        const double d22 = lane(hankel.d22, 0);
        const double d33 = lane(hankel.d33, 0);
        const double l32 = lane(hankel.l32, 0);
        INFO("case " << i);
        REQUIRE(d22 > 0);
        REQUIRE(std::fabs(b.first * b.first + d22 - b.second) < 1e-15);
        REQUIRE(std::fabs(b.first * b.second + l32 * d22 - b.third) < 1e-15);
        REQUIRE(std::fabs(b.second * b.second + l32 * l32 * d22 + d33 - b.fourth) < 1e-15);
        const Vec3<Double> solution = solve_hankel(lanes, hankel, Double(t));
        const double c1 = lane(solution.x, 0);
        const double c2 = lane(solution.y, 0);
        const double c3 = lane(solution.z, 0);
        REQUIRE(std::fabs(c1 + b.first * c2 + b.second * c3 - d33) < 1e-15);
        REQUIRE(std::fabs(b.first * c1 + b.second * c2 + b.third * c3 - d33 * t) < 1e-15);
        REQUIRE(std::fabs(b.second * c1 + b.third * c2 + b.fourth * c3 - d33 * t * t) < 1e-15);
    }
}

TEST_CASE("[Peters15] 4.1, deviation: quadratic roots keep their digits where one is far away", "[peters15]") {
    const auto roots = [](float c1, float c2, float c3) {
        const auto z = quadratic_roots(Vec3<Float>{Float(c1), Float(c2), Float(c3)});
        return std::pair{lane(z.lower, 0), lane(z.upper, 0)};
    };
    CHECK(roots(3.0f, -4.0f, 1.0f) == std::pair{1.0f, 3.0f});
    CHECK(roots(-3.0f, 4.0f, -1.0f) == std::pair{1.0f, 3.0f});
    CHECK(roots(-1.0f, 0.0f, 4.0f) == std::pair{-0.5f, 0.5f});
    CHECK(roots(1.0f, 2.0f, 1.0f) == std::pair{-1.0f, -1.0f});
    CHECK(roots(1.0f, 2.0f, 1.1f) == std::pair{-1.0f, -1 / 1.1f});  // no real ones: as if the discriminant were 0
    CHECK(roots(-1.0f, 2.0f, 0.0f) == std::pair{-0x1p60f, 0.5f});
    CHECK(roots(-1.0f, 2.0f, -0.0f) == std::pair{0.5f, 0x1p60f});
    CHECK(roots(0.0f, 0.0f, 0.0f) == std::pair{-0x1p60f, -0x1p60f});
    // (x - 1/2) (1 - 2^-20 x): -p/2 + sqrt(p^2/4 - q) of x^2 + p x + q would leave four bits of the smaller one.
    CHECK(std::fabs(roots(-0.5f, 1.0f + 0x1p-21f, -0x1p-20f).first - 0.5f) <= 0x1p-24f);
}

TEST_CASE("[Peters15] deviation: a receiver on the nearer of two depths is lit, whatever fp32 makes of d33", "[peters15]") {
    // A bilinear mix of two depths in fp32; their d33 is 0 but for the bias and the rounding, and often comes out as 0 or less.
    int hidden = 0;
    for (int i = 0; i < 20000; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const float near = random.in(0.0f, 0.9f);
        const Numbers a = numbers_of(power_moments_of_depth(Float(near)));
        const Numbers b = numbers_of(power_moments_of_depth(Float(random.in(near + 0.05f, 1.0f))));
        const float weight = static_cast<float>(random.integer(0, 255)) / 256.0f;
        const auto mix = [&](double x, double y) {
            const float from = static_cast<float>(x);
            return Float(from + (static_cast<float>(y) - from) * weight);
        };
        const PowerMoments<Float> moments = biased(
            PowerMoments<Float>{mix(a.first, b.first), mix(a.second, b.second), mix(a.third, b.third), mix(a.fourth, b.fourth)},
            Float(standard_moment_bias(Format::Rgba32Float)));
        hidden += lane(hankel_factors(moments).d33, 0) == 0x1p-23f;
        for (const MomentBound bound : kBounds) {
            const double found = bound_of(bound, moments, static_cast<double>(near));
            if (!(found > 0.75)) FAIL(fmt::format("case {}: {} at {:a}: {:a}", i, name_of(bound), near, found));
        }
    }
    INFO(hidden << " cases without d33");
    CHECK(hidden > 500);
}

TEST_CASE("[Peters15]: up to two depths come back exactly", "[peters15]") {
    // Between the depths and beyond them; at a depth visibility jumps. Two: the bound errs as E(p) of its majorant does. One:
    // by what rounding leaves of the variance over (t - x)^2; Hausdorff's free depth z errs by 8 u / (x (1 - x) |t - x|), and
    // its bound by at most 3 / (t (1 - x) |t - x|) times that.
    double worst = 0;
    int judged = 0;
    for (int i = 0; i < 40000; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const Distribution d = random_distribution(random, random.integer(1, 2));
        const double t = random_receiver(random, d);
        const auto [first, last] = std::ranges::minmax(d.depths);
        const bool is_one = d.depths.size() == 1;
        const double apart = std::min(std::fabs(t - first), std::fabs(t - last));
        if (apart < 1e-3 || (!is_one && last - first < 1e-3) || (is_one && !(first > 0))) continue;
        const double one = 24 / (t * first * (1 - first) * (1 - first) * apart * apart);
        const double factor = is_one ? one : 4 + 4 * weighed(hamburger_majorant(t, first, last), {1, 1, 1, 1});
        if (!(factor * kDouble < 1e-6)) continue;
        ++judged;
        for (const MomentBound bound : kBounds) {
            const double found = bound_of(bound, lanes_of<Double>(d.moments()), t);
            const double error = std::fabs(found - d.visibility(t));
            worst = std::max(worst, error / (factor * kDouble));
            if (!(error <= factor * kDouble))
                FAIL(fmt::format("case {}: {} of {} depths at {:a}: {:a}, visibility {:a}", i, name_of(bound), d.depths.size(),
                                 t, found, d.visibility(t)));
        }
    }
    INFO(judged << " cases, worst " << worst << " of what is allowed");
    CHECK(judged > 20000);
}

TEST_CASE("[Peters15]: upper bounds on visibility, Hausdorff's below Hamburger's below Chebyshev's", "[peters15]") {
    int judged = 0;
    int tighter = 0;
    int below_chebyshev = 0;
    double worst = 0;
    for (int i = 0; i < 60000; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const Distribution d = random_distribution(random, random.integer(2, 16));
        const Numbers b = d.moments();
        const double t = random_receiver(random, d);
        // What moments that err by 16 half ULPs take from a bound; where that is much, so close are the depths, nothing is
        // promised.
        std::array<double, 2> slack{};
        std::array<double, 2> found{};
        for (std::size_t k = 0; k < 2; ++k) {
            slack[k] = 16 * kDouble * (1 + weighed(majorant_of(kBounds[k], b, t), {1, 1, 1, 1}));
            found[k] = bound_of(kBounds[k], lanes_of<Double>(b), t);
        }
        if (!(slack[0] < 1e-6 && slack[1] < 1e-6)) continue;
        ++judged;
        const std::string where = fmt::format("case {}, {} depths, t {:a}: visibility {:a}, bounds {:a} and {:a}", i,
                                              d.depths.size(), t, d.visibility(t), found[0], found[1]);
        for (std::size_t k = 0; k < 2; ++k) {
            worst = std::max(worst, (d.visibility(t) - found[k]) / slack[k]);
            if (!(found[k] >= d.visibility(t) - slack[k] && found[k] <= 1)) FAIL(where);
        }
        if (d.depths.size() > 2) {  // with two the bounds jump at the depths, each where its rounding has it
            if (!(found[1] <= found[0] + slack[0] + slack[1])) FAIL(where);
            if (!(found[0] <= chebyshev(b, t) + slack[0])) FAIL(where << ", Chebyshev's " << chebyshev(b, t));
        }
        tighter += found[1] < found[0] - 1e-3;
        below_chebyshev += found[0] < chebyshev(b, t) - 1e-3;
    }
    INFO(judged << " cases; Hausdorff's tighter in " << tighter << ", Hamburger's than Chebyshev's in " << below_chebyshev
                << "; worst violation " << worst << " of what is allowed");
    CHECK(judged > 55000);
    CHECK(tighter > 3000);
    CHECK(below_chebyshev > 20000);
}

TEST_CASE("[Peters15]: the bounds at the ends", "[peters15]") {
    const Distribution d{{0.25, 0.5, 0.75, 1.0}, {0.25, 0.25, 0.25, 0.25}};
    const PowerMoments<Double> b = lanes_of<Double>(d.moments());
    for (const MomentBound bound : kBounds) {
        CHECK(bound_of(bound, b, 0.0) == 1);
        CHECK(bound_of(bound, b, -0.5) == 1);
    }
    // Beyond the far plane Hausdorff's stays at what can lie on it; Hamburger's goes on falling.
    CHECK(bound_of(MomentBound::Hausdorff, b, 1.0) >= 0.25);
    CHECK(bound_of(MomentBound::Hausdorff, b, 1.5) == bound_of(MomentBound::Hausdorff, b, 1.0));
    CHECK(bound_of(MomentBound::Hamburger, b, 1.5) < 0.1);
    // One exact depth has no variance, which counts as an ULP of 1: behind it is next to no light.
    for (const float x : {0.0f, 0.25f, 0.5f, 1.0f}) {
        const PowerMoments<Float> one = power_moments_of_depth(Float(x));
        for (const MomentBound bound : kBounds) {
            INFO(name_of(bound) << " of one depth " << x);
            CHECK(bound_of(bound, one, static_cast<double>(x)) == 1);
            if (x > 0) CHECK(bound_of(bound, one, static_cast<double>(x) - 0.125) == 1);
            if (x < 1) CHECK(bound_of(bound, one, static_cast<double>(x) + 0.125) <= 0x1p-23 / (0.125 * 0.125));
        }
    }
    // Of 0, 1 and a depth between Hausdorff's is exact.
    const PowerMoments<Float> three{Float(0.5f), Float(0.375f), Float(0.3125f), Float(0.28125f)};  // 0 and 1: 1/4, 0.5: 1/2
    CHECK(bound_of(MomentBound::Hausdorff, three, 0.25) == 0.75);
    CHECK(bound_of(MomentBound::Hausdorff, three, 0.5) == 0.75);
    CHECK(bound_of(MomentBound::Hausdorff, three, 0.75) == 0.25);
}

namespace {

/// What a receiver has of a distribution: each depth stored, texels filtered without loss, restored and biased.
PowerMoments<Float> received(const Distribution& d, Format format, float alpha) {
    const PowerMomentStorage storage{format == Format::Rgba16Unorm ? 1 : 0};
    std::array<double, 4> sums{};
    for (std::size_t i = 0; i < d.depths.size(); ++i) {
        Vec4<Float> texel = storage.store(power_moments_of_depth(Float(static_cast<float>(d.depths[i]))));
        if (format == Format::Rgba16Unorm) texel = stored_in_unorm16(texel);
        const std::array<double, 4> numbers = numbers_of(texel);
        for (std::size_t c = 0; c < 4; ++c) sums[c] += d.shares[i] * numbers[c];
    }
    const auto component = [&](std::size_t c) { return Float(static_cast<float>(sums[c])); };
    return biased(storage.restore(Vec4<Float>{component(0), component(1), component(2), component(3)}), Float(alpha));
}

/// Whether fp32, which errs by up to 20 half ULPs in d33, can tell that the moments are a distribution's: on the axis or on [0,
/// 1].
bool are_safe(MomentBound bound, const Numbers& b) {
    constexpr double kMargin = 64 * kSingle;
    if (!(lane(hankel_factors(lanes_of<Double>(b)).d33, 0) > kMargin)) return false;
    const double inner = b.second - b.third;
    return bound == MomentBound::Hamburger || (b.first - b.second) * (b.third - b.fourth) - inner * inner > kMargin;
}

struct Violations {
    int cases = 0;
    int judged = 0;
    int many = 0;  // by more than 1/256
    double worst = 0;
    double worst_judged = 0;
    double worst_share = 0;  // of what is allowed
};

void judge(Violations& out, MomentBound bound, Format format, std::uint64_t index) {
    oracle::Random random(index);
    Distribution d = random_distribution(random, random.integer(1, 16));
    for (double& x : d.depths) x = static_cast<double>(static_cast<float>(x));
    const double t = static_cast<double>(static_cast<float>(random_receiver(random, d)));
    const double alpha = static_cast<double>(standard_moment_bias(format));
    const PowerMoments<Float> b = received(d, format, standard_moment_bias(format));
    const double violation = d.visibility(t) - bound_of(bound, b, t);
    ++out.cases;
    out.many += violation > 1.0 / 256;
    out.worst = std::max(out.worst, violation);
    if (!are_safe(bound, numbers_of(b))) return;

    // The bias moves a moment by alpha / 2 at most, storage by what it loses, fp32 by a rounding in each of a few steps.
    std::array<double, 4> errors{};
    if (format == Format::Rgba16Unorm) errors = errors_of_unorm16();
    for (double& error : errors) error += alpha / 2 + 16 * kSingle;
    const double allowed = weighed(majorant_of(bound, numbers_of(b), t), errors) + 8 * kSingle;
    ++out.judged;
    out.worst_judged = std::max(out.worst_judged, violation);
    out.worst_share = std::max(out.worst_share, violation / allowed);
    if (!(violation <= allowed))
        FAIL(fmt::format("case {}: {} {} of {} depths at {:a}: visibility {:a}, bound {:a} less, allowed {:a}", index,
                         name_of(format), name_of(bound), d.depths.size(), t, d.visibility(t), violation, allowed));
}

}  // namespace

TEST_CASE("[Peters15]: what fp32 and unorm16 take from the bounds", "[peters15]") {
    for (const Format format : {Format::Rgba32Float, Format::Rgba16Unorm})
        for (const MomentBound bound : kBounds) {
            Violations found;
            for (std::uint64_t i = 0; i < 30000; ++i) judge(found, bound, format, i);
            INFO(name_of(format) << " " << name_of(bound) << ": " << found.many << " of " << found.cases
                                 << " are too dark by more than 1/256, worst " << found.worst << "; of " << found.judged
                                 << " that fp32 can tell, worst " << found.worst_judged << ", at most " << found.worst_share
                                 << " of what is allowed");
            CHECK(found.judged > 5000);
            CHECK(found.many * 500 < found.cases);
            CHECK(found.worst_judged > 0);
        }
}

TEST_CASE("msm: moment-bias 0 is the format's, and the list says which", "[techniques][peters15]") {
    for (const Format format : kMsm.formats) {
        const float bias = standard_moment_bias(format);
        const auto summary = std::ranges::find(kMsm.parameters, "moment-bias", &Parameter::name)->summary;
        CHECK(summary.find(fmt::format("of {}", name_of(format))) != std::string_view::npos);
        CHECK((bias > 0 && bias < 0.1f));
        const auto constants = [&](const char* value) {
            Device device(Profile{}, 1);
            const TechniqueRequest request{.map_size = 8, .format = format, .set = {{"moment-bias", value}}};
            const auto passes = kMsm.make(device, resolve_settings(kMsm, request));
            const auto bytes = passes->receiver_constants({});
            return std::vector(bytes.begin(), bytes.end());
        };
        CHECK(constants("0") == constants(fmt::format("{}", bias).c_str()));
        CHECK_FALSE(constants("0") == constants("0.25"));
    }
}
