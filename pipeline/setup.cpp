#include "pipeline/setup.h"

#include "pipeline/peer_setup.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon {

namespace {

/// Snaps to the profile's grid, nearest even. Positions beyond the range of 16.8 saturate. D3D11.3 3.4.1, 3.2.4.1
template <class Scalar>
std::int32_t snap(Scalar position, int subpixel_bits) {
    const Scalar limited = std::clamp(position, Scalar(-32767), Scalar(32767));
    const auto snapped = static_cast<std::int32_t>(std::nearbyint(limited * static_cast<Scalar>(1 << subpixel_bits)));
    return snapped * (1 << (kSubpixelBits - subpixel_bits));
}

/// The edge from p to q; positive to the right of it with y down, so inside a clockwise triangle.
Edge edge_between(const GridPoint& p, const GridPoint& q) {
    const std::int64_t a = std::int64_t{p.y} - q.y;
    const std::int64_t b = std::int64_t{q.x} - p.x;
    const bool top_left = a > 0 || (a == 0 && b > 0);
    return {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), -(a * p.x + b * p.y) - (top_left ? 0 : 1)};
}

/// The smallest step of a depth near `max_z`. D3D11.3 15.10
template <class Scalar>
double depth_step(const SetupState& state, Scalar max_z) {
    switch (state.depth_type) {
        case ComponentType::Depth16: return state.bias_steps / 65535.0;
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8:
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Float16:
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth24: return state.bias_steps / 16777215.0;
        case ComponentType::Depth32: {
            // 2^(exponent of the largest depth - 23)
            const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(max_z)) & 0x7fffffffu;
            return std::ldexp(1.0, static_cast<int>(bits >> 23) - 127 - 23);
        }
    }
    __builtin_unreachable();
}

/// Pixels of which a sample can be inside, for snapped extremes low and high and samples from `first` to `last` of each pixel.
int first_pixel(std::int32_t low, int last) { return (low - last + kSubpixels - 1) >> kSubpixelBits; }
int end_pixel(std::int32_t high, int first) { return ((high - first) >> kSubpixelBits) + 1; }

PixelRect pixels_between(const GridPoint& low, const GridPoint& high, const PixelRect& samples) {
    return {first_pixel(low.x, samples.x1), first_pixel(low.y, samples.y1), end_pixel(high.x, samples.x0),
            end_pixel(high.y, samples.y0)};
}

/// Edges and bounds of a clockwise triangle; false where it lies between all samples or out of sight.
template <class Scalar>
bool set_up_edges(const std::array<GridPoint, 3>& v, const SetupState& state, Primitive<Scalar>& out) {
    const auto [low_x, high_x] = std::minmax({v[0].x, v[1].x, v[2].x});
    const auto [low_y, high_y] = std::minmax({v[0].y, v[1].y, v[2].y});
    out.bounds = pixel_bounds({low_x, low_y}, {high_x, high_y}, out.viewport, state);
    if (out.bounds.empty()) return false;
    for (std::size_t i = 0; i < 3; ++i) out.edges[i] = edge_between(v[i], v[(i + 1) % 3]);
    return true;
}

template <class Scalar>
void take_head(const PrimitiveHead<Scalar>& head, bool front, Primitive<Scalar>& out) {
    out.front = front;
    out.id = head.id;
    out.viewport = head.viewport;
    out.layer = head.layer;
    out.flat = head.flat;
}

/// Slopes of the linear barycentrics of vertices 1 and 2, per pixel: the edge functions opposite them, scaled to go from 0 to 1
/// over the area. In double from exact integers.
struct BarycentricSlopes {
    double l1_dx, l1_dy, l2_dx, l2_dy;

    BarycentricSlopes(const std::array<GridPoint, 3>& v, std::int64_t area) {
        const double per_pixel = static_cast<double>(kSubpixels) / static_cast<double>(area);
        l1_dx = static_cast<double>(v[2].y - v[0].y) * per_pixel;
        l1_dy = static_cast<double>(v[0].x - v[2].x) * per_pixel;
        l2_dx = static_cast<double>(v[0].y - v[1].y) * per_pixel;
        l2_dy = static_cast<double>(v[1].x - v[0].x) * per_pixel;
    }
    template <class Scalar>
    [[nodiscard]] double dx(const std::array<Scalar, 3>& z) const {
        return static_cast<double>(z[1] - z[0]) * l1_dx + static_cast<double>(z[2] - z[0]) * l2_dx;
    }
    template <class Scalar>
    [[nodiscard]] double dy(const std::array<Scalar, 3>& z) const {
        return static_cast<double>(z[1] - z[0]) * l1_dy + static_cast<double>(z[2] - z[0]) * l2_dy;
    }
};

