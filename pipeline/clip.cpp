#include "pipeline/clip.h"

namespace gnomon {

namespace {

/// Signed distance to one plane, scaled; inside where >= 0.
double distance(const double* v, ClipCode plane, const GuardBand<double>& guard) {
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
void put_on_plane(double* v, ClipCode plane, const GuardBand<double>& guard) {
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

void clip(ClipPolygon& polygon, unsigned planes, const GuardBand<double>& guard) {
    std::vector<double> out;
    for (unsigned plane = kOutsideNear; plane <= kOutsideTop; plane <<= 1u) {
        if ((planes & plane) == 0) continue;
        const auto code = static_cast<ClipCode>(plane);
        const std::size_t count = polygon.count();
        const std::size_t stride = polygon.stride;
        out.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const double* a = polygon.vertices.data() + i * stride;
            const double* b = polygon.vertices.data() + (i + 1) % count * stride;
            const double da = distance(a, code, guard);
            const double db = distance(b, code, guard);
            if (da >= 0) out.insert(out.end(), a, a + stride);
            if ((da >= 0) == (db >= 0)) continue;

            // The edge crosses: go from the vertex inside to the one outside.
            const bool a_inside = da >= 0;
            const double* inside = a_inside ? a : b;
            const double* outside = a_inside ? b : a;
            const double d_in = a_inside ? da : db;
            const double d_out = a_inside ? db : da;
            const double t = d_in / (d_in - d_out);
            for (std::size_t s = 0; s < stride; ++s) out.push_back(inside[s] + t * (outside[s] - inside[s]));
            put_on_plane(&out[out.size() - stride], code, guard);
        }
        polygon.vertices.swap(out);
        if (polygon.vertices.empty()) return;
    }
}

}  // namespace gnomon
