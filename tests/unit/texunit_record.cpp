// texunit/record.h: a record is what sampling did. Its result is that of the picture's path to the bit, its parts add up to it,
// its texels are those that are stored, and its counts are what sampling costs.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/aniso.h"
#include "texunit/record.h"
#include "texunit/sample_core.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

template <class Enum>
Enum any_of(oracle::Random& random) {
    const auto& names = kEnumNames<Enum>;
    return names[static_cast<std::size_t>(random.integer(0, static_cast<int>(names.size()) - 1))].value;
}

/// A stored code: any bits, or one with a moderate finite value.
std::uint32_t code_of(const FormatInfo& info, oracle::Random& random, int component, bool any_bits) {
    if (!any_bits) return moderate_code(info.format, random, component);
    const int bits = code_bits(info, component);
    if (info.type == ComponentType::Depth16) return random.bits() & 0xffffu;
    if (info.type == ComponentType::Depth24) return random.bits() & 0xffffffu;
    return bits == 32 ? random.bits() : random.bits() & ((1u << bits) - 1u);
}

Texture random_texture(Format format, TextureKind kind, oracle::Random& random, bool any_bits) {
    const int width = random.integer(1, 20);
    const int height = kind == TextureKind::Cube ? width : random.integer(1, 20);
    Texture texture({.format = format,
                     .width = width,
                     .height = height,
                     .levels = random.integer(1, full_level_count(width, height)),
                     .kind = kind,
                     .layers = kind == TextureKind::Flat   ? 1
                               : kind == TextureKind::Cube ? kCubeFaces
                                                           : random.integer(1, 4)});
    const FormatInfo& info = texture.info();
    for (int layer = 0; layer < texture.desc().layers; ++layer)
        for (int level = 0; level < texture.desc().levels; ++level) {
            std::vector<std::uint32_t> codes;
            for (int i = 0; i < texture.width(level) * texture.height(level); ++i)
                for (int c = 0; c < info.components; ++c) codes.push_back(code_of(info, random, c, any_bits));
            const auto bytes = packed(format, codes);
            texture.set_level_bytes(level, bytes.data(), bytes.size(), layer);
        }
    return texture;
}

Sampler random_sampler(oracle::Random& random, bool integer) {
    Sampler sampler{.min = any_of<TexelFilter>(random),
                    .mag = any_of<TexelFilter>(random),
                    .mip = any_of<MipFilter>(random),
                    .address_u = any_of<AddressMode>(random),
                    .address_v = any_of<AddressMode>(random),
                    .max_anisotropy = random.chance(2) ? 1 : random.integer(1, 16),
                    .reduction = random.chance(2) ? Reduction::Average : any_of<Reduction>(random),
                    .compare = any_of<CompareOp>(random),
                    .lod_bias = random.chance(2) ? 0.0f : random.in(-2.0f, 2.0f),
                    .min_lod = random.chance(3) ? random.in(0.0f, 2.0f) : 0.0f,
                    .max_lod = random.chance(3) ? random.in(0.0f, 4.0f) : 1000.0f,
                    .border = {random.unit(), random.unit(), random.unit(), random.unit()}};
    if (integer) {
        sampler.min = sampler.mag = TexelFilter::Nearest;
        if (sampler.mip == MipFilter::Linear) sampler.mip = MipFilter::Nearest;
        sampler.max_anisotropy = 1;
        sampler.reduction = Reduction::Average;
    }
    return sampler;
}

SampleRequest random_request(const Texture& texture, oracle::Random& random, bool gradient, bool compare, bool any_bits) {
    const auto number = [&](float size) { return static_cast<double>(random.in(-size, size)); };
    SampleRequest request{.coordinate = {number(2.0f), number(2.0f), number(4.0f)},
                          .lod = number(5.0f),
                          .lod_bias = random.chance(3) ? number(2.0f) : 0.0};
    if (any_bits && random.chance(20)) request.coordinate[static_cast<std::size_t>(random.integer(0, 1))] = random.any_float();
    if (gradient) {
        const float scale = std::ldexp(1.0f, -random.integer(0, 5));
        request.gradient = {{number(scale), number(scale), number(scale)}, {number(scale), number(scale), number(scale)}};
        if (random.chance(20)) request.gradient->dx = {0, 0, 0};
    }
    if (compare) request.reference = number(1.0f);
    if (texture.desc().kind == TextureKind::Cube)
        for (double& component : request.coordinate) component = number(1.0f);
    return request;
}

