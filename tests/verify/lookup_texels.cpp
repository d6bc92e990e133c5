// Texels and weights in intervals.
#include "tests/verify/lookup_texels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace verify {

using namespace gnomon;

Bounds nothing() {
    Bounds b;
    b.lo.fill(std::numeric_limits<double>::infinity());
    b.hi.fill(-std::numeric_limits<double>::infinity());
    return b;
}

void include(Bounds& a, const Bounds& b) {
    for (std::size_t c = 0; c < 4; ++c) {
        a.lo[c] = std::min(a.lo[c], b.lo[c]);
        a.hi[c] = std::max(a.hi[c], b.hi[c]);
    }
}

Bounds lerp(const Bounds& a, const Bounds& b, double w) {
    Bounds result;
    for (std::size_t c = 0; c < 4; ++c) {
        result.lo[c] = a.lo[c] * (1 - w) + b.lo[c] * w;
        result.hi[c] = a.hi[c] * (1 - w) + b.hi[c] * w;
    }
    return result;
}

namespace {

Bounds at(const Cell& cell, double a, double b) {
    return lerp(lerp(cell.tap[0], cell.tap[1], a), lerp(cell.tap[2], cell.tap[3], a), b);
}

}  // namespace

Bounds hull(const Cell& cell) {
    Bounds all = nothing();
    for (const double a : {cell.a.lo, cell.a.hi})
        for (const double b : {cell.b.lo, cell.b.hi}) include(all, at(cell, a, b));
    return all;
}

Bounds hull(const std::vector<Cell>& cells) {
    Bounds all = nothing();
    for (const Cell& cell : cells) include(all, hull(cell));
    return all;
}

namespace {

/// -1 for the border. D3D11.3 7.18.9
std::int64_t address(AddressMode mode, std::int64_t i, std::int64_t size) {
    const auto modulo = [](std::int64_t n, std::int64_t period) { return (n % period + period) % period; };
    switch (mode) {
        case AddressMode::Wrap: return modulo(i, size);
        case AddressMode::Mirror: {
            const std::int64_t m = modulo(i, 2 * size);
            return m < size ? m : 2 * size - 1 - m;
        }
        case AddressMode::Clamp: return std::clamp<std::int64_t>(i, 0, size - 1);
        case AddressMode::Border: return i < 0 || i >= size ? -1 : i;
        case AddressMode::MirrorOnce: return std::min(i < 0 ? -i - 1 : i, size - 1);
    }
    return 0;
}

/// Whether `reference OP texel` may hold, and whether it may fail, for some pair out of the two intervals.
struct Outcome {
    bool may_pass = false;
    bool may_fail = false;
};

Outcome compare(CompareOp op, Range reference, Range texel) {
    const bool may_less = reference.lo < texel.hi;
    const bool may_greater = reference.hi > texel.lo;
    const bool may_equal = reference.lo <= texel.hi && texel.lo <= reference.hi;
    switch (op) {
        case CompareOp::Never: return {false, true};
        case CompareOp::Less: return {may_less, may_equal || may_greater};
        case CompareOp::Equal: return {may_equal, may_less || may_greater};
        case CompareOp::LessEqual: return {may_less || may_equal, may_greater};
        case CompareOp::Greater: return {may_greater, may_equal || may_less};
        case CompareOp::NotEqual: return {may_less || may_greater, may_equal};
        case CompareOp::GreaterEqual: return {may_greater || may_equal, may_less};
        case CompareOp::Always: return {true, false};
    }
    return {};
}

}  // namespace

Lookup::Lookup(const Image& image, const Sampler& sampler, const LookupPrecision& precision, const SampleRequest& request)
    : image_(image), sampler_(sampler), precision_(precision), request_(request) {
    if (request.reference) set_reference(*request.reference);
    const double largest = request.reference ? 1.0 : image.largest_texel;
    tolerance_ = precision.color_absolute + precision.color_relative * largest;
}

std::vector<Cell> Lookup::cells(int level, TexelFilter filter, const Footprint& footprint, double along) const {
    const Image::Level& texels = image_.levels[static_cast<std::size_t>(level)];
    const Image::Level& base = image_.levels[0];
    const double du = along * footprint.major_u / base.width;
    const double dv = along * footprint.major_v / base.height;
    const double error_u = std::abs(along) * footprint.major_error / base.width;
    const double error_v = std::abs(along) * footprint.major_error / base.height;
    const auto us = spans(request_.coordinate[0] + du, error_u, texels.width, request_.offset.x, filter);
    const auto vs = spans(request_.coordinate[1] + dv, error_v, texels.height, request_.offset.y, filter);
    std::vector<Cell> all;
    for (const Span& v : vs)
        for (const Span& u : us) {
            const std::int64_t step = filter == TexelFilter::Linear ? 1 : 0;
            all.push_back({{tap(texels, u.first, v.first), tap(texels, u.first + step, v.first),
                            tap(texels, u.first, v.first + step), tap(texels, u.first + step, v.first + step)},
                           u.weight,
                           v.weight});
        }
    return all;
}

