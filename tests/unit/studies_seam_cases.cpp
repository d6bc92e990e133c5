// Small cases of the seam laboratory: what is bad without a cure, pixel by pixel, and what is left with each.
#include "tests/unit/seam_model.h"

#include "pipeline/derivatives.h"
#include "sim/error.h"
#include "tests/oracle/coverage.h"

using namespace seam_model;

namespace {

/// Of coordinates that are linear, with a cure: the level of detail is that of the exact derivatives.
void check_linear(const SeamImage& image, const SeamMeasures& measures) {
    CHECK(worst_exact_error(image) < kLodStep / 4);
    CHECK(measures.changed_pixels == 0);
}

/// Of jumps that no derivative misses.
void check_uncured_jumps(const SeamMeasures& measures, const Expected& expected) {
    CHECK(measures.bad_quads >= expected.crossed_quads);
    CHECK(measures.worst_lod_error >= 4.0);
}

int floor_of(double x) { return static_cast<int>(std::floor(x)); }

}  // namespace

TEST_CASE("Atlas tiles: every crossing is bad, and no cure leaves one", "[seam]") {
    const Model model{.choice =
                          [](int x, int y) {
                              const glm::dvec3 at = on_plane(kAtlasPlane, x, y);
                              return 16 * floor_of(at.y) + floor_of(at.x);
                          },
                      .smooth =
                          [](int x, int y, int choice) {
                              const int column = choice % 16;
                              const int row = choice / 16;
                              const glm::dvec3 at = on_plane(kAtlasPlane, x, y);
                              const glm::dvec2 tile((3 * column + 5 * row) % kAtlasTiles, (5 * column + 3 * row) % kAtlasTiles);
                              return (glm::dvec2(at.x - column, at.y - row) + tile) * (double{kAtlasSide} / kAtlasTiles);
                          }};
    check_case("atlas", model,
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   if (cure == "none") return check_uncured_jumps(measures, expected);
                   check_linear(image, measures);
                   CHECK(measures.disagreeing_quads == expected.disagreeing_quads);
               });
}

