// The bound of every moment technique is an upper bound: visibility is never below the share of its filter that lies at or
// behind the receiver, but for what the format loses. [Donnelly06] eq. 5, [Lauritzen08] eq. 3.3, chapter 4
#include "sim/fixed.h"
#include "sim/half.h"
#include "sim/parallel.h"
#include "techniques/evsm.h"
#include "techniques/layers.h"
#include "techniques/lvsm.h"
#include "techniques/vsm.h"
#include "tests/oracle/random.h"
#include "tests/techniques/bound_interval.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/mipmap.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

/// One warp of depth whose two moments a texel holds, in components `first` and `second`.
struct WarpedPart {
    ExponentialWarp exponential{};  // exponent2 0: depth as it is, or a layer of it
    DepthLayers layers{};
    int layer = -1;  // 0 or more: of `layers`
    int component = 0;

    template <class Real>
    [[nodiscard]] Real warp(const Real& depth) const {
        if (exponential.exponent2 != 0.0f) return exponential(depth).value;
        return layer >= 0 ? layers.warp(depth, layer) : depth;
    }
    [[nodiscard]] double of(float depth) const { return static_cast<double>(lane(warp(Float(depth)), 0)); }

    template <class Real>
    [[nodiscard]] Real bound(const Moments<Real>& moments, const Real& depth) const {
        if (exponential.exponent2 != 0.0f) return warped_upper_bound(moments, exponential(depth), 0.0f);
        return chebyshev_upper_bound(moments, warp(depth), Real(0.0f));
    }
};

/// A technique and format under test, as one slice of texels and the bounds in it. No least variance.
struct Case {
    std::string name;
    Format format = Format::Rg32Float;
    MomentSplit split{};
    std::vector<WarpedPart> parts;

    [[nodiscard]] Vec4<Float> encode(float depth) const {
        if (split.factor != 0.0f) return split.store(moments_of_depth(Float(depth)));
        Vec4<Float> texel{Float(0.0f), Float(0.0f), Float(0.0f), Float(1.0f)};
        for (const WarpedPart& part : parts) {
            const Moments<Float> m = moments_of_depth(part.warp(Float(depth)));
            (part.component == 0 ? texel.x : texel.z) = m.first;
            (part.component == 0 ? texel.y : texel.w) = m.second;
        }
        return texel;
    }
    template <class Real>
    [[nodiscard]] Moments<Real> moments(const WarpedPart& part, const Vec4<Real>& texel) const {
        if (split.factor != 0.0f) return split.restore(texel);
        return part.component == 0 ? Moments<Real>{texel.x, texel.y} : Moments<Real>{texel.z, texel.w};
    }
    [[nodiscard]] float visibility(const std::array<float, 4>& texel, float depth) const {
        Float least(1.0f);
        for (const WarpedPart& part : parts) {
            const Vec4<Float> sampled{Float(texel[0]), Float(texel[1]), Float(texel[2]), Float(texel[3])};
            least = min(least, part.bound(moments(part, sampled), Float(depth)));
        }
        return lane(least, 0);
    }
};

std::uint32_t code_of(Format format, float x, Narrowing narrowing) {
    switch (format_info(format).type) {
        case ComponentType::Float16: return half_from_float(x, narrowing).bits;
        case ComponentType::Unorm16: return unorm_from_float(x, 16);
        case ComponentType::Unorm8: return unorm_from_float(x, 8);
        default: return std::bit_cast<std::uint32_t>(x);
    }
}

/// How far a stored number may be from what it was: relative, and absolute.
struct StorageError {
    double relative = 0;
    double absolute = 0;
};