bool has_bias(const RasterState& raster) { return raster.depth_bias != 0 || raster.slope_scaled_depth_bias != 0.0f; }

/// By operations of the profile's width: binary32 where the profile is, as 15.10 says.
template <class Scalar>
Scalar bias_of(const std::array<Scalar, 3>& z, double slope, const SetupState& state) {
    const RasterState& raster = state.raster;
    if (state.bias_arithmetic != DepthBiasArithmetic::D3d11)
        return static_cast<Scalar>(driver_depth_bias(
            {static_cast<float>(z[0]), static_cast<float>(z[1]), static_cast<float>(z[2])}, static_cast<float>(slope), state));
    const Scalar max_z = std::max({std::fabs(z[0]), std::fabs(z[1]), std::fabs(z[2])});
    Scalar bias = static_cast<Scalar>(raster.depth_bias) * static_cast<Scalar>(depth_step(state, max_z));
    if (raster.slope_scaled_depth_bias != 0.0f)
        bias += static_cast<Scalar>(raster.slope_scaled_depth_bias) * static_cast<Scalar>(slope);
    const auto limit = static_cast<Scalar>(raster.depth_bias_clamp);
    if (limit > 0) bias = std::min(limit, bias);
    if (limit < 0) bias = std::max(limit, bias);
    return bias;
}

/// The planes of a clockwise triangle that begins with its farthest vertex.
template <class Scalar>
void set_up_planes(const std::array<SetupVertex<Scalar>, 3>& v, std::int64_t area, const SetupState& state,
                   Primitive<Scalar>& out) {
    const std::array<GridPoint, 3> at{v[0].screen.at, v[1].screen.at, v[2].screen.at};
    const BarycentricSlopes slopes(at, area);
    out.x0 = at[0].x;
    out.y0 = at[0].y;
    out.l1_dx = static_cast<Scalar>(slopes.l1_dx);
    out.l1_dy = static_cast<Scalar>(slopes.l1_dy);
    out.l2_dx = static_cast<Scalar>(slopes.l2_dx);
    out.l2_dy = static_cast<Scalar>(slopes.l2_dy);
    for (std::size_t i = 0; i < 3; ++i) {
        out.inv_w[i] = v[i].screen.inv_w;
        out.varyings[i] = v[i].record + kPositionScalars;
    }

    // Depth plane. The bias is added to each vertex, or kept for the fragments.
    std::array<Scalar, 3> z{v[0].screen.z, v[1].screen.z, v[2].screen.z};
    out.z_bias = Scalar(0);
    if (has_bias(state.raster)) {
        const Scalar bias = bias_of(z, std::max(std::fabs(slopes.dx(z)), std::fabs(slopes.dy(z))), state);
        if (state.bias_place == DepthBiasPlace::Fragment) out.z_bias = bias;
        if (state.bias_place == DepthBiasPlace::Vertex)
            for (Scalar& depth : z) depth += bias;
    }
    out.z0 = z[0];
    out.z_origin = at[0];
    out.z_dx = static_cast<Scalar>(slopes.dx(z));
    out.z_dy = static_cast<Scalar>(slopes.dy(z));
}

/// Begins with the farthest vertex: then 1/w grows away from vertex 0 on every side, and its interpolation cannot cancel.
template <class Scalar>
void put_farthest_first(std::array<SetupVertex<Scalar>, 3>& v) {
    const auto farthest =
        std::ranges::min_element(v, {}, [](const SetupVertex<Scalar>& vertex) { return vertex.screen.inv_w; }) - v.begin();
    std::rotate(v.begin(), v.begin() + farthest, v.end());
}