TEST_CASE("A coordinate that wraps around: every crossing is bad, and no cure leaves one", "[seam]") {
    const Model model{.choice = [](int x, int y) { return floor_of(on_plane(kWrapPlane, x, y).x); },
                      .smooth =
                          [](int x, int y, int choice) {
                              const glm::dvec3 at = on_plane(kWrapPlane, x, y);
                              return glm::dvec2(at.x - choice, at.y) * double{kWrapSide};
                          }};
    check_case("wrap", model,
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   if (cure == "none") return check_uncured_jumps(measures, expected);
                   check_linear(image, measures);
               });
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
    const Model model{.choice = page_at, .smooth = [](int x, int y, int choice) {
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
    check_case("pages", model,
               [&](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   if (cure == "none") return check_uncured_jumps(measures, expected);
                   CHECK(worst_exact_error(image) < kLodStep / 4);
                   const bool is_shared = cure == "quad-broadcast";
                   CHECK(measures.outside_pixels == (is_shared ? outside : 0));
                   CHECK(measures.disagreeing_quads == (is_shared ? 0 : expected.disagreeing_quads));
                   CHECK((measures.changed_pixels > 0) == is_shared);
               });
}

TEST_CASE("Faces of a cube: every crossing is bad, and no cure leaves one", "[seam]") {
    const auto direction_at = [](int x, int y) {
        const glm::dvec3 at = on_plane(kFacesPlane, x, y);
        return glm::dvec3(2 * at.x, 2 * at.y, 1 - at.x * at.x - at.y * at.y);
    };
    // D3D11.3 7.18.7 has the faces; `out` of a face first, then what grows to the right and downwards.
    struct Face {
        glm::dvec3 out, right, down;
    };
    static const std::array<Face, 6> kFaces{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                             {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                             {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                             {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                             {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                             {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};
    const auto face_at = [&](int x, int y) {
        std::array<double, 6> height;
        std::ranges::transform(kFaces, height.begin(),
                               [&](const Face& face) { return glm::dot(face.out, direction_at(x, y)); });
        return static_cast<int>(std::ranges::max_element(height) - height.begin());
    };
    const Model model{.choice = face_at, .smooth = [&](int x, int y, int choice) {
                          const Face& face = kFaces[static_cast<std::size_t>(choice)];
                          const glm::dvec3 d = direction_at(x, y);
                          const glm::dvec2 at(glm::dot(face.right, d), glm::dot(face.down, d));
                          return (at / glm::dot(face.out, d) + 1.0) * (0.5 * kFaceSide);
                      }};
    std::uint64_t outside = 0;
    std::array<bool, 6> seen{};
    for (int y = 0; y < kSeamSide; ++y)
        for (int x = 0; x < kSeamSide; ++x) {
            outside += face_at(x, y) != face_at(x & ~1, y & ~1);
            seen[static_cast<std::size_t>(face_at(x, y))] = true;
        }
    CHECK(std::ranges::all_of(seen, [](bool is_seen) { return is_seen; }));
    check_case("cube-faces", model,
               [&](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   if (cure == "none") return check_uncured_jumps(measures, expected);
                   // Nothing here is linear, so differences over a pixel are not quite derivatives.
                   CHECK(worst_exact_error(image) < 0.1);
                   CHECK(measures.exact_lod_error < 0.02);
                   const bool is_shared = cure == "quad-broadcast";
                   CHECK(measures.outside_pixels == (is_shared ? outside : 0));
                   CHECK(measures.disagreeing_quads == (is_shared ? 0 : expected.disagreeing_quads));
               });
}

TEST_CASE("Layers: packed ones are bad at every crossing, those of an array are not", "[seam]") {
    const Model model{.choice =
                          [](int x, int y) {
                              const double depth = on_plane(kLayerPlane, x, y).z;
                              return floor_of((depth - std::floor(depth)) * kLayers);
                          },
                      .smooth =
                          [](int x, int y, int choice) {
                              const glm::dvec3 at = on_plane(kLayerPlane, x, y);
                              return (glm::dvec2(at) + glm::dvec2(choice % 2, choice / 2)) * double{kLayerSide};
                          }};
    check_case("lvsm-layers", model,
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   const bool has_branches = cure == "branches";
                   CHECK(flagged(image, ~0u) == (has_branches ? expected.reading_pixels : 0));
                   CHECK(flagged(image, kFromInactive) == (has_branches ? expected.reading_pixels : 0));
                   CHECK(image.counters.invalid_derivatives == (has_branches ? expected.reading_pixels : 0));
                   if (cure == "none") return check_uncured_jumps(measures, expected);
                   check_linear(image, measures);
               });
}

namespace {

/// Inside a disc around the middle of a square of the grid.
bool in_disc(int x, int y) {
    const auto from_middle = [](int at) { return at % kDiscs.side + 0.5 - kDiscs.side / 2; };
    return from_middle(x) * from_middle(x) + from_middle(y) * from_middle(y) < double{kDiscs.radius_squared};
}

/// Pixels in discs, or those around them, take a sample; the others hold old coordinates.
Model flow_model(bool in_discs) {
    const auto takes = [in_discs](int x, int y) { return in_disc(x, y) == in_discs; };
    const auto smooth = [](int x, int y) { return glm::dvec2(on_plane(kFlowPlane, x, y)) * double{kFlowSide}; };
    return {.choice = [](int x, int y) { return in_disc(x, y) ? 1 : 0; },
            .smooth = [smooth](int x, int y, int) { return smooth(x, y); },
            .held = [=](int x, int y) { return takes(x, y) ? smooth(x, y) : glm::dvec2(0); },
            .takes = takes,
            .draws_others = in_discs};
}

/// Only gradients from before are free of flags.
void check_flags(std::string_view cure, const SeamImage& image, const Expected& expected, std::uint32_t cause) {
    const std::uint64_t flags = cure == "explicit-gradients" ? 0 : expected.reading_pixels;
    CHECK(flagged(image, cause) == flags);
    CHECK(flagged(image, ~cause) == 0);
    CHECK(image.counters.invalid_derivatives == flags);
}

}  // namespace

TEST_CASE("Branches: coordinates from inside are bad at every crossing, those from before are flagged", "[seam]") {
    check_case("branch", flow_model(true),
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   check_flags(cure, image, expected, kFromInactive);
                   if (cure != "none") return check_linear(image, measures);
                   check_uncured_jumps(measures, expected);
                   CHECK(measures.bad_pixels == expected.reading_pixels);
               });
}

TEST_CASE("Discards: old coordinates are bad at every crossing, those of helpers are flagged", "[seam]") {
    check_case("discard", flow_model(false),
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   check_flags(cure, image, expected, kFromKilled);
                   CHECK(image.counters.lanes_discarded == image.counters.lanes_shaded - expected.pixels);
                   if (cure != "none") return check_linear(image, measures);
                   check_uncured_jumps(measures, expected);
                   CHECK(measures.bad_pixels == expected.reading_pixels);
               });
}

TEST_CASE("Centroids: bad wherever they make the longer derivative another", "[seam]") {
    // Masks and centroids of all pixels; the triangles share none.
    constexpr oracle::SamplePattern kPattern = oracle::standard_pattern(kCentroidSamples);
    std::vector<std::uint32_t> masks(std::size_t{kSeamSide} * kSeamSide);
    const auto index = [](int x, int y) { return static_cast<std::size_t>(y * kSeamSide + x); };
    for (const CentroidTriangle& triangle : centroid_triangles()) {
        const oracle::SnappedTriangle snapped{oracle::Point{triangle[0].x, triangle[0].y},
                                              oracle::Point{triangle[1].x, triangle[1].y},
                                              oracle::Point{triangle[2].x, triangle[2].y}};
        const auto [left, right] = std::ranges::minmax({triangle[0].x, triangle[1].x, triangle[2].x});
        const auto [top, bottom] = std::ranges::minmax({triangle[0].y, triangle[1].y, triangle[2].y});
        for (int y = top / 256; y <= bottom / 256; ++y)
            for (int x = left / 256; x <= right / 256; ++x) {
                const std::uint32_t mask = oracle::mask_by_definition(snapped, x, y, kPattern);
                CHECK((mask == 0 || masks[index(x, y)] == 0));
                masks[index(x, y)] |= mask;
            }
    }
    const auto is_cut = [&](int x, int y) {
        const std::uint32_t mask = masks[index(x, y)];
        return mask != 0 && mask != kPattern.all();
    };
    const auto coordinate = [](double x_px, double y_px) {
        const glm::dvec3 at =
            glm::dvec3(kCentroidPlane.origin) + glm::dvec3(kCentroidPlane.dx) * x_px + glm::dvec3(kCentroidPlane.dy) * y_px;
        return glm::dvec2(at) * double{kCentroidSide};
    };
    const Model model{.choice = [&](int x, int y) { return is_cut(x, y) ? 1 : 0; },
                      .smooth = [&](int x, int y, int) { return coordinate(x + 0.5, y + 0.5); },
                      .held =
                          [&](int x, int y) {
                              if (!is_cut(x, y)) return coordinate(x + 0.5, y + 0.5);
                              const auto first = static_cast<std::size_t>(std::countr_zero(masks[index(x, y)]));
                              const auto [dx, dy] = kPattern.positions[first];
                              return coordinate(x + dx / 16.0, y + dy / 16.0);
                          },
                      .takes = [&](int x, int y) { return masks[index(x, y)] != 0; }};
    check_case("centroid", model,
               [](std::string_view cure, const SeamImage& image, const SeamMeasures& measures, const Expected& expected) {
                   CHECK(flagged(image, kFromHelper) > 200);
                   CHECK(flagged(image, ~std::uint32_t{kFromHelper}) == 0);
                   if (cure != "none") return check_linear(image, measures);
                   CHECK(measures.bad_quads >= 200);
                   CHECK(measures.bad_quads <= expected.disagreeing_quads);
                   CHECK(measures.worst_lod_error >= 0.5);
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
            // One sample a lane, and one load of the page table; the laboratory's own derivatives would be five times these.
            const std::uint64_t lanes = image.counters.lanes_shaded;
            CHECK(lanes > 10000);
            CHECK(image.counters.texture_instructions <= lanes * (seam.name == "pages" ? 2 : 1));
            CHECK(image.counters.derivatives > 0);
            if (cure == "none") CHECK(image.counters.derivatives <= lanes);
            CHECK(image.milliseconds > 0);
            const auto [least, most] = std::ranges::minmax(image.pixels, {}, &SeamPixel::value);
            CHECK(least.value < most.value);
        }
}

TEST_CASE("Small cases: in double arithmetic the cures hold, too", "[seam]") {
    for (const SeamCase& seam : all_seam_cases()) {
        Device device(load_profile("ideal"));
        const SeamImage reference = seam.draw(device, seam.reference);
        INFO(seam.name);
        CHECK(measure_seam(reference, reference, reference).worst_lod_error < kLodStep);
    }
}
