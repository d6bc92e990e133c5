#include "tests/oracle/sampler.h"

#include "tests/oracle/interval.h"
#include "tests/oracle/level_of_detail.h"
#include "tests/oracle/texel.h"

#include <algorithm>
#include <cmath>

namespace oracle {

using gnomon::AddressMode;
using gnomon::Profile;
using gnomon::Sampler;

std::uint32_t Contents::code(int level, int layer, int x, int y, int component) const {
    const auto components = static_cast<std::size_t>(gnomon::format_info(format).components);
    const auto texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_of(level)) + static_cast<std::size_t>(x);
    return codes[static_cast<std::size_t>(level * layers + layer)][texel * components + static_cast<std::size_t>(component)];
}

namespace {

// --- One axis: coordinate to texel and weight -----------------------------------------------------------------------------

/// The left texel and the weight of the right one; only the texel where the filter is nearest.
struct Place {
    std::int64_t texel = 0;
    double weight = 0;

    bool operator==(const Place&) const = default;
};

double nearest_even(double x) {
    const double whole = std::floor(x);
    const double rest = x - whole;
    return rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0) ? whole + 1 : whole;
}

/// Scaled coordinate to fixed point. D3D11.3 3.2.4.1
Place place_of(double scaled, const Profile& profile) {
    if (std::isnan(scaled)) scaled = 0;
    const double floor = std::floor(scaled);
    if (profile.texel_fraction_bits == gnomon::kExactBits)
        return {static_cast<std::int64_t>(floor), Arithmetic(profile).round(scaled - floor)};
    const double one = std::ldexp(1.0, profile.texel_fraction_bits);
    const auto round = [&](double x) {
        return profile.texel_rounding == gnomon::FixedRounding::NearestEven ? nearest_even(x) : std::floor(x);
    };
    // The fraction of an unrounded coordinate is an operation of its own.
    if (profile.texel_carry == gnomon::TexelCarry::Weight)
        return {static_cast<std::int64_t>(floor), round(Arithmetic(profile).round(scaled - floor) * one) / one};
    const double code = round(scaled * one);
    const double texel = std::floor(code / one);
    return {static_cast<std::int64_t>(texel), code / one - texel};
}

/// ReduceRange, one rounding per operation. D3D11.3 7.18.6
double reduced(double u, AddressMode mode, const Arithmetic& arithmetic) {
    switch (mode) {
        case AddressMode::Wrap: return arithmetic.round(u - std::floor(u));
        case AddressMode::Mirror: {
            const double half = arithmetic.round(u / 2);
            return arithmetic.round(arithmetic.round(half - std::trunc(half)) * 2);
        }
        case AddressMode::Clamp:
        case AddressMode::Border:
        case AddressMode::MirrorOnce: return u <= -10 ? -10 : u >= 10 ? 10 : u;
    }
    return 0;
}

/// The texel coordinate of a normalised one. D3D11.3 7.18.7, 7.18.8
double scaled(double normalised, int size, bool linear, const Arithmetic& arithmetic) {
    const double s = arithmetic.round(normalised * size);
    return linear ? arithmetic.round(s - 0.5) : s;
}

/// The texel an index stands for, or -1 for the border colour. D3D11.3 7.18.9
std::int64_t addressed(std::int64_t t, std::int64_t n, AddressMode mode) {
    if (t >= 0 && t <= n - 1) return t;
    switch (mode) {
        case AddressMode::Wrap: t %= n; return t < 0 ? t + n : t;
        case AddressMode::Mirror: {
            if (t < 0) t = -t - 1;
            const bool flip = (t / n & 1) != 0;
            t %= n;
            return flip ? n - t - 1 : t;
        }
        case AddressMode::Clamp: return std::clamp<std::int64_t>(t, 0, n - 1);
        case AddressMode::MirrorOnce:
            if (t < 0) t = -t - 1;
            return std::clamp<std::int64_t>(t, 0, n - 1);
        case AddressMode::Border: return -1;
    }
    return 0;
}

/// Every place in an interval of scaled coordinates: its ends, and both sides of each whole texel between. Between those the
/// filter is linear in the coordinate. Empty where there are too many.
std::vector<Place> places_in(const Interval& s, const Profile& profile) {
    const Place first = place_of(s.low, profile);
    const Place last = place_of(s.high, profile);
    if (!(s.high - s.low < 6)) return {};
    std::vector<Place> places{first};
    const double step =
        profile.texel_fraction_bits == gnomon::kExactBits ? 0x1p-52 : std::ldexp(1.0, -profile.texel_fraction_bits);
    for (std::int64_t k = first.texel; k <= last.texel + 1; ++k) {
        const auto whole = static_cast<double>(k);
        if (whole <= s.low - step || whole >= s.high + step) continue;
        const auto add = [&](const Place& p) {
            const double at = static_cast<double>(p.texel) + p.weight;
            if (at > static_cast<double>(first.texel) + first.weight && at < static_cast<double>(last.texel) + last.weight)
                places.push_back(p);
        };
        add({k - 1, 1 - step});
        if (profile.texel_carry == gnomon::TexelCarry::Weight) add({k - 1, 1});
        add({k, 0});
        add({k, step});
    }
    if (last != first) places.push_back(last);
    return places;
}