StorageError storage_error(const Case& what, bool is_mip) {
    switch (format_info(what.format).type) {
        case ComponentType::Float16:
            // Toward zero: 2^-10 of the number, or the smallest denormal. Coarse parts of a split moment are exact, and remain
            // so in halves until a mip needs more than 11 bits; fine parts are below 1 and lose 2^-11 of 1 / factor.
            if (what.split.factor == 0.0f) return {0x1p-10, 0x1p-24};
            return {0, (is_mip ? 0x1p-11 : 0.0) + 0x1p-11 / static_cast<double>(what.split.factor)};
        case ComponentType::Unorm16: return {0, 0.5 / 65535};
        case ComponentType::Unorm8: return {0, 0.5 / 255};
        default: return {0, 0x1p-126};  // denormals count as zero
    }
}

/// A filter over texels: depths and the exact weights that they have in the sample.
struct Footprint {
    std::vector<float> depths;
    std::vector<double> weights;
    int level = 0;  // of the mip chain that the weights come from

    [[nodiscard]] double share_beyond(float depth) const {
        double share = 0;
        for (std::size_t i = 0; i < depths.size(); ++i)
            if (depths[i] >= depth) share += weights[i];
        return share;
    }
};

/// The least that the bound of one warp may be by eq. 5. The warp itself is what fp32 makes of it: any monotonic one will do.
double least_bound(const Case& what, const WarpedPart& part, const Footprint& footprint, float depth) {
    double m1 = 0;
    double m2 = 0;
    double mean_magnitude = 0;
    double largest = 0;
    for (std::size_t i = 0; i < footprint.depths.size(); ++i) {
        const double x = part.of(footprint.depths[i]);
        m1 += footprint.weights[i] * x;
        m2 += footprint.weights[i] * x * x;
        mean_magnitude += footprint.weights[i] * std::fabs(x);
        if (footprint.weights[i] > 0) largest = std::max(largest, std::fabs(x));
    }
    // Storage errs once per texel and level; the square rounds once; each of two lerps in sequence rounds three times; a mip
    // takes two means in sequence, of two roundings each; a split moment is put together with one more. Any of these may fall
    // below the smallest normal number.
    double e1 = 0;
    double e2 = 0;
    for (int level = 0; level <= footprint.level; ++level) {
        const StorageError storage = storage_error(what, level >= 2);
        e1 += storage.relative * mean_magnitude + storage.absolute;
        e2 += storage.relative * m2 + storage.absolute;
    }
    const double roundings = 6 + 4 * footprint.level + 2;
    e1 += roundings * (kUnit * largest + 0x1p-126);
    e2 += (roundings + 1) * (kUnit * largest * largest + 0x1p-126);
    return bound_interval(m1, m2, part.of(depth), e1, e2, kUnit).low;
}

/// What became of the plain inequality, without any allowance.
struct Violations {
    std::size_t samples = 0;
    std::size_t below = 0;    // visibility < share
    std::size_t visibly = 0;  // by more than an 8-bit display shows
    double worst = 0;         // share - visibility

    void count(double visibility, double share) {
        ++samples;
        below += visibility < share;
        visibly += visibility < share - 1.0 / 255;
        worst = std::max(worst, share - visibility);
    }
};

/// Judges one sample; fails where the format cannot explain it.
void judge(const Case& what, const Footprint& footprint, float depth, const std::array<float, 4>& texel, int index,
           Violations& violations) {
    const double share = footprint.share_beyond(depth);
    const auto visibility = static_cast<double>(what.visibility(texel, depth));
    violations.count(visibility, share);
    double low = share;
    for (const WarpedPart& part : what.parts) low = std::min(low, least_bound(what, part, footprint, depth));
    if (visibility >= low) return;
    std::string texels;
    for (std::size_t i = 0; i < std::min<std::size_t>(footprint.depths.size(), 16); ++i)
        texels += fmt::format(" {:a} x {:a}", footprint.depths[i], footprint.weights[i]);
    FAIL(fmt::format("case {}: {} level {}: receiver {:a}: visibility {:a}, share {:a}, least {:a}; depths{}", index, what.name,
                     footprint.level, depth, visibility, share, low, texels));
}

