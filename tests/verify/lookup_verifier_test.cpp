// The verifier accepts every profile's samples and a correct sampler's, and rejects samplers with one defect each.
#include "tests/verify/lookup_verifier.h"

#include "sim/profile.h"
#include "tests/verify/random_lookups.h"
#include "tests/verify/scalar_sampler.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <vector>

using namespace gnomon;
using namespace verify;
using oracle::Random;

namespace {

constexpr std::array<std::pair<int, int>, 6> kSizes{{{16, 16}, {32, 8}, {64, 64}, {13, 21}, {5, 1}, {47, 30}}};
constexpr std::array kTestedFormats{Format::Rgba8Unorm, Format::Rg16Unorm, Format::Rg16Float, Format::Rg32Float,
                                    Format::R32Float,   Format::D32Float,  Format::D16};

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
int samples_until_refusal(Defect defect, int samples, std::string* report) {
    constexpr int kPerTexture = 16;
    const LookupPrecision precision = scalar_precision();
    for (int first = 0; first < samples; first += kPerTexture) {
        Random random(static_cast<std::uint64_t>(first / kPerTexture));
        const auto [width, height] = kSizes[random.bits() % kSizes.size()];
        const Format format = kTestedFormats[random.bits() % kTestedFormats.size()];
        const TexturePair pair = random_texture(random, format, width, height);
        const Sampler sampler = random_sampler(random, static_cast<int>(pair.image.levels.size()));
        for (int i = 0; i < kPerTexture; ++i) {
            const SampleRequest request = random_request(random, pair.image, format_info(format).is_depth);
            const Color result = verify::sample(pair.image, sampler, request, defect);
            std::string why;
            if (is_legal(pair.image, sampler, precision, request, result, &why)) continue;
            *report = fmt::format("{} {}x{} {}; {}", format_info(format).name, width, height,
                                  description(sampler, request, result), why);
            return first + i;
        }
    }
    return -1;
}

}  // namespace

TEST_CASE("a correct sampler is legal", "[verifier][7.18]") {
    std::string report;
    const int refused = samples_until_refusal(Defect::None, 40000, &report);
    INFO(report);
    REQUIRE(refused == -1);
}

TEST_CASE("every broken sampler is refused", "[verifier][7.18]") {
    for (const Defect defect : kDefects) {
        std::string report;
        const int survived = samples_until_refusal(defect, 2000, &report);
        INFO(verify::name_of(defect));
        UNSCOPED_INFO(survived);
        CHECK(survived >= 0);
        if (std::getenv("VERBOSE")) fmt::print("{}: {} {}\n", verify::name_of(defect), survived, report);
    }
}