// --- Taps and their sums --------------------------------------------------------------------------------------------------

struct Tap {
    std::array<double, 4> value{};
    double weight = 0;
    bool approximate = false;         // the mean at a cube's corner
    std::array<double, 4> largest{};  // magnitude of what it is the mean of
};

/// One component of a partial sum: what it may be, before rounding.
struct Part {
    bool finite = false;
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    bool nan = false;
    bool up = false;
    bool down = false;
    double least = HUGE_VAL;  // of the texels under it
    double most = -HUGE_VAL;
    bool moved = false;        // one texel, no arithmetic
    bool approximate = false;  // a texel is itself a rounded mean

    [[nodiscard]] bool number() const { return finite || up || down; }
};
using Parts = std::array<Part, 4>;

Part hull(const Part& a, const Part& b) {
    return {.finite = a.finite || b.finite,
            .low = std::fmin(a.low, b.low),
            .high = std::fmax(a.high, b.high),
            .nan = a.nan || b.nan,
            .up = a.up || b.up,
            .down = a.down || b.down,
            .least = std::fmin(a.least, b.least),
            .most = std::fmax(a.most, b.most),
            .moved = a.moved && b.moved,
            .approximate = a.approximate || b.approximate};
}

Part part_of(double value) {
    Part part{.nan = std::isnan(value), .up = value == HUGE_VAL, .down = value == -HUGE_VAL};
    if (std::isfinite(value)) {
        part.finite = true;
        part.low = part.high = part.least = part.most = value;
    }
    return part;
}

Part part_of(const Tap& tap, std::size_t component) {
    Part part = part_of(tap.value[component]);
    part.approximate = tap.approximate;
    if (tap.approximate && part.finite) {
        part.least = -tap.largest[component];
        part.most = tap.largest[component];
    }
    return part;
}

/// How infinities meet: as terms of a sum, or in a difference first, where equal ones cancel.
enum class Infinities { Terms, Differences };

/// The weighted sum of two; weights are positive.
Part weighted(const Part& a, double wa, const Part& b, double wb, Infinities infinities) {
    Part sum = hull(a, b);
    sum.moved = false;
    sum.finite = a.finite && b.finite;
    sum.low = sum.finite ? wa * a.low + wb * b.low : HUGE_VAL;
    sum.high = sum.finite ? wa * a.high + wb * b.high : -HUGE_VAL;
    sum.up = (a.up && b.number()) || (b.up && a.number());
    sum.down = (a.down && b.number()) || (b.down && a.number());
    sum.nan = a.nan || b.nan || (a.up && b.down) || (a.down && b.up);
    if (infinities == Infinities::Differences) sum.nan = sum.nan || sum.up || sum.down;
    return sum;
}

/// The least or greatest of two; what is no number is passed over. D3D11.3 3.1.3.1
Part reduced(const Part& a, const Part& b, gnomon::Reduction reduction) {
    if (!a.number()) return b;
    if (!b.number()) return a;
    const auto widened = [](const Part& p) {
        Interval i{p.low, p.high};
        if (p.up) i = hull(i, point(HUGE_VAL));
        if (p.down) i = hull(i, point(-HUGE_VAL));
        return i;
    };
    const Interval x = widened(a);
    const Interval y = widened(b);
    Interval r = reduction == gnomon::Reduction::Minimum ? min(x, y) : max(x, y);
    if (a.nan) r = hull(r, y);
    if (b.nan) r = hull(r, x);
    Part part = hull(a, b);
    part.moved = false;
    part.nan = a.nan && b.nan;
    part.up = r.high == HUGE_VAL;
    part.down = r.low == -HUGE_VAL;
    part.finite = (a.finite || b.finite) && r.low < HUGE_VAL && r.high > -HUGE_VAL;
    part.low = part.finite ? (part.down ? part.least : r.low) : HUGE_VAL;
    part.high = part.finite ? (part.up ? part.most : r.high) : -HUGE_VAL;
    return part;
}

/// Position of one probe: texel coordinates that are known, or intervals of normalised ones.
struct Probe {
    bool exact = true;
    double u = 0;
    double v = 0;
    Interval wide_u{};
    Interval wide_v{};
};

/// Everything about one sample that does not depend on the probe.
class Sampling {
public:
    Sampling(const Contents& contents, const Sampler& sampler, const Profile& profile, const Question& question)
        : contents_(contents),
          sampler_(sampler),
          profile_(profile),
          question_(question),
          arithmetic_(profile),
          info_(gnomon::format_info(contents.format)) {
        components_ = question.reference ? 1 : static_cast<std::size_t>(info_.components);
        // A reference that is no number: nothing says what clamping makes of it. D3D11.3 22.4.19
        if (question.reference) {
            const double r = arithmetic_.round(*question.reference);
            references_ = {compared_reference(contents.format, profile, r)};
            if (std::isnan(references_[0])) references_ = {references_[0], 0.0, 1.0};
        }
    }

