#include "pipeline/peer_clip.h"

namespace gnomon {

namespace {

using Corner = std::vector<float>;

struct Polygon {
    std::vector<Corner> corners;
    std::vector<char> made;

    void add(Corner corner, bool is_made) {
        corners.push_back(std::move(corner));
        made.push_back(is_made ? 1 : 0);
    }
};

// In the order of clipping; top and bottom are ours, y up, which is down to both drivers.
constexpr std::array kLlvmpipeOrder{kOutsideRight, kOutsideLeft, kOutsideBottom, kOutsideTop, kOutsideNear, kOutsideFar};
constexpr std::array kSwiftShaderOrder{kOutsideNear, kOutsideFar, kOutsideLeft, kOutsideRight, kOutsideTop, kOutsideBottom};

/// Inside where >= 0. llvmpipe's dot products with planes of 0, 1 and -1 round as these do.
float distance(const Corner& v, ClipCode plane) {
    switch (plane) {
        case kOutsideNear: return v[2];
        case kOutsideFar: return v[3] - v[2];
        case kOutsideLeft: return v[3] + v[0];
        case kOutsideRight: return v[3] - v[0];
        case kOutsideBottom: return v[3] + v[1];
        case kOutsideTop: return v[3] - v[1];
        case kBeyondLeft:
        case kBeyondRight:
        case kBeyondBottom:
        case kBeyondTop:
        case kNotFinite: break;
    }
    __builtin_unreachable();
}

/// Scalars that are linear on the screen take the parameter that is linear there; `t` is the part of `in`.
void put_linear(Corner& made, const Corner& out, const Corner& in, float t, std::span<const std::uint8_t> linear) {
    if (linear.empty() || !(made[3] > 0)) return;
    const float on_screen = t * in[3] / made[3];
    for (std::size_t k = 0; k < linear.size(); ++k) {
        const std::size_t s = std::size_t{kPositionScalars} + k;
        if (linear[k] != 0) made[s] = out[s] + on_screen * (in[s] - out[s]);
    }
}

Corner between(float t, const Corner& out, const Corner& in, std::span<const std::uint8_t> linear) {
    Corner made(out.size());
    for (std::size_t s = 0; s < made.size(); ++s) made[s] = out[s] + t * (in[s] - out[s]);
    put_linear(made, out, in, t, linear);
    return made;
}

/// The parameter runs from the vertex that is nearer to the plane. Without corners where a distance is not finite.
Polygon clipped_by_llvmpipe(const Polygon& polygon, ClipCode plane, std::span<const std::uint8_t> linear) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
        const Corner& from = polygon.corners[i];
        const Corner& next = polygon.corners[(i + 1) % polygon.corners.size()];
        const float d0 = distance(from, plane);
        const float d1 = distance(next, plane);
        if (!(d0 - d0 == 0 && d1 - d1 == 0)) return {};
        if (d0 >= 0) kept.add(from, polygon.made[i] != 0);
        if ((d0 >= 0) == (d1 >= 0)) continue;
        const float length = d1 - d0;
        const bool from_next = d1 < 0 ? -d1 < d0 : !(-d0 < d1);
        kept.add(from_next ? between(d1 / length, next, from, linear) : between(-d0 / length, from, next, linear), true);
    }
    return kept;
}

/// Each corner weighs by the other's distance.
Corner crossing(const Corner& in, const Corner& out, float d_in, float d_out, std::span<const std::uint8_t> linear) {
    const float scale = 1.0f / (d_out - d_in);
    Corner made(in.size());
    for (std::size_t s = 0; s < made.size(); ++s) made[s] = (d_out * in[s] - d_in * out[s]) * scale;
    put_linear(made, out, in, d_out * scale, linear);
    return made;
}

Polygon clipped_by_swiftshader(const Polygon& polygon, ClipCode plane, std::span<const std::uint8_t> linear) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
        const Corner& a = polygon.corners[i];
        const Corner& b = polygon.corners[(i + 1) % polygon.corners.size()];
        const float da = distance(a, plane);
        const float db = distance(b, plane);
        if (da >= 0) {
            kept.add(a, polygon.made[i] != 0);
            if (db < 0) kept.add(crossing(a, b, da, db, linear), true);
        } else if (db > 0) {
            kept.add(crossing(b, a, db, da, linear), true);
        }
    }
    return kept;
}

}  // namespace

template <class Scalar>
ClippedTriangle<Scalar>::ClippedTriangle(const std::array<const Scalar*, 3>& corners, std::size_t stride, unsigned planes,
                                         std::span<const std::uint8_t> linear, Clipping clipping) {
    const bool llvmpipe = clipping == Clipping::Llvmpipe;
    Polygon polygon;
    for (const Scalar* corner : corners) {
        Corner copy(stride);
        for (std::size_t s = 0; s < stride; ++s) copy[s] = static_cast<float>(corner[s]);
        polygon.add(std::move(copy), false);
    }
    for (const ClipCode plane : llvmpipe ? kLlvmpipeOrder : kSwiftShaderOrder) {
        if ((planes & plane) == 0) continue;
        polygon = llvmpipe ? clipped_by_llvmpipe(polygon, plane, linear) : clipped_by_swiftshader(polygon, plane, linear);
        if (polygon.corners.size() < 3) return;
    }
    made = std::move(polygon.made);
    for (const Corner& corner : polygon.corners)
        for (const float value : corner) records.push_back(static_cast<Scalar>(value));
}

template struct ClippedTriangle<float>;
template struct ClippedTriangle<double>;

}  // namespace gnomon
