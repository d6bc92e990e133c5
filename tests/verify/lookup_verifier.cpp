#include "tests/verify/lookup_verifier.h"

#include "tests/verify/lookup_footprint.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

namespace verify {

using namespace gnomon;

namespace {

constexpr int kHalvings = 10;

/// What a texel, a filter or a whole sample may be, component by component.
struct Bounds {
    Color lo{};
    Color hi{};
};

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

/// Four taps and the weights of the right and of the lower ones. A nearest filter repeats its texel.
struct Cell {
    std::array<Bounds, 4> tap;  // (0,0), (1,0), (0,1), (1,1)
    Range a;                    // of u
    Range b;                    // of v
};

Bounds at(const Cell& cell, double a, double b) {
    return lerp(lerp(cell.tap[0], cell.tap[1], a), lerp(cell.tap[2], cell.tap[3], a), b);
}

/// Exact for points as taps: a bilinear function has its extremes over a box of weights at the corners.
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

/// Where along one axis a filter may be: texel indices before the address mode, and the weight of the second.
struct Span {
    std::int64_t first = 0;
    Range weight;
};

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

/// The texels and the arithmetic of one request.
class Lookup {
public:
    Lookup(const Image& image, const Sampler& sampler, const LookupPrecision& precision, const SampleRequest& request)
        : image_(image), sampler_(sampler), precision_(precision), request_(request) {
        if (request.reference) {
            reference_ = {*request.reference, *request.reference};
            if (precision.reference_quantised && image.unit_range)
                reference_ = {std::clamp(reference_.lo, 0.0, 1.0), std::clamp(reference_.hi, 0.0, 1.0)};
            // A code of a depth format of integers: the nearest, ties either way. D3D11.3 17.11
            if (precision.reference_quantised && image.depth_codes > 0) {
                const double code = reference_.lo * image.depth_codes;
                const double slack = code * 4 * precision.epsilon;
                reference_ = {std::ceil(code - 0.5 - slack) / image.depth_codes,
                              std::floor(code + 0.5 + slack) / image.depth_codes};
            }
        }
        const double largest = request.reference ? 1.0 : image.largest_texel;
        tolerance_ = precision.color_absolute + precision.color_relative * largest;
    }

    [[nodiscard]] double tolerance() const { return tolerance_; }
    [[nodiscard]] int last_level() const { return static_cast<int>(image_.levels.size()) - 1; }