    [[nodiscard]] std::size_t alternatives() const { return references_.empty() ? 1 : references_.size(); }
    void choose(std::size_t alternative) {
        if (!references_.empty()) reference_ = references_[alternative];
    }

    /// Formats of 32-bit floats may be beyond the filter; depth formats are not among them.
    [[nodiscard]] bool point_sampled() const {
        return !profile_.filters_float32 && info_.type == gnomon::ComponentType::Float32;
    }
    [[nodiscard]] bool linear(bool magnified) const {
        if (point_sampled()) return false;
        return (magnified ? sampler_.mag : sampler_.min) == gnomon::TexelFilter::Linear;
    }
    [[nodiscard]] std::size_t components() const { return components_; }

    /// The result of a comparison with a code.
    [[nodiscard]] double compared(std::uint32_t code) const {
        return passes(sampler_.compare, reference_, compared_texel(contents_.format, profile_, code)) ? 1.0 : 0.0;
    }

    /// The slice of an array: nearest even, then the clamp. D3D11.3 22.4.15
    [[nodiscard]] int slice() const {
        if (contents_.kind != Kind::Array) return 0;
        const double w = arithmetic_.round(question_.coordinate[2]);
        if (std::isnan(w)) return 0;
        return static_cast<int>(std::clamp(nearest_even(w), 0.0, static_cast<double>(contents_.layers - 1)));
    }

    /// One level under one probe; `level` counts in the texture.
    [[nodiscard]] Parts level(const Probe& probe, int layer, int level, bool linear) const {
        const int w = contents_.width_of(level);
        const int h = contents_.height_of(level);
        std::vector<Place> us;
        std::vector<Place> vs;
        if (probe.exact) {
            us = {place_of(scaled(probe.u, w, linear, arithmetic_), profile_)};
            vs = {place_of(scaled(probe.v, h, linear, arithmetic_), profile_)};
        } else {
            us = places(probe.wide_u, probe.u, w, sampler_.address_u, linear);
            vs = places(probe.wide_v, probe.v, h, sampler_.address_v, linear);
        }
        if (us.empty() || vs.empty()) return anywhere(level, layer);
        Parts all{};
        bool first = true;
        for (const Place& u : us) {
            for (const Place& v : vs) {
                const Parts parts = combine(linear ? footprint(level, layer, u, v) : nearest(level, layer, u, v), !linear);
                for (std::size_t c = 0; c < 4; ++c) all[c] = first ? parts[c] : hull(all[c], parts[c]);
                first = false;
            }
        }
        return all;
    }

    /// The four texels under a bilinear filter, zero weights included: (floor, floor), (ceil, floor), (floor, ceil), (ceil,
    /// ceil).
    [[nodiscard]] std::vector<Tap> footprint(int level, int layer, const Place& u, const Place& v) const {
        std::vector<Tap> taps;
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 2; ++i) {
                Tap tap = fetch(level, layer, u.texel + i, v.texel + j);
                tap.weight = (i == 0 ? 1 - u.weight : u.weight) * (j == 0 ? 1 - v.weight : v.weight);
                taps.push_back(tap);
            }
        }
        return taps;
    }

    [[nodiscard]] Place place(double coordinate, int size, AddressMode mode, bool linear) const {
        return place_of(scaled(reduced_exactly(coordinate, mode), size, linear, arithmetic_), profile_);
    }
    [[nodiscard]] double reduced_exactly(double coordinate, AddressMode mode) const {
        return oracle::reduced(arithmetic_.round(coordinate), mode, arithmetic_);
    }

    [[nodiscard]] Part mix(const Part& fine, const Part& coarse, double weight) const {
        if (weight == 0) return fine;
        if (sampler_.reduction != gnomon::Reduction::Average) return reduced(fine, coarse, sampler_.reduction);
        return weighted(fine, 1 - weight, coarse, weight, infinities());
    }

    [[nodiscard]] const Arithmetic& arithmetic() const { return arithmetic_; }

