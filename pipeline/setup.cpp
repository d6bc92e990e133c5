#include "pipeline/setup.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon {

namespace {

/// A vertex on the screen.
template <class Scalar>
struct ScreenVertex {
    std::int32_t x, y;  // snapped, 1/256 pixel
    Scalar z;           // [0, 1] up to rounding
    Scalar inv_w;
};

/// Snaps to the profile's grid, nearest even. D3D11.3 3.4.1
template <class Scalar>
std::int32_t snap(Scalar position, int subpixel_bits) {
    const auto snapped = static_cast<std::int32_t>(std::nearbyint(position * static_cast<Scalar>(1 << subpixel_bits)));
    return snapped * (1 << (kSubpixelBits - subpixel_bits));
}

/// Perspective divide and viewport. False where a coordinate is not a number; the guard band keeps the others in the range of
/// 16.8 positions, and what rounding still pushes over its end saturates. D3D11.3 3.2.4.1
template <class Scalar>
bool to_screen(const Scalar* v, const SetupState& state, ScreenVertex<Scalar>& screen) {
    const auto width = static_cast<Scalar>(state.viewport.x1 - state.viewport.x0);
    const auto height = static_cast<Scalar>(state.viewport.y1 - state.viewport.y0);
    const Scalar w = v[3];
    const Scalar x = (v[0] / w + Scalar(1)) * width * Scalar(0.5) + static_cast<Scalar>(state.viewport.x0);  // D3D11.3 15.6
    const Scalar y = (Scalar(1) - v[1] / w) * height * Scalar(0.5) + static_cast<Scalar>(state.viewport.y0);
    if (std::isnan(x) || std::isnan(y)) return false;
    const auto saturated = [](Scalar position) { return std::clamp(position, Scalar(-32767), Scalar(32767)); };
    screen = {snap(saturated(x), state.subpixel_bits), snap(saturated(y), state.subpixel_bits), v[2] / w, Scalar(1) / w};
    return screen.z - screen.z == Scalar(0) && screen.inv_w - screen.inv_w == Scalar(0);
}

/// a x + b y + c over snapped positions; positive to the right of p -> q with y down, so inside a clockwise triangle.
struct ExactEdge {
    std::int64_t a, b, c;
};
template <class Scalar>
ExactEdge exact_edge(const ScreenVertex<Scalar>& p, const ScreenVertex<Scalar>& q) {
    const std::int64_t a = std::int64_t{p.y} - q.y;
    const std::int64_t b = std::int64_t{q.x} - p.x;
    return {a, b, -(a * p.x + b * p.y)};
}

/// The edge function as the rasteriser evaluates it: see Edge.
Edge pixel_edge(const ExactEdge& e) {
    const bool top_left = e.a > 0 || (e.a == 0 && e.b > 0);
    const std::int64_t at_first_centre = e.c + (e.a + e.b) * (kSubpixels / 2) - (top_left ? 0 : 1);
    return {static_cast<std::int32_t>(e.a), static_cast<std::int32_t>(e.b), at_first_centre >> kSubpixelBits};
}

/// Depth bias of a primitive. D3D11.3 15.10
double depth_bias(const SetupState& state, double max_z, double slope) {
    const RasterState& raster = state.raster;
    double step = 0;
    switch (state.depth_type) {
        case ComponentType::Depth16: step = 1.0 / 65535.0; break;
        case ComponentType::Depth24: step = 1.0 / 16777215.0; break;
        case ComponentType::Unorm8:
        case ComponentType::Snorm8:
        case ComponentType::Srgb8:
        case ComponentType::Unorm16:
        case ComponentType::Snorm16:
        case ComponentType::Float16:
        case ComponentType::Float32:
        case ComponentType::Uint32:
        case ComponentType::Float11:
        case ComponentType::Depth32: {
            // 2^(exponent of the largest depth - 23)
            const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(max_z)) & 0x7fffffffu;
            step = std::ldexp(1.0, static_cast<int>(bits >> 23) - 127 - 23);
            break;
        }
    }
    double bias = raster.depth_bias * step;
    if (raster.slope_scaled_depth_bias != 0.0f) bias += static_cast<double>(raster.slope_scaled_depth_bias) * slope;
    const auto limit = static_cast<double>(raster.depth_bias_clamp);
    if (limit > 0) bias = std::min(limit, bias);
    if (limit < 0) bias = std::max(limit, bias);
    return bias;
}

/// Pixels whose centres can be inside, for snapped extremes low and high: first with centre >= low, one past the last <= high.
int first_pixel(std::int32_t low) { return (low + kSubpixels / 2 - 1) >> kSubpixelBits; }
int end_pixel(std::int32_t high) { return ((high - kSubpixels / 2) >> kSubpixelBits) + 1; }

}  // namespace

template <class Scalar>
GuardBand<Scalar> guard_band(const PixelRect& viewport) {
    // Stay one pixel inside +-32767 so that rounding cannot leave the range.
    const Scalar reach = Scalar(32766);
    const Scalar half_width = Scalar(0.5) * static_cast<Scalar>(viewport.x1 - viewport.x0);
    const Scalar half_height = Scalar(0.5) * static_cast<Scalar>(viewport.y1 - viewport.y0);
    const Scalar centre_x = static_cast<Scalar>(viewport.x0) + half_width;
    const Scalar centre_y = static_cast<Scalar>(viewport.y0) + half_height;
    return {.left = (reach + centre_x) / half_width,
            .right = (reach - centre_x) / half_width,
            .bottom = (reach - centre_y) / half_height,
            .top = (reach + centre_y) / half_height};
}

