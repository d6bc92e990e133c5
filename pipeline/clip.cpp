#include "pipeline/clip.h"

namespace gnomon {

namespace {

/// Signed distance to one plane, scaled; inside where >= 0.
template <class Scalar>
Scalar distance(const Scalar* v, ClipCode plane, const GuardBand<Scalar>& guard) {
    switch (plane) {
        case kOutsideNear: return v[2];
        case kOutsideFar: return v[3] - v[2];
        case kOutsideLeft: return v[0] + guard.left * v[3];
        case kOutsideRight: return guard.right * v[3] - v[0];
        case kOutsideBottom: return v[1] + guard.bottom * v[3];
        case kOutsideTop: return guard.top * v[3] - v[1];
        case kBeyondLeft:
        case kBeyondRight:
        case kBeyondBottom:
        case kBeyondTop:
        case kNotFinite: break;
    }
    __builtin_unreachable();
}

/// Puts a new vertex exactly on the plane that made it: interpolation leaves it off by roundings of the outer vertex, which may
/// be far away.
template <class Scalar>
void put_on_plane(Scalar* v, ClipCode plane, const GuardBand<Scalar>& guard) {
    switch (plane) {
        case kOutsideNear: v[2] = 0; return;
        case kOutsideFar: v[2] = v[3]; return;
        case kOutsideLeft: v[0] = -guard.left * v[3]; return;
        case kOutsideRight: v[0] = guard.right * v[3]; return;
        case kOutsideBottom: v[1] = -guard.bottom * v[3]; return;
        case kOutsideTop: v[1] = guard.top * v[3]; return;
        case kBeyondLeft:
        case kBeyondRight:
        case kBeyondBottom:
        case kBeyondTop:
        case kNotFinite: break;
    }
    __builtin_unreachable();
}

}  // namespace

template <class Scalar>
void clip(ClipPolygon<Scalar>& polygon, unsigned planes, const GuardBand<Scalar>& guard) {
    std::vector<Scalar> out;
    for (unsigned plane = kOutsideNear; plane <= kOutsideTop; plane <<= 1u) {
        if ((planes & plane) == 0) continue;
        const auto code = static_cast<ClipCode>(plane);
        const int count = polygon.count();
        const auto stride = static_cast<std::size_t>(polygon.stride);
        out.clear();
        for (int i = 0; i < count; ++i) {
            const Scalar* a = polygon.vertices.data() + static_cast<std::size_t>(i) * stride;
            const Scalar* b = polygon.vertices.data() + static_cast<std::size_t>((i + 1) % count) * stride;
            const Scalar da = distance(a, code, guard);
            const Scalar db = distance(b, code, guard);
            if (da >= 0) out.insert(out.end(), a, a + stride);
            if ((da >= 0) == (db >= 0)) continue;

            // The edge crosses: go from the vertex inside to the one outside.
            const bool a_inside = da >= 0;
            const Scalar* inside = a_inside ? a : b;
            const Scalar* outside = a_inside ? b : a;
            const Scalar d_in = a_inside ? da : db;
            const Scalar d_out = a_inside ? db : da;
            const Scalar t = d_in / (d_in - d_out);
            for (std::size_t s = 0; s < stride; ++s) out.push_back(inside[s] + t * (outside[s] - inside[s]));
            put_on_plane(&out[out.size() - stride], code, guard);
        }
        polygon.vertices.swap(out);
        if (polygon.vertices.empty()) return;
    }
}

template void clip(ClipPolygon<float>&, unsigned, const GuardBand<float>&);
template void clip(ClipPolygon<double>&, unsigned, const GuardBand<double>&);

}  // namespace gnomon