private:
    /// The form "lerp" takes what is not finite from a (1 - w) + b w.
    [[nodiscard]] Infinities infinities() const {
        const auto form = profile_.bilinear_form;
        const bool terms = form == gnomon::BilinearForm::Lerp || form == gnomon::BilinearForm::Products;
        return terms ? Infinities::Terms : Infinities::Differences;
    }

    [[nodiscard]] std::vector<Place> places(const Interval& wide, double centre, int size, AddressMode mode,
                                            bool linear) const {
        // Coordinates that are not finite stay so, whatever is added.
        if (!std::isfinite(centre)) return {place(centre, size, mode, linear)};
        if (!(wide.high - wide.low < 1)) return {};
        Interval p = wide;
        switch (mode) {
            case AddressMode::Wrap: p = {wide.low - std::floor(wide.low), wide.high - std::floor(wide.low)}; break;
            case AddressMode::Mirror: {
                const double tile = 2 * std::floor(wide.low / 2);
                p = {wide.low - tile, wide.high - tile};
                break;
            }
            case AddressMode::Clamp:
            case AddressMode::Border:
            case AddressMode::MirrorOnce: p = {std::clamp(wide.low, -10.0, 10.0), std::clamp(wide.high, -10.0, 10.0)}; break;
        }
        // Four roundings at most: the reduction (two), the scaling and the half texel.
        const double error = 4 * arithmetic_.unit() * (size * std::fmax(1.0, p.magnitude()) + 1);
        const double half = linear ? 0.5 : 0.0;
        return places_in({p.low * size - half - error, p.high * size - half + error}, profile_);
    }

    [[nodiscard]] double decoded(int level, int layer, std::int64_t x, std::int64_t y, std::size_t c) const {
        const std::uint32_t code = contents_.code(level, layer, static_cast<int>(x), static_cast<int>(y), static_cast<int>(c));
        if (question_.reference) return compared(code);
        return texel_value(contents_.format, profile_, code, static_cast<int>(c));
    }

    [[nodiscard]] Tap texel(int level, int layer, std::int64_t x, std::int64_t y) const {
        Tap tap{.weight = 1};
        for (std::size_t c = 0; c < components_; ++c) tap.value[c] = decoded(level, layer, x, y, c);
        return tap;
    }

    [[nodiscard]] Tap border() const {
        Tap tap{.weight = 1};
        for (std::size_t c = 0; c < components_; ++c) {
            const float stated = sampler_.border[static_cast<glm::length_t>(c)];
            const double value = arithmetic_.round(border_value(contents_.format, profile_, stated));
            // The border meets the reference at the precision of the format. D3D11.3 7.18.9.1
            tap.value[c] =
                question_.reference
                    ? (passes(sampler_.compare, reference_, compared_reference(contents_.format, profile_, value)) ? 1.0 : 0.0)
                    : value;
        }
        return tap;
    }

    /// The texel at an index that may lie outside.
    [[nodiscard]] Tap fetch(int level, int layer, std::int64_t x, std::int64_t y) const {
        const int w = contents_.width_of(level);
        const int h = contents_.height_of(level);
        if (contents_.kind == Kind::Cube) return fetch_cube(level, layer, x, y, w);
        const std::int64_t tx = addressed(x + question_.offset[0], w, sampler_.address_u);
        const std::int64_t ty = addressed(y + question_.offset[1], h, sampler_.address_v);
        if (tx < 0 || ty < 0) return border();
        return texel(level, layer, tx, ty);
    }

    /// Past one edge the adjacent face, past two the mean of the others. D3D11.3 7.18.12
    [[nodiscard]] Tap fetch_cube(int level, int face, std::int64_t x, std::int64_t y, int n) const {
        const bool out_x = x < 0 || x >= n;
        const bool out_y = y < 0 || y >= n;
        const std::int64_t inside_x = std::clamp<std::int64_t>(x, 0, n - 1);
        const std::int64_t inside_y = std::clamp<std::int64_t>(y, 0, n - 1);
        if ((!out_x && !out_y) || profile_.cube_edges == gnomon::CubeEdges::PerFace)
            return texel(level, face, inside_x, inside_y);
        if (out_x && out_y) {
            const Tap a = fetch_cube(level, face, inside_x, y, n);
            const Tap b = fetch_cube(level, face, x, inside_y, n);
            const Tap c = texel(level, face, inside_x, inside_y);
            Tap mean{.weight = 1, .approximate = true};
            for (std::size_t i = 0; i < components_; ++i) {
                const bool three = profile_.cube_corner == gnomon::CubeCorner::ThreeTexels;
                mean.largest[i] = std::fmax(std::fabs(a.value[i]), std::fabs(b.value[i]));
                if (three) mean.largest[i] = std::fmax(mean.largest[i], std::fabs(c.value[i]));
                mean.value[i] = three ? (a.value[i] + b.value[i] + c.value[i]) / 3 : (a.value[i] + b.value[i]) / 2;
            }
            return mean;
        }
        // Fold the plane of the face over its edge: the texel beyond it lies as far down the adjacent face as it lay outside.
        const CubeFace from = cube_face(face);
        const auto centre = [&](std::int64_t i) { return (2.0 * static_cast<double>(i) + 1.0) / n - 1.0; };
        double s = centre(x);
        double t = centre(y);
        const double depth = 1.0 - 1.0 / n;
        if (out_x) s = s < 0 ? -1.0 : 1.0;
        if (out_y) t = t < 0 ? -1.0 : 1.0;
        std::array<double, 3> point{};
        point[static_cast<std::size_t>(from.axis[0])] = s * from.sign[0];
        point[static_cast<std::size_t>(from.axis[1])] = t * from.sign[1];
        point[static_cast<std::size_t>(from.major)] = depth * from.major_sign;
        const int axis = out_x ? from.axis[0] : from.axis[1];
        const CubeFace to = cube_face(2 * axis + (point[static_cast<std::size_t>(axis)] < 0 ? 1 : 0));
        const auto index = [&](std::size_t i) {
            const double at = to.sign[i] * point[static_cast<std::size_t>(to.axis[i])];
            return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((at + 1.0) / 2.0 * n)), 0, n - 1);
        };
        return texel(level, to.face, index(0), index(1));
    }

    [[nodiscard]] std::vector<Tap> nearest(int level, int layer, const Place& u, const Place& v) const {
        // A point sample at the far edge of a face is the face's own last texel.
        if (contents_.kind == Kind::Cube) {
            const std::int64_t last = contents_.width_of(level) - 1;
            return {
                texel(level, layer, std::clamp<std::int64_t>(u.texel, 0, last), std::clamp<std::int64_t>(v.texel, 0, last))};
        }
        return {fetch(level, layer, u.texel, v.texel)};
    }

    [[nodiscard]] Parts combine(const std::vector<Tap>& taps, bool moved) const {
        Parts parts{};
        for (std::size_t c = 0; c < components_; ++c) {
            Part& sum = parts[c];
            bool first = true;
            bool leaks = false;
            for (const Tap& tap : taps) {
                // a + 0 (b - a) of an infinite a: differences make NaN of it even where the other weight is 0.
                const bool differences = infinities() == Infinities::Differences && taps.size() > 1;
                leaks = leaks || (differences && !std::isfinite(tap.value[c]));
                // What is not finite may or may not be propagated with weight 0; the form "lerp" does not. D3D11.3 7.18.16.2
                if (tap.weight == 0) {
                    leaks = leaks || !std::isfinite(tap.value[c]);
                    continue;
                }
                const Part one = part_of(tap, c);
                if (first) {
                    sum = one;
                } else if (sampler_.reduction != gnomon::Reduction::Average) {
                    sum = reduced(sum, one, sampler_.reduction);
                } else {
                    sum = weighted(sum, 1, one, tap.weight, infinities());
                }
                if (first && sampler_.reduction == gnomon::Reduction::Average) {
                    sum.low *= tap.weight;
                    sum.high *= tap.weight;
                }
                first = false;
            }
            sum.moved = moved;
            const bool average = sampler_.reduction == gnomon::Reduction::Average;
            sum.nan = sum.nan || (leaks && average && profile_.bilinear_form != gnomon::BilinearForm::Lerp);
        }
        return parts;
    }

    /// Any texel of a level.
    [[nodiscard]] Parts anywhere(int level, int layer) const {
        Parts parts{};
        const bool borders = sampler_.address_u == AddressMode::Border || sampler_.address_v == AddressMode::Border;
        const Tap outside = border();
        for (std::size_t c = 0; c < components_; ++c) {
            bool first = true;
            const auto add = [&](double value) {
                Part part = part_of(value);
                part.nan = part.nan || part.up || part.down;
                parts[c] = first ? part : hull(parts[c], part);
                first = false;
            };
            if (question_.reference) {
                add(0);
                add(1);
                continue;
            }
            for (int y = 0; y < contents_.height_of(level); ++y)
                for (int x = 0; x < contents_.width_of(level); ++x) add(decoded(level, layer, x, y, c));
            if (borders) add(outside.value[c]);
        }
        return parts;
    }

    const Contents& contents_;
    const Sampler& sampler_;
    const Profile& profile_;
    const Question& question_;
    Arithmetic arithmetic_;
    gnomon::FormatInfo info_;
    std::size_t components_ = 0;
    std::vector<double> references_;
    double reference_ = 0;
};