/// One random case: a view, how it is sampled, and requests of one shape.
struct Case {
    std::uint64_t seed;
    Texture texture;
    int base;
    int levels;
    float min_lod;
    Sampler sampler;
    std::vector<SampleRequest> requests;

    [[nodiscard]] TextureView view() const { return {texture, base, levels, min_lod}; }
    [[nodiscard]] std::string text(const Profile& profile, std::size_t i) const {
        const SampleRequest& r = requests[i];
        return fmt::format(
            "seed {} request {}: {} {} {}x{} levels {} from {} {} min {} mag {} mip {} aniso {} {} at "
            "({:a}, {:a}, {:a}) lod {:a}",
            seed, i, profile.name, texture.info().name, texture.desc().width, texture.desc().height, levels, base,
            name_of(texture.desc().kind), name_of(sampler.min), name_of(sampler.mag), name_of(sampler.mip),
            sampler.max_anisotropy, name_of(sampler.reduction), r.coordinate[0], r.coordinate[1], r.coordinate[2], r.lod);
    }
};

Case random_case(std::uint64_t seed, Format format, bool any_bits) {
    oracle::Random random(seed);
    const bool integer = format_info(format).is_integer();
    const auto kind = any_of<TextureKind>(random);
    Case result{.seed = seed,
                .texture = random_texture(format, kind, random, any_bits),
                .base = 0,
                .levels = 1,
                .min_lod = 0,
                .sampler = random_sampler(random, integer),
                .requests = {}};
    const int available = result.texture.desc().levels;
    result.base = random.integer(0, available - 1);
    result.levels = random.integer(1, available - result.base);
    if (random.chance(4)) result.min_lod = random.in(0.0f, static_cast<float>(result.base + result.levels - 1));
    const bool gradient = random.chance(2);
    const bool compare = !integer && random.chance(4);
    const glm::ivec2 offset = kind == TextureKind::Cube || random.chance(2)
                                  ? glm::ivec2(0)
                                  : glm::ivec2(random.integer(-8, 7), random.integer(-8, 7));
    for (int i = 0; i < kLanes + 3; ++i) {
        result.requests.push_back(random_request(result.texture, random, gradient, compare, any_bits));
        result.requests.back().offset = offset;
    }
    return result;
}

