// Seams as the host counts them: choices and coordinates of single pixels in double, differences as the specification has them.
#pragma once

#include "sim/profile.h"
#include "studies/seams/case_list.h"
#include "studies/seams/seam.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace seam_model {

using namespace gnomon;
using namespace gnomon::studies;

/// A profile for every choice of derivatives that changes what a quad reads.
inline std::vector<Profile> derivative_profiles() {
    std::vector<Profile> profiles;
    for (const EnumName<PlainDerivative>& plain : kEnumNames<PlainDerivative>)
        for (const EnumName<LodSharing>& sharing : kEnumNames<LodSharing>)
            for (const EnumName<DerivativeCorner>& corner : kEnumNames<DerivativeCorner>) {
                const bool has_corner = plain.value == PlainDerivative::Coarse || sharing.value == LodSharing::Quad;
                if (!has_corner && corner.value != DerivativeCorner::TopLeft) continue;
                Profile profile = load_profile("d3d11");
                profile.name = fmt::format("{}, shared by {}, {}", plain.name, sharing.name, corner.name);
                profile.plain_derivative = plain.value;
                profile.lod_sharing = sharing.value;
                profile.derivative_corner = corner.value;
                profiles.push_back(profile);
            }
    return profiles;
}

/// The two differences of a pixel: from which pixels to which.
struct Differences {
    glm::ivec2 x_from, x_to, y_from, y_to;

    [[nodiscard]] std::array<glm::ivec2, 4> read() const { return {x_from, x_to, y_from, y_to}; }
};
/// D3D11.3 22.5.2, 22.5.4
inline Differences differences(int x, int y, bool coarse, DerivativeCorner corner) {
    const int left = x & ~1;
    const int top = y & ~1;
    const bool bottom = corner == DerivativeCorner::BottomLeft || corner == DerivativeCorner::BottomRight;
    const bool right = corner == DerivativeCorner::TopRight || corner == DerivativeCorner::BottomRight;
    const int row = coarse ? top + bottom : y;
    const int column = coarse ? left + right : x;
    return {{left, row}, {left + 1, row}, {column, top}, {column, top + 1}};
}
/// Of the derivatives behind an implicit level of detail.
inline Differences sample_differences(int x, int y, const Profile& profile) {
    return differences(x, y, profile.lod_sharing == LodSharing::Quad, profile.derivative_corner);
}

inline double level_of_detail(const glm::dvec2& dx, const glm::dvec2& dy) {
    return 0.5 * std::log2(std::max(glm::dot(dx, dx), glm::dot(dy, dy)));
}
/// `at(x, y)`: what a pixel holds for its coordinate, texels.
template <class At>
double level_of_detail(const Differences& d, const At& at) {
    return level_of_detail(at(d.x_to.x, d.x_to.y) - at(d.x_from.x, d.x_from.y),
                           at(d.y_to.x, d.y_to.y) - at(d.y_from.x, d.y_from.y));
}

inline glm::dvec3 on_plane(const SeamPlane& plane, int x, int y) {
    return glm::dvec3(plane.origin) + glm::dvec3(plane.dx) * (x + 0.5) + glm::dvec3(plane.dy) * (y + 0.5);
}

/// A case as the host has it. Coordinates are in texels.
struct Model {
    std::function<int(int x, int y)> choice;
    std::function<glm::dvec2(int x, int y, int choice)> smooth;  // goes on past the borders of a choice
    std::function<glm::dvec2(int x, int y)> held{};              // what a pixel holds; none: smooth of its own choice
    std::function<bool(int x, int y)> takes{};                   // a sample; none: every pixel does
    bool draws_others = false;                                   // those that take none

    [[nodiscard]] glm::dvec2 coordinate(int x, int y) const { return held ? held(x, y) : smooth(x, y, choice(x, y)); }
    [[nodiscard]] bool samples(int x, int y) const { return !takes || takes(x, y); }
};

struct Expected {
    std::uint64_t pixels = 0;  // drawn
    std::uint64_t disagreeing_quads = 0;
    std::uint64_t crossed_quads = 0;   // the derivatives of a pixel read pixels of different choices
    std::uint64_t reading_pixels = 0;  // that read a pixel of another choice than their own
    std::uint64_t bad_quads = 0;
    std::uint64_t bad_pixels = 0;
};

inline bool near(double a, double b) { return a == b || std::fabs(a - b) < 1e-3; }