/// Where probe `i` of `n` lies on the line, in lines from its middle.
double station(int i, int n, gnomon::ProbePlacement placement) {
    switch (placement) {
        case gnomon::ProbePlacement::Interior: return (i + 1.0) / (n + 1.0) - 0.5;
        case gnomon::ProbePlacement::Centred:
        case gnomon::ProbePlacement::Ewa: return (i + 0.5) / n - 0.5;
    }
    return 0;
}

Outcome constant(double value) { return {.low = value, .high = value, .bits = true, .ideal_low = value, .ideal_high = value}; }

/// The allowance for rounding, derived from the operations of a filter.
struct Rounding {
    bool linear = false;   // two lerps in u and one in v, or four products
    bool between = false;  // of levels: one lerp more
    int probes = 1;
    double lod_width = 0;  // of levels of detail that nothing quantises
    double texel = 0;      // relative error of the texels themselves
};

/// A lerp a + w (b - a) errs by at most 5 roundings of the largest texel: the difference (2, as it may be twice as large), the
/// product (2) and the sum (1). In the second direction the errors of the first arrive with weights that sum to 1: 10. Products
/// of 16-bit weights are exact: 1 for the product and 3 for the sums. N probes are N - 1 sums and a product with a rounded 1/N:
/// N + 1. The mean at a corner has two sums and a rounded third: 4. In double the oracle itself errs as much again.
Outcome outcome_of(const Part& part, const Rounding& rounding, const Sampler& sampler, const Profile& profile,
                   const Arithmetic& arithmetic) {
    Outcome outcome{
        .finite = part.finite, .low = part.low, .high = part.high, .nan = part.nan, .up = part.up, .down = part.down};
    outcome.ideal_low = part.low;
    outcome.ideal_high = part.high;
    outcome.uniform = part.finite && part.least == part.most && !part.approximate;
    outcome.bits = part.moved && rounding.probes == 1 && !rounding.between;
    const bool averages = sampler.reduction == gnomon::Reduction::Average;
    const bool numbers = part.least <= part.most;
    const double peak = numbers ? std::fmax(std::fabs(part.least), std::fabs(part.most)) : 0;
    double roundings = part.approximate ? 4 : 0;
    double operations = 1;
    if (averages) {
        roundings += (rounding.linear ? 10 : 0) + (rounding.between ? 5 : 0) + (rounding.probes > 1 ? rounding.probes + 1 : 0);
        operations =
            (rounding.linear ? 9 : 0) * 2 + (rounding.between ? 3 : 0) + (rounding.probes > 1 ? rounding.probes + 1 : 0);
    }
    if (!arithmetic.fp32) roundings *= 2;
    double allowance = roundings * arithmetic.unit() * peak + operations * arithmetic.tiny();
    allowance += rounding.lod_width * (part.finite ? part.most - part.least : 0);
    if (outcome.bits) allowance = 0;
    outcome.allowance = allowance;
    outcome.low -= allowance;
    outcome.high += allowance;
    if (!averages || outcome.bits) {
        outcome.low -= rounding.texel * peak;
        outcome.high += rounding.texel * peak;
        return outcome;
    }

    // "The output must fall between the min and the max values of the texels accessed." D3D11.3 7.18.16.3
    const bool ordered = profile.bilinear_form != gnomon::BilinearForm::Products && rounding.probes == 1 && !part.approximate &&
                         profile.texel_fraction_bits != gnomon::kExactBits;
    if (ordered && part.finite) {
        const double slack = operations * arithmetic.tiny();
        outcome.low = std::fmax(outcome.low, part.least - (part.least == part.most && peak >= arithmetic.tiny() ? 0 : slack));
        outcome.high = std::fmin(outcome.high, part.most + (part.least == part.most && peak >= arithmetic.tiny() ? 0 : slack));
    }
    outcome.low -= rounding.texel * peak;
    outcome.high += rounding.texel * peak;
    // Sums of probes near the largest number may pass it, and so may differences where nothing catches them.
    const bool catches = profile.bilinear_form == gnomon::BilinearForm::Lerp;
    const double difference = catches ? 0 : part.most - part.least;
    const double span = std::fmax(difference, rounding.probes > 1 || !catches ? rounding.probes * peak : 0);
    if (numbers && part.number() && span > arithmetic.largest() * (1 - 32 * arithmetic.unit()))
        outcome.nan = outcome.up = outcome.down = true;
    return outcome;
}