/// Puts a driver's plane in the place of the depth's.
template <class Scalar>
void take_depth(const DepthPlane& plane, const SetupState& state, Primitive<Scalar>& out) {
    out.z0 = static_cast<Scalar>(plane.z0);
    out.z_origin = plane.origin;
    out.z_dx = static_cast<Scalar>(plane.dx);
    out.z_dy = static_cast<Scalar>(plane.dy);
    out.z_bias = Scalar(0);
    if (!has_bias(state.raster)) return;
    const std::array<Scalar, 3> z{static_cast<Scalar>(plane.z[0]), static_cast<Scalar>(plane.z[1]),
                                  static_cast<Scalar>(plane.z[2])};
    const Scalar bias = bias_of(z, static_cast<double>(plane.slope), state);
    (state.bias_place == DepthBiasPlace::Fragment ? out.z_bias : out.z0) += bias;
}

}  // namespace

GridPoint snap_position(float x, float y, const Profile& profile) {
    return {snap(x, profile.raster_subpixel_bits), snap(y, profile.raster_subpixel_bits)};
}

template <class Scalar>
ScreenVertex<Scalar> project(const Scalar* v, const Viewport& viewport, int subpixel_bits) {
    const Scalar w = v[3];
    ScreenVertex<Scalar> screen;
    // D3D11.3 15.6
    screen.x = (v[0] / w + Scalar(1)) * static_cast<Scalar>(viewport.width) * Scalar(0.5) + static_cast<Scalar>(viewport.x);
    screen.y = (Scalar(1) - v[1] / w) * static_cast<Scalar>(viewport.height) * Scalar(0.5) + static_cast<Scalar>(viewport.y);
    const auto min_depth = static_cast<Scalar>(viewport.min_depth);
    screen.z = min_depth + v[2] / w * (static_cast<Scalar>(viewport.max_depth) - min_depth);
    screen.inv_w = Scalar(1) / w;
    // The guard band keeps x and y in the range of 16.8 positions. x - x is 0 only for finite x. D3D11.3 15.16.1
    screen.valid = screen.x == screen.x && screen.y == screen.y && screen.z - screen.z == Scalar(0) &&
                   screen.inv_w - screen.inv_w == Scalar(0);
    if (screen.valid) screen.at = {snap(screen.x, subpixel_bits), snap(screen.y, subpixel_bits)};
    return screen;
}

Facing facing_of(std::int64_t signed_area, const RasterState& raster) {
    Facing facing;
    if (signed_area != 0) facing.front = (signed_area > 0) != raster.front_counter_clockwise;
    facing.culled = raster.cull == (facing.front ? CullMode::Front : CullMode::Back);
    return facing;
}

template <class Scalar>
Scalar triangle_depth_bias(const std::array<SetupVertex<Scalar>, 3>& vertices, const SetupState& state) {
    if (!has_bias(state.raster)) return Scalar(0);
    const std::array<GridPoint, 3> at{vertices[0].screen.at, vertices[1].screen.at, vertices[2].screen.at};
    const std::array<Scalar, 3> z{vertices[0].screen.z, vertices[1].screen.z, vertices[2].screen.z};
    const std::int64_t area = signed_area(at[0], at[1], at[2]);
    if (area == 0) return bias_of(z, 0.0, state);
    const BarycentricSlopes slopes(at, area);
    return bias_of(z, std::max(std::fabs(slopes.dx(z)), std::fabs(slopes.dy(z))), state);
}

template <class Scalar>
bool set_up_triangle(const std::array<SetupVertex<Scalar>, 3>& vertices, const PrimitiveHead<Scalar>& head,
                     const SetupState& state, Primitive<Scalar>& out) {
    std::array<SetupVertex<Scalar>, 3> v = vertices;

    // Facing by the snapped area; no area covers nothing.
    std::int64_t area = signed_area(v[0].screen.at, v[1].screen.at, v[2].screen.at);
    const Facing facing = facing_of(area, state.raster);
    if (area == 0 || facing.culled) return false;
    take_head(head, facing.front, out);
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }

    put_farthest_first(v);
    const std::array<GridPoint, 3> at{v[0].screen.at, v[1].screen.at, v[2].screen.at};
    if (!set_up_edges(at, state, out)) return false;
    out.shape = PrimitiveShape::Triangle;
    set_up_planes(v, area, state, out);
    if (state.plane_equations != PlaneEquations::Barycentric)
        take_depth(driver_depth_plane(vertices, state.viewports[out.viewport].viewport, state), state, out);
    return true;
}

