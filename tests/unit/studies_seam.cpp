// The measures of a picture of seams, on pictures made by hand.
#include "studies/seams/seam.h"

#include "pipeline/derivatives.h"
#include "studies/seams/probe.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <limits>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// 4x4 pixels, all of choice 0 at the right level: four quads.
SeamImage calm() {
    SeamImage image{.width = 4, .height = 4, .pixels = {}, .derivatives = {}, .counters = {}};
    image.pixels.assign(16, {.own = 0, .lod = 1, .smooth_lod = 1, .exact_lod = 1, .level = 1, .value = 0.5f});
    image.derivatives.assign(16, 0);
    return image;
}

SeamPixel& at(SeamImage& image, int x, int y) { return image.pixels[static_cast<std::size_t>(y * image.width + x)]; }

SeamMeasures measured(const SeamImage& image) { return measure_seam(image, image, image); }

const SeamPicture& named(const std::vector<SeamPicture>& pictures, std::string_view name) {
    for (const SeamPicture& picture : pictures)
        if (picture.name == name) return picture;
    FAIL("no picture " << name);
    return pictures.front();
}
std::array<int, 3> color_at(const ByteImage& image, int x, int y) {
    const auto first = static_cast<std::size_t>(3 * (y * image.width + x));
    return {image.values[first], image.values[first + 1], image.values[first + 2]};
}

}  // namespace

TEST_CASE("Error of a level of detail: capped, and nothing between equal infinities", "[seam]") {
    const auto error = [](float lod, float smooth) { return lod_error({.lod = lod, .smooth_lod = smooth}); };
    CHECK(error(1.5f, 1.0f) == 0.5);
    CHECK(error(1.0f, 1.5f) == 0.5);
    CHECK(error(-kInfinity, -kInfinity) == 0);
    CHECK(error(-kInfinity, 2.0f) == kWorstLod);
    CHECK(error(kInfinity, -kInfinity) == kWorstLod);
    CHECK(error(40.0f, 2.0f) == kWorstLod);
    CHECK(error(std::numeric_limits<float>::quiet_NaN(), 2.0f) == kWorstLod);
}

TEST_CASE("Measures: nothing is bad in a calm picture", "[seam]") {
    const SeamMeasures measures = measured(calm());
    CHECK(measures.pixels == 16);
    CHECK(measures.quads == 4);
    CHECK(measures.disagreeing_quads == 0);
    CHECK(measures.bad_quads == 0);
    CHECK(measures.bad_pixels == 0);
    CHECK(measures.outside_pixels == 0);
    CHECK(measures.worst_lod_error == 0);
    CHECK(measures.mean_lod_error == 0);
    CHECK(measures.exact_lod_error == 0);
    CHECK(measures.worst_value_error == 0);
    CHECK(measures.mean_value_error == 0);
    CHECK(measures.changed_pixels == 0);
}

TEST_CASE("Measures: a pixel is bad from one step of the level of detail on", "[seam]") {
    SeamImage image = calm();
    at(image, 1, 1).lod = 1 + 1 / 256.0f;                     // the first quad, by just one step
    at(image, 2, 0).lod = 1 + 0.999f / 256.0f;                // the second, by less
    at(image, 0, 2).lod = at(image, 1, 3).lod = 1.0f - 2.0f;  // the third, twice
    const SeamMeasures measures = measured(image);
    CHECK(measures.bad_pixels == 3);
    CHECK(measures.bad_quads == 2);
    CHECK(measures.worst_lod_error == 2);
    CHECK(measures.mean_lod_error == Approx((2 + 2 + 1 / 256.0) / 3));
    CHECK(measures.exact_lod_error == Approx((2 + 2 + 1.999 / 256.0) / 16));
}

TEST_CASE("Measures: quads disagree by their flag, not by the choices that their pixels call for", "[seam]") {
    SeamImage image = calm();
    // The first quad's choices differ, but after the cure it is of one mind; of the second only lanes that are not drawn
    // differ, which the flag knows; the last has a choice of its own and no seam.
    at(image, 1, 0).own = 3;
    at(image, 2, 0).flags = at(image, 2, 1).flags = SeamPixel::kDisagrees;
    at(image, 3, 0).own = at(image, 3, 1).own = -1;
    for (const int x : {2, 3}) at(image, x, 2).own = at(image, x, 3).own = 7;
    at(image, 3, 3).flags = SeamPixel::kOutside;
    const SeamMeasures measures = measured(image);
    CHECK(measures.pixels == 14);
    CHECK(measures.quads == 4);
    CHECK(measures.disagreeing_quads == 1);
    CHECK(measures.outside_pixels == 1);
}

TEST_CASE("Measures: against exact derivatives, the pixels of quads that disagree without a cure", "[seam]") {
    SeamImage uncured = calm();
    at(uncured, 0, 0).flags = at(uncured, 1, 0).flags = SeamPixel::kDisagrees;
    SeamImage cured = calm();
    at(cured, 0, 0).exact_lod = at(cured, 0, 0).lod + 0.5f;
    at(cured, 3, 3).exact_lod = at(cured, 3, 3).lod + 8;  // elsewhere
    const SeamMeasures measures = measure_seam(cured, uncured, cured);
    CHECK(measures.crossing_lod_error == 0.25);
    CHECK(measures.exact_lod_error == 8.5 / 16);
    CHECK(measured(cured).crossing_lod_error == 0);
}