bool same_bits(double a, double b) {
    return (a != a && b != b) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// A field of one request in every lane.
template <class Real>
Vec3<Real> all_lanes(const std::array<double, 3>& v) {
    using Scalar = typename Real::Scalar;
    return {Real(static_cast<Scalar>(v[0])), Real(static_cast<Scalar>(v[1])), Real(static_cast<Scalar>(v[2]))};
}

template <class Real>
LevelOfDetail<Real> detail_of(const Case& c, const Profile& profile, const SampleRequest& r) {
    using Scalar = typename Real::Scalar;
    if (!r.gradient) return LevelOfDetail<Real>(Real(static_cast<Scalar>(r.lod)));
    const Vec3<Real> dx = all_lanes<Real>(r.gradient->dx);
    const Vec3<Real> dy = all_lanes<Real>(r.gradient->dy);
    Gradients<Real> gradients{{dx.x, dx.y}, {dy.x, dy.y}};
    if (c.texture.desc().kind == TextureKind::Cube) gradients = cube_gradients(all_lanes<Real>(r.coordinate), dx, dy);
    return level_of_detail(gradients, c.view(), effective_sampler(c.sampler, c.texture.info(), profile), profile);
}

/// The instruction itself, one request in every lane.
template <class Real>
std::array<double, 4> instruction(const Case& c, const Profile& profile, const SampleRequest& r) {
    using Scalar = typename Real::Scalar;
    const DenormalScope denormals(profile.flush_denormals);
    const SampleOperands<Real> operands{.offset = r.offset, .lod_bias = Real(static_cast<Scalar>(r.lod_bias))};
    const LevelOfDetail<Real> lod = detail_of<Real>(c, profile, r);
    const auto number = [](const Real& x) { return lane(Double(x), kLanes - 1); };  // denormals stay, whatever the scope
    if (r.reference) {
        const double result = number(sample_compare(c.view(), c.sampler, profile, all_lanes<Real>(r.coordinate),
                                                    Real(static_cast<Scalar>(*r.reference)), lod, operands));
        return {result, result, result, result};
    }
    const Vec4<Real> color = sample(c.view(), c.sampler, profile, all_lanes<Real>(r.coordinate), lod, operands);
    return {number(color.x), number(color.y), number(color.z), number(color.w)};
}

template <class Real>
SampleCost cost_of(const Case& c, const Profile& profile, const SampleRequest& r, std::uint32_t active) {
    using Scalar = typename Real::Scalar;
    const DenormalScope denormals(profile.flush_denormals);
    const SampleOperands<Real> operands{.offset = r.offset, .lod_bias = Real(static_cast<Scalar>(r.lod_bias))};
    return sample_cost(c.view(), c.sampler, profile, all_lanes<Real>(r.coordinate), detail_of<Real>(c, profile, r), operands,
                       active);
}

/// Calls body(case, profile) for random cases over all presets and formats.
template <class Body>
void for_cases(int rounds, bool any_bits, const Body& body) {
    std::uint64_t seed = 0;
    for (int round = 0; round < rounds; ++round)
        for (const Profile& profile : profile_presets())
            for (const FormatInfo& info : kFormats) body(random_case(seed++, info.format, any_bits), profile);
}

}  // namespace

TEST_CASE("a record's result is the instruction's to the bit", "[texunit][record]") {
    int different = 0;
    for_cases(40, true, [&](const Case& c, const Profile& profile) {
        const auto together = sample_all(c.view(), c.sampler, profile, c.requests);
        REQUIRE(together.size() == c.requests.size());
        for (std::size_t i = 0; i < c.requests.size(); ++i) {
            const SampleRecord record = record_sample(c.view(), c.sampler, profile, c.requests[i]);
            if (!same_bits(record.lod, together[i].lod))
                FAIL(fmt::format("{}: lod {:a}, in a wave {:a}", c.text(profile, i), record.lod, together[i].lod));
            std::array<double, 4> alone = together[i].color;
            if (!c.texture.info().is_integer())
                alone = profile.arithmetic == Arithmetic::Fp32 ? instruction<Float>(c, profile, c.requests[i])
                                                               : instruction<Double>(c, profile, c.requests[i]);
            for (std::size_t k = 0; k < 4; ++k)
                if (!same_bits(record.result[k], together[i].color[k]) || !same_bits(record.result[k], alone[k]))
                    FAIL(fmt::format("{}: component {} is {:a} in the record, {:a} in a wave, {:a} alone", c.text(profile, i),
                                     k, record.result[k], together[i].color[k], alone[k]));
            different += record.result[0] != together[0].color[0];
        }
    });
    CHECK(different > 10000);
}

