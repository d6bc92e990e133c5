// How small cases of the seam laboratory are drawn: their plane, their texture, and a functor that runs with the laboratory's
// questions and without.
#pragma once

#include "pipeline/device.h"
#include "pipeline/fragment.h"
#include "pipeline/vertex_stage.h"
#include "studies/seams/probe.h"

#include <glm/vec3.hpp>

#include <span>
#include <string_view>
#include <type_traits>

namespace gnomon::studies {

inline constexpr int kSeamSide = 256;  // pixels

/// Three numbers that are linear over the picture.
struct SeamPlane {
    glm::vec3 origin;  // in the top left corner of the picture
    glm::vec3 dx;      // change per pixel
    glm::vec3 dy;
};

/// A triangle that covers the picture, with the numbers of a plane.
struct SeamVertex {
    template <class Real>
    struct Input {
        Real x, y;
        Vec3<Real> at;
    };
    template <class Real>
    struct Varyings {
        Vec3<Real> at;
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{Vec4<Real>{v.in.x, v.in.y, Real(0.5f), Real(1.0f)}, Varyings<Real>{v.in.at}};
    }
};

/// Noise of squares of every size from a texel to half the side, all equally strong, so that every level of detail shows
/// values of its own. (u, v) in [0, 1)^2; `octaves` halvings.
float seam_noise(double u, double v, int octaves, unsigned seed);

/// One component with all levels, `slices` of noise; one slice is a flat texture.
TextureId seam_texture(Device& device, int side, int slices = 1);
/// The same from `texels`, slice by slice, values in [0, 1].
TextureId seam_texture(Device& device, int side, int slices, std::span<const float> texels);

/// Trilinear; coordinates repeat.
Sampler seam_sampler(AddressMode address = AddressMode::Wrap);

/// The place of a cure in its case's list. Throws Error that lists them.
int seam_cure(std::string_view seam, std::span<const std::string_view> cures, std::string_view cure);

/// One pass: a program with SeamVertex, or another vertex functor without constants, and its pixel functor.
struct SeamPass {
    std::string_view label;
    const Program* program = nullptr;
    std::span<const std::byte> constants{};
};

/// Executes a draw as a user would, with time and counters into `image`. The device does not count afterwards.
void measure_draw(Device& device, const Draw& draw, SeamImage& image);

/// Both passes over the plane.
SeamImage draw_seam_passes(Device& device, const SeamPlane& plane, const SeamPass& probed, const SeamPass& plain);

/// `make(std::bool_constant<kProbes>)` gives the pixel functor with the laboratory's questions and without.
template <class Make>
SeamImage draw_seam(Device& device, std::string_view name, const SeamPlane& plane, const Make& make) {
    const auto probed = make(std::true_type{});
    const auto plain = make(std::false_type{});
    static const Program probed_program = make_program<SeamVertex, std::remove_const_t<decltype(probed)>>(name);
    static const Program plain_program = make_program<SeamVertex, std::remove_const_t<decltype(plain)>>(name);
    return draw_seam_passes(device, plane, {name, &probed_program, constants_of(probed)},
                            {name, &plain_program, constants_of(plain)});
}

/// What a pixel functor returns: what a user sees, or what the laboratory asks.
template <bool kProbes, class F, class Probe, class Real = typename F::Real>
auto seam_colors(const F& f, const Real& value, const Probe& probe) {
    if constexpr (kProbes) {
        return probe_colors(f, probe());
    } else {
        return Vec4<Real>{value, value, value, Real(1.0f)};
    }
}

/// A sample to be taken.
template <class Real>
struct SeamLookup {
    Vec3<Real> coordinate;       // and slice
    bool has_gradients = false;  // or else derivatives of the quad
    Gradients<Real> gradients{};
};

template <class Real>
Vec3<Real> flat_coordinate(const Real& u, const Real& v) {
    return {u, v, Real(0.0f)};
}

/// The exact derivatives of a plane's first two numbers.
template <class Real>
Gradients<Real> plane_gradients(const SeamPlane& plane) {
    return {{Real(plane.dx.x), Real(plane.dx.y)}, {Real(plane.dy.x), Real(plane.dy.y)}};
}

template <class Real>
Gradients<Real> select(Mask mask, const Gradients<Real>& yes, const Gradients<Real>& no) {
    const auto pick = [&](const Real& a, const Real& b) { return gnomon::select(mask, a, b); };
    return {{pick(yes.dx.x, no.dx.x), pick(yes.dx.y, no.dx.y)}, {pick(yes.dy.x, no.dy.x), pick(yes.dy.y, no.dy.y)}};
}

template <class F, class Real = typename F::Real>
Real look_up(const F& f, TextureId texture, const Sampler& sampler, const SeamLookup<Real>& lookup) {
    if (lookup.has_gradients) return f.sample_gradient(texture, sampler, lookup.coordinate, lookup.gradients).x;
    return f.sample(texture, sampler, lookup.coordinate).x;
}
template <class F, class Real = typename F::Real>
SampledLevel<Real> level_of(const F& f, TextureId texture, const Sampler& sampler, const SeamLookup<Real>& lookup) {
    if (lookup.has_gradients) return f.lod(texture, sampler, lookup.gradients);
    return f.lod(texture, sampler, Vec2<Real>{lookup.coordinate.x, lookup.coordinate.y});
}

/// Calls visit(of_lane) four times, where of_lane(x) is the value of one lane of the quad in all of its lanes: what lanes need
/// to follow the choice of a neighbour.
template <class F, class Visit, class Real = typename F::Real>
void for_each_lane_of_quad(const F& f, const Visit& visit) {
    visit([&](const Real& x) { return f.template quad_read<0>(x); });
    visit([&](const Real& x) { return f.template quad_read<1>(x); });
    visit([&](const Real& x) { return f.template quad_read<2>(x); });
    visit([&](const Real& x) { return f.template quad_read<3>(x); });
}

/// Gradients of the function that each lane chose: `gradients(of_lane)` takes those of the choice of one lane.
template <class F, class GradientsOf, class Real = typename F::Real>
Gradients<Real> gradients_before_choice(const F& f, const Real& used, const GradientsOf& gradients) {
    Gradients<Real> chosen{};
    for_each_lane_of_quad(f, [&](const auto& of_lane) { chosen = select(of_lane(used) == used, gradients(of_lane), chosen); });
    return chosen;
}

/// SeamPixel::smooth_lod of a sample: `lookup(of_lane)` is the lookup with the choice of one lane in all four.
template <class F, class LookupOf, class Real = typename F::Real>
Real smooth_lod_of(const F& f, TextureId texture, const Sampler& sampler, const Real& used, const LookupOf& lookup) {
    Real smooth(0.0f);
    for_each_lane_of_quad(f, [&](const auto& of_lane) {
        smooth = gnomon::select(of_lane(used) == used, level_of(f, texture, sampler, lookup(of_lane)).unclamped, smooth);
    });
    return smooth;
}

/// x - floor(x), as shading languages have it.
template <class Real>
Real frac(const Real& x) {
    return x - floor(x);
}

}  // namespace gnomon::studies
