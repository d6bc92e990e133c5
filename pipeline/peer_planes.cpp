#include "pipeline/peer_planes.h"

#include "pipeline/peer_setup.h"

namespace gnomon {

namespace {

/// llvmpipe's planes go through window positions that were not snapped.
template <class Scalar>
void take_llvmpipe(const std::array<SetupVertex<Scalar>, 3>& triangle, const SetupState& state, PeerPlanes<Scalar>& out) {
    std::array<const SetupVertex<Scalar>*, 3> v{&triangle[0], &triangle[1], &triangle[2]};
    if (signed_area(v[0]->screen.at, v[1]->screen.at, v[2]->screen.at) < 0) std::swap(v[1], v[2]);
    const auto x = [&](std::size_t i) { return static_cast<float>(v[i]->screen.x); };
    const auto y = [&](std::size_t i) { return static_cast<float>(v[i]->screen.y); };
    const float centre = state.samples == 1 ? 0.5f : 0.0f;
    out.x0 = x(0) - centre;
    out.y0 = y(0) - centre;
    out.dx01 = x(0) - x(1);
    out.dy01 = y(0) - y(1);
    out.dx20 = x(2) - x(0);
    out.dy20 = y(2) - y(0);
    out.over_area = 1.0f / (out.dx01 * out.dy20 - out.dy01 * out.dx20);
    const int corner = state.samples == 1 ? kSubpixels / 2 : 0;
    out.origin = {corner, corner};
    for (std::size_t i = 0; i < 3; ++i) {
        out.varyings[i] = v[i]->record + kPositionScalars;
        out.over_w[i] = static_cast<float>(v[i]->screen.inv_w);
        out.w[i] = static_cast<float>(v[i]->record[3]);
    }
    out.inverse_w = out.through(out.over_w);
}

/// SwiftShader inverts the matrix of the vertices' homogeneous positions, from the vertex of largest w.
template <class Scalar>
void take_swiftshader(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport, const SetupState& state,
                      PeerPlanes<Scalar>& out) {
    const SwiftShaderVertices v = swiftshader_vertices(triangle, viewport, state);
    for (std::size_t i = 0; i < 3; ++i) {
        out.varyings[i] = triangle[v.order[i]].record + kPositionScalars;
        out.over_w[i] = v.over_w[i];
        out.w[i] = v.clip[i][3];
    }
    out.origin = v.origin;
    const float step = 1.0f / static_cast<float>(1 << state.subpixel_bits);
    const float w1 = out.w[1];
    const float w2 = out.w[2];
    const float x1 = w1 * step * v.steps(1, 0);
    const float y1 = w1 * step * v.steps(1, 1);
    const float x2 = w2 * step * v.steps(2, 0);
    const float y2 = w2 * step * v.steps(2, 1);
    const float area = x1 * y2 - x2 * y1;
    out.share[0].start = v.over_w[0];
    if (area != 0) {
        const float over_area = 1.0f / area;
        const float first = over_area * v.over_w[0];
        out.share[0] = {v.over_w[0], (y1 * w2 - y2 * w1) * first, (x2 * w1 - x1 * w2) * first};
        out.share[1] = {0, y2 * over_area, -x2 * over_area};
        out.share[2] = {0, -y1 * over_area, x1 * over_area};
    }
    out.inverse_w = out.through({1, 1, 1});
}

Float at(const PeerPlane& plane, const PixelOffset<Float>& offset, PlaneEquations equations) {
    if (equations == PlaneEquations::Llvmpipe)
        return fused_multiply_add(Float(plane.dy), offset.dy,
                                  fused_multiply_add(Float(plane.dx), offset.dx, Float(plane.start)));
    return offset.dx * Float(plane.dx) + (Float(plane.start) + offset.dy * Float(plane.dy));
}

}  // namespace

template <class Scalar>
PeerPlane PeerPlanes<Scalar>::through(const std::array<float, 3>& values) const {
    const auto& [a, b, c] = values;
    if (equations == PlaneEquations::SwiftShader) {
        const auto sum = [&](float PeerPlane::* part) { return a * share[0].*part + b * share[1].*part + c * share[2].*part; };
        return {sum(&PeerPlane::start), sum(&PeerPlane::dx), sum(&PeerPlane::dy)};
    }
    const float d01 = a - b;
    const float d20 = c - a;
    const float dx = d01 * (dy20 * over_area) - d20 * (dy01 * over_area);
    const float dy = d20 * (dx01 * over_area) - d01 * (dx20 * over_area);
    return {a - (dx * x0 + dy * y0), dx, dy};
}

template <class Scalar>
PeerPlanes<Scalar> make_peer_planes(const std::array<SetupVertex<Scalar>, 3>& triangle, const Viewport& viewport,
                                    const SetupState& state) {
    PeerPlanes<Scalar> planes;
    planes.equations = state.plane_equations;
    if (state.plane_equations == PlaneEquations::Llvmpipe) {
        take_llvmpipe(triangle, state, planes);
    } else {
        take_swiftshader(triangle, viewport, state, planes);
    }
    return planes;
}

template <class Real>
void interpolate_as_peer(const PeerPlanes<typename Real::Scalar>& planes, std::span<const Interpolation> modes,
                         const PixelLanes& pixels, const PeerPositions& positions, const typename Real::Scalar* flat,
                         Real* varyings, Real& w) {
    const auto offset = [&](const PixelLanes& at) {
        return pixel_offset<Float>(pixels, at.x, at.y, planes.origin.x, planes.origin.y);
    };
    const std::array<PixelOffset<Float>, 3> offsets{offset(positions.centre), offset(positions.centroid),
                                                    offset(positions.sample)};
    std::array<Float, 3> w_at;
    for (std::size_t i = 0; i < 3; ++i) w_at[i] = Float(1.0f) / at(planes.inverse_w, offsets[i], planes.equations);
    w = Real(w_at[2]);

    // llvmpipe divides by w what perspective corrects; SwiftShader multiplies what it does not.
    const bool llvmpipe = planes.equations == PlaneEquations::Llvmpipe;
    for (std::size_t i = 0; i < modes.size(); ++i) {
        const Interpolation how = modes[i];
        if (how == Interpolation::Flat) {
            varyings[i] = Real(flat[i]);
            continue;
        }
        std::array<float, 3> values;
        for (std::size_t v = 0; v < 3; ++v) {
            values[v] = static_cast<float>(planes.varyings[v][i]);
            if (llvmpipe && !is_linear(how)) values[v] *= planes.over_w[v];
            if (!llvmpipe && is_linear(how)) values[v] *= planes.w[v];
        }
        const std::size_t place = is_at_sample(how) ? 2 : is_centroid(how) ? 1 : 0;
        const Float value = at(planes.through(values), offsets[place], planes.equations);
        varyings[i] = Real(is_linear(how) ? value : value * w_at[place]);
    }
}

template struct PeerPlanes<float>;
template struct PeerPlanes<double>;
template PeerPlanes<float> make_peer_planes(const std::array<SetupVertex<float>, 3>&, const Viewport&, const SetupState&);
template PeerPlanes<double> make_peer_planes(const std::array<SetupVertex<double>, 3>&, const Viewport&, const SetupState&);
template void interpolate_as_peer<Float>(const PeerPlanes<float>&, std::span<const Interpolation>, const PixelLanes&,
                                         const PeerPositions&, const float*, Float*, Float&);
template void interpolate_as_peer<Double>(const PeerPlanes<double>&, std::span<const Interpolation>, const PixelLanes&,
                                          const PeerPositions&, const double*, Double*, Double&);

}  // namespace gnomon