    /// Every cell that a filter may find itself in, `along` of the way along the line of anisotropy, [-1/2, 1/2].
    [[nodiscard]] std::vector<Cell> cells(int level, TexelFilter filter, const Footprint& footprint, double along) const {
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

    /// The extremes of everything under the ellipse's bounding box: the filter may be wider than the ellipse by half and by two
    /// texels, [Heckbert89] 3.5.8 adds one.
    [[nodiscard]] Bounds under_ellipse(int level, const Footprint& footprint) const {
        const Image::Level& texels = image_.levels[static_cast<std::size_t>(level)];
        const Image::Level& base = image_.levels[0];
        const auto range = [](double centre, double half) {
            return std::pair{static_cast<std::int64_t>(std::floor(centre - half)),
                             static_cast<std::int64_t>(std::floor(centre + half))};
        };
        const double half_u = 1.5 * footprint.extent_u * texels.width / base.width + 2;
        const double half_v = 1.5 * footprint.extent_v * texels.height / base.height + 2;
        const auto [u0, u1] = range(request_.coordinate[0] * texels.width + request_.offset.x, half_u);
        const auto [v0, v1] = range(request_.coordinate[1] * texels.height + request_.offset.y, half_v);
        Bounds all = nothing();
        for (std::int64_t v = v0; v <= v1; ++v)
            for (std::int64_t u = u0; u <= u1; ++u) include(all, tap(texels, u, v));
        return all;
    }

    /// The extremes of the image and the border.
    [[nodiscard]] Bounds anything() const {
        Bounds all = border();
        for (const Image::Level& level : image_.levels)
            for (std::int64_t y = 0; y < level.height; ++y)
                for (std::int64_t x = 0; x < level.width; ++x) include(all, tap(level, x, y));
        return all;
    }

private:
    [[nodiscard]] std::vector<Span> spans(double coordinate, double error, int size, int offset, TexelFilter filter) const {
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

    [[nodiscard]] Bounds border() const {
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

    [[nodiscard]] Bounds tap(const Image::Level& level, std::int64_t u, std::int64_t v) const {
        const std::int64_t x = address(sampler_.address_u, u, level.width);
        const std::int64_t y = address(sampler_.address_v, v, level.height);
        if (x < 0 || y < 0) return border();
        const Color& texel = level.texels[static_cast<std::size_t>(y * level.width + x)];
        return compared({texel, texel});
    }

    /// The result of the comparison in place of the texel. D3D11.3 22.4.19
    [[nodiscard]] Bounds compared(const Bounds& texel) const {
        if (!request_.reference) return texel;
        const Outcome outcome = compare(sampler_.compare, reference_, {texel.lo[0], texel.hi[0]});
        Bounds result;
        result.lo.fill(outcome.may_fail ? 0.0 : 1.0);
        result.hi.fill(outcome.may_pass ? 1.0 : 0.0);
        return result;
    }

    const Image& image_;
    const Sampler& sampler_;
    const LookupPrecision& precision_;
    const SampleRequest& request_;
    Range reference_;
    double tolerance_ = 0;
};

/// One choice of filter and levels, with the interval of the coarser one's weight.
struct Mips {
    TexelFilter filter = TexelFilter::Linear;
    int finer = 0;
    int coarser = 0;
    Range weight;
};

/// Filters and levels that an interval of clamped levels of detail may select. D3D11.3 7.18.10, 7.18.11
std::vector<Mips> mips_of(Range lod, const Sampler& sampler, const LookupPrecision& precision, int last) {
    std::vector<Mips> all;
    if (lod.lo <= 0) all.push_back({sampler.mag, 0, 0, {0, 0}});
    if (lod.hi <= 0) return all;
    const double lo = std::max(lod.lo, 0.0);
    const auto level = [last](double l) { return static_cast<int>(std::clamp(l, 0.0, static_cast<double>(last))); };
    switch (sampler.mip) {
        case MipFilter::Base: all.push_back({sampler.min, 0, 0, {0, 0}}); break;
        case MipFilter::Nearest: {
            // Half-way between two levels either may be meant: profiles differ.
            const int first = level(std::ceil(lo + 0.5) - 1);
            for (int l = first; l <= level(std::floor(lod.hi + 0.5)); ++l) all.push_back({sampler.min, l, l, {0, 0}});
            break;
        }
        case MipFilter::Linear: {
            const double error =
                precision.weight_bits >= 0 ? std::ldexp(precision.weight_rounding, -precision.weight_bits) : 0.0;
            for (double l = std::floor(lo); l <= std::floor(lod.hi) && l <= last; ++l) {
                const Range weight{std::max(std::max(lo, l) - l - error, 0.0),
                                   std::min(std::min(lod.hi, l + 1) - l + error, 1.0)};
                all.push_back({sampler.min, level(l), level(l + 1), weight});
            }
            if (std::floor(lo) > last) all.push_back({sampler.min, last, last, {0, 0}});
            break;
        }
    }
    return all;
}

Range clamped_lod(Range lod, const Sampler& sampler, const LookupPrecision& precision, const SampleRequest& request) {
    const double bias = static_cast<double>(sampler.lod_bias) + request.lod_bias;
    const auto clamp = [&](double l) { return std::max<double>(sampler.min_lod, std::min<double>(sampler.max_lod, l + bias)); };
    // Sums of numbers below 64.
    double rounding = 64 * precision.epsilon;
    if (precision.lod_bits >= 0) rounding += std::ldexp(precision.lod_rounding, -precision.lod_bits);
    return {clamp(lod.lo) - rounding, clamp(lod.hi) + rounding};
}

bool holds(const Bounds& bounds, const Color& result, double tolerance) {
    for (std::size_t c = 0; c < 4; ++c)
        if (!(result[c] >= bounds.lo[c] - tolerance && result[c] <= bounds.hi[c] + tolerance)) return false;
    return true;
}

double width_of(const Bounds& bounds) {
    double width = 0;
    for (std::size_t c = 0; c < 4; ++c) width = std::max(width, bounds.hi[c] - bounds.lo[c]);
    return width;
}

/// Whether some weights of the two cells and of the levels give the result: halves the weights until the bounds are as narrow
/// as the tolerance or exclude it.
bool reaches(const Cell& finer, const Cell& coarser, Range w, const Color& result, double tolerance, int halvings) {
    const Bounds f = hull(finer);
    Bounds c = f;
    Bounds all = f;
    const bool mixes = w.hi > 0;
    if (mixes) {
        c = hull(coarser);
        all = lerp(f, c, w.lo);
        include(all, lerp(f, c, w.hi));
    }
    if (!holds(all, result, tolerance)) return false;
    if (halvings == 0 || width_of(all) <= tolerance) return true;

    // Halve what moves the bounds most.
    const double of_finer = width_of(f) * (1 - w.lo);
    const double of_coarser = mixes ? width_of(c) * w.hi : 0;
    Bounds apart = f;
    include(apart, c);
    const double of_weight = mixes ? width_of(apart) * (w.hi - w.lo) : 0;
    if (of_weight >= of_finer && of_weight >= of_coarser) {
        const double middle = (w.lo + w.hi) / 2;
        if (middle <= w.lo || middle >= w.hi) return true;
        return reaches(finer, coarser, {w.lo, middle}, result, tolerance, halvings - 1) ||
               reaches(finer, coarser, {middle, w.hi}, result, tolerance, halvings - 1);
    }
    const bool in_finer = of_finer >= of_coarser;
    for (const bool upper : {false, true}) {
        Cell half = in_finer ? finer : coarser;
        Range& range = half.a.hi - half.a.lo >= half.b.hi - half.b.lo ? half.a : half.b;
        const double middle = (range.lo + range.hi) / 2;
        if (middle <= range.lo || middle >= range.hi) return true;
        (upper ? range.lo : range.hi) = middle;
        if (reaches(in_finer ? half : finer, in_finer ? coarser : half, w, result, tolerance, halvings - 1)) return true;
    }
    return false;
}

/// Ends of the way along the line: D3D11.3 leaves them open, so they are declared.
double along_line(int probe, int probes, ProbePlacement placement) {
    switch (placement) {
        case ProbePlacement::Interior: return (probe + 1.0) / (probes + 1.0) - 0.5;
        case ProbePlacement::Centred: return (probe + 0.5) / probes - 0.5;
        case ProbePlacement::Ewa: return 0;
    }
    return 0;
}

/// Whether a result lies within what one footprint makes of one choice of levels; widens `seen` by that.
bool reaches(const Lookup& lookup, const Footprint& footprint, const Mips& mips, ProbePlacement placement, const Color& result,
             Bounds& seen) {
    const bool one_level = mips.weight.hi == 0 || mips.finer == mips.coarser;
    const Range weight = one_level ? Range{0, 0} : mips.weight;
    if (!footprint.any_weights && footprint.probes == 1) {
        const std::vector<Cell> finer = lookup.cells(mips.finer, mips.filter, footprint, 0);
        const std::vector<Cell> coarser =
            one_level ? std::vector<Cell>(1) : lookup.cells(mips.coarser, mips.filter, footprint, 0);
        for (const Cell& f : finer)
            for (const Cell& c : coarser) {
                if (reaches(f, c, weight, result, lookup.tolerance(), kHalvings)) return true;
                const Bounds of_finer = hull(f);
                for (const double w : {weight.lo, weight.hi}) include(seen, w == 0 ? of_finer : lerp(of_finer, hull(c), w));
            }
        return false;
    }
    // The mean over the probes of what each may be.
    const auto level_bounds = [&](int level) {
        if (footprint.any_weights) return lookup.under_ellipse(level, footprint);
        Bounds sum;
        for (int probe = 0; probe < footprint.probes; ++probe) {
            const double along = along_line(probe, footprint.probes, placement);
            const Bounds one = hull(lookup.cells(level, mips.filter, footprint, along));
            for (std::size_t c = 0; c < 4; ++c) {
                sum.lo[c] += one.lo[c] / footprint.probes;
                sum.hi[c] += one.hi[c] / footprint.probes;
            }
        }
        return sum;
    };
    const Bounds finer = level_bounds(mips.finer);
    Bounds all = finer;
    if (!one_level) {
        const Bounds coarser = level_bounds(mips.coarser);
        all = lerp(finer, coarser, weight.lo);
        include(all, lerp(finer, coarser, weight.hi));
    }
    include(seen, all);
    return holds(all, result, lookup.tolerance());
}

std::string text(const Range& range) {
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "[%a, %a]", range.lo, range.hi);
    return buffer.data();
}

}  // namespace

bool is_legal(const Image& image, const Sampler& sampler, const LookupPrecision& precision, const SampleRequest& request,
              const Color& result, std::string* why) {
    const Lookup lookup(image, sampler, precision, request);
    const std::vector<Footprint> ways = footprints(image.levels[0].width, image.levels[0].height, sampler, precision, request);
    Bounds seen = nothing();
    for (const Footprint& footprint : ways) {
        if (footprint.unbounded) {
            const Bounds all = lookup.anything();
            if (holds(all, result, lookup.tolerance())) return true;
            include(seen, all);
            continue;
        }
        const Range lod = clamped_lod(footprint.lod, sampler, precision, request);
        for (const Mips& mips : mips_of(lod, sampler, precision, lookup.last_level()))
            if (reaches(lookup, footprint, mips, precision.probe_placement, result, seen)) return true;
    }
    if (why != nullptr) {
        *why = "level of detail and probes:";
        for (const Footprint& footprint : ways)
            *why +=
                " " + text(clamped_lod(footprint.lod, sampler, precision, request)) + " " + std::to_string(footprint.probes);
        *why += "; components together or one of them outside, each within " + text({-lookup.tolerance(), lookup.tolerance()}) +
                " of:";
        for (std::size_t c = 0; c < 4; ++c) *why += " " + text({seen.lo[c], seen.hi[c]});
    }
    return false;
}

bool is_legal_lod(const Image& image, const Sampler& sampler, const LookupPrecision& precision, const SampleRequest& request,
                  double lod, std::string* why) {
    const std::vector<Footprint> ways = footprints(image.levels[0].width, image.levels[0].height, sampler, precision, request);
    if (why != nullptr) *why = "level of detail:";
    for (const Footprint& footprint : ways) {
        const double rounding = 64 * precision.epsilon;
        if (footprint.unbounded || (lod >= footprint.lod.lo - rounding && lod <= footprint.lod.hi + rounding)) return true;
        if (why != nullptr) *why += " " + text(footprint.lod);
    }
    return false;
}

}  // namespace verify
