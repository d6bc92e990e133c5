#include "pipeline/peer_setup.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon {

namespace {

/// x, y, z, w with y down.
using Clip = std::array<float, 4>;

template <class Scalar>
Clip clip_of(const Scalar* v) {
    return {static_cast<float>(v[0]), -static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])};
}

/// minps and maxps: equal or unordered, the second.
float min_ps(float a, float b) { return a < b ? a : b; }
float max_ps(float a, float b) { return a > b ? a : b; }

/// To nearest even. Where 16.8 positions end, it saturates; NaN gives the lower end.
std::int32_t rounded(float x, float limit) {
    return static_cast<std::int32_t>(std::nearbyint(max_ps(min_ps(x, limit), -limit)));
}

/// 0 to `steps` grid steps are a pixel.
GridPoint to_grid(const std::array<std::int32_t, 2>& at, int steps, int offset) {
    const int scale = kSubpixels / steps;
    return {at[0] * scale + offset, at[1] * scale + offset};
}
constexpr float kReach = 32767.0f;  // pixels. D3D11.3 3.4.1

/// Half the size, and the middle, in pixels.
struct Scale {
    std::array<float, 2> half;
    std::array<float, 2> middle;

    explicit Scale(const Viewport& v) {
        half = {0.5f * v.width, 0.5f * v.height};
        middle = {half[0] + v.x, half[1] + v.y};
    }
};

float depth_scale(const Viewport& v) { return static_cast<float>(static_cast<double>(v.max_depth) - v.min_depth); }

/// Window positions by a fused multiply-add; the grid counts from the first sample place, which is the pixel's centre where
/// there is one sample.
template <class Scalar>
ScreenVertex<Scalar> project_llvmpipe(const Clip& clip, const Viewport& viewport, const SetupState& state, bool made) {
    const Scale to(viewport);
    const float over_w = 1.0f / clip[3];
    const auto window = [&](float ndc, float scale, float translate) {
        return made ? ndc * scale + translate : std::fma(ndc, scale, translate);
    };
    const std::array<float, 2> at{window(clip[0] * over_w, to.half[0], to.middle[0]),
                                  window(clip[1] * over_w, to.half[1], to.middle[1])};
    const int steps = 1 << state.subpixel_bits;
    const auto scale = static_cast<float>(steps);
    const float centre = state.samples == 1 ? 0.5f : 0.0f;
    ScreenVertex<Scalar> screen;
    screen.at = to_grid({rounded((at[0] - centre) * scale, kReach * scale), rounded((at[1] - centre) * scale, kReach * scale)},
                        steps, state.samples == 1 ? kSubpixels / 2 : 0);
    screen.x = static_cast<Scalar>(at[0]);
    screen.y = static_cast<Scalar>(at[1]);
    screen.z = static_cast<Scalar>(window(clip[2] * over_w, depth_scale(viewport), viewport.min_depth));
    screen.inv_w = static_cast<Scalar>(over_w);
    return screen;
}

/// A w of zero gets the bits of 1 on top: -0 becomes -1.
float swiftshader_over_w(const Clip& clip) {
    const float w = clip[3];
    return 1.0f / (w == 0 ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(w) | 0x3f800000u) : w);
}

/// Grid steps from the centre of the first pixel, before they are rounded.
std::array<float, 2> swiftshader_position(const Clip& clip, const Viewport& viewport, const SetupState& state) {
    const Scale to(viewport);
    const auto steps = static_cast<float>(1 << state.subpixel_bits);
    const float over_w = swiftshader_over_w(clip);
    const auto position = [&](float x, float half, float middle) {
        return (middle * steps - steps / 2) + x * over_w * (half * steps);
    };
    return {position(clip[0], to.half[0], to.middle[0]), position(clip[1], to.half[1], to.middle[1])};
}

template <class Scalar>
ScreenVertex<Scalar> project_swiftshader(const Clip& clip, const Viewport& viewport, const SetupState& state) {
    const std::array<float, 2> at = swiftshader_position(clip, viewport, state);
    const int steps = 1 << state.subpixel_bits;
    const float limit = kReach * static_cast<float>(steps);
    const float over_w = swiftshader_over_w(clip);
    ScreenVertex<Scalar> screen;
    screen.at = to_grid({rounded(at[0], limit), rounded(at[1], limit)}, steps, kSubpixels / 2);
    screen.x = static_cast<Scalar>(screen.at.x) / Scalar(kSubpixels);
    screen.y = static_cast<Scalar>(screen.at.y) / Scalar(kSubpixels);
    screen.z = static_cast<Scalar>(clip[2] * over_w * depth_scale(viewport) + viewport.min_depth);
    screen.inv_w = static_cast<Scalar>(over_w);
    if (!(at[0] == at[0] && at[1] == at[1])) screen.x = screen.y = screen.inv_w;
    return screen;
}