/// Depths in multiples of 2^-16, so that a warp keeps two of them apart or equal: spread out, in a narrow band, of two planes,
/// or all the same.
std::vector<float> random_depths(oracle::Random& random, std::size_t count) {
    const int kind = random.integer(0, 3);
    const int base = random.integer(0, 65536);
    const int other = random.integer(0, 65536);
    std::vector<float> depths(count);
    for (float& depth : depths) {
        int code = base;
        if (kind == 0) code = random.integer(0, 65536);
        if (kind == 1) code = std::clamp(base + random.integer(-64, 64), 0, 65536);
        if (kind == 2 && random.chance(2)) code = other;
        depth = static_cast<float>(code) * 0x1p-16f;
    }
    return depths;
}

/// Anywhere, at one of the depths, or closely behind it.
float random_receiver(oracle::Random& random, const std::vector<float>& depths) {
    const float at = depths[static_cast<std::size_t>(random.integer(0, static_cast<int>(depths.size()) - 1))];
    switch (random.integer(0, 2)) {
        case 0: return static_cast<float>(random.integer(0, 65536)) * 0x1p-16f;
        case 1: return at;
        default: return std::min(1.0f, at + static_cast<float>(random.integer(1, 256)) * 0x1p-16f);
    }
}

Texture map_of(const Case& what, const std::vector<float>& depths, int size, int levels) {
    std::vector<std::uint32_t> codes;
    for (const float depth : depths) {
        const Vec4<Float> texel = what.encode(depth);
        const std::array values{lane(texel.x, 0), lane(texel.y, 0), lane(texel.z, 0), lane(texel.w, 0)};
        for (int c = 0; c < format_info(what.format).components; ++c)
            codes.push_back(code_of(what.format, values[static_cast<std::size_t>(c)], Narrowing::TowardZero));
    }
    Texture texture({.format = what.format, .width = size, .height = size, .levels = levels});
    const auto bytes = packed(what.format, codes);
    texture.set_level_bytes(0, bytes.data(), bytes.size());
    return texture;
}

Violations check_bilinear(const Case& what, int cases) {
    Violations violations;
    const Profile profile;
    for (int i = 0; i < cases; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const std::vector<float> depths = random_depths(random, 4);
        const Texture map = map_of(what, depths, 2, 1);
        std::vector<Coordinate> coordinates;
        std::vector<Footprint> footprints;
        for (int k = 0; k < 16; ++k) {
            const int u = random.chance(4) ? 0 : random.integer(0, 255);
            const int v = random.chance(4) ? 255 : random.integer(0, 255);
            coordinates.push_back({0.25f + static_cast<float>(u) / 512.0f, 0.25f + static_cast<float>(v) / 512.0f});
            const double wu = u / 256.0;
            const double wv = v / 256.0;
            footprints.push_back({depths, {(1 - wu) * (1 - wv), wu * (1 - wv), (1 - wu) * wv, wu * wv}});
        }
        const auto texels = sample_all(map, Sampler{}, profile, coordinates);
        const DenormalScope denormals(profile.flush_denormals);
        for (std::size_t k = 0; k < texels.size(); ++k)
            judge(what, footprints[k], random_receiver(random, depths), texels[k], i, violations);
    }
    return violations;
}

/// 16 x 16 texels; four texels of a level under a bilinear filter, each the mean of a square of level 0.
Footprint mip_footprint(const std::vector<float>& depths, int level, const glm::ivec2& texel, const glm::ivec2& weight) {
    constexpr int kSize = 16;
    const int side = 1 << level;
    Footprint footprint{.depths = {}, .weights = {}, .level = level};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double share = (i == 1 ? weight.x : 256 - weight.x) / 256.0 * (j == 1 ? weight.y : 256 - weight.y) / 256.0;
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) {
                    const int at = ((texel.y + j) * side + y) * kSize + (texel.x + i) * side + x;
                    footprint.depths.push_back(depths[static_cast<std::size_t>(at)]);
                    footprint.weights.push_back(share / (side * side));
                }
        }
    return footprint;
}

