// Seams as the host counts them: choices and coordinates of single pixels in double, differences as the specification has them.
#pragma once

#include "sim/profile.h"
#include "studies/seam.h"
#include "studies/seam_case_list.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

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

/// A case as the host has it.
struct Model {
    std::function<int(int x, int y)> choice;
    std::function<glm::dvec2(int x, int y, int choice)> coordinate;  // texels; goes on smoothly past the borders of a choice
};

struct Expected {
    std::uint64_t crossed_quads = 0;  // the derivatives of a pixel read pixels of different choices
    std::uint64_t bad_quads = 0;
    std::uint64_t bad_pixels = 0;
};

/// Compares every pixel of a picture without a cure with the model.
inline Expected check_uncured(const SeamImage& image, const Model& model, const Profile& profile) {
    Expected expected;
    std::uint64_t wrong = 0;
    for (int top = 0; top < kSeamSide; top += 2)
        for (int left = 0; left < kSeamSide; left += 2) {
            bool is_crossed = false;
            bool is_bad = false;
            for (int lane = 0; lane < 4; ++lane) {
                const int x = left + lane % 2;
                const int y = top + lane / 2;
                const SeamPixel& pixel = image.pixels[static_cast<std::size_t>(y * kSeamSide + x)];
                const int own = model.choice(x, y);
                const Differences d = sample_differences(x, y, profile);
                for (const glm::ivec2& at : d.read())
                    is_crossed |= model.choice(at.x, at.y) != model.choice(d.x_from.x, d.x_from.y);
                const double taken =
                    level_of_detail(d, [&](int px, int py) { return model.coordinate(px, py, model.choice(px, py)); });
                const double smooth = level_of_detail(d, [&](int px, int py) { return model.coordinate(px, py, own); });
                const bool bad = std::fabs(taken - smooth) >= kLodStep;
                expected.bad_pixels += bad;
                is_bad |= bad;
                const bool same = pixel.own == static_cast<float>(own) && std::fabs(pixel.lod - taken) < 1e-3 &&
                                  std::fabs(pixel.smooth_lod - smooth) < 1e-3;
                if (!same && wrong++ == 0) {
                    UNSCOPED_INFO("pixel " << x << ", " << y << ": choice " << pixel.own << " (" << own << "), lod "
                                           << pixel.lod << " (" << taken << "), smooth " << pixel.smooth_lod << " (" << smooth
                                           << ")");
                }
            }
            expected.crossed_quads += is_crossed;
            expected.bad_quads += is_bad;
        }
    CHECK(wrong == 0);
    return expected;
}

/// The largest distance of lod from exact_lod.
inline double worst_exact_error(const SeamImage& image) {
    double worst = 0;
    for (const SeamPixel& pixel : image.pixels)
        if (pixel.drawn())
            worst = std::max(worst, std::fabs(static_cast<double>(pixel.lod) - static_cast<double>(pixel.exact_lod)));
    return worst;
}

inline std::uint64_t flagged(const SeamImage& image, std::uint32_t cause) {
    return static_cast<std::uint64_t>(
        std::ranges::count_if(image.derivatives, [&](std::uint32_t bits) { return (bits & cause) != 0; }));
}

inline bool same_bytes(const SeamImage& a, const SeamImage& b) {
    static_assert(sizeof(SeamPixel) == 10 * sizeof(float));
    return a.pixels.size() == b.pixels.size() && a.derivatives == b.derivatives && a.counters == b.counters &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(SeamPixel)) == 0;
}

/// What holds of every cure that keeps each lane's choice: no pixel is bad.
inline void check_cured(const SeamMeasures& measures) {
    CHECK(measures.bad_pixels == 0);
    CHECK(measures.bad_quads == 0);
    CHECK(measures.worst_lod_error < kLodStep);
}

}  // namespace seam_model
