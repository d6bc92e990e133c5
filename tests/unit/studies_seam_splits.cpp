// The quad that straddles two splits, on scenes: what is wrong without a cure, and what each cure leaves.
// [PSVSM] "Texture coordinate derivatives"
#include "studies/seams/splits.h"
#include "techniques/common/cascade_setup.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <set>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

/// A technique in a scene, and one machine.
struct Subject {
    RenderRequest request;
    scenes::Scene scene;
    Profile profile;
    PlannedRun plan;

    [[nodiscard]] SeamImage draw(std::string_view cure) const { return draw_split_seams(scene, profile, request, plan, cure); }
};

struct Question {
    std::string scene = "fence";
    std::string technique = "psvsm";
    int cascades = 4;
    Profile profile{};
    int threads = 2;
};

Subject subject_of(const Question& question) {
    Subject subject{.request = {.scene = question.scene, .technique = question.technique, .choices = {}},
                    .scene = find_scene(question.scene, {}),
                    .profile = question.profile,
                    .plan = {}};
    subject.request.width = 320;
    subject.request.height = 240;
    subject.request.threads = question.threads;
    subject.request.choices.map_size = 256;
    subject.request.choices.cascades = question.cascades;
    subject.request.choices.set = {{"lambda", "0.8"}};
    subject.plan = plan_runs(subject.request, subject.profile).front();
    return subject;
}

/// The splits of the four lanes of a pixel's quad, helpers too.
std::array<int, 4> quad_of(const SeamPixel& pixel) {
    const int packed = static_cast<int>(pixel.quad);
    return {packed & 15, packed >> 4 & 15, packed >> 8 & 15, packed >> 12 & 15};
}

int kinds_in(const std::array<int, 4>& quad) { return static_cast<int>(std::set<int>(quad.begin(), quad.end()).size()); }

/// Where the trick with 2^split cannot bring the lanes of a quad together: fine derivatives, three or more splits; coarse ones,
/// a split that only the lane has which they do not read. tests/techniques/psvsm_trick.cpp finds these over all quads.
bool trick_may_fail(const std::array<int, 4>& quad, const Profile& profile) {
    if (profile.plain_derivative == PlainDerivative::Fine) return kinds_in(quad) >= 3;
    const auto unread = [&]() -> std::size_t {
        switch (profile.derivative_corner) {
            case DerivativeCorner::TopLeft: return 3;
            case DerivativeCorner::TopRight: return 2;
            case DerivativeCorner::BottomLeft: return 1;
            case DerivativeCorner::BottomRight: return 0;
        }
        return 0;
    }();
    std::array<int, 4> read = quad;
    read[unread] = quad[3 - unread];
    return kinds_in(quad) > 1 && kinds_in(read) == 1;
}

struct Mode {
    PlainDerivative plain;
    DerivativeCorner corner;
    LodSharing sharing;
};
constexpr std::array kModes{Mode{PlainDerivative::Fine, DerivativeCorner::TopLeft, LodSharing::Quad},
                            Mode{PlainDerivative::Fine, DerivativeCorner::BottomRight, LodSharing::Pixel},
                            Mode{PlainDerivative::Coarse, DerivativeCorner::TopLeft, LodSharing::Quad},
                            Mode{PlainDerivative::Coarse, DerivativeCorner::TopRight, LodSharing::Pixel},
                            Mode{PlainDerivative::Coarse, DerivativeCorner::BottomLeft, LodSharing::Quad},
                            Mode{PlainDerivative::Coarse, DerivativeCorner::BottomRight, LodSharing::Quad}};

Profile profile_of(const Mode& mode) {
    Profile profile;
    profile.plain_derivative = mode.plain;
    profile.derivative_corner = mode.corner;
    profile.lod_sharing = mode.sharing;
    return profile;
}

}  // namespace

TEST_CASE("without a cure every quad that straddles two splits takes a wrong level of detail, and says so",
          "[studies][seam][PSVSM]") {
    std::uint64_t crossings = 0;
    for (int cascades = 2; cascades <= 8; ++cascades) {
        for (const Mode& mode : kModes) {
            const Subject subject = subject_of({.cascades = cascades, .profile = profile_of(mode)});
            const SeamImage image = subject.draw("none");
            const SeamMeasures seam = measure_seam(image, image, image);
            INFO(fmt::format("{} splits, derivative {}, corner {}", cascades, static_cast<int>(mode.plain),
                             static_cast<int>(mode.corner)));
            REQUIRE(seam.disagreeing_quads > 20);
            crossings += seam.disagreeing_quads;
            std::uint64_t flagged = 0;
            std::uint64_t disagreeing = 0;
            for (std::size_t i = 0; i < image.pixels.size(); ++i) {
                const SeamPixel& pixel = image.pixels[i];
                if (!pixel.drawn()) continue;
                CHECK(pixel.used == pixel.own);
                CHECK(pixel.is(SeamPixel::kDisagrees) == (kinds_in(quad_of(pixel)) > 1));
                if (!pixel.is(SeamPixel::kDisagrees)) {
                    if (lod_error(pixel) != 0.0) FAIL_CHECK(fmt::format("pixel {}: {} levels off", i, lod_error(pixel)));
                    continue;
                }
                ++disagreeing;
                flagged += (image.derivatives[i] & kFromInactive) != 0;
            }
            // A quad is bad where its derivatives are taken across the seam, or a lane takes those of another projection: here
            // every one that straddles two splits.
            CHECK(seam.bad_quads == seam.disagreeing_quads);
            CHECK(seam.worst_lod_error > 3.0);
            CHECK(seam.mean_lod_error > 1.0);
            CHECK(flagged > 0);
            CHECK(flagged <= disagreeing);
        }
    }
    CHECK(crossings > 2000);
}

