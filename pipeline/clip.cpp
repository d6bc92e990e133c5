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

/// Appends the point of the edge from `inside` to `outside` that lies on the plane.
void append_intersection(std::vector<double>& out, const double* inside, const double* outside, ClipCode plane,
                         const ClipPolygon& polygon, const GuardBand<double>& guard) {
    const double d_in = distance(inside, plane, guard);
    const double d_out = distance(outside, plane, guard);
    const double t = d_in / (d_in - d_out);
    for (std::size_t s = 0; s < polygon.stride; ++s) out.push_back(inside[s] + t * (outside[s] - inside[s]));
    double* made = &out[out.size() - polygon.stride];
    if (!polygon.linear.empty() && made[3] > 0) {
        const double on_screen = t * outside[3] / made[3];
        for (std::size_t k = 0; k < polygon.linear.size(); ++k) {
            const std::size_t s = std::size_t{kPositionScalars} + k;
            if (polygon.linear[k] != 0) made[s] = inside[s] + on_screen * (outside[s] - inside[s]);
        }
    }
    put_on_plane(made, plane, guard);
}

}  // namespace

void clip(ClipPolygon& polygon, unsigned planes, const GuardBand<double>& guard) {
    std::vector<double> out;
    std::vector<char> edges;
    for (unsigned plane = kOutsideNear; plane <= kOutsideTop; plane <<= 1u) {
        if ((planes & plane) == 0) continue;
        const auto code = static_cast<ClipCode>(plane);
        const std::size_t count = polygon.count();
        const std::size_t stride = polygon.stride;
        out.clear();
        edges.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const double* a = polygon.vertices.data() + i * stride;
            const double* b = polygon.vertices.data() + (i + 1) % count * stride;
            const bool a_inside = distance(a, code, guard) >= 0;
            const bool b_inside = distance(b, code, guard) >= 0;
            if (a_inside) {
                out.insert(out.end(), a, a + stride);
                edges.push_back(polygon.edges[i]);
            }
            if (a_inside == b_inside) continue;
            // The edge crosses: where it leaves, the polygon goes on along the plane.
            append_intersection(out, a_inside ? a : b, a_inside ? b : a, code, polygon, guard);
            edges.push_back(a_inside ? char{0} : polygon.edges[i]);
        }
        polygon.vertices.swap(out);
        polygon.edges.swap(edges);
        if (polygon.vertices.empty()) return;
    }
}

void clip_line(ClipPolygon& line, unsigned planes, const GuardBand<double>& guard) {
    for (unsigned plane = kOutsideNear; plane <= kOutsideTop; plane <<= 1u) {
        if ((planes & plane) == 0) continue;
        const auto code = static_cast<ClipCode>(plane);
        const double* a = line.vertices.data();
        const double* b = a + line.stride;
        const bool a_inside = distance(a, code, guard) >= 0;
        const bool b_inside = distance(b, code, guard) >= 0;
        if (a_inside && b_inside) continue;
        std::vector<double> out;
        if (a_inside || b_inside) {
            if (a_inside) out.insert(out.end(), a, b);
            append_intersection(out, a_inside ? a : b, a_inside ? b : a, code, line, guard);
            if (b_inside) out.insert(out.end(), b, b + line.stride);
        }
        line.vertices.swap(out);
        if (line.vertices.empty()) return;
    }
}

}  // namespace gnomon