std::vector<Probe> probes_of(const Footprint& footprint, const Sampling& sampling, const Sampler& sampler,
                             const Profile& profile, const Question& question) {
    const Arithmetic& arithmetic = sampling.arithmetic();
    const double u = arithmetic.round(question.coordinate[0]);
    const double v = arithmetic.round(question.coordinate[1]);
    if (footprint.probes <= 1)
        return {{.u = sampling.reduced_exactly(u, sampler.address_u), .v = sampling.reduced_exactly(v, sampler.address_v)}};
    const IntervalMath math(arithmetic);
    std::vector<Probe> probes;
    for (int i = 0; i < footprint.probes; ++i) {
        // The station itself takes up to three roundings.
        const double t = station(i, footprint.probes, profile.probe_placement);
        const double t_error = t == 0 ? 0 : 3 * arithmetic.unit();
        const Interval along{t - t_error, t + t_error};
        probes.push_back({.exact = false,
                          .u = u,
                          .v = v,
                          .wide_u = math.add(point(u), math.mul(along, footprint.axis_u)),
                          .wide_v = math.add(point(v), math.mul(along, footprint.axis_v))});
    }
    return probes;
}

/// The probe of a cube: projected, then moved to [0, 1]. D3D11.3 7.18.7
Probe cube_probe(const CubeFace& face, const Arithmetic& arithmetic, const Question& question) {
    const auto at = [&](int i) { return arithmetic.round(question.coordinate[static_cast<std::size_t>(i)]); };
    const double major = std::fabs(at(face.major));
    const auto position = [&](std::size_t i) {
        const double projected = arithmetic.round(face.sign[i] * at(face.axis[i]) / major);
        return arithmetic.round(arithmetic.round(projected * 0.5) + 0.5);
    };
    return {.u = position(0), .v = position(1)};
}

