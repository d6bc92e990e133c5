// Filters, levels and probes in intervals, and the search for weights that make a result.
#include "tests/verify/lookup_verifier.h"

#include "tests/verify/lookup_footprint.h"
#include "tests/verify/lookup_texels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace verify {

using namespace gnomon;

namespace {

constexpr int kHalvings = 10;

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

Bounds negated(const Bounds& b) {
    Bounds result;
    for (std::size_t c = 0; c < 4; ++c) {
        result.lo[c] = -b.hi[c];
        result.hi[c] = -b.lo[c];
    }
    return result;
}

/// The smallest texel of one cell: at least the smallest that may have a weight, at most the smallest that must have one.
Bounds minimum(const Cell& cell, bool negate) {
    Bounds possible = nothing();
    Bounds certain;
    certain.hi.fill(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < 4; ++i) {
        const bool right = i % 2 == 1;
        const bool lower = i / 2 == 1;
        if ((right ? cell.a.hi : 1 - cell.a.lo) <= 0 || (lower ? cell.b.hi : 1 - cell.b.lo) <= 0) continue;
        const Bounds tap = negate ? negated(cell.tap[i]) : cell.tap[i];
        include(possible, tap);
        if ((right ? cell.a.lo : 1 - cell.a.hi) <= 0 || (lower ? cell.b.lo : 1 - cell.b.hi) <= 0) continue;
        for (std::size_t c = 0; c < 4; ++c) certain.hi[c] = std::min(certain.hi[c], tap.hi[c]);
    }
    for (std::size_t c = 0; c < 4; ++c) possible.hi[c] = std::min(possible.hi[c], certain.hi[c]);
    return possible;
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

/// Minimum or maximum over all probes and levels whose weight is not 0. D3D11.3 5.9.4.5.6
Bounds reduced(const Lookup& lookup, const Footprint& footprint, const Mips& mips, ProbePlacement placement, bool negate) {
    struct Level {
        int level = 0;
        Range weight;
    };
    Bounds possible = nothing();
    Color certain;
    certain.fill(std::numeric_limits<double>::infinity());
    for (const Level& level : {Level{mips.finer, {1 - mips.weight.hi, 1 - mips.weight.lo}}, Level{mips.coarser, mips.weight}}) {
        if (level.weight.hi <= 0) continue;
        for (int probe = 0; probe < footprint.probes; ++probe) {
            Bounds one = nothing();
            for (const Cell& cell :
                 lookup.cells(level.level, mips.filter, footprint, along_line(probe, footprint.probes, placement)))
                include(one, minimum(cell, negate));
            include(possible, one);
            if (level.weight.lo <= 0) continue;
            for (std::size_t c = 0; c < 4; ++c) certain[c] = std::min(certain[c], one.hi[c]);
        }
    }
    for (std::size_t c = 0; c < 4; ++c) possible.hi[c] = std::min(possible.hi[c], certain[c]);
    return negate ? negated(possible) : possible;
}

/// Whether a result lies within what one footprint makes of one choice of levels; widens `seen` by that.
bool reaches(const Lookup& lookup, const Footprint& footprint, const Mips& mips, ProbePlacement placement, const Color& result,
             Bounds& seen) {
    if (lookup.reduction() != Reduction::Average && !footprint.any_weights) {
        const Bounds all = reduced(lookup, footprint, mips, placement, lookup.reduction() == Reduction::Maximum);
        include(seen, all);
        return holds(all, result, lookup.tolerance());
    }
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
        // Of minima and maxima either level may hold the last; a filter of one level may choose either.
        const bool either = lookup.reduction() != Reduction::Average || footprint.one_level;
        all = lerp(finer, coarser, either ? 0 : weight.lo);
        include(all, lerp(finer, coarser, either ? 1 : weight.hi));
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