PixelRect pixel_bounds(const GridPoint& low, const GridPoint& high, std::uint32_t viewport, const SetupState& state) {
    return intersect(pixels_between(low, high, state.sample_extent), state.viewports[viewport].visible);
}

template <class Scalar>
void set_up_outline(const OutlineCorners<Scalar>& corners, const Outline& outline, const PixelRect& bounds,
                    const PrimitiveHead<Scalar>& head, const SetupState& state, Primitive<Scalar>& out) {
    take_head(head, facing_of(outline.counter_clockwise ? -1 : 1, state.raster).front, out);
    out.shape = PrimitiveShape::Outline;
    out.outline = &outline;
    out.bounds = bounds;
    std::array<SetupVertex<Scalar>, 3> v = corners.polygon;
    std::int64_t area = signed_area(v[0].screen.at, v[1].screen.at, v[2].screen.at);
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    put_farthest_first(v);
    set_up_planes(v, area, state, out);
    if (state.plane_equations != PlaneEquations::Barycentric)
        take_depth(driver_depth_plane(corners.triangle, state.viewports[head.viewport].viewport, state), state, out);
}

namespace {

/// Planes that vary along a line and not across it. [OpenGL46] 14.5.1: the projection of the position onto the line
template <class Scalar>
void set_up_line_planes(const std::array<SetupVertex<Scalar>, 2>& ends, const std::array<Scalar, 2>& z,
                        Primitive<Scalar>& out) {
    const GridPoint& from = ends[0].screen.at;
    const GridPoint& to = ends[1].screen.at;
    const double dx = static_cast<double>(to.x - from.x) / kSubpixels;
    const double dy = static_cast<double>(to.y - from.y) / kSubpixels;
    const double length2 = dx * dx + dy * dy;
    const double along_x = length2 > 0 ? dx / length2 : 0.0;
    const double along_y = length2 > 0 ? dy / length2 : 0.0;
    const auto rise = static_cast<double>(z[1] - z[0]);
    out.x0 = from.x;
    out.y0 = from.y;
    out.l1_dx = static_cast<Scalar>(along_x);
    out.l1_dy = static_cast<Scalar>(along_y);
    out.l2_dx = out.l2_dy = Scalar(0);
    out.z0 = z[0];
    out.z_origin = from;
    out.z_dx = static_cast<Scalar>(rise * along_x);
    out.z_dy = static_cast<Scalar>(rise * along_y);
    out.z_bias = Scalar(0);
    out.inv_w = {ends[0].screen.inv_w, ends[1].screen.inv_w, ends[0].screen.inv_w};
    const Scalar* first = ends[0].record + kPositionScalars;
    out.varyings = {first, ends[1].record + kPositionScalars, first};
}

/// The two triangles of a quadrilateral whose corners go round; pieces that cover nothing are left out.
template <class Scalar>
int set_up_quadrilateral(const std::array<GridPoint, 4>& corner, const SetupState& state, const Primitive<Scalar>& planes,
                         std::array<Primitive<Scalar>, 2>& out) {
    int pieces = 0;
    for (std::array<GridPoint, 3> half : {std::array{corner[0], corner[1], corner[2]}, {corner[0], corner[2], corner[3]}}) {
        const std::int64_t area = signed_area(half[0], half[1], half[2]);
        if (area == 0) continue;
        if (area < 0) std::swap(half[1], half[2]);
        Primitive<Scalar>& piece = out[static_cast<std::size_t>(pieces)];
        piece = planes;
        piece.shape = PrimitiveShape::Triangle;
        if (set_up_edges(half, state, piece)) ++pieces;
    }
    return pieces;
}

}  // namespace