TEST_CASE("Measures: what is not drawn counts for nothing", "[seam]") {
    SeamImage image = calm();
    for (const int y : {0, 1})
        for (const int x : {0, 1}) {
            at(image, x, y) = {.own = -1, .lod = 9, .flags = SeamPixel::kDisagrees + SeamPixel::kOutside, .value = 1};
        }
    at(image, 2, 0) = at(image, 0, 0);
    at(image, 3, 1).own = 2;
    const SeamMeasures measures = measured(image);
    CHECK(measures.pixels == 11);
    CHECK(measures.quads == 3);
    CHECK(measures.disagreeing_quads == 0);
    CHECK(measures.bad_pixels == 0);
    CHECK(measures.bad_quads == 0);
    CHECK(measures.outside_pixels == 0);
    CHECK(measures.exact_lod_error == 0);
}

TEST_CASE("Measures: values are compared with those of the reference, where it was bad without a cure", "[seam]") {
    SeamImage uncured = calm();
    at(uncured, 0, 0).lod = at(uncured, 1, 0).lod = 5;
    SeamImage reference = calm();
    at(reference, 0, 0).value = 0.75f;
    SeamImage cured = calm();
    at(cured, 3, 3).value = 0.5f + 1 / 256.0f;  // changed by less than a code, and never bad
    at(cured, 3, 2).value = 0.5f - 1 / 250.0f;  // by more
    const SeamMeasures measures = measure_seam(cured, uncured, reference);
    CHECK(measures.bad_pixels == 0);
    CHECK(measures.worst_value_error == 0.25);
    CHECK(measures.mean_value_error == 0.125);  // of the two that were bad
    CHECK(measures.changed_pixels == 2);
    CHECK(measure_seam(reference, uncured, reference).worst_value_error == 0);
    CHECK(measure_seam(uncured, uncured, reference).bad_pixels == 2);
}

TEST_CASE("Measures: pictures of odd sides end in halves of quads", "[seam]") {
    SeamImage image{.width = 3, .height = 3, .pixels = {}, .derivatives = {}, .counters = {}};
    image.pixels.assign(9, {.own = 0, .lod = 1, .smooth_lod = 1});
    at(image, 2, 2).lod = 2;
    at(image, 2, 0).flags = at(image, 2, 1).flags = SeamPixel::kDisagrees;
    const SeamMeasures measures = measured(image);
    CHECK(measures.pixels == 9);
    CHECK(measures.quads == 4);
    CHECK(measures.bad_quads == 1);
    CHECK(measures.disagreeing_quads == 1);
}

TEST_CASE("Pictures of a seam: every one shows what it is for", "[seam]") {
    SeamImage image = calm();
    at(image, 1, 0) = {.own = 1, .used = 1, .lod = 5, .smooth_lod = 1, .probes = 4, .flags = SeamPixel::kDisagrees};
    at(image, 2, 0).lod = -3;
    at(image, 3, 3).own = -1;
    image.derivatives[2] = kFromKilled;
    const std::vector<SeamPicture> pictures = seam_pictures(image);
    CHECK(pictures.size() == 6);
    for (const SeamPicture& picture : pictures) {
        INFO(picture.name);
        CHECK(picture.image.width == 4);
        CHECK(picture.image.height == 4);
        REQUIRE(picture.image.values.size() == 48);
        const bool shows_pixel_2 = picture.name == "derivatives" || picture.name == "lod" || picture.name == "lod-error";
        CHECK((color_at(picture.image, 2, 0) != color_at(picture.image, 0, 0)) == shows_pixel_2);
        CHECK((color_at(picture.image, 1, 0) != color_at(picture.image, 0, 0)) == (picture.name != "derivatives"));
        CHECK(color_at(picture.image, 3, 3) != color_at(picture.image, 0, 0));  // not drawn
        CHECK(color_at(picture.image, 0, 3) == color_at(picture.image, 0, 0));
    }
    // Too coarse is red, too fine blue.
    const ByteImage& error = named(pictures, "lod-error").image;
    CHECK(color_at(error, 1, 0)[0] > color_at(error, 1, 0)[2]);
    CHECK(color_at(error, 2, 0)[0] < color_at(error, 2, 0)[2]);
}

TEST_CASE("Probe targets: what is written comes back, field by field", "[seam]") {
    Device device(load_profile("d3d11"));
    const ProbeTargets targets(device, 4, 2);
    const auto write = [&](TextureId id, float first) {
        std::vector<float> values;
        for (int i = 0; i < 4 * 2 * 4; ++i) values.push_back(first + static_cast<float>(i));
        device.execute(WriteTexture{.id = id, .data = std::as_bytes(std::span(values))});
    };
    for (std::size_t i = 0; i < kProbeTargets; ++i) write(targets.colors()[i].texture, 100.0f * static_cast<float>(i));
    const std::array<std::uint32_t, 8> causes{0, 1, 2, 3, 4, 5, 6, 7};
    device.execute(WriteTexture{.id = targets.derivatives(), .data = std::as_bytes(std::span(causes))});
    const SeamImage image = targets.read();
    CHECK(image.width == 4);
    CHECK(image.height == 2);
    REQUIRE(image.pixels.size() == 8);
    const SeamPixel& pixel = image.pixels[5];
    CHECK(pixel.own == 20);
    CHECK(pixel.used == 21);
    CHECK(pixel.lod == 22);
    CHECK(pixel.smooth_lod == 23);
    CHECK(pixel.exact_lod == 120);
    CHECK(pixel.level == 121);
    CHECK(pixel.probes == 122);
    CHECK(pixel.flags == 123);
    CHECK(pixel.value == 220);
    CHECK(pixel.quad == 221);
    CHECK(std::ranges::equal(image.derivatives, causes));
}