Color color_of(const Parts& parts, const Rounding& rounding, const Sampling& sampling, const Sampler& sampler,
               const Profile& profile, bool compares) {
    Color color{};
    for (std::size_t c = 0; c < 4; ++c) {
        if (c < sampling.components()) {
            color[c] = outcome_of(parts[c], rounding, sampler, profile, sampling.arithmetic());
        } else {
            color[c] = compares ? color[0] : constant(missing_value(static_cast<int>(c)));
        }
    }
    return color;
}

}  // namespace

Answer sample(const Contents& contents, const Levels& view, const Sampler& sampler, const Profile& profile,
              const Question& question) {
    Answer answer;
    const std::array size{contents.width_of(view.base), contents.height_of(view.base)};
    Sampling sampling(contents, sampler, profile, question);
    Sampler effective = sampler;
    if (sampling.point_sampled()) {
        // One texel of one level. D3D11.3 7.18.16.3
        effective.max_anisotropy = 1;
        if (effective.mip == gnomon::MipFilter::Linear) effective.mip = gnomon::MipFilter::Nearest;
    }
    const auto footprints_found = footprints(contents.kind, size, effective, profile, question);
    answer.lod_low = HUGE_VAL;
    answer.lod_high = -HUGE_VAL;
    for (const Footprint& f : footprints_found) {
        answer.lod_nan = answer.lod_nan || f.lod_nan;
        if (f.lod_nan) continue;
        answer.lod_low = std::fmin(answer.lod_low, f.lod.low);
        answer.lod_high = std::fmax(answer.lod_high, f.lod.high);
    }

    // No level left: out of bounds, 0, which is also what a comparison sees. D3D11.3 5.8.5, 5.8.6.1
    if (view.min_lod - static_cast<float>(view.base) > static_cast<float>(view.count - 1)) {
        for (std::size_t alternative = 0; alternative < sampling.alternatives(); ++alternative) {
            sampling.choose(alternative);
            Color empty{};
            for (int c = 0; c < 4; ++c) {
                const double plain = c < gnomon::format_info(contents.format).components ? 0.0 : missing_value(c);
                empty[static_cast<std::size_t>(c)] = constant(question.reference ? sampling.compared(0) : plain);
            }
            answer.colors.push_back(empty);
        }
        return answer;
    }

    for (std::size_t alternative = 0; alternative < sampling.alternatives(); ++alternative) {
        sampling.choose(alternative);
        for (const Footprint& f : footprints_found) {
            // The probes, with the layer each samples; a direction that is no number may choose any face.
            std::vector<std::vector<Probe>> lines;
            std::vector<int> layers;
            if (contents.kind == Kind::Cube) {
                std::array<double, 3> direction{};
                for (std::size_t i = 0; i < 3; ++i) direction[i] = sampling.arithmetic().round(question.coordinate[i]);
                for (const CubeFace& face : cube_faces(direction)) {
                    lines.push_back({cube_probe(face, sampling.arithmetic(), question)});
                    layers.push_back(face.face);
                }
            } else {
                lines.push_back(probes_of(f, sampling, sampler, profile, question));
                layers.push_back(sampling.slice());
            }
            double lod_width = 0;
            const auto mips = mip_choices(f, view, effective, profile, question, lod_width);
            for (const MipChoice& mip : mips) {
                const bool linear = sampling.linear(mip.magnified);
                for (std::size_t line = 0; line < lines.size(); ++line) {
                    Parts total{};
                    bool first = true;
                    const auto n = static_cast<double>(lines[line].size());
                    for (const Probe& probe : lines[line]) {
                        const Parts fine = sampling.level(probe, layers[line], view.base + mip.fine, linear);
                        const bool two = mip.weight_high > 0 && mip.coarse != mip.fine;
                        const Parts coarse =
                            two ? sampling.level(probe, layers[line], view.base + mip.coarse, linear) : Parts{};
                        for (std::size_t c = 0; c < sampling.components(); ++c) {
                            Part part = two ? sampling.mix(fine[c], coarse[c], mip.weight) : fine[c];
                            if (two && mip.weight_high != mip.weight)
                                part = hull(part, sampling.mix(fine[c], coarse[c], mip.weight_high));
                            if (sampler.reduction != gnomon::Reduction::Average) {
                                total[c] = first ? part : reduced(total[c], part, sampler.reduction);
                            } else if (first) {
                                total[c] = part;
                                total[c].low /= n;
                                total[c].high /= n;
                            } else {
                                total[c] = weighted(total[c], 1, part, 1 / n, Infinities::Terms);
                            }
                        }
                        first = false;
                    }
                    const Rounding rounding{.linear = linear,
                                            .between = mip.weight_high > 0,
                                            .probes = static_cast<int>(lines[line].size()),
                                            .lod_width = lod_width,
                                            .texel = question.reference ? 0 : texel_error(contents.format, profile)};
                    answer.colors.push_back(
                        color_of(total, rounding, sampling, sampler, profile, question.reference.has_value()));
                }
            }
        }
    }
    return answer;
}

