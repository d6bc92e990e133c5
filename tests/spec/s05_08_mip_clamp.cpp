// D3D11.3 5.8: views of some levels, and the limit a resource sets to the level of detail of all of its views.
#include "tests/oracle/random.h"
#include "tests/unit/texunit_calls.h"
#include "texunit/record.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Level n of the resource is constant n + 1, so that a result of 0 is no level.
Texture resource(int levels, Format format = Format::R32Float) {
    Texture texture({.format = format, .width = 1 << (levels - 1), .height = 1 << (levels - 1), .levels = levels});
    for (int level = 0; level < levels; ++level) {
        const std::vector<float> values(
            static_cast<std::size_t>(texture.width(level) * texture.height(level) * texture.info().components),
            static_cast<float>(level + 1));
        texture.set_level_bytes(level, std::as_bytes(std::span(values)).data(), values.size() * 4);
    }
    return texture;
}

SampleRecord at_lod(const TextureView& view, const Sampler& sampler, double lod) {
    return record_sample(view, sampler, Profile{}, SampleRequest{.coordinate = {0.4, 0.6, 0}, .lod = lod});
}

/// Steps of 1/256, nearest even.
double fixed8(double x) {
    const double steps = x * 256;
    double whole = std::floor(steps);
    if (steps - whole > 0.5 || (steps - whole == 0.5 && std::fmod(whole, 2.0) != 0)) whole += 1;
    return whole / 256;
}

std::array<float, 4> gathered(const TextureView& view, const Sampler& sampler, int component) {
    const Vec4<Float> v = gather(view, sampler, Profile{}, Vec3<Float>{Float(0.4f), Float(0.6f), Float(0.0f)}, component);
    return {lane(v.x, 0), lane(v.y, 0), lane(v.z, 0), lane(v.w, 0)};
}
std::array<float, 4> gather_compared(const TextureView& view, const Sampler& sampler, float reference) {
    const Vec4<Float> v =
        gather_compare(view, sampler, Profile{}, Vec3<Float>{Float(0.4f), Float(0.6f), Float(0.0f)}, Float(reference));
    return {lane(v.x, 0), lane(v.y, 0), lane(v.z, 0), lane(v.w, 0)};
}

constexpr std::array<float, 4> kZeros{0, 0, 0, 0};
constexpr std::array<float, 4> kOnes{1, 1, 1, 1};

/// 5.8.6: "Resource: 8 miplevels [0..7]; Shader Resource View: [1..6]; Sampler MinLOD = 1.2, MaxLOD = 4; MIN_MAG_MIP_LINEAR".
/// The mag filter differs here, so that the filter that was used can be told.
constexpr Sampler kExample{
    .min = TexelFilter::Linear, .mag = TexelFilter::Nearest, .mip = MipFilter::Linear, .min_lod = 1.2f, .max_lod = 4.0f};

/// "fetches from View mips `level` and `level + 1`, applies LINEAR filtering to both mips ... and blends them 50% each".
void check_half_way(const TextureView& view, double lod, int level) {
    const SampleRecord record = at_lod(view, kExample, lod);
    INFO("lod " << lod << " view mip " << level);
    CHECK(record.lod == lod);
    CHECK(record.clamped_lod == level + 0.5);
    CHECK(!record.magnified);
    const auto& levels = record.probes.at(0).levels;
    REQUIRE(levels.size() == 2);
    for (int i = 0; i < 2; ++i) {
        const LevelRecord& read = levels[static_cast<std::size_t>(i)];
        CHECK(read.level == view.base() + level + i);  // in the resource's numbers
        CHECK(read.weight == 0.5);
        CHECK(read.taps.size() == 4);
    }
    CHECK(record.result[0] == view.base() + level + 1.5);
}

}  // namespace

TEST_CASE("case 1: the resource's limit falls within view and sampler limits", "[5.8.6.1]") {
    const Texture texture = resource(8);
    const TextureView view(texture, 1, 6, 3.5f);
    check_half_way(view, -2, 2);
    check_half_way(view, 2, 2);
    // gather4 works on view mip 0, which is clamped off: out of bounds, and that is what comparisons see.
    CHECK(gathered(view, Sampler{}, 0) == kZeros);
    CHECK(gather_compared(view, Sampler{.compare = CompareOp::LessEqual}, 0.5f) == kZeros);
    CHECK(gather_compared(view, Sampler{.compare = CompareOp::Greater}, 0.5f) == kOnes);
    // Below MaxLOD the sampler's own limits still count.
    CHECK(at_lod(view, kExample, 3.25).clamped_lod == 3.25);
    CHECK(at_lod(view, kExample, 9).clamped_lod == 4.0);
}

TEST_CASE("case 2: within the view but outside the sampler's limits", "[5.8.6.2]") {
    const Texture texture = resource(8);
    const TextureView view(texture, 1, 6, 5.5f);
    check_half_way(view, -2, 4);
    check_half_way(view, 2, 4);
    check_half_way(view, 100, 4);  // MaxLOD = 4 is below it
    CHECK(gathered(view, Sampler{}, 0) == kZeros);
    CHECK(gather_compared(view, Sampler{.compare = CompareOp::Equal}, 0.0f) == kOnes);
}