TEST_CASE("with a cure no quad straddles two splits, or its level of detail is that of a quad without a seam",
          "[studies][seam][PSVSM]") {
    std::uint64_t failures_of_the_trick = 0;
    for (int cascades = 2; cascades <= 8; ++cascades) {
        for (const Mode& mode : kModes) {
            const Subject subject = subject_of({.cascades = cascades, .profile = profile_of(mode)});
            for (const std::string_view cure : split_cures()) {
                if (cure == "none") continue;
                const SeamImage image = subject.draw(cure);
                const SeamMeasures seam = measure_seam(image, image, image);
                INFO(fmt::format("{}, {} splits, derivative {}, corner {}", cure, cascades, static_cast<int>(mode.plain),
                                 static_cast<int>(mode.corner)));
                if (cure == "quad-min" || cure == "quad-max") {
                    // Exactly where its algebra says: nowhere else, and there each lane keeps what it computed.
                    for (const SeamPixel& pixel : image.pixels) {
                        if (!pixel.drawn() || !pixel.is(SeamPixel::kDisagrees)) continue;
                        ++failures_of_the_trick;
                        if (!trick_may_fail(quad_of(pixel), subject.profile))
                            FAIL_CHECK(fmt::format("splits {} disagree", fmt::join(quad_of(pixel), " ")));
                    }
                    CHECK(seam.bad_quads <= seam.disagreeing_quads);
                    continue;
                }
                if (cure == "quad-broadcast") {
                    CHECK(seam.disagreeing_quads == 0);
                    for (const SeamPixel& pixel : image.pixels)
                        if (pixel.drawn() && static_cast<int>(pixel.used) != quad_of(pixel)[0]) FAIL_CHECK("not lane 0's");
                }
                CHECK(seam.bad_quads == 0);
                CHECK(seam.worst_lod_error < kLodStep);
            }
        }
    }
    CHECK(failures_of_the_trick > 0);  // the scene has quads that it cannot bring together
    CHECK(failures_of_the_trick < 2000);
}

TEST_CASE("the level of detail of finite differences is the exact one to within the change of distance over a quad",
          "[studies][seam]") {
    // Of a ratio S/Q that is linear over linear the difference over a pixel is the derivative times Q at one pixel over Q at
    // the next: by the change of distance, which on the ground of `fence` is small near the camera.
    const Subject subject = subject_of({});
    const SeamImage image = subject.draw("explicit-gradients");
    const SeamMeasures seam = measure_seam(image, image, image);
    CHECK(seam.exact_lod_error < 0.03);
    std::size_t near_camera = 0;
    for (int y = image.height * 3 / 4; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const SeamPixel& pixel = image.pixels[static_cast<std::size_t>(y * image.width + x)];
            // 60 rows below the horizon at least: distances change by less than 1/59 from row to row, log2(60/59) = 0.0243.
            if (!pixel.drawn() || pixel.lod == pixel.exact_lod) continue;
            ++near_camera;
            if (std::fabs(pixel.lod - pixel.exact_lod) > 0.025f)
                FAIL_CHECK(fmt::format("({}, {}): {} instead of {}", x, y, pixel.lod, pixel.exact_lod));
        }
    CHECK(near_camera > 1000);
}

TEST_CASE("at seams, cures bring the level of detail back to what finite differences give elsewhere", "[studies][seam]") {
    const Subject subject = subject_of({.cascades = 6});
    const SeamImage none = subject.draw("none");
    const double uncured = measure_seam(none, none, none).crossing_lod_error;
    CHECK(uncured > 1.0);
    const SeamImage reference = subject.draw("explicit-gradients");
    const double elsewhere = measure_seam(reference, none, none).crossing_lod_error;
    CHECK(elsewhere < 0.1);
    for (const std::string_view cure : split_cures()) {
        if (cure == "none") continue;
        const SeamImage image = subject.draw(cure);
        const SeamMeasures seam = measure_seam(image, none, none);
        INFO(cure);
        const bool is_trick = cure == "quad-min" || cure == "quad-max";  // which misses a lane here and there
        if (is_trick) {
            CHECK(seam.crossing_lod_error < 0.1 * uncured);
        } else {
            CHECK(seam.crossing_lod_error == Approx(elsewhere).margin(kLodStep));
        }
    }
}