/// What rounds to 32 bits in SwiftShader: cvtps2dq below a limit, so that only the lower end is out of range.
std::array<std::int32_t, 2> swiftshader_grid(const Clip& clip, const Viewport& viewport, const SetupState& state) {
    const auto whole = [](float x) {
        const float limited = min_ps(x, 2147483520.0f);
        return limited >= -2147483648.0f ? static_cast<std::int32_t>(std::nearbyint(limited))
                                         : std::numeric_limits<std::int32_t>::min();
    };
    const std::array<float, 2> at = swiftshader_position(clip, viewport, state);
    return {whole(at[0]), whole(at[1])};
}

/// Through window positions that were not snapped, from the target's corner (the first pixel's centre, with one sample).
template <class Scalar>
DepthPlane llvmpipe_plane(const std::array<SetupVertex<Scalar>, 3>& triangle, const SetupState& state) {
    std::array<const ScreenVertex<Scalar>*, 3> v{&triangle[0].screen, &triangle[1].screen, &triangle[2].screen};
    if (signed_area(v[0]->at, v[1]->at, v[2]->at) < 0) std::swap(v[1], v[2]);
    const auto x = [&](std::size_t i) { return static_cast<float>(v[i]->x); };
    const auto y = [&](std::size_t i) { return static_cast<float>(v[i]->y); };
    const auto z = [&](std::size_t i) { return static_cast<float>(v[i]->z); };
    const float centre = state.samples == 1 ? 0.5f : 0.0f;
    const float dx01 = x(0) - x(1);
    const float dy01 = y(0) - y(1);
    const float dx20 = x(2) - x(0);
    const float dy20 = y(2) - y(0);
    const float dz01 = z(0) - z(1);
    const float dz20 = z(2) - z(0);
    const float over_area = 1.0f / (dx01 * dy20 - dy01 * dx20);
    DepthPlane plane;
    plane.dx = dz01 * (dy20 * over_area) - dz20 * (dy01 * over_area);
    plane.dy = dz20 * (dx01 * over_area) - dz01 * (dx20 * over_area);
    plane.z0 = z(0) - (plane.dx * (x(0) - centre) + plane.dy * (y(0) - centre));
    const int corner = state.samples == 1 ? kSubpixels / 2 : 0;
    plane.origin = {corner, corner};
    plane.z = {z(0), z(1), z(2)};
    // The bias rounds the slopes in another order.
    plane.slope =
        max_ps(std::fabs((dz20 * dy01 - dy20 * dz01) * over_area), std::fabs((dx20 * dz01 - dz20 * dx01) * over_area));
    return plane;
}

/// Through snapped positions.
template <class Scalar>
DepthPlane swiftshader_plane(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                             const SetupState& state) {
    const SwiftShaderVertices v = swiftshader_vertices(triangle, viewport, state);
    std::array<float, 3> z;
    for (std::size_t i = 0; i < 3; ++i) z[i] = v.clip[i][2] * v.over_w[i];
    const float step = 1.0f / static_cast<float>(1 << state.subpixel_bits);
    const float x1 = v.steps(1, 0) * step;
    const float y1 = v.steps(1, 1) * step;
    const float x2 = v.steps(2, 0) * step;
    const float y2 = v.steps(2, 1) * step;
    const float z1 = z[1] - z[0];
    const float z2 = z[2] - z[0];
    const float range = depth_scale(viewport);
    const float over_area = range / (x1 * y2 - x2 * y1);
    DepthPlane plane;
    plane.dx = (y2 * z1 - y1 * z2) * over_area;
    plane.dy = (x1 * z2 - x2 * z1) * over_area;
    plane.z0 = z[0] * range + viewport.min_depth;
    plane.origin = v.origin;
    plane.z = {plane.z0, z1 * range + viewport.min_depth, z2 * range + viewport.min_depth};
    plane.slope = max_ps(std::fabs(plane.dx), std::fabs(plane.dy));
    return plane;
}

float power_of(std::int32_t exponent_bits) { return std::bit_cast<float>(exponent_bits); }

}  // namespace

template <class Scalar>
ScreenVertex<Scalar> project(const Scalar* v, const Viewport& viewport, const SetupState& state, bool made) {
    ScreenVertex<Scalar> screen;
    switch (state.viewport_arithmetic) {
        case ViewportArithmetic::D3d11: return project(v, viewport, state.subpixel_bits);
        case ViewportArithmetic::Llvmpipe: screen = project_llvmpipe<Scalar>(clip_of(v), viewport, state, made); break;
        case ViewportArithmetic::SwiftShader: screen = project_swiftshader<Scalar>(clip_of(v), viewport, state); break;
    }
    screen.valid = screen.x == screen.x && screen.y == screen.y && screen.z - screen.z == Scalar(0) &&
                   screen.inv_w - screen.inv_w == Scalar(0);
    return screen;
}