Violations check_mips(const Case& what, int cases) {
    constexpr int kSize = 16;
    constexpr int kLevels = 4;  // down to 2 x 2
    Violations violations;
    const Profile profile;
    Workers workers(1);
    for (int i = 0; i < cases; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const std::vector<float> depths = random_depths(random, kSize * kSize);
        Texture map = map_of(what, depths, kSize, kLevels);
        generate_mips(map, profile, workers);
        std::vector<Coordinate> coordinates;
        std::vector<Footprint> footprints;
        for (int level = 1; level < kLevels; ++level)
            for (int k = 0; k < 4; ++k) {
                const int side = kSize >> level;
                const glm::ivec2 texel{random.integer(0, side - 2), random.integer(0, side - 2)};
                const glm::ivec2 weight{random.integer(0, 255), random.integer(0, 255)};
                const auto coordinate = [&](int at, int w) {
                    return (static_cast<float>(at) + 0.5f + static_cast<float>(w) / 256.0f) / static_cast<float>(side);
                };
                coordinates.push_back(
                    {coordinate(texel.x, weight.x), coordinate(texel.y, weight.y), static_cast<float>(level)});
                footprints.push_back(mip_footprint(depths, level, texel, weight));
            }
        const auto texels = sample_all(map, {.mip = MipFilter::Linear}, profile, coordinates);
        const DenormalScope denormals(profile.flush_denormals);
        for (std::size_t k = 0; k < texels.size(); ++k)
            judge(what, footprints[k], random_receiver(random, depths), texels[k], i, violations);
    }
    return violations;
}

std::vector<Case> cases_of_vsm() {
    std::vector<Case> cases;
    for (const Format format : find_technique("vsm").formats)
        cases.push_back({.name = fmt::format("vsm {}", name_of(format)),
                         .format = format,
                         .split = {format == Format::Rgba16Float ? 256.0f : 0.0f},
                         .parts = {WarpedPart{}}});
    return cases;
}

std::vector<Case> cases_of_evsm() {
    std::vector<Case> cases;
    for (const char* name : {"evsm2", "evsm4"})
        for (const Format format : find_technique(name).formats) {
            const double limit = exponent_limit(format_info(format), 2);
            for (const double c : {1.0, 5.0, 40.0, limit}) {
                if (c > limit) continue;
                const auto exponent = static_cast<float>(c);
                Case what{
                    .name = fmt::format("{} {} c {:g}", name, name_of(format), c), .format = format, .split = {}, .parts = {}};
                what.parts.push_back({.exponential = positive_warp(exponent)});
                if (name == std::string_view("evsm4"))
                    what.parts.push_back({.exponential = negative_warp(exponent), .component = 2});
                cases.push_back(what);
            }
        }
    return cases;
}

/// The layer of a receiver is the only one that it looks at; these judge any layer for any receiver that it holds.
std::vector<Case> cases_of_lvsm() {
    std::vector<Case> cases;
    for (const Format format : find_technique("lvsm").formats)
        for (const int count : {1, 2, 3, 4, 8}) {
            const DepthLayers layers = make_layers(uniform_splits(count), 0.01);
            for (int layer = 0; layer < count; ++layer)
                cases.push_back({.name = fmt::format("lvsm {} {} of {}", name_of(format), layer, count),
                                 .format = format,
                                 .split = {},
                                 .parts = {WarpedPart{.layers = layers, .layer = layer, .component = layer % 2 * 2}}});
        }
    return cases;
}

/// One line per case with -s: per cent of the samples that are below their share at all and visibly, and the worst of them.
void check_all(const std::vector<Case>& all, int cases) {
    for (const Case& what : all) {
        const auto text = [](const Violations& v) {
            const auto percent = [&](std::size_t count) {
                return 100 * static_cast<double>(count) / static_cast<double>(v.samples);
            };
            return fmt::format("{:>5.2f} {:>5.2f} {:.0e}", percent(v.below), percent(v.visibly), std::max(v.worst, 0.0));
        };
        const Violations bilinear = check_bilinear(what, cases);
        const Violations mips = check_mips(what, cases / 8);
        INFO(fmt::format("{:<24}: bilinear {}; mips {}", what.name, text(bilinear), text(mips)));
        // Most hold as they are.
        CHECK(bilinear.below + mips.below < (bilinear.samples + mips.samples) / 4);
    }
}

}  // namespace

