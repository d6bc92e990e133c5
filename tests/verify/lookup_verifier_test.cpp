// The verifier accepts every profile's samples and a correct sampler's, and refuses those of samplers with one defect each.
#include "tests/verify/lookup_verifier.h"

#include "sim/profile.h"
#include "tests/verify/random_lookups.h"
#include "tests/verify/scalar_sampler.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

using namespace gnomon;
using namespace verify;
using oracle::Random;

namespace {

constexpr std::array<std::pair<int, int>, 6> kSizes{{{16, 16}, {32, 8}, {64, 64}, {13, 21}, {5, 1}, {47, 30}}};
constexpr std::array kTestedFormats{Format::Rgba8Unorm, Format::Rg16Unorm, Format::Rg16Float, Format::Rg32Float,
                                    Format::R32Float,   Format::D32Float,  Format::D16};

/// What a profile promises for a format, from its fields.
LookupPrecision declared(const Profile& profile, Format format) {
    LookupPrecision precision;
    precision.epsilon = profile.arithmetic == Arithmetic::Fp64 ? 0x1p-53 : 0x1p-24;
    // SwiftShader SamplerCore.cpp sampleFloatAniso() adds up the steps from probe to probe.
    if (profile.aniso_rule == AnisoRule::SwiftShader) precision.coordinate_error += 16;
    precision.coordinate_bits = profile.texel_fraction_bits;
    precision.coordinate_rounding = profile.texel_rounding == FixedRounding::Truncate ? 1.0 : 0.5;
    precision.lod_bits = profile.lod_fraction_bits;
    precision.lod_rounding = profile.lod_rounding == FixedRounding::Truncate ? 1.0 : 0.5;
    precision.lod_error_low = precision.lod_error_high = 64 * precision.epsilon;
    switch (profile.log2_model) {
        case Log2Model::Exact: break;
        case Log2Model::Linear2: precision.lod_error_low += 0.0431; break;
        case Log2Model::Linear4: precision.lod_error_low += 0.0216; break;
    }
    precision.color_relative = 16 * precision.epsilon;
    // Coordinates and weights of 1/256, three lerps that round to whole codes.
    if (profile.unorm_filter == UnormFilter::Llvmpipe && format == Format::Rgba8Unorm) {
        precision.coordinate_bits = precision.weight_bits = 8;
        precision.coordinate_rounding = precision.weight_rounding = 1;
        precision.color_absolute = 1.5 / 255;
    }
    if (profile.border_precision == BorderPrecision::Unorm8) precision.border_error = 0.5 / 255;
    precision.reference_quantised = profile.compare_reference == CompareReference::Quantised;
    precision.lod_rule = profile.lod_rule;
    precision.ellipse_transform = profile.ellipse_transform;
    precision.ellipse_transform_isotropic = false;  // Profile::ellipse_transform is about anisotropic filters alone
    precision.aniso_clamps_to_top = profile.aniso_clamps_to_top;
    precision.aniso_rule = profile.aniso_rule;
    precision.probe_count = profile.probe_count;
    precision.aniso_limits = profile.aniso_limits;
    precision.probe_placement = profile.probe_placement;
    return precision;
}

/// What the profile makes of the sampler for a request.
Sampler honoured(const Profile& profile, Format format, const SampleRequest& request, Sampler sampler) {
    // Point sampling, of one texel, where the profile does not filter the format. D3D11.3 7.18.16.3
    if (!profile.filters_float32 && format_info(format).type == ComponentType::Float32) {
        sampler.min = sampler.mag = TexelFilter::Nearest;
        if (sampler.mip == MipFilter::Linear) sampler.mip = MipFilter::Nearest;
        sampler.max_anisotropy = 1;
    }
    // Mesa 22.3.6 lp_bld_sample_soa.c lp_build_sample_common: the whole part of the level of detail, whatever the mip filter.
    if (profile.aniso_rule == AnisoRule::Llvmpipe && sampler.max_anisotropy > 1 && request.gradient)
        sampler.mip = MipFilter::Linear;
    return sampler;
}

/// What the scalar sampler promises: 8-bit coordinates and levels of detail, doubles for the rest.
LookupPrecision scalar_precision() {
    LookupPrecision precision;
    precision.epsilon = 0x1p-53;
    precision.coordinate_rounding = 0.5;
    precision.lod_rounding = 0.5;
    precision.lod_error_low = precision.lod_error_high = 0x1p-40;
    precision.color_relative = 0x1p-40;
    return precision;
}

/// Samples of the scalar sampler until the verifier refuses one; -1 if it accepts all.
int samples_until_refusal(Defect defect, const LookupPrecision& precision, int stream, int samples, std::string* report) {
    constexpr int kPerTexture = 16;
    for (int first = 0; first < samples; first += kPerTexture) {
        Random random(static_cast<std::uint64_t>(stream) << 32 | static_cast<std::uint64_t>(first / kPerTexture));
        const auto [width, height] = kSizes[random.bits() % kSizes.size()];
        const Format format = kTestedFormats[random.bits() % kTestedFormats.size()];
        const TexturePair pair = random_texture(random, format, width, height);
        const Sampler sampler = random_sampler(random, static_cast<int>(pair.image.levels.size()));
        for (int i = 0; i < kPerTexture; ++i) {
            const SampleRequest request = random_request(random, pair.image, format_info(format).is_depth);
            const Color result = verify::sample(pair.image, sampler, request, defect);
            std::string why;
            if (is_legal(pair.image, sampler, precision, request, result, &why)) continue;
            *report = fmt::format("stream {} sample {} {} {}x{} {}; {}", stream, first + i, format_info(format).name, width,
                                  height, description(sampler, request, result), why);
            return first + i;
        }
    }
    return -1;
}

/// Counts what the verifier refuses of a profile, and tells of the first few.
struct Refusals {
    int results = 0;
    int lods = 0;
    std::string report;
};

/// Random samples of one random texture and sampler.
void verify_texture(const Profile& profile, Format format, int index, Refusals& refused) {
    constexpr int kRequests = 160;
    constexpr int kReported = 3;
    Random random(static_cast<std::uint64_t>(index) << 8 | static_cast<std::uint64_t>(format));
    const auto [width, height] = kSizes[static_cast<std::size_t>(index) % kSizes.size()];
    const TexturePair pair = random_texture(random, format, width, height);
    const Sampler sampler = random_sampler(random, static_cast<int>(pair.image.levels.size()));
    std::vector<SampleRequest> requests;
    for (int i = 0; i < kRequests; ++i) requests.push_back(random_request(random, pair.image, format_info(format).is_depth));

    const std::vector<SampleResult> results = sample_all(pair.texture, sampler, profile, requests);
    const LookupPrecision precision = declared(profile, format);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const Sampler kept = honoured(profile, format, requests[i], sampler);
        std::string why;
        std::string why_lod;
        const bool legal = is_legal(pair.image, kept, precision, requests[i], results[i].color, &why);
        const bool legal_lod = is_legal_lod(pair.image, kept, precision, requests[i], results[i].lod, &why_lod);
        if (legal && legal_lod) continue;
        refused.results += legal ? 0 : 1;
        refused.lods += legal_lod ? 0 : 1;
        if (refused.results + refused.lods > kReported) continue;
        refused.report += fmt::format(
            "{} {} {}x{} texture {} sample {} {} lod {:a}; {}\n", profile.name, format_info(format).name, width, height, index,
            i, description(sampler, requests[i], results[i].color), results[i].lod, legal ? why_lod : why);
    }
}

