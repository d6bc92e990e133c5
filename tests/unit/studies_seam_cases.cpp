// Small cases of the seam laboratory: coordinates that jump.
#include "tests/unit/seam_model.h"

#include "sim/error.h"

using namespace seam_model;

namespace {

/// Draws a case without a cure and with each, for all choices of derivatives, and compares what is uncured with the model.
/// `check(cure, image, measures)` looks at the cures.
template <class Check>
void check_case(const char* name, const Model& model, const Check& check) {
    const SeamCase& seam = find_seam_case(name);
    for (const Profile& profile : derivative_profiles()) {
        INFO(name << ", derivatives " << profile.name);
        Device device(profile);
        const SeamImage uncured = seam.draw(device, "none");
        const SeamImage reference = seam.draw(device, seam.reference);
        const Expected expected = check_uncured(uncured, model, profile);
        const SeamMeasures bad = measure_seam(uncured, uncured, reference);
        CHECK(expected.crossed_quads >= 200);
        CHECK(bad.bad_quads == expected.bad_quads);
        CHECK(bad.bad_pixels == expected.bad_pixels);
        CHECK(bad.bad_quads >= expected.crossed_quads);
        CHECK(bad.pixels == std::uint64_t{kSeamSide} * kSeamSide);
        CHECK(bad.worst_lod_error >= 1.0);
        CHECK(bad.changed_pixels > 0);
        for (const std::string_view cure : seam.cures) {
            if (cure == "none") continue;
            INFO("cure " << cure);
            const SeamImage image = seam.draw(device, cure);
            const SeamMeasures measures = measure_seam(image, uncured, reference);
            check_cured(measures);
            check(cure, image, measures);
        }
    }
}

/// Of coordinates that are linear: the level of detail is the same everywhere.
void check_linear(const SeamImage& image, const SeamMeasures& measures) {
    CHECK(worst_exact_error(image) < kLodStep / 4);
    CHECK(measures.changed_pixels == 0);
}

int floor_of(double x) { return static_cast<int>(std::floor(x)); }

}  // namespace

TEST_CASE("Atlas tiles: every crossing is bad, and no cure leaves one", "[seam]") {
    const Model model{.choice =
                          [](int x, int y) {
                              const glm::dvec3 at = on_plane(kAtlasPlane, x, y);
                              return 16 * floor_of(at.y) + floor_of(at.x);
                          },
                      .coordinate =
                          [](int x, int y, int choice) {
                              const int column = choice % 16;
                              const int row = choice / 16;
                              const glm::dvec3 at = on_plane(kAtlasPlane, x, y);
                              const glm::dvec2 tile((3 * column + 5 * row) % kAtlasTiles, (5 * column + 3 * row) % kAtlasTiles);
                              return (glm::dvec2(at.x - column, at.y - row) + tile) * (double{kAtlasSide} / kAtlasTiles);
                          }};
    check_case("atlas", model, [](std::string_view, const SeamImage& image, const SeamMeasures& measures) {
        check_linear(image, measures);
        CHECK(measures.disagreeing_quads >= 200);
    });
}

TEST_CASE("A coordinate that wraps around: every crossing is bad, and no cure leaves one", "[seam]") {
    const Model model{.choice = [](int x, int y) { return floor_of(on_plane(kWrapPlane, x, y).x); },
                      .coordinate =
                          [](int x, int y, int choice) {
                              const glm::dvec3 at = on_plane(kWrapPlane, x, y);
                              return glm::dvec2(at.x - choice, at.y) * double{kWrapSide};
                          }};
    check_case("wrap", model,
               [](std::string_view, const SeamImage& image, const SeamMeasures& measures) { check_linear(image, measures); });
}