TEST_CASE("a record's taps are the stored texels", "[texunit][record]") {
    int borders = 0;
    int corners = 0;
    int texels = 0;
    for_cases(20, false, [&](const Case& c, const Profile& profile) {
        const FormatInfo& info = c.texture.info();
        for (std::size_t i = 0; i < c.requests.size(); ++i) {
            const SampleRecord record = record_sample(c.view(), c.sampler, profile, c.requests[i]);
            for (const ProbeRecord& probe : record.probes)
                for (const LevelRecord& level : probe.levels)
                    for (const TapRecord& tap : level.taps) {
                        borders += tap.border;
                        corners += tap.corner;
                        const bool placed = tap.level == level.level && tap.level >= c.base && tap.level < c.base + c.levels &&
                                            tap.layer >= 0 && tap.layer < c.texture.desc().layers && tap.x >= 0 &&
                                            tap.x < c.texture.width(tap.level) && tap.y >= 0 &&
                                            tap.y < c.texture.height(tap.level) && tap.weight >= 0 && tap.weight <= 1;
                        if (!placed)
                            FAIL(fmt::format("{}: tap at level {} layer {} ({}, {}) weight {}", c.text(profile, i), tap.level,
                                             tap.layer, tap.x, tap.y, tap.weight));
                        if (tap.border || tap.corner) continue;
                        ++texels;
                        for (int k = 0; k < info.components; ++k) {
                            const auto component = static_cast<std::size_t>(k);
                            // The code, bit by bit from memory.
                            const std::byte* at = c.texture.row(tap.level, tap.y, tap.layer) + tap.x * info.bytes_per_texel;
                            std::uint32_t code = 0;
                            for (int b = 0; b < code_bits(info, k); ++b) {
                                const int bit = first_bit(info, k) + b;
                                code |= (static_cast<std::uint32_t>(at[bit / 8]) >> (bit % 8) & 1u) << b;
                            }
                            if (tap.raw[component] != code)
                                FAIL(fmt::format("{}: raw {:#x}, stored {:#x}", c.text(profile, i), tap.raw[component], code));
                            if (c.requests[i].reference) {
                                if (k == 0 && tap.value[0] != 0 && tap.value[0] != 1)
                                    FAIL(fmt::format("{}: comparison gives {:a}", c.text(profile, i), tap.value[0]));
                                continue;
                            }
                            if (profile.unorm_decode == UnormDecode::Late || profile.unorm_filter == UnormFilter::Llvmpipe)
                                continue;  // filters that see codes
                            const double value = code_value(info.format, code, k);
                            if (std::fabs(tap.value[component] - value) > std::fabs(value) * 0x1p-23)
                                FAIL(fmt::format("{}: code {:#x} seen as {:a}, is {:a}", c.text(profile, i), code,
                                                 tap.value[component], value));
                        }
                    }
        }
    });
    CHECK(borders > 1000);
    CHECK(corners > 1000);
    CHECK(texels > 100000);
}

