// Summed-area variance shadow maps as pictures: every kind of table, beside mipmapped maps, with several samples.
// [Lauritzen07] 8.5
#include "techniques/frame.h"
#include "tests/techniques/frames.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace gnomon;
using namespace gnomon::testing;
using namespace gnomon::techniques;

namespace {

std::vector<float> visibility_of(const TechniqueRequest& request, std::string_view technique = "savsm") {
    return shoot(technique, request, {.scene = "car", .width = 160, .height = 120}).visibility;
}

/// The mean of |a - b| over pixels with a surface.
double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] == Frame::kNoSurface) continue;
        sum += std::fabs(static_cast<double>(a[i] - b[i]));
        ++count;
    }
    REQUIRE(count > 1000);
    return sum / count;
}

}  // namespace

TEST_CASE("every kind of table gives the same picture, up to its precision", "[techniques][savsm]") {
    const auto with = [](Format format, ParameterTexts set, int anisotropy = 16) {
        return visibility_of({.map_size = 256, .format = format, .anisotropy = anisotropy, .set = std::move(set)});
    };
    const auto split = with(Format::Rgba32Float, {});
    const double fixed = mean_difference(split, with(Format::Rg32Uint, {{"fraction-bits", "20"}}));
    const double uncentred = mean_difference(split, with(Format::Rgba32Float, {{"centre", "none"}}));
    const double centred_float = mean_difference(split, with(Format::Rg32Float, {}));
    const double plain_float = mean_difference(split, with(Format::Rg32Float, {{"centre", "none"}}));
    INFO(fixed << " " << uncentred << " " << centred_float << " " << plain_float);
    CHECK(fixed < 1e-3);
    CHECK(uncentred < 1e-3);
    CHECK(centred_float > fixed);
    CHECK(plain_float > centred_float);
    CHECK(plain_float < 2e-2);

    // The footprint counts: its limit of anisotropy, its least side.
    CHECK(mean_difference(split, with(Format::Rgba32Float, {}, 1)) > 1e-4);
    CHECK(mean_difference(split, with(Format::Rgba32Float, {{"min-width", "12"}})) > 5e-3);
}

TEST_CASE("pictures are close to those of mipmapped variance shadow maps", "[techniques][savsm]") {
    for (const int samples : {1, 4}) {
        const auto savsm = visibility_of({.map_size = 256, .map_samples = samples});
        const auto vsm = visibility_of({.map_size = 256, .map_samples = samples, .anisotropy = 16}, "vsm");
        INFO("samples " << samples);
        CHECK(mean_difference(savsm, vsm) < 1e-2);
        const auto coarse = visibility_of({.map_size = 32, .map_samples = samples});
        CHECK(mean_difference(savsm, coarse) > 2 * mean_difference(savsm, vsm));
    }
}

TEST_CASE("samples of a map are resolved before they are summed", "[techniques][savsm]") {
    const auto one = visibility_of({.map_size = 64});
    const auto four = visibility_of({.map_size = 64, .map_samples = 4});
    CHECK(mean_difference(one, four) > 1e-3);
    CHECK(mean_difference(four, visibility_of({.map_size = 64, .map_samples = 4, .anisotropy = 16}, "vsm")) < 2e-2);
}