TEST_CASE("vsm: never below the share of the filter by more than its format loses", "[bounds][donnelly06]") {
    check_all(cases_of_vsm(), 10000);
}

TEST_CASE("evsm: never below the share of the filter by more than its format loses", "[bounds][lauritzen08][4.2]") {
    check_all(cases_of_evsm(), 1000);
}

TEST_CASE("lvsm: never below the share of the filter by more than its format loses", "[bounds][lauritzen08][4.1]") {
    check_all(cases_of_lvsm(), 400);
}

namespace {

/// Moments of four depths in Double, without storage.
Violations check_in_double(const WarpedPart& part, int depth_steps, int cases, bool is_exact) {
    Violations violations;
    for (int i = 0; i < cases; ++i) {
        oracle::Random random(static_cast<std::uint64_t>(i));
        const double wu = random.integer(0, 256) / 256.0;
        const double wv = random.integer(0, 256) / 256.0;
        const std::array weights{(1 - wu) * (1 - wv), wu * (1 - wv), (1 - wu) * wv, wu * wv};
        std::array<double, 4> depths{};
        const int planes = random.integer(1, 4);
        for (std::size_t k = 0; k < 4; ++k)
            depths[k] = k < static_cast<std::size_t>(planes) ? random.integer(0, depth_steps) / static_cast<double>(depth_steps)
                                                             : depths[0];
        const double t = random.chance(2) ? depths[static_cast<std::size_t>(random.integer(0, 3))]
                                          : random.integer(0, depth_steps) / static_cast<double>(depth_steps);
        double m1 = 0;
        double m2 = 0;
        double share = 0;
        double largest = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const double x = lane(part.warp(Double(depths[k])), 0);
            m1 += weights[k] * x;
            m2 += weights[k] * (x * x);
            largest = std::max(largest, std::fabs(x));
            if (depths[k] >= t) share += weights[k];
        }
        const double got = lane(part.bound(Moments<Double>{Double(m1), Double(m2)}, Double(t)), 0);
        // Not exact: four products, squares and sums round.
        const double e1 = 8 * 0x1p-53 * largest;
        const double low = bound_interval(m1, m2, lane(part.warp(Double(t)), 0), e1, e1 * largest, 0x1p-53).low;
        violations.count(got, is_exact ? share : std::min(share, low));
    }
    return violations;
}

}  // namespace

TEST_CASE("in Double no bound is below the share of its filter", "[bounds]") {
    // Depths of 8 bits and weights of 8 bits per axis: m1 has 24 bits, its square 48, m2 32: all exact in 53 bits. The quotient
    // rounds once, and rounding keeps order: it cannot pass the share, which has 16 bits. Layers of a power of two without
    // overlap are as exact.
    const Violations plain = check_in_double({}, 256, 100000, true);
    CHECK(plain.samples == 100000);
    CHECK(plain.below == 0);
    for (const int count : {2, 4, 8, 16})
        for (int layer = 0; layer < count; ++layer) {
            INFO("layer " << layer << " of " << count);
            CHECK(check_in_double({.layers = make_layers(uniform_splits(count), 0.0), .layer = layer}, 256, 4000, true).below ==
                  0);
        }
    // Exponentials round: nothing is below the share by more than the roundings of double explain.
    for (const float c : {0.5f, 5.0f, 40.0f, 44.36f}) {
        INFO("c " << c);
        CHECK(check_in_double({.exponential = positive_warp(c)}, 65536, 20000, false).below == 0);
        CHECK(check_in_double({.exponential = negative_warp(c)}, 65536, 20000, false).below == 0);
    }
}