TEST_CASE("case 3: outside the view everything is out of bounds", "[5.8.6.3][5.8.5]") {
    for (const Format format : {Format::R32Float, Format::Rg32Float, Format::Rgba32Float}) {
        const Texture texture = resource(8, format);
        const TextureView view(texture, 1, 6, 6.5f);
        const double alpha = format == Format::Rgba32Float ? 0 : 1;  // "0 for all defined components, and defaults for missing"
        const std::array<double, 4> nothing{0, 0, 0, alpha};
        for (const double lod : {-2.0, 2.0, 100.0}) {
            Sampler border = kExample;
            border.address_u = border.address_v = AddressMode::Border;
            border.border = glm::vec4(9.0f);
            for (const Sampler& sampler : {kExample, border}) {
                const SampleRecord record = at_lod(view, sampler, lod);
                CHECK(record.result == nothing);
                CHECK(record.lod == lod);
                CHECK(record.clamped_lod == 0);  // "The lod instruction returns 0 for the clamped LOD in this empty-set case."
                const SampleRecord outside =
                    record_sample(view, sampler, Profile{}, SampleRequest{.coordinate = {-3, -3, 0}, .lod = lod});
                CHECK(outside.result == nothing);
            }
        }
        CHECK(gathered(view, Sampler{}, 0) == kZeros);
        CHECK(gathered(view, Sampler{}, 3) == (alpha == 1 ? kOnes : kZeros));
        CHECK(gather_compared(view, Sampler{.compare = CompareOp::Less}, -1.0f) == kOnes);
        CHECK(gather_compared(view, Sampler{.compare = CompareOp::Less}, 0.0f) == kZeros);
    }
}

TEST_CASE("integers in the empty set are 0, missing components their defaults", "[5.8.5]") {
    for (const Format format : {Format::R32Uint, Format::Rg32Uint, Format::Rgba32Uint}) {
        const Texture texture({.format = format, .width = 4, .height = 4, .levels = 3});
        const Sampler nearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
        const double alpha = format == Format::Rgba32Uint ? 0 : 1;
        INFO(name_of(format));
        CHECK(at_lod(TextureView(texture, 0, 1, 1.5f), nearest, 0).result == std::array<double, 4>{0, 0, 0, alpha});
    }
}

TEST_CASE("comparisons in the empty set see 0", "[5.8.5]") {
    const Texture texture = resource(4);
    const TextureView empty(texture, 0, 2, 2.0f);
    const auto compared = [&](CompareOp op, double reference) {
        return record_sample(empty, Sampler{.compare = op}, Profile{}, SampleRequest{.reference = reference}).result[0];
    };
    CHECK(compared(CompareOp::Equal, 0) == 1);
    CHECK(compared(CompareOp::Less, -1) == 1);
    CHECK(compared(CompareOp::Less, 0.5) == 0);
    CHECK(compared(CompareOp::Greater, 0.5) == 1);
}

TEST_CASE("the reference of a comparison in the empty set is quantised like any other", "[5.8.6.3][22.4.19]") {
    // "the out of bounds result is used as the comparison value against the reference"; 22.4.19 quantises the reference to the
    // format, "this includes a clamp to the format range": -0.5 is 0 in D16, and so is 2^-20.
    const Texture texture({.format = Format::D16, .width = 4, .height = 4, .levels = 3});
    const TextureView empty(texture, 0, 2, 2.0f);
    for (const double reference : {-0.5, 0x1p-20}) {
        const auto compared = [&](CompareOp op) {
            return record_sample(empty, Sampler{.compare = op}, Profile{}, SampleRequest{.reference = reference}).result[0];
        };
        INFO("reference " << reference);
        CHECK(compared(CompareOp::Equal) == 1);
        CHECK(compared(CompareOp::Less) == 0);
        CHECK(compared(CompareOp::Greater) == 0);
        CHECK(gather_compared(empty, Sampler{.compare = CompareOp::Equal}, static_cast<float>(reference)) == kOnes);
    }
}

TEST_CASE("a fractional limit blends the levels around it", "[5.8.4]") {
    // "suppose the per-resource MinLOD clamp is 1.1, and the current Shader Resource View is the entire mipchain. Texture
    // filters would behave as if the most detailed mipmap available is a blend of 90% of mipmap [1] and 10% of mipmap [2]."
    const Texture texture = resource(6);
    const SampleRecord record = at_lod(TextureView(texture, 0, 6, 1.1f), Sampler{.mip = MipFilter::Linear}, -3);
    const double code = 282.0 / 256.0;  // 1.1 in 8.8
    CHECK(record.clamped_lod == code);
    REQUIRE(record.probes.at(0).levels.size() == 2);
    CHECK(record.probes[0].levels[0].level == 1);
    CHECK(record.probes[0].levels[0].weight == 2 - code);
    CHECK(record.probes[0].levels[1].level == 2);
    CHECK(record.result[0] == code + 1);
    // Nearest: the level that the limit is next to.
    CHECK(at_lod(TextureView(texture, 0, 6, 1.1f), Sampler{.mip = MipFilter::Nearest}, -3).result[0] == 2);
    CHECK(at_lod(TextureView(texture, 0, 6, 1.75f), Sampler{.mip = MipFilter::Nearest}, -3).result[0] == 3);
    // "since the clamp of 0.1 requires mip 0 to be present, gather4 will fetch from mip 0"
    CHECK(gathered(TextureView(texture, 0, 6, 0.1f), Sampler{}, 0) == kOnes);
}

