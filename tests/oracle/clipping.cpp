// Signs of homogeneous edge and plane functions on 128-bit integers. D3D11.3 15.4, 15.5, 15.6
#include "tests/oracle/clipping.h"

#include <algorithm>
#include <cmath>

namespace oracle {

namespace {

using Wide = __int128;

Wide magnitude(Wide v) { return v < 0 ? -v : v; }

}  // namespace

std::optional<std::int64_t> clip_integer(float component) {
    const double scaled = static_cast<double>(component) * (1 << kClipFractionBits);
    if (!(std::fabs(scaled) <= 1 << 22) || scaled != std::floor(scaled)) return std::nullopt;
    return static_cast<std::int64_t>(scaled);
}

ClippedTriangle::ClippedTriangle(const std::array<ClipVertex, 3>& vertices, const PixelRect& viewport, DepthClip depth_clip) {
    // Screen space in grid steps before the division by w: X = (x + w) width / 2 + left w, Y = (w - y) height / 2 + top w.
    const auto screen_x = [&](const ClipVertex& v) {
        return (Wide{v.x} + v.w) * (viewport.right - viewport.left) * 128 + Wide{v.w} * viewport.left * 256;
    };
    const auto screen_y = [&](const ClipVertex& v) {
        return (Wide{v.w} - v.y) * (viewport.bottom - viewport.top) * 128 + Wide{v.w} * viewport.top * 256;
    };

    // l_i times the determinant is det(s, p_j, p_k).
    for (std::size_t i = 0; i < 3; ++i) {
        const ClipVertex& p = vertices[(i + 1) % 3];
        const ClipVertex& q = vertices[(i + 2) % 3];
        planes_[i] = {screen_y(p) * q.w - screen_y(q) * p.w, screen_x(q) * p.w - screen_x(p) * q.w,
                      screen_x(p) * screen_y(q) - screen_x(q) * screen_y(p)};
    }
    const ClipVertex& first = vertices[0];
    determinant_ = planes_[0].dx * screen_x(first) + planes_[0].dy * screen_y(first) + planes_[0].c * first.w;
    if (determinant_ < 0)
        for (std::size_t i = 0; i < 3; ++i) planes_[i] = {-planes_[i].dx, -planes_[i].dy, -planes_[i].c};

    // Near and far are sums of the l_i.
    plane_count_ = depth_clip == DepthClip::On ? 5 : 3;
    const auto [first_z, last_z] = std::minmax({vertices[0].z, vertices[1].z, vertices[2].z});
    const auto [first_far, last_far] =
        std::minmax({vertices[0].w - vertices[0].z, vertices[1].w - vertices[1].z, vertices[2].w - vertices[2].z});
    crosses_depth_plane_ = depth_clip == DepthClip::On && ((first_z <= 0 && last_z >= 0) || (first_far <= 0 && last_far >= 0));
    for (std::size_t i = 0; i < 3; ++i) {
        const Wide before_far = Wide{vertices[i].w} - vertices[i].z;
        planes_[3].dx += planes_[i].dx * vertices[i].z;
        planes_[3].dy += planes_[i].dy * vertices[i].z;
        planes_[3].c += planes_[i].c * vertices[i].z;
        planes_[4].dx += planes_[i].dx * before_far;
        planes_[4].dy += planes_[i].dy * before_far;
        planes_[4].c += planes_[i].c * before_far;
    }
}

__int128 ClippedTriangle::value(const HalfPlane& plane, const Point& sample) {
    return plane.dx * sample.x + plane.dy * sample.y + plane.c;
}

// A corner that moves by at most `band` per axis moves the border by at most this much.
__int128 ClippedTriangle::margin(const HalfPlane& plane, std::int64_t band) {
    return (magnitude(plane.dx) + magnitude(plane.dy)) * band;
}

ClippedTriangle::Where ClippedTriangle::at(const Point& sample, std::int64_t band) const {
    if (edge_on()) return Where::Close;
    bool close = false;
    for (std::size_t i = 0; i < plane_count_; ++i) {
        const Wide here = value(planes_[i], sample);
        const Wide reach = margin(planes_[i], band);
        if (here < -reach) return Where::Outside;
        close = close || here <= reach;
    }
    return close ? Where::Close : Where::Inside;
}

bool ClippedTriangle::shows(const Point& sample) const {
    if (edge_on()) return false;
    for (std::size_t i = 0; i < plane_count_; ++i) {
        const Wide here = value(planes_[i], sample);
        const Wide beside = planes_[i].dx != 0 ? planes_[i].dx : planes_[i].dy;
        if (here < 0 || (here == 0 && beside < 0)) return false;
    }
    return true;
}

bool ClippedTriangle::depth_cut_near(const Point& sample, std::int64_t band) const {
    if (edge_on()) return crosses_depth_plane_;
    bool near = false;
    for (std::size_t i = 0; i < plane_count_; ++i) {
        const Wide here = value(planes_[i], sample);
        const Wide reach = margin(planes_[i], band);
        if (here < -reach) return false;
        near = near || (i >= 3 && here <= reach);
    }
    return near;
}

Tally tally(std::span<const ClippedTriangle> triangles, const Point& sample, std::int64_t band) {
    Tally sum;
    for (const ClippedTriangle& t : triangles) switch (t.at(sample, band)) {
            case ClippedTriangle::Where::Inside: ++(t.facing() == Facing::Front ? sum.front : sum.back); break;
            case ClippedTriangle::Where::Close: ++sum.close; break;
            case ClippedTriangle::Where::Outside: break;
        }
    return sum;
}

SignedCount signed_count(std::span<const ClippedTriangle> triangles, const Point& sample, std::int64_t band) {
    SignedCount sum;
    for (const ClippedTriangle& t : triangles) {
        if (t.shows(sample)) sum.count += t.facing() == Facing::Front ? 1 : -1;
        sum.sure = sum.sure && !t.depth_cut_near(sample, band);
    }
    return sum;
}

}  // namespace oracle
