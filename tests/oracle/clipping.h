// What is left of a clip-space triangle after clipping, decided per sample by exact signs: no clipped vertex is made.
// D3D11.3 15.4, 15.5, 15.6
//
// Let (X, Y, w) be a vertex in screen space before the division and s = (x, y, 1) a sample. s = sum l_i (X_i, Y_i, w_i) has one
// solution l; the sample shows a point of the triangle with w > 0 exactly if every l_i >= 0, its z is in front of the near
// plane if sum l_i z_i >= 0 and of the far plane if sum l_i (w_i - z_i) >= 0. Times the determinant all are integers.
//
// Snapping moves the corners of what is left by at most half a grid step per axis, rounding in clipping and in the viewport
// transform by more (16.8 in fp32 has steps of up to 2^-9 pixel near the ends of the range). If every corner moves by at most
// `band` grid steps per axis, samples called Inside stay inside and samples called Outside stay outside.
#pragma once

#include "tests/oracle/coverage.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace oracle {

/// A clip-space position in whole multiples of a unit of the caller's choice (a power of two, so that fp32 holds it too), each
/// component within +-2^22.
struct ClipVertex {
    std::int64_t x, y, z, w;

    bool operator==(const ClipVertex&) const = default;
};

/// The unit of the generators' positions: 2^-12.
inline constexpr int kClipFractionBits = 12;

/// The fp32 component. Exact.
constexpr float clip_float(std::int64_t component) {
    return static_cast<float>(component) * (1.0f / static_cast<float>(1 << kClipFractionBits));
}

/// The multiple of 2^-12 that an fp32 component is; nothing if it is none, or too large.
std::optional<std::int64_t> clip_integer(float component);

enum class DepthClip { On, Off };

class ClippedTriangle {
public:
    /// The viewport's extent is at most 2^13 pixels from the origin.
    ClippedTriangle(const std::array<ClipVertex, 3>& vertices, const PixelRect& viewport, DepthClip depth_clip = DepthClip::On);

    enum class Where { Inside, Outside, Close };

    /// Close: within `band` grid steps per axis of being both. With band 0 only samples exactly on a border are.
    /// Every sample is close to a triangle seen edge-on or without area.
    [[nodiscard]] Where at(const Point& sample, std::int64_t band = 2) const;

    /// Whether the sample is inside, exactly; one on an edge counts as if it lay an infinitesimal step to the right, and a far
    /// smaller one down. Triangles that share an edge agree on which of them has it. False if edge_on().
    [[nodiscard]] bool shows(const Point& sample) const;

    /// Whether the near or the far plane cuts what is within `band` of the sample.
    [[nodiscard]] bool depth_cut_near(const Point& sample, std::int64_t band = 2) const;

    [[nodiscard]] bool edge_on() const { return determinant_ == 0; }
    /// Facing of whatever is visible; clockwise is front.
    [[nodiscard]] Facing facing() const { return determinant_ > 0 ? Facing::Front : Facing::Back; }

private:
    /// value(s) = dx s.x + dy s.y + c >= 0 for what is left.
    struct HalfPlane {
        __int128 dx = 0, dy = 0, c = 0;
    };
    [[nodiscard]] static __int128 value(const HalfPlane& plane, const Point& sample);
    [[nodiscard]] static __int128 margin(const HalfPlane& plane, std::int64_t band);

    __int128 determinant_ = 0;
    bool crosses_depth_plane_ = false;
    std::array<HalfPlane, 5> planes_;
    std::size_t plane_count_ = 0;
};

/// How often the triangles of a mesh cover a sample.
struct Tally {
    int front = 0;
    int back = 0;
    int close = 0;  // triangles that may or may not
};
Tally tally(std::span<const ClippedTriangle> triangles, const Point& sample, std::int64_t band = 2);

/// Front faces less back faces over a sample. Of a mesh without border the difference is 0 wherever no depth plane has opened
/// it, and elsewhere changes only where the border that the cut has left passes: on all other edges, shared ones and outlines,
/// it is exact, whatever snapping did to them. Implementations must have the same difference, close to edges too, where it is
/// `sure`.
struct SignedCount {
    int count = 0;
    bool sure = true;  // no cut within the band
};
SignedCount signed_count(std::span<const ClippedTriangle> triangles, const Point& sample, std::int64_t band = 2);

}  // namespace oracle