template <class Scalar>
int set_up_line(const std::array<SetupVertex<Scalar>, 2>& ends, const PrimitiveHead<Scalar>& head, Scalar bias, bool front,
                const SetupState& state, std::array<Primitive<Scalar>, 2>& out) {
    Primitive<Scalar> line;
    take_head(head, front, line);
    const bool at_fragments = state.bias_place == DepthBiasPlace::Fragment;
    const Scalar at_vertices = at_fragments ? Scalar(0) : bias;
    set_up_line_planes(ends, {ends[0].screen.z + at_vertices, ends[1].screen.z + at_vertices}, line);
    if (at_fragments) line.z_bias = bias;
    const GridPoint& from = ends[0].screen.at;
    const GridPoint& to = ends[1].screen.at;

    if (state.raster.lines == LineMode::Aliased) {
        // Diamonds reach half a pixel beyond what the line touches.
        const auto [low_x, high_x] = std::minmax(from.x, to.x);
        const auto [low_y, high_y] = std::minmax(from.y, to.y);
        line.shape = PrimitiveShape::AliasedLine;
        line.line = {from, to};
        line.bounds = intersect({(low_x >> kSubpixelBits) - 1, (low_y >> kSubpixelBits) - 1, (high_x >> kSubpixelBits) + 2,
                                 (high_y >> kSubpixelBits) + 2},
                                state.viewports[line.viewport].visible);
        if (from == to || line.bounds.empty()) return 0;
        out[0] = line;
        return 1;
    }

    // A rectangle of width 1.4 whose corners are snapped, not its ends. D3D11.3 3.4.5, 3.4.1
    const double ax = static_cast<double>(ends[0].screen.x);
    const double ay = static_cast<double>(ends[0].screen.y);
    const double bx = static_cast<double>(ends[1].screen.x);
    const double by = static_cast<double>(ends[1].screen.y);
    const double length = std::sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay));
    if (!(length > 0)) return 0;
    const double across_x = 0.7 * (by - ay) / length;
    const double across_y = 0.7 * (ax - bx) / length;
    const auto corner = [&](double x, double y) {
        return GridPoint{snap(x, state.subpixel_bits), snap(y, state.subpixel_bits)};
    };
    return set_up_quadrilateral({corner(ax + across_x, ay + across_y), corner(bx + across_x, by + across_y),
                                 corner(bx - across_x, by - across_y), corner(ax - across_x, ay - across_y)},
                                state, line, out);
}

template <class Scalar>
int set_up_point(const SetupVertex<Scalar>& centre, const PrimitiveHead<Scalar>& head, const SetupState& state,
                 std::array<Primitive<Scalar>, 2>& out) {
    Primitive<Scalar> point;
    take_head(head, true, point);
    set_up_line_planes({centre, centre}, {centre.screen.z, centre.screen.z}, point);
    const GridPoint& c = centre.screen.at;
    constexpr int kHalf = kSubpixels / 2;
    return set_up_quadrilateral({GridPoint{c.x - kHalf, c.y - kHalf}, GridPoint{c.x + kHalf, c.y - kHalf},
                                 GridPoint{c.x + kHalf, c.y + kHalf}, GridPoint{c.x - kHalf, c.y + kHalf}},
                                state, point, out);
}

#define GNOMON_INSTANTIATE(Scalar)                                                                                            \
    template ScreenVertex<Scalar> project(const Scalar*, const Viewport&, int);                                               \
    template Scalar triangle_depth_bias(const std::array<SetupVertex<Scalar>, 3>&, const SetupState&);                        \
    template void set_up_outline(const OutlineCorners<Scalar>&, const Outline&, const PixelRect&,                             \
                                 const PrimitiveHead<Scalar>&, const SetupState&, Primitive<Scalar>&);                        \
    template bool set_up_triangle(const std::array<SetupVertex<Scalar>, 3>&, const PrimitiveHead<Scalar>&, const SetupState&, \
                                  Primitive<Scalar>&);                                                                        \
    template int set_up_line(const std::array<SetupVertex<Scalar>, 2>&, const PrimitiveHead<Scalar>&, Scalar, bool,           \
                             const SetupState&, std::array<Primitive<Scalar>, 2>&);                                           \
    template int set_up_point(const SetupVertex<Scalar>&, const PrimitiveHead<Scalar>&, const SetupState&,                    \
                              std::array<Primitive<Scalar>, 2>&);
GNOMON_INSTANTIATE(float)
GNOMON_INSTANTIATE(double)
#undef GNOMON_INSTANTIATE

}  // namespace gnomon