Bounds Lookup::under_ellipse(int level, const Footprint& footprint) const {
    const Image::Level& texels = image_.levels[static_cast<std::size_t>(level)];
    const Image::Level& base = image_.levels[0];
    // More than two periods: every texel and the border.
    const auto range = [](double centre, double half, int size) {
        if (half > size) return std::pair{static_cast<std::int64_t>(-size), static_cast<std::int64_t>(size)};
        return std::pair{static_cast<std::int64_t>(std::floor(centre - half)),
                         static_cast<std::int64_t>(std::floor(centre + half))};
    };
    const double half_u = 1.5 * footprint.extent_u * texels.width / base.width + 2;
    const double half_v = 1.5 * footprint.extent_v * texels.height / base.height + 2;
    const auto [u0, u1] = range(request_.coordinate[0] * texels.width + request_.offset.x, half_u, texels.width);
    const auto [v0, v1] = range(request_.coordinate[1] * texels.height + request_.offset.y, half_v, texels.height);
    Bounds all = nothing();
    for (std::int64_t v = v0; v <= v1; ++v)
        for (std::int64_t u = u0; u <= u1; ++u) include(all, tap(texels, u, v));
    return all;
}

Bounds Lookup::anything() const {
    Bounds all = border();
    for (const Image::Level& level : image_.levels)
        for (std::int64_t y = 0; y < level.height; ++y)
            for (std::int64_t x = 0; x < level.width; ++x) include(all, tap(level, x, y));
    return all;
}

void Lookup::set_reference(double reference) {
    const double clamped = image_.unit_range ? std::clamp(reference, 0.0, 1.0) : reference;
    // Unquantised ones may still be clamped, and the texels that they meet are rounded.
    if (!precision_.reference_quantised) {
        reference_ = {std::min(reference, clamped), std::max(reference, clamped)};
        decode_error_ = image_.depth_codes > 0 ? 2 * precision_.epsilon : 0;
        return;
    }
    reference_ = {clamped, clamped};
    if (image_.depth_codes == 0) return;
    // A code of a depth format of integers: the nearest, ties either way. D3D11.3 17.11
    const double code = clamped * image_.depth_codes;
    const double slack = 4 * precision_.epsilon * code;
    reference_ = {std::ceil(code - 0.5 - slack) / image_.depth_codes, std::floor(code + 0.5 + slack) / image_.depth_codes};
}

std::vector<Lookup::Span> Lookup::spans(double coordinate, double error, int size, int offset, TexelFilter filter) const {
    const double shift = filter == TexelFilter::Linear ? 0.5 : 0.0;
    const double centre = coordinate * size + offset - shift;
    const double magnitude = std::abs(coordinate) * size + size + std::abs(offset) + 1;
    double radius = error * size + precision_.coordinate_error * precision_.epsilon * magnitude;
    if (precision_.coordinate_bits >= 0) radius += std::ldexp(precision_.coordinate_rounding, -precision_.coordinate_bits);
    const double weight_error =
        precision_.weight_bits >= 0 ? std::ldexp(precision_.weight_rounding, -precision_.weight_bits) : 0.0;
    const double lo = centre - radius;
    const double hi = centre + radius;
    std::vector<Span> all;
    for (double i = std::floor(lo); i <= std::floor(hi); ++i) {
        Span span{static_cast<std::int64_t>(i), {0, 0}};
        if (filter == TexelFilter::Linear)
            span.weight = {std::max(std::max(lo, i) - i - weight_error, 0.0),
                           std::min(std::min(hi, i + 1) - i + weight_error, 1.0)};
        all.push_back(span);
    }
    return all;
}

Bounds Lookup::border() const {
    Bounds b;
    b.lo = b.hi = {0, 0, 0, 1};
    for (int c = 0; c < image_.components; ++c) {
        const auto i = static_cast<std::size_t>(c);
        b.lo[i] = sampler_.border[c] - precision_.border_error;
        b.hi[i] = sampler_.border[c] + precision_.border_error;
        if (!image_.unit_range) continue;
        b.lo[i] = std::clamp(b.lo[i], 0.0, 1.0);
        b.hi[i] = std::clamp(b.hi[i], 0.0, 1.0);
    }
    return compared(b);
}

Bounds Lookup::tap(const Image::Level& level, std::int64_t u, std::int64_t v) const {
    const std::int64_t x = address(sampler_.address_u, u, level.width);
    const std::int64_t y = address(sampler_.address_v, v, level.height);
    if (x < 0 || y < 0) return border();
    const Color& texel = level.texels[static_cast<std::size_t>(y * level.width + x)];
    return compared({texel, texel});
}

/// The result of the comparison in place of the texel. D3D11.3 22.4.19
Bounds Lookup::compared(const Bounds& texel) const {
    if (!request_.reference) return texel;
    const Outcome outcome =
        compare(sampler_.compare, reference_, {texel.lo[0] * (1 - decode_error_), texel.hi[0] * (1 + decode_error_)});
    Bounds result;
    result.lo.fill(outcome.may_fail ? 0.0 : 1.0);
    result.hi.fill(outcome.may_pass ? 1.0 : 0.0);
    return result;
}

}  // namespace verify