TEST_CASE("the empty set begins past the view's last level", "[5.8.5]") {
    const Texture texture = resource(6);
    struct Case {
        int base, levels;
        float min_lod;
        double expected;  // at level of detail 0, linear
    };
    // "a texture has 6 mip levels (0..5) and the MinLOD clamp is set to any value past the least detailed mip ... (e.g. 5.1)";
    // "a ShaderResourceView of mipmaps 0..3 on a resource along with a resource MinLOD clamp of 5".
    for (const Case& c : {Case{0, 6, 5.1f, 0}, Case{0, 6, 5.0f, 6}, Case{0, 6, 4.5f, 5.5}, Case{0, 4, 5.0f, 0},
                          Case{0, 4, 3.0f, 4}, Case{0, 4, 3.01f, 0}, Case{2, 2, 3.0f, 4}, Case{2, 2, 3.25f, 0},
                          Case{2, 2, 1.0f, 3}, Case{5, 1, 5.0f, 6}, Case{5, 1, 0.0f, 6}, Case{1, 1, 1.5f, 0}}) {
        INFO("view of " << c.levels << " from " << c.base << " limit " << c.min_lod);
        CHECK(at_lod(TextureView(texture, c.base, c.levels, c.min_lod), Sampler{.mip = MipFilter::Linear}, 0).result[0] ==
              c.expected);
        CHECK(TextureView(texture, c.base, c.levels, c.min_lod).empty() == (c.expected == 0));
    }
}

TEST_CASE("each limit counts in its own number space", "[5.8.3][7.18.11]") {
    // The sampler's limits count levels of the view, the resource's those of the resource.
    const Texture texture = resource(8);
    int limited_by_resource = 0;
    int limited_by_sampler = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        oracle::Random random(seed);
        const int base = random.integer(0, 7);
        const int levels = random.integer(1, 8 - base);
        const float min_lod = random.chance(3) ? 0.0f : random.in(0.0f, static_cast<float>(base + levels - 1));
        const Sampler sampler{.mip = MipFilter::Linear,
                              .lod_bias = random.in(-3.0f, 3.0f),
                              .min_lod = random.in(-1.0f, 6.0f),
                              .max_lod = random.in(-1.0f, 8.0f)};
        // Numbers of few bits: no addition rounds.
        Sampler exact = sampler;
        exact.lod_bias = std::floor(sampler.lod_bias * 64) / 64;
        const double lod = std::floor(static_cast<double>(random.in(-4.0f, 10.0f)) * 64) / 64;
        const double biased = lod + static_cast<double>(exact.lod_bias);
        const double in_view = static_cast<double>(min_lod - static_cast<float>(base));
        const double by_sampler =
            std::max(static_cast<double>(exact.min_lod), std::min(static_cast<double>(exact.max_lod), biased));
        const double clamped = fixed8(std::max(in_view, by_sampler));
        const double expected = base + 1 + std::clamp(clamped, 0.0, levels - 1.0);
        limited_by_resource += in_view > by_sampler && in_view > 0;
        limited_by_sampler += by_sampler != biased && by_sampler > in_view;
        const SampleRecord record = at_lod(TextureView(texture, base, levels, min_lod), exact, lod);
        if (record.result[0] != expected || record.clamped_lod != clamped)
            FAIL(
                fmt::format("seed {} view of {} from {} limit {:a} sampler [{:a}, {:a}] bias {:a} lod {:a}: {:a} clamped {:a}, "
                            "expected {:a} and {:a}",
                            seed, levels, base, min_lod, exact.min_lod, exact.max_lod, exact.lod_bias, lod, record.result[0],
                            record.clamped_lod, expected, clamped));
    }
    CHECK(limited_by_resource > 1000);
    CHECK(limited_by_sampler > 1000);
}

TEST_CASE("derivatives count texels of the view's finest level", "[5.8.3][7.18.11]") {
    const Texture texture = resource(8);
    for (int base = 0; base < 6; ++base) {
        const double width = 128 >> base;
        SampleRequest request{.coordinate = {0.4, 0.6, 0}};
        request.gradient = {{4 / width, 0, 0}, {0, 1 / width, 0}};  // 4 texels by 1
        const SampleRecord record =
            record_sample(TextureView(texture, base, 8 - base), Sampler{.mip = MipFilter::Linear}, Profile{}, request);
        INFO("base " << base);
        CHECK(record.lod == 2.0);
        CHECK(record.result[0] == std::min(base + 2, 7) + 1.0);
    }
}