TEST_CASE("derivatives of the position err by the last bits of a coordinate, the more the larger the zoom", "[studies][seam]") {
    // A coordinate of up to 1 is rounded by 2^-25, a difference of two by twice that, and there are three of them in each
    // derivative; so are those of the split's own coordinates. Of a gradient of 2^lod texels of a map that is `zoom` times as
    // fine as one of the whole light these are so many octaves. Coordinates of the light are at most 1.
    const Subject subject = subject_of({.scene = "city", .cascades = 4});
    const SeamImage image = subject.draw("derivative-of-position");
    const scenes::View camera = scenes::camera_view(subject.scene.camera, 4.0f / 3.0f);
    const scenes::View light = scenes::light_view(subject.scene.light, subject.scene.bounds());
    Device device(subject.profile, 1);
    techniques::CascadeSetup setup(device, subject.plan.settings);
    techniques::PassTimer timer(device);
    setup.update({.scene = {}, .camera = camera, .light = light, .width = image.width, .height = image.height}, timer);
    std::size_t judged = 0;
    double worst_share = 0;
    for (const SeamPixel& pixel : image.pixels) {
        if (!pixel.drawn()) continue;
        const glm::dvec2 zoom = setup.window(static_cast<std::size_t>(pixel.used)).zoom();
        const double texels = 256 * std::max(zoom.x, zoom.y);
        const double allowed = 8 * 0x1p-24 * texels / std::exp2(static_cast<double>(pixel.smooth_lod)) / 0.693;
        if (allowed > 0.25) continue;  // next to no gradient
        ++judged;
        worst_share = std::max(worst_share, lod_error(pixel) / allowed);
    }
    INFO(judged << " pixels, worst share " << worst_share);
    CHECK(judged > 30000);
    CHECK(worst_share <= 1.0);
    CHECK(worst_share > 0.01);
}

TEST_CASE("what a cure costs, in instructions", "[studies][seam]") {
    for (const int cascades : {2, 4, 8}) {
        const Subject subject = subject_of({.cascades = cascades});
        const auto lanes = [](const SeamImage& image) { return image.counters.lanes_shaded; };
        const auto n = static_cast<std::uint64_t>(cascades);
        const SeamImage none = subject.draw("none");
        CHECK(none.counters.texture_instructions == lanes(none));
        CHECK(none.counters.derivatives == lanes(none));  // the sample's own
        const auto derivatives = [&](std::string_view cure) { return subject.draw(cure).counters.derivatives; };
        CHECK(derivatives("quad-min") == 4 * lanes(none));  // three of 2^split, and the sample's
        CHECK(derivatives("quad-max") == 4 * lanes(none));
        CHECK(derivatives("quad-broadcast") == lanes(none));
        CHECK(derivatives("explicit-gradients") == 4 * n * lanes(none));  // two coordinates, two directions, every split
        CHECK(derivatives("derivative-of-position") == 6 * lanes(none));  // s, t and q
        const SeamImage all = subject.draw("sample-all");
        CHECK(all.counters.texture_instructions == n * lanes(all));
        CHECK(all.counters.derivatives == n * lanes(all));
    }
}

TEST_CASE("a profile that does not filter the maps has seams too", "[studies][seam]") {
    const Subject subject = subject_of({.profile = load_profile("nv40")});
    const SeamImage image = subject.draw("none");
    const SeamMeasures seam = measure_seam(image, image, image);
    CHECK(seam.disagreeing_quads > 20);
    CHECK(seam.bad_quads > 20);
}

TEST_CASE("every technique with splits can be looked at, the same for every number of threads", "[studies][seam]") {
    for (const techniques::Technique& technique : techniques::all_techniques()) {
        INFO(technique.name);
        const auto draw = [&](int threads) {
            return subject_of({.technique = std::string(technique.name), .cascades = 3, .threads = threads}).draw("none");
        };
        const SeamImage one = draw(1);
        const SeamImage two = draw(2);
        REQUIRE(one.pixels.size() == two.pixels.size());
        std::size_t differing = 0;
        for (std::size_t i = 0; i < one.pixels.size(); ++i)
            differing += std::bit_cast<std::array<std::uint32_t, 10>>(one.pixels[i]) !=
                         std::bit_cast<std::array<std::uint32_t, 10>>(two.pixels[i]);
        CHECK(differing == 0);
        CHECK(one.derivatives == two.derivatives);
        CHECK(measure_seam(one, one, one).disagreeing_quads > 20);
    }
}