TEST_CASE("the parts of a record add up", "[texunit][record]") {
    int several_probes = 0;
    int several_levels = 0;
    int ellipses = 0;
    for_cases(40, false, [&](const Case& c, const Profile& profile) {
        for (std::size_t i = 0; i < c.requests.size(); ++i) {
            const SampleRecord record = record_sample(c.view(), c.sampler, profile, c.requests[i]);
            const FormatInfo& info = c.texture.info();
            if (record.probes.empty()) FAIL(fmt::format("{}: no probes", c.text(profile, i)));
            const bool compare = c.requests[i].reference.has_value();
            // Neither peer reduces under its anisotropic filter: it averages.
            const bool peer = profile.aniso_rule == AnisoRule::Llvmpipe || profile.aniso_rule == AnisoRule::SwiftShader;
            const Reduction reduction = c.sampler.reduction;
            if (peer && reduction != Reduction::Average && c.sampler.max_anisotropy > 1) continue;
            // What a filter that rounds to codes may lose at each lerp, in codes; all others a few roundings of binary32 per
            // texel, or half a step of the border colour's.
            const bool sees_codes =
                !compare && (profile.unorm_filter == UnormFilter::Llvmpipe && info.type == ComponentType::Unorm8);
            double largest = 0;
            for (const ProbeRecord& probe : record.probes)
                for (const LevelRecord& level : probe.levels)
                    for (const TapRecord& tap : level.taps)
                        for (const double value : tap.value) largest = std::max(largest, std::fabs(value));
            const auto bound = [&](std::size_t terms) {
                const double rounding = sees_codes ? 1.0 / 256.0 + 3.0 / 255.0 : 0x1p-24;
                return (sees_codes ? 4.0 : 4.0 * static_cast<double>(terms)) * rounding * std::max(largest, 1e-30);
            };
            const auto reduced = [&](double a, double b) {
                return reduction == Reduction::Minimum ? std::fmin(a, b) : std::fmax(a, b);
            };
            const auto components = static_cast<std::size_t>(compare ? 1 : info.components);
            std::array<double, 4> total{};
            double probe_weights = 0;
            std::size_t count = 0;
            for (const ProbeRecord& probe : record.probes) {
                std::array<double, 4> probe_sum{};
                double level_weights = 0;
                std::size_t level_count = 0;
                for (const LevelRecord& level : probe.levels) {
                    if (level.taps.empty() && probe.levels.size() > 1)
                        continue;  // an ellipse between texels: see the next level
                    std::array<double, 4> sum{};
                    double weights = 0;
                    std::size_t taps = 0;
                    for (const TapRecord& tap : level.taps) {
                        weights += tap.weight;
                        if (tap.weight == 0 && reduction != Reduction::Average) continue;
                        for (std::size_t k = 0; k < components; ++k)
                            sum[k] = reduction == Reduction::Average ? sum[k] + tap.weight * tap.value[k]
                                     : taps == 0                     ? tap.value[k]
                                                                     : reduced(sum[k], tap.value[k]);
                        ++taps;
                    }
                    const double slack = bound(level.taps.size() + 2);
                    if (std::fabs(weights - 1) > 0x1p-20)
                        FAIL(fmt::format("{}: weights of a level sum to {:a}", c.text(profile, i), weights));
                    for (std::size_t k = 0; k < components; ++k)
                        if (!(std::fabs(sum[k] - level.sum[k]) <= (reduction == Reduction::Average ? slack : 0)))
                            FAIL(fmt::format("{}: component {} of level {} is {:a}, taps give {:a} ({} taps)",
                                             c.text(profile, i), k, level.level, level.sum[k], sum[k], level.taps.size()));
                    level_weights += level.weight;
                    for (std::size_t k = 0; k < components; ++k)
                        probe_sum[k] = reduction == Reduction::Average ? probe_sum[k] + level.weight * level.sum[k]
                                       : level_count == 0              ? level.sum[k]
                                                                       : reduced(probe_sum[k], level.sum[k]);
                    ++level_count;
                    ellipses += level.taps.size() > 4;
                }
                several_levels += probe.levels.size() > 1;
                if (std::fabs(level_weights - 1) > 0x1p-22)
                    FAIL(fmt::format("{}: weights of the levels sum to {:a}", c.text(profile, i), level_weights));
                for (std::size_t k = 0; k < components; ++k)
                    if (!(std::fabs(probe_sum[k] - probe.sum[k]) <= (reduction == Reduction::Average ? bound(4) : 0)))
                        FAIL(fmt::format("{}: component {} of a probe is {:a}, levels give {:a}", c.text(profile, i), k,
                                         probe.sum[k], probe_sum[k]));
                probe_weights += probe.weight;
                for (std::size_t k = 0; k < components; ++k)
                    total[k] = reduction == Reduction::Average ? total[k] + probe.weight * probe.sum[k]
                               : count == 0                    ? probe.sum[k]
                                                               : reduced(total[k], probe.sum[k]);
                ++count;
            }
            several_probes += count > 1;
            if (std::fabs(probe_weights - 1) > 0x1p-20)
                FAIL(fmt::format("{}: weights of the probes sum to {:a}", c.text(profile, i), probe_weights));
            // Filters that see codes or integers: the result is their sum over the largest.
            if (info.is_integer()) continue;
            const bool late = profile.unorm_decode == UnormDecode::Late && !compare;
            double scale = 1;
            if (late && info.type == ComponentType::Unorm8) scale = 65280;
            if (late && info.type == ComponentType::Unorm16) scale = 65535;
            if (sees_codes && largest > 1.5) scale = 255;
            for (std::size_t k = 0; k < components; ++k) {
                const double slack = reduction == Reduction::Average ? bound(4 + 2 * count) : 0x1p-23 * largest * (scale > 1);
                if (!(std::fabs(total[k] - record.result[k] * scale) <= slack + 0x1p-22 * largest * (scale > 1)))
                    FAIL(fmt::format("{}: component {} is {:a}, probes give {:a} over {}", c.text(profile, i), k,
                                     record.result[k], total[k], scale));
            }
        }
    });
    CHECK(several_probes > 1000);
    CHECK(several_levels > 1000);
    CHECK(ellipses > 1000);
}