void verify_profile(const Profile& profile) {
    constexpr int kTextures = 48;
    Refusals refused;
    for (const Format format : kTestedFormats)
        for (int index = 0; index < kTextures; ++index) verify_texture(profile, format, index, refused);
    INFO(profile.name << "\n" << refused.report);
    CHECK(refused.results == 0);
    CHECK(refused.lods == 0);
}

}  // namespace

TEST_CASE("every sample of every profile is legal by what the profile declares", "[verifier][7.18]") {
    for (const Profile& profile : profile_presets()) verify_profile(profile);
}

TEST_CASE("a correct sampler is legal", "[verifier][7.18]") {
    std::string report;
    const int refused = samples_until_refusal(Defect::None, scalar_precision(), 0, 200000, &report);
    INFO(report);
    REQUIRE(refused == -1);
}

TEST_CASE("every broken sampler is refused", "[verifier][7.18]") {
    // Also by what binary32 hardware of the specification declares, which is less than the scalar sampler keeps.
    constexpr int kStreams = 32;
    constexpr int kSamples = 4000;
    for (const LookupPrecision& precision : {scalar_precision(), declared(profile_presets()[0], Format::Rg16Float)})
        for (const Defect defect : kDefects) {
            std::vector<int> survived;
            for (int stream = 0; stream < kStreams; ++stream) {
                std::string report;
                survived.push_back(samples_until_refusal(defect, precision, stream, kSamples, &report));
            }
            std::sort(survived.begin(), survived.end());
            INFO(verify::name_of(defect) << ": samples before refusal from " << survived.front() << " by median "
                                         << survived[kStreams / 2] << " to " << survived.back());
            CHECK(survived.front() >= 0);
        }
}