Color gather(const Contents& contents, const Levels& view, const Sampler& sampler, const Profile& profile,
             const Question& question, int component) {
    Sampling sampling(contents, sampler, profile, question);
    sampling.choose(0);
    Color color{};
    // Without the view's finest level the texels are out of bounds: 0. D3D11.3 5.8.4, 5.8.6.1
    if (view.min_lod - static_cast<float>(view.base) >= 1.0f ||
        view.min_lod - static_cast<float>(view.base) > static_cast<float>(view.count - 1)) {
        const bool missing = component >= gnomon::format_info(contents.format).components;
        color.fill(constant(question.reference ? sampling.compared(0) : missing ? missing_value(component) : 0));
        return color;
    }
    int layer = sampling.slice();
    Place u;
    Place v;
    const int w = contents.width_of(view.base);
    const int h = contents.height_of(view.base);
    if (contents.kind == Kind::Cube) {
        std::array<double, 3> direction{};
        for (std::size_t i = 0; i < 3; ++i) direction[i] = sampling.arithmetic().round(question.coordinate[i]);
        const CubeFace face = cube_faces(direction).front();
        const Probe probe = cube_probe(face, sampling.arithmetic(), question);
        layer = face.face;
        u = place_of(scaled(probe.u, w, true, sampling.arithmetic()), profile);
        v = place_of(scaled(probe.v, h, true, sampling.arithmetic()), profile);
    } else {
        u = sampling.place(question.coordinate[0], w, sampler.address_u, true);
        v = sampling.place(question.coordinate[1], h, sampler.address_v, true);
    }
    // (-, +), (+, +), (+, -), (-, -): v grows downward.
    const std::vector<Tap> taps = sampling.footprint(view.base, layer, u, v);
    for (const auto& [to, from] : {std::pair<std::size_t, std::size_t>{0, 2}, {1, 3}, {2, 1}, {3, 0}}) {
        const Tap& tap = taps[from];
        const bool present = component < gnomon::format_info(contents.format).components;
        Part part = present ? part_of(tap, static_cast<std::size_t>(component)) : part_of(missing_value(component));
        // Integers arrive as numbers of the profile's arithmetic.
        if (gnomon::format_info(contents.format).is_integer() && !tap.approximate)
            part = part_of(sampling.arithmetic().round(part.low));
        part.moved = !tap.approximate;
        const Rounding rounding{.texel = question.reference ? 0 : texel_error(contents.format, profile)};
        color[to] = outcome_of(part, rounding, sampler, profile, sampling.arithmetic());
        color[to].denormals = !tap.approximate;  // D3D11.3 22.4.2: a synthesised texel may be flushed
    }
    return color;
}

bool Outcome::accepts(double got) const {
    if (std::isnan(got)) return nan;
    if (got == HUGE_VAL) return up || (finite && high == HUGE_VAL);
    if (got == -HUGE_VAL) return down || (finite && low == -HUGE_VAL);
    if (!finite) return false;
    // A denormal that was moved or made may or may not be flushed. D3D11.3 22.4.2, 22.4.15
    const bool tiny = std::fabs(low) < 0x1p-126 && std::fabs(high) < 0x1p-126;
    const bool same_sign = std::signbit(got) == std::signbit(low);
    if (!denormals && got == 0 && tiny && (!bits || low != high || same_sign)) return true;
    return got >= low && got <= high && (!bits || low != high || same_sign);
}

bool Answer::accepts(const std::array<double, 4>& got) const {
    return std::any_of(colors.begin(), colors.end(), [&](const Color& color) {
        for (std::size_t c = 0; c < 4; ++c)
            if (!color[c].accepts(got[c])) return false;
        return true;
    });
}

bool Answer::accepts_lod(double got) const {
    if (std::isnan(got)) return lod_nan;
    return got >= lod_low && got <= lod_high;
}

double Answer::deviation(const std::array<double, 4>& got) const {
    double least = HUGE_VAL;
    for (const Color& color : colors) {
        double worst = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            if (!color[c].accepts(got[c])) worst = HUGE_VAL;
            if (!std::isfinite(got[c]) || !color[c].finite) continue;
            const double outside = std::fmax(color[c].ideal_low - got[c], got[c] - color[c].ideal_high);
            const double allowed = color[c].allowance;
            // Not where the oracle's own double sums show, or where all that is allowed is a flush to zero.
            if (outside > 0x1p-50 * std::fabs(got[c]) && allowed > 0x1p-100) worst = std::fmax(worst, outside / allowed);
        }
        least = std::fmin(least, worst);
    }
    return least;
}

}  // namespace oracle