template <class Scalar>
SwiftShaderVertices swiftshader_vertices(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                                         const SetupState& state) {
    SwiftShaderVertices v;
    std::array<Clip, 3> clip;
    for (std::size_t i = 0; i < 3; ++i) clip[i] = clip_of(triangle[i].record);
    const auto rotate = [&](std::size_t axis, float (*better)(float, float)) {
        const std::array<float, 3> keys{clip[v.order[0]][axis], clip[v.order[1]][axis], clip[v.order[2]][axis]};
        const float chosen = better(better(keys[0], keys[1]), keys[2]);
        if (chosen == keys[1]) v.order = {v.order[1], v.order[2], v.order[0]};
        if (chosen == keys[2]) v.order = {v.order[2], v.order[0], v.order[1]};  // of both, one after the other
    };
    rotate(1, min_ps);
    rotate(3, max_ps);

    for (std::size_t i = 0; i < 3; ++i) {
        v.clip[i] = clip[v.order[i]];
        v.grid[i] = swiftshader_grid(v.clip[i], viewport, state);
        v.over_w[i] = swiftshader_over_w(v.clip[i]);
    }
    const int steps = 1 << state.subpixel_bits;
    const std::int32_t limit = static_cast<std::int32_t>(kReach) * steps;
    v.origin =
        to_grid({std::clamp(v.grid[0][0], -limit, limit), std::clamp(v.grid[0][1], -limit, limit)}, steps, kSubpixels / 2);
    return v;
}

template <class Scalar>
bool turns_counter_clockwise(const std::array<const Scalar*, 3>& clip_positions, const Viewport& viewport,
                             const SetupState& state) {
    std::array<float, 3> x;
    std::array<float, 3> y;
    bool negative = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const Clip clip = clip_of(clip_positions[i]);
        const auto grid = swiftshader_grid(clip, viewport, state);
        x[i] = static_cast<float>(grid[0]);
        y[i] = static_cast<float>(grid[1]);
        negative ^= std::signbit(clip[3]);
    }
    const float area = (y[0] - y[2]) * x[1] + (y[2] - y[1]) * x[0] + (y[1] - y[0]) * x[2];
    return (negative ? -area : area) > 0;
}

template <class Scalar>
DepthPlane driver_depth_plane(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                              const SetupState& state) {
    return state.plane_equations == PlaneEquations::Llvmpipe ? llvmpipe_plane(triangle, state)
                                                             : swiftshader_plane(triangle, viewport, state);
}

float driver_depth_bias(const std::array<float, 3>& z, float slope, const SetupState& state) {
    const RasterState& raster = state.raster;
    const bool is_float = state.depth_type == ComponentType::Depth32;
    const auto constant = static_cast<float>(raster.depth_bias);
    const double codes = state.depth_type == ComponentType::Depth16 ? 65535.0 : 16777215.0;
    constexpr std::int32_t kExponent = 0xff << 23;
    float bias = 0;
    if (state.bias_arithmetic == DepthBiasArithmetic::Llvmpipe) {
        const float sloped = slope * raster.slope_scaled_depth_bias;
        if (is_float) {
            const float largest = std::max({std::fabs(z[0]), std::fabs(z[1]), std::fabs(z[2])});
            const std::int32_t exponent = (std::bit_cast<std::int32_t>(largest) & kExponent) - (23 << 23);
            bias = power_of(std::max(exponent, 0)) * constant + sloped;
        } else {
            bias = static_cast<float>(raster.depth_bias * (state.bias_steps / codes)) + sloped;
        }
    } else {
        if (raster.depth_bias != 0) {
            const auto exponent = [](float depth) { return std::bit_cast<std::int32_t>(depth) & kExponent; };
            const float largest = power_of(std::max({exponent(z[0]), exponent(z[1]), exponent(z[2])}));
            const float step = 1.01f * static_cast<float>(state.bias_steps) / static_cast<float>(codes);
            bias = (is_float ? largest * 0x1p-23f : step) * constant;
        }
        if (raster.slope_scaled_depth_bias != 0.0f) bias += slope * raster.slope_scaled_depth_bias;
    }
    if (raster.depth_bias_clamp > 0) bias = std::min(raster.depth_bias_clamp, bias);
    if (raster.depth_bias_clamp < 0) bias = std::max(raster.depth_bias_clamp, bias);
    return bias;
}

#define GNOMON_INSTANTIATE(Scalar)                                                                                  \
    template ScreenVertex<Scalar> project(const Scalar*, const Viewport&, const SetupState&, bool);                 \
    template SwiftShaderVertices swiftshader_vertices(const std::array<SetupVertex<Scalar>, 3>&, const Viewport&,   \
                                                      const SetupState&);                                           \
    template bool turns_counter_clockwise(const std::array<const Scalar*, 3>&, const Viewport&, const SetupState&); \
    template DepthPlane driver_depth_plane(const std::array<SetupVertex<Scalar>, 3>&, const Viewport&, const SetupState&);
GNOMON_INSTANTIATE(float)
GNOMON_INSTANTIATE(double)
#undef GNOMON_INSTANTIATE

}  // namespace gnomon