TEST_CASE("Pages of a virtual texture: every crossing is bad, and no cure leaves one", "[seam]") {
    const auto page_at = [](int x, int y) {
        const glm::dvec3 at = on_plane(kPagesPlane, x, y);
        const std::span pages = seam_pages();
        for (std::size_t i = 0; i < pages.size(); ++i) {
            const SeamPage& page = pages[i];
            if (at.x >= page.left && at.x < page.left + page.side && at.y >= page.top && at.y < page.top + page.side)
                return static_cast<int>(i);
        }
        FAIL("no page at pixel " << x << ", " << y);
        return -1;
    };
    const Model model{.choice = page_at, .coordinate = [](int x, int y, int choice) {
                          const SeamPage& page = seam_pages()[static_cast<std::size_t>(choice)];
                          const glm::dvec3 at = on_plane(kPagesPlane, x, y);
                          const glm::dvec2 slot(page.slot % kCachePages, page.slot / kCachePages);
                          const glm::dvec2 inside(at.x - page.left, at.y - page.top);
                          return (inside / double(page.side) + slot) * (double{kCacheSide} / kCachePages);
                      }};
    // Lanes that follow the top left one out of their own page.
    std::uint64_t outside = 0;
    for (int y = 0; y < kSeamSide; ++y)
        for (int x = 0; x < kSeamSide; ++x) outside += page_at(x, y) != page_at(x & ~1, y & ~1);
    check_case("pages", model, [&](std::string_view cure, const SeamImage& image, const SeamMeasures& measures) {
        CHECK(worst_exact_error(image) < kLodStep / 4);
        CHECK(measures.outside_pixels == (cure == "quad-broadcast" ? outside : 0));
        CHECK((measures.disagreeing_quads == 0) == (cure == "quad-broadcast"));
        if (cure == "derivative-of-position") CHECK(measures.changed_pixels == 0);
    });
}

TEST_CASE("Pages cover the virtual texture and the cache once", "[seam]") {
    std::array<int, std::size_t{kVirtualPages} * kVirtualPages> covered{};
    std::array<int, kCachedPages> taken{};
    for (const SeamPage& page : seam_pages()) {
        ++taken[static_cast<std::size_t>(page.slot)];
        for (int y = page.top; y < page.top + page.side; ++y)
            for (int x = page.left; x < page.left + page.side; ++x) ++covered[static_cast<std::size_t>(y * kVirtualPages + x)];
    }
    CHECK(std::ranges::all_of(covered, [](int count) { return count == 1; }));
    CHECK(std::ranges::all_of(taken, [](int count) { return count == 1; }));
}

TEST_CASE("Small cases: the list", "[seam]") {
    for (const SeamCase& seam : all_seam_cases()) {
        INFO(seam.name);
        CHECK(&find_seam_case(seam.name) == &seam);
        REQUIRE_FALSE(seam.cures.empty());
        CHECK(seam.cures.front() == "none");
        CHECK(std::ranges::find(seam.cures, seam.reference) != seam.cures.end());
        for (const std::string_view text : {seam.summary, seam.source, seam.expectation})
            CHECK((!text.empty() && text.find('\n') == std::string_view::npos));
        Device device(load_profile("d3d11"), 1);
        CHECK_THROWS_WITH(seam.draw(device, "garlic"),
                          Catch::Contains("--cure garlic: seam '" + std::string(seam.name) + "'") && Catch::Contains("none, "));
    }
    CHECK_THROWS_WITH(find_seam_case("zip"),
                      Catch::Contains("seam 'zip': not known; expected one of") && Catch::Contains("atlas"));
}

TEST_CASE("Small cases: the same bytes for one thread and two, and probes are not counted", "[seam]") {
    for (const SeamCase& seam : all_seam_cases())
        for (const std::string_view cure : seam.cures) {
            INFO(seam.name << ", cure " << cure);
            Device one(load_profile("d3d11"), 1);
            Device two(load_profile("d3d11"), 2);
            const SeamImage image = seam.draw(one, cure);
            CHECK(same_bytes(image, seam.draw(two, cure)));
            CHECK(image.counters.lanes_shaded > 0);
            CHECK(image.counters.invalid_derivatives <= image.counters.derivatives);
            CHECK(image.milliseconds > 0);
            // Somewhere the value is that of no other pixel: the picture shows something.
            const auto [least, most] = std::ranges::minmax(image.pixels, {}, &SeamPixel::value);
            CHECK(least.value < most.value);
        }
}

TEST_CASE("Small cases: in double arithmetic the cures hold, too", "[seam]") {
    for (const SeamCase& seam : all_seam_cases()) {
        Device device(load_profile("ideal"));
        const SeamImage reference = seam.draw(device, seam.reference);
        INFO(seam.name);
        check_cured(measure_seam(reference, reference, reference));
    }
}
