// Axes of the ellipse, ratio and level of detail in intervals.
#include "tests/verify/lookup_footprint.h"

#include <algorithm>
#include <cmath>

namespace verify {

using namespace gnomon;

namespace {

// Above this relative error of a denominator the formulas of D3D11.3 7.18.11 say nothing.
constexpr double kWorthless = 0x1p-6;

struct Vector {
    double u = 0;  // texels of level 0 per pixel
    double v = 0;
    [[nodiscard]] double length() const { return std::hypot(u, v); }
};

/// The two vectors that level of detail and anisotropy come from, with what arithmetic does to them.
struct Axes {
    Vector major;
    Range major_length;
    Range minor_length;
    Range determinant;       // |dX x dY|: area of the parallelogram
    double angle_error = 0;  // of the major axis, radians
    bool worthless = false;
};

Range around(double value, double relative) { return {value * (1 - relative), value * (1 + relative)}; }

Axes plain_axes(Vector major, Vector minor, double error) {
    const double products = std::abs(major.u * minor.v) + std::abs(major.v * minor.u);
    const double determinant = std::abs(major.u * minor.v - major.v * minor.u);
    return {.major = major,
            .major_length = around(major.length(), error),
            .minor_length = around(minor.length(), error),
            .determinant = {std::max(0.0, determinant - error * products), determinant + error * products},
            .angle_error = error};
}

/// Error of the square root of a value in [0, 1] that is known to `error`.
double root_error(double value, double error) { return std::min(std::sqrt(error), error / std::max(std::sqrt(value), 1e-300)); }

/// The orthogonal axes of the ellipse: of D3D11.3's quantities F, p, q and t, the major axis is new_dY and its length
/// sqrt(2 F / (q - t)), whose denominator and whose direction (t - p) / 2t cancel.
Axes ellipse_axes(Vector dx, Vector dy, double error) {
    const double uu = dx.u * dx.u + dy.u * dy.u;
    const double uv = dx.u * dx.v + dy.u * dy.v;
    const double vv = dx.v * dx.v + dy.v * dy.v;
    const double q = uu + vv;
    const double t = std::hypot(uu - vv, 2 * uv);
    const double products = std::abs(dx.u * dy.v) + std::abs(dx.v * dy.u);
    const double area = std::abs(dx.u * dy.v - dx.v * dy.u);
    Axes axes;
    if (area == 0) {
        axes.worthless = true;
        return axes;
    }
    const double area_error = error * (1 + products / area);
    const double major = std::sqrt((q + t) / 2);
    const double minor = area / major;
    const double major_error = area_error + error * q / (2 * minor * minor);
    axes.worthless = !(major_error < kWorthless);
    const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
    axes.major = {major * std::cos(angle), major * std::sin(angle)};
    axes.major_length = around(major, major_error);
    axes.minor_length = around(minor, area_error);
    axes.determinant = around(area, area_error + major_error);
    if (t > 0) {
        const double cosine = std::cos(angle);
        const double sine = std::sin(angle);
        const double direction_error = error * (1 + q / t);
        axes.angle_error = root_error(cosine * cosine, direction_error) + root_error(sine * sine, direction_error);
    } else {
        axes.angle_error = 2;
    }
    axes.angle_error = std::min(axes.angle_error, 2.0);
    return axes;
}

/// Both orders of the two vectors where the arithmetic cannot tell which is longer.
std::vector<Axes> untransformed(Vector dx, Vector dy, double error) {
    std::vector<Axes> all;
    if (dx.length() * (1 + error) >= dy.length() * (1 - error)) all.push_back(plain_axes(dx, dy, error));
    if (dy.length() * (1 + error) >= dx.length() * (1 - error)) all.push_back(plain_axes(dy, dx, error));
    return all;
}

/// D3D11.3 7.18.11 skips the transformation for zero, parallel and perpendicular vectors; perpendicular ones are their own
/// ellipse's axes. What counts as parallel is left open.
std::vector<Axes> axes_of(Vector dx, Vector dy, bool transform, double error) {
    if (!transform) return untransformed(dx, dy, error);
    const double products = dx.length() * dy.length();
    const double area = std::abs(dx.u * dy.v - dx.v * dy.u);
    if (products == 0 || area == 0) return untransformed(dx, dy, error);
    std::vector<Axes> all{ellipse_axes(dx, dy, error)};
    const double cosine = std::abs(dx.u * dy.u + dx.v * dy.v) / products;
    if (area < 1e-3 * products || cosine < 1e-3) {
        const std::vector<Axes> skipped = untransformed(dx, dy, error);
        all.insert(all.end(), skipped.begin(), skipped.end());
    }
    return all;
}

/// A scale of nothing may end at the smallest exponent instead of at minus infinity: either is far below what biases reach.
Range log2_range(Range scale, const LookupPrecision& precision) {
    constexpr double kLowest = -60;
    return {std::log2(scale.lo) - precision.lod_error_low, std::max(std::log2(scale.hi), kLowest) + precision.lod_error_high};
}

/// The scale factor of an isotropic filter, texels of level 0 per pixel.
Range isotropic_scale(Vector dx, Vector dy, const LookupPrecision& precision, double error) {
    switch (precision.lod_rule) {
        case LodRule::Longest: return around(std::max(dx.length(), dy.length()), error);
        case LodRule::Box: return around(std::max({std::abs(dx.u), std::abs(dx.v), std::abs(dy.u), std::abs(dy.v)}), error);
        case LodRule::Area: {
            const Range area = plain_axes(dx, dy, error).determinant;
            return {std::sqrt(area.lo) * (1 - error), std::sqrt(area.hi) * (1 + error)};
        }
    }
    return {};
}

constexpr std::array kSteps{1, 2, 4, 6, 8, 10, 12, 16};

int limit_of(int max_anisotropy, AnisoLimits limits) {
    if (limits == AnisoLimits::Any) return max_anisotropy;
    return *(std::upper_bound(kSteps.begin(), kSteps.end(), max_anisotropy) - 1);
}

int probes_of(double ratio, ProbeCount count, int limit) {
    const auto at_most = [&](int n) { return std::clamp(n, 1, limit); };
    switch (count) {
        case ProbeCount::Ceil: return at_most(static_cast<int>(std::ceil(std::min(ratio, 64.0))));
        case ProbeCount::Round: return at_most(static_cast<int>(std::floor(std::min(ratio, 64.0) + 0.5)));
        case ProbeCount::Steps:
            for (const int step : kSteps)
                if (step >= ratio) return at_most(step);
            return limit;
    }
    return 1;
}

/// Ratio of anisotropy and the scale that the level of detail is taken from.
struct Anisotropy {
    double ratio = 1;
    double scale = 1;
};

/// D3D11.3 7.18.11, ComputeAnisotropicLOD.
Anisotropy d3d11_anisotropy(double major, double area, int limit, bool clamps_to_top) {
    double ratio = major * major / area;
    double minor = area / major;
    if (ratio > limit) {
        ratio = limit;
        minor = major / limit;
    }
    if (minor < 1) {
        ratio = std::max(1.0, ratio * minor);
        if (clamps_to_top) minor = 1;
    }
    return {ratio, minor};
}

/// SwiftShader SamplerCore.cpp computeLod2D: the ratio as in D3D11.3, never lessened for minor axes below a texel.
Anisotropy swiftshader_anisotropy(double major, double area, int limit) {
    const double ratio = std::clamp(major * major / area, 1.0, static_cast<double>(limit));
    return {ratio, major / ratio};
}

/// EXT_texture_filter_anisotropic and Vulkan 1.3 (Scale Factor Operation), before the ratio becomes whole. The clamp concerns
/// the level of detail: neither lessens the number of probes.
Anisotropy length_anisotropy(double major, double minor, int limit, bool clamps_to_top) {
    const double ratio = std::clamp(major / minor, 1.0, static_cast<double>(limit));
    return {ratio, clamps_to_top ? std::max(1.0, major / ratio) : major / ratio};
}

Anisotropy anisotropy(const LookupPrecision& precision, int limit, double major, double minor, double area) {
    switch (precision.aniso_rule) {
        case AnisoRule::D3d11: return d3d11_anisotropy(major, area, limit, precision.aniso_clamps_to_top);
        case AnisoRule::SwiftShader: return swiftshader_anisotropy(major, area, limit);
        case AnisoRule::OpenGl:
        case AnisoRule::Vulkan: return length_anisotropy(major, minor, limit, precision.aniso_clamps_to_top);
        case AnisoRule::Llvmpipe: return {1, minor};  // Mesa 22.3.6 lp_build_pmin: the limit never takes effect
    }
    return {};
}

Footprint on_line(const Axes& axes, int probes, Range lod, const LookupPrecision& precision) {
    Footprint footprint;
    footprint.lod = lod;
    footprint.probes = probes;
    footprint.major_u = axes.major.u;
    footprint.major_v = axes.major.v;
    footprint.major_error = axes.major_length.hi * axes.angle_error + (axes.major_length.hi - axes.major_length.lo) / 2;
    footprint.any_weights = precision.probe_placement == ProbePlacement::Ewa;
    footprint.one_level = precision.aniso_rule == AnisoRule::Llvmpipe;
    footprint.unbounded = axes.worthless;
    return footprint;
}

/// The ways to read one pair of axes: one per number of probes.
std::vector<Footprint> anisotropic(const Axes& axes, const Sampler& sampler, const LookupPrecision& precision) {
    const int limit = limit_of(sampler.max_anisotropy, precision.aniso_limits);
    const double error = precision.gradient_error * precision.epsilon;
    Range ratio{1e300, 0};
    Range scale{1e300, 0};
    for (const double major : {axes.major_length.lo, axes.major_length.hi})
        for (const bool low : {false, true}) {
            const double area = low ? axes.determinant.lo : axes.determinant.hi;
            const double minor = low ? axes.minor_length.lo : axes.minor_length.hi;
            const Anisotropy a = anisotropy(precision, limit, major, minor, area);
            ratio = {std::min(ratio.lo, a.ratio), std::max(ratio.hi, a.ratio)};
            scale = {std::min(scale.lo, a.scale), std::max(scale.hi, a.scale)};
        }
    ratio = {ratio.lo * (1 - error), ratio.hi * (1 + error)};
    scale = {scale.lo * (1 - error), scale.hi * (1 + error)};

    std::vector<Footprint> all;
    const int fewest = probes_of(ratio.lo, precision.probe_count, limit);
    const int most = probes_of(ratio.hi, precision.probe_count, limit);
    for (int probes = fewest; probes <= most; ++probes) {
        Range lod = log2_range(scale, precision);
        if (precision.aniso_rule == AnisoRule::OpenGl) {
            Range whole{axes.major_length.lo / probes, axes.major_length.hi / probes};
            if (precision.aniso_clamps_to_top) whole = {std::max(1.0, whole.lo), std::max(1.0, whole.hi)};
            lod = log2_range(whole, precision);
        }
        all.push_back(on_line(axes, probes, lod, precision));
    }
    return all;
}

}  // namespace

std::vector<Footprint> footprints(int width, int height, const Sampler& sampler, const LookupPrecision& precision,
                                  const SampleRequest& request) {
    // A level of detail from the instruction has a ratio of 1. D3D11.3 7.18.11
    if (!request.gradient) {
        const double error = precision.epsilon * (1 + std::abs(request.lod));
        return {{.lod = {request.lod - error, request.lod + error}}};
    }
    const Vector dx{request.gradient->dx[0] * width, request.gradient->dx[1] * height};
    const Vector dy{request.gradient->dy[0] * width, request.gradient->dy[1] * height};
    const double error = precision.gradient_error * precision.epsilon;
    std::vector<Footprint> all;
    if (sampler.max_anisotropy <= 1) {
        if (precision.lod_rule == LodRule::Longest && precision.ellipse_transform_isotropic) {
            for (const Axes& axes : axes_of(dx, dy, true, error))
                all.push_back({.lod = log2_range(axes.major_length, precision), .unbounded = axes.worthless});
        } else {
            all.push_back({.lod = log2_range(isotropic_scale(dx, dy, precision, error), precision)});
        }
        return all;
    }
    for (const Axes& axes : axes_of(dx, dy, precision.ellipse_transform, error))
        for (Footprint& footprint : anisotropic(axes, sampler, precision)) {
            // Where the ratio is limited the ellipse is widened to the scale of its level of detail.
            const double widened = std::exp2(footprint.lod.hi);
            footprint.extent_u = std::hypot(dx.u, dy.u, widened);
            footprint.extent_v = std::hypot(dx.v, dy.v, widened);
            all.push_back(footprint);
        }
    return all;
}

}  // namespace verify