TEST_CASE("sums of small integers under short weights are exact", "[texunit][record]") {
    // 8-bit texels, 4-bit weights in u, v and level: 20 bits, so that every step of the filter is exact.
    oracle::Random random(4);
    Texture texture({.format = Format::R32Float, .width = 16, .height = 16, .levels = 5});
    for (int level = 0; level < 5; ++level) {
        std::vector<float> values(static_cast<std::size_t>(texture.width(level) * texture.height(level)));
        for (float& value : values) value = static_cast<float>(random.integer(0, 255));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    Profile profile;
    profile.texel_fraction_bits = 4;
    profile.lod_fraction_bits = 4;
    int fractions = 0;
    for (const BilinearForm form :
         {BilinearForm::Lerp, BilinearForm::Products, BilinearForm::PlainLerp, BilinearForm::FusedLerp})
        for (int round = 0; round < 3000; ++round) {
            profile.bilinear_form = form;
            SampleRequest request{.coordinate = {static_cast<double>(random.unit()), static_cast<double>(random.unit()), 0},
                                  .lod = static_cast<double>(random.in(-1.0f, 5.0f))};
            int probes = 1;
            if (random.chance(2)) {  // two texels by four: two probes
                request.gradient = {{4.0 / 16.0, 0, 0}, {0, 2.0 / 16.0, 0}};
                probes = 2;
            }
            const SampleRecord record =
                record_sample(texture, Sampler{.mip = MipFilter::Linear, .max_anisotropy = 16}, profile, request);
            REQUIRE(record.probes.size() == static_cast<std::size_t>(probes));
            double total = 0;
            for (const ProbeRecord& probe : record.probes) {
                double probe_sum = 0;
                for (const LevelRecord& level : probe.levels) {
                    double sum = 0;
                    for (const TapRecord& tap : level.taps) sum += tap.weight * tap.value[0];
                    if (sum != level.sum[0])
                        FAIL(fmt::format("{} round {}: level {:a}, taps {:a}", name_of(form), round, level.sum[0], sum));
                    probe_sum += level.weight * sum;
                }
                if (probe_sum != probe.sum[0])
                    FAIL(fmt::format("{} round {}: probe {:a}, levels {:a}", name_of(form), round, probe.sum[0], probe_sum));
                total += probe.weight * probe_sum;
            }
            if (total != record.result[0])
                FAIL(fmt::format("{} round {}: result {:a}, probes {:a}", name_of(form), round, record.result[0], total));
            fractions += total != std::floor(total);
        }
    CHECK(fractions > 1000);
}

TEST_CASE("the cost of a sample is what its record lists", "[texunit][record]") {
    std::uint64_t probes = 0;
    std::uint64_t texels = 0;
    for_cases(20, false, [&](const Case& c, const Profile& profile) {
        for (std::size_t i = 0; i < c.requests.size(); ++i) {
            const SampleRecord record = record_sample(c.view(), c.sampler, profile, c.requests[i]);
            std::uint64_t taps = 0;
            for (const ProbeRecord& probe : record.probes)
                for (const LevelRecord& level : probe.levels) taps += level.taps.size();
            const std::uint32_t active = 0b1011;  // three lanes
            const SampleCost cost = profile.arithmetic == Arithmetic::Fp32 ? cost_of<Float>(c, profile, c.requests[i], active)
                                                                           : cost_of<Double>(c, profile, c.requests[i], active);
            if (cost.probes != 3 * record.probes.size() || cost.texels != 3 * taps)
                FAIL(fmt::format("{}: costs {} probes and {} texels in three lanes, the record has {} and {}",
                                 c.text(profile, i), cost.probes, cost.texels, record.probes.size(), taps));
            probes += record.probes.size();
            texels += taps;
        }
    });
    CHECK(probes > 20000);
    CHECK(texels > 4 * probes / 2);
}

TEST_CASE("a view without levels gives a record without probes", "[texunit][record]") {
    const Texture texture({.format = Format::Rg8Unorm, .width = 8, .height = 8, .levels = 4});
    const SampleRecord record = record_sample(TextureView(texture, 0, 2, 2.0f), Sampler{.border = glm::vec4(0.5f)}, Profile{},
                                              SampleRequest{.lod = 1.5});
    CHECK(record.probes.empty());
    CHECK(record.result == std::array<double, 4>{0, 0, 0, 1});
    CHECK(record.lod == 1.5);
}

TEST_CASE("requests that no instruction can do are errors", "[texunit][record]") {
    const Texture flat({.format = Format::Rgba8Unorm, .width = 8, .height = 8});
    const Texture cube(
        {.format = Format::Rgba8Unorm, .width = 8, .height = 8, .levels = 1, .kind = TextureKind::Cube, .layers = kCubeFaces});
    const Texture integer({.format = Format::R32Uint, .width = 8, .height = 8});
    const Sampler nearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    const auto message = [](const TextureView& view, const Sampler& sampler, const SampleRequest& request) {
        std::string one;
        std::string many;
        try {
            (void)record_sample(view, sampler, Profile{}, request);
        } catch (const Error& error) {
            one = error.what();
        }
        try {
            (void)sample_all(view, sampler, Profile{}, std::span(&request, 1));
        } catch (const Error& error) {
            many = error.what();
        }
        CHECK(one == many);
        return one;
    };
    for (const glm::ivec2 offset :
         {glm::ivec2(-9, 0), glm::ivec2(8, 0), glm::ivec2(0, -9), glm::ivec2(0, 8), glm::ivec2(1000, 0)})
        CHECK_THAT(message(flat, Sampler{}, {.offset = offset}), Catch::Contains("expected -8 to 7"));
    for (const glm::ivec2 offset : {glm::ivec2(-8, 7), glm::ivec2(7, -8), glm::ivec2(0)})
        CHECK(message(flat, Sampler{}, {.offset = offset}).empty());
    CHECK_THAT(message(cube, Sampler{}, {.coordinate = {1, 0, 0}, .offset = {1, 0}}), Catch::Contains("cube"));
    CHECK(message(cube, Sampler{}, {.coordinate = {1, 0, 0}}).empty());

    CHECK(message(integer, nearest, {}).empty());
    CHECK_THAT(message(integer, Sampler{}, {}), Catch::Contains("r32ui"));
    Sampler bad = nearest;
    bad.mip = MipFilter::Linear;
    CHECK_THAT(message(integer, bad, {}), Catch::Contains("nearest"));
    bad = nearest;
    bad.max_anisotropy = 2;
    CHECK_THAT(message(integer, bad, {}), Catch::Contains("nearest"));
    bad = nearest;
    bad.reduction = Reduction::Maximum;
    CHECK_THAT(message(integer, bad, {}), Catch::Contains("nearest"));
    CHECK_THAT(message(integer, nearest, {.reference = 0.5}), Catch::Contains("compared"));

    CHECK_THROWS_AS(TextureView(flat, 1, 1), Error);
    CHECK_THROWS_AS(TextureView(flat, -1, 1), Error);
    CHECK_THROWS_AS(TextureView(flat, 0, 2), Error);
    CHECK_THROWS_AS(TextureView(flat, 0, 0), Error);
    CHECK_THROWS_AS(TextureView(flat, 0, 1, -1.0f), Error);
    CHECK_THROWS_AS(TextureView(flat, 0, 1, std::nanf("")), Error);
}