template <class Scalar>
std::optional<GridPoint> snap_vertex(const Scalar* vertex, const SetupState& state) {
    ScreenVertex<Scalar> screen;
    if (!to_screen(vertex, state, screen)) return std::nullopt;
    return GridPoint{screen.x, screen.y};
}

template <class Scalar>
SetupResult set_up_triangle(const std::array<const Scalar*, 3>& vertices, const SetupState& state, Triangle<Scalar>& triangle) {
    std::array<ScreenVertex<Scalar>, 3> v;
    for (std::size_t i = 0; i < 3; ++i)
        if (!to_screen(vertices[i], state, v[i])) return SetupResult::Culled;
    triangle.varyings = {vertices[0] + kPositionScalars, vertices[1] + kPositionScalars, vertices[2] + kPositionScalars};

    // Facing by the sign of the snapped area; no area faces nowhere and covers nothing. D3D11.3 15.11
    const ExactEdge first = exact_edge(v[0], v[1]);
    std::int64_t area = first.a * v[2].x + first.b * v[2].y + first.c;  // twice the area, 1/65536 pixels
    if (area == 0) return SetupResult::Culled;
    const bool clockwise = area > 0;
    const bool front = clockwise != state.raster.front_counter_clockwise;
    if (state.raster.cull == (front ? CullMode::Front : CullMode::Back)) return SetupResult::Culled;
    if (!clockwise) {
        std::swap(v[1], v[2]);
        std::swap(triangle.varyings[1], triangle.varyings[2]);
        area = -area;
    }

    // Begin with the farthest vertex: then 1/w grows away from vertex 0 on every side, and its interpolation cannot cancel.
    const auto farthest = std::ranges::min_element(v, {}, &ScreenVertex<Scalar>::inv_w) - v.begin();
    std::rotate(v.begin(), v.begin() + farthest, v.end());
    std::rotate(triangle.varyings.begin(), triangle.varyings.begin() + farthest, triangle.varyings.end());

    // Pixels it may cover.
    const auto [low_x, high_x] = std::minmax({v[0].x, v[1].x, v[2].x});
    const auto [low_y, high_y] = std::minmax({v[0].y, v[1].y, v[2].y});
    triangle.bounds = intersect({first_pixel(low_x), first_pixel(low_y), end_pixel(high_x), end_pixel(high_y)}, state.viewport);
    if (triangle.bounds.empty()) return SetupResult::Culled;

    const std::array<ExactEdge, 3> edges{exact_edge(v[0], v[1]), exact_edge(v[1], v[2]), exact_edge(v[2], v[0])};
    for (std::size_t i = 0; i < 3; ++i) triangle.edges[i] = pixel_edge(edges[i]);

    // Barycentrics grow away from vertex 0: vertex 1's is the edge from 2 to 0, vertex 2's the edge from 0 to 1, over the area.
    // Coefficients are computed in double from exact integers and rounded once.
    const double per_pixel = static_cast<double>(kSubpixels) / static_cast<double>(area);
    const double l1_dx = static_cast<double>(edges[2].a) * per_pixel;
    const double l1_dy = static_cast<double>(edges[2].b) * per_pixel;
    const double l2_dx = static_cast<double>(edges[0].a) * per_pixel;
    const double l2_dy = static_cast<double>(edges[0].b) * per_pixel;
    triangle.x0 = v[0].x;
    triangle.y0 = v[0].y;
    triangle.l1_dx = static_cast<Scalar>(l1_dx);
    triangle.l1_dy = static_cast<Scalar>(l1_dy);
    triangle.l2_dx = static_cast<Scalar>(l2_dx);
    triangle.l2_dy = static_cast<Scalar>(l2_dy);
    for (std::size_t i = 0; i < 3; ++i) triangle.inv_w[i] = v[i].inv_w;

    // Depth plane. The bias is added to each vertex, in the arithmetic of the profile. D3D11.3 15.10
    std::array<Scalar, 3> z{v[0].z, v[1].z, v[2].z};
    const auto slope_of = [&](double d1, double d2) {
        return static_cast<double>(z[1] - z[0]) * d1 + static_cast<double>(z[2] - z[0]) * d2;
    };
    if (state.raster.depth_bias != 0 || state.raster.slope_scaled_depth_bias != 0.0f) {
        const double slope = std::max(std::fabs(slope_of(l1_dx, l2_dx)), std::fabs(slope_of(l1_dy, l2_dy)));
        const double max_z = static_cast<double>(std::max({z[0], z[1], z[2]}));
        const auto bias = static_cast<Scalar>(depth_bias(state, max_z, slope));
        for (Scalar& depth : z) depth += bias;
    }
    triangle.z0 = z[0];
    triangle.z_dx = static_cast<Scalar>(slope_of(l1_dx, l2_dx));
    triangle.z_dy = static_cast<Scalar>(slope_of(l1_dy, l2_dy));
    return SetupResult::Drawn;
}

template GuardBand<float> guard_band(const PixelRect&);
template GuardBand<double> guard_band(const PixelRect&);
template std::optional<GridPoint> snap_vertex(const float*, const SetupState&);
template std::optional<GridPoint> snap_vertex(const double*, const SetupState&);
template SetupResult set_up_triangle(const std::array<const float*, 3>&, const SetupState&, Triangle<float>&);
template SetupResult set_up_triangle(const std::array<const double*, 3>&, const SetupState&, Triangle<double>&);

}  // namespace gnomon