/// Compares every pixel of a picture without a cure with the model.
inline Expected check_uncured(const SeamImage& image, const Model& model, const Profile& profile) {
    Expected expected;
    std::uint64_t wrong = 0;
    const auto differs_from = [&](int choice) {
        return [&, choice](const glm::ivec2& at) { return model.choice(at.x, at.y) != choice; };
    };
    for (int top = 0; top < kSeamSide; top += 2)
        for (int left = 0; left < kSeamSide; left += 2) {
            bool is_drawn = false;
            bool disagrees = false;
            bool is_crossed = false;
            bool is_bad = false;
            for (int lane = 0; lane < 4; ++lane) {
                const int x = left + lane % 2;
                const int y = top + lane / 2;
                const SeamPixel& pixel = image.pixels[static_cast<std::size_t>(y * kSeamSide + x)];
                const int own = model.choice(x, y);
                disagrees |= own != model.choice(left, top);
                double taken = 0;
                double smooth = 0;
                const bool drawn = model.samples(x, y) || model.draws_others;
                if (model.samples(x, y)) {
                    const Differences d = sample_differences(x, y, profile);
                    is_crossed |= std::ranges::any_of(d.read(), differs_from(model.choice(d.x_from.x, d.x_from.y)));
                    expected.reading_pixels += std::ranges::any_of(d.read(), differs_from(own));
                    taken = level_of_detail(d, [&](int px, int py) { return model.coordinate(px, py); });
                    smooth = level_of_detail(d, [&](int px, int py) { return model.smooth(px, py, own); });
                    const bool bad = std::fabs(taken - smooth) >= kLodStep;
                    expected.bad_pixels += bad;
                    is_bad |= bad;
                }
                is_drawn |= drawn;
                expected.pixels += drawn;
                const bool same =
                    drawn ? pixel.own == static_cast<float>(own) && near(pixel.lod, taken) && near(pixel.smooth_lod, smooth)
                          : !pixel.drawn();
                if (!same && wrong++ == 0)
                    UNSCOPED_INFO("pixel " << x << ", " << y << ": choice " << pixel.own << " (" << own << "), lod "
                                           << pixel.lod << " (" << taken << "), smooth " << pixel.smooth_lod << " (" << smooth
                                           << ")");
            }
            expected.disagreeing_quads += is_drawn && disagrees;
            expected.crossed_quads += is_crossed;
            expected.bad_quads += is_bad;
        }
    CHECK(wrong == 0);
    return expected;
}

/// Draws a case without a cure and with each, for all choices of derivatives, and compares what is uncured with the model.
/// `check(cure, image, measures, expected)` says the rest, of the picture without a cure, too.
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
        CHECK(bad.pixels == expected.pixels);
        CHECK(bad.disagreeing_quads == expected.disagreeing_quads);
        CHECK(bad.bad_quads == expected.bad_quads);
        CHECK(bad.bad_pixels == expected.bad_pixels);
        CHECK(bad.changed_pixels > expected.bad_pixels / 2);
        for (const std::string_view cure : seam.cures) {
            INFO("cure " << cure);
            const SeamImage image = cure == "none" ? uncured : seam.draw(device, cure);
            const SeamMeasures measures = measure_seam(image, uncured, reference);
            if (cure != "none") {
                CHECK(measures.bad_pixels == 0);
                CHECK(measures.bad_quads == 0);
                CHECK(measures.worst_lod_error < kLodStep);
                CHECK(measures.pixels == expected.pixels);
            }
            check(cure, image, measures, expected);
        }
    }
}

/// The largest distance of lod from exact_lod.
inline double worst_exact_error(const SeamImage& image) {
    double worst = 0;
    for (const SeamPixel& pixel : image.pixels)
        if (pixel.drawn() && pixel.lod != pixel.exact_lod)
            worst = std::max(worst, std::fabs(static_cast<double>(pixel.lod) - static_cast<double>(pixel.exact_lod)));
    return worst;
}

/// Pixels whose derivatives read a lane of that kind.
inline std::uint64_t flagged(const SeamImage& image, std::uint32_t cause) {
    return static_cast<std::uint64_t>(
        std::ranges::count_if(image.derivatives, [&](std::uint32_t bits) { return (bits & cause) != 0; }));
}

inline bool same_bytes(const SeamImage& a, const SeamImage& b) {
    static_assert(sizeof(SeamPixel) == 10 * sizeof(float));
    return a.pixels.size() == b.pixels.size() && a.derivatives == b.derivatives && a.counters == b.counters &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(SeamPixel)) == 0;
}

}  // namespace seam_model
