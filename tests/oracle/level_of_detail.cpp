#include "tests/oracle/level_of_detail.h"

#include <algorithm>
#include <cmath>

namespace oracle {

using gnomon::Profile;
using gnomon::Sampler;

namespace {

struct Vector {
    Interval u{};
    Interval v{};

    [[nodiscard]] bool is_zero() const { return u.is_zero() && v.is_zero(); }
};

struct Gradients {
    Vector x{};
    Vector y{};
};

bool finite(double a) { return std::isfinite(a); }
bool finite(const Question::Gradient& g) {
    for (const auto& d : {g.dx, g.dy})
        if (!finite(d[0]) || !finite(d[1]) || !finite(d[2])) return false;
    return true;
}

constexpr std::array kSteps{1, 2, 4, 6, 8, 10, 12, 16};

int probes_for(double ratio, int limit, const Profile& profile) {
    if (!(ratio < 64)) return limit;
    int count = 1;
    switch (profile.probe_count) {
        case gnomon::ProbeCount::Ceil: count = static_cast<int>(std::ceil(ratio)); break;
        case gnomon::ProbeCount::Round: count = static_cast<int>(std::floor(ratio + 0.5)); break;
        case gnomon::ProbeCount::Steps:
            count = 64;
            for (auto step = kSteps.rbegin(); step != kSteps.rend(); ++step)
                if (*step >= ratio) count = *step;
            break;
    }
    return std::clamp(count, 1, limit);
}

/// Every number of probes that a ratio in the interval may have.
std::vector<int> probe_counts(const Interval& ratio, int limit, const Profile& profile) {
    std::vector<int> counts;
    const auto add = [&](double r) {
        const int n = probes_for(r, limit, profile);
        if (std::find(counts.begin(), counts.end(), n) == counts.end()) counts.push_back(n);
    };
    add(ratio.low);
    for (int i = 1; i <= limit; ++i) {
        if (i > ratio.low && i < ratio.high) add(i);
        if (i - 0.5 > ratio.low && i - 0.5 < ratio.high) add(i - 0.5);
    }
    add(ratio.high);
    return counts;
}

/// Footprints of one pair of vectors in texels, some of whose outcomes may differ in kind.
class Gather {
public:
    Gather(std::array<int, 2> size, const Sampler& sampler, const Profile& profile)
        : size_(size), profile_(profile), limit_(anisotropy_limit(sampler, profile)), math_(Arithmetic(profile)) {}

    /// D3D11.3 7.18.11, "if(ComputeIsotropicLOD)"; max() passes over NaN. D3D11.3 3.1.3.1
    void isotropic(const Gradients& g, bool nan_x, bool nan_y) {
        if (nan_x && nan_y) return add_nan();
        if (profile_.lod_rule == gnomon::LodRule::Area) {
            if (nan_x || nan_y) return add_nan();
            const double infinite = g.x.u.low * g.y.v.low - g.x.v.low * g.y.u.low;
            for (const Interval& i : {g.x.u, g.x.v, g.y.u, g.y.v}) {
                if (!std::isinf(i.low)) continue;
                return std::isnan(infinite) ? add_nan() : add(point(HUGE_VAL));
            }
            // Two products that pass the largest number cancel to NaN.
            const Interval det = absolute(math_.det(g.x.u, g.y.v, g.x.v, g.y.u));
            if (std::isinf(det.high)) add_nan();
            return add(math_.log2(math_.sqrt(det)));
        }
        // Lengths are compared squared, so large and small ones may leave the range of the arithmetic.
        Interval rho{};
        for (const auto& [d, nan] : {std::pair{g.x, nan_x}, std::pair{g.y, nan_y}}) {
            if (nan) continue;
            if (profile_.lod_rule == gnomon::LodRule::Box)
                rho = max(rho, math_.sqrt(math_.square(max(absolute(d.u), absolute(d.v)))));
            else
                rho = max(rho, math_.sqrt(math_.sum_of_squares(d.u, d.v)));
        }
        add(math_.log2(rho));
    }

    /// The two vectors as they are, or as the axes of their ellipse.
    void anisotropic(const Gradients& g) {
        const Interval sx = math_.sum_of_squares(g.x.u, g.x.v);
        const Interval sy = math_.sum_of_squares(g.y.u, g.y.v);
        const Interval det = absolute(math_.det(g.x.u, g.y.v, g.x.v, g.y.u));
        const Interval dot = math_.add(math_.mul(g.x.u, g.y.u), math_.mul(g.x.v, g.y.v));

        // "If both gradients have zero length, or anything is not finite": the isotropic rule.
        if (sx.low <= 0 && sy.low <= 0) isotropic(g, false, false);
        if (sx.high <= 0 && sy.high <= 0) return;
        if (math_.may_overflow(sx) || math_.may_overflow(sy) || math_.may_overflow(det)) isotropic(g, false, false);

        // The transformation, unless a caveat tells to skip it.
        const bool may_skip = sx.low <= 0 || sy.low <= 0 || det.low <= 0 || dot.has_zero();
        const bool must_skip = sx.high <= 0 || sy.high <= 0 || det.is_zero() || dot.is_zero();
        const bool transforms = profile_.ellipse_transform && !must_skip;
        if (!profile_.ellipse_transform || may_skip || extreme(g, det, false)) untransformed(g, sx, sy, det);
        if (transforms) transformed(g, det);
        // Where the ellipse itself passes the largest number nothing is said about what is not NaN: any ratio.
        if (transforms && extreme(g, det, true)) {
            const Interval longest = math_.sqrt(math_.add(sx, sy));
            const Interval span{-longest.high, longest.high};
            const Interval shortest = math_.div(max(math_.sqrt(sx), math_.sqrt(sy)), point(limit_));
            isotropic(g, false, false);
            add({math_.log2(shortest).low, math_.log2(longest).high}, limit_, {span, span});
        }
    }

    /// Levels of detail that two biases of at most 16 cannot bring back may be any such. D3D11.3 7.18.11, on MipLODBias
    [[nodiscard]] std::vector<Footprint> take() {
        for (Footprint& f : found_) {
            if (f.lod.high < -32) f.lod = {-HUGE_VAL, -32};
            if (f.lod.low > 32 + 16) f.lod = {32 + 16, HUGE_VAL};
        }
        return std::move(found_);
    }
    void add_nan() { found_.push_back({.lod_nan = true}); }
    void add(const Interval& lod) { found_.push_back({.lod = lod}); }

private:
    /// "If components of dX and dY are large or small enough to cause NaNs in these calculations."
    [[nodiscard]] bool extreme(const Gradients& g, const Interval& det, bool large_only) const {
        const Interval a = math_.sum_of_squares(g.x.v, g.y.v);
        const Interval c = math_.sum_of_squares(g.x.u, g.y.u);
        const Interval f = math_.square(det);
        const Interval q = math_.add(a, c);
        const Interval q2 = math_.square(q);
        const Interval fq = math_.mul(f, q);
        for (const Interval& i : {f, q2, fq})
            if (math_.may_overflow(i) || (!large_only && math_.may_underflow(i))) return true;
        return false;
    }

    void untransformed(const Gradients& g, const Interval& sx, const Interval& sy, const Interval& det) {
        const Interval x = math_.sqrt(sx);
        const Interval y = math_.sqrt(sy);
        if (sx.high > sy.low) rule(g.x, x, y, sx, det);
        if (sx.low <= sy.high) rule(g.y, y, x, sy, det);
    }

    /// Axes of the ellipse with A, B, C, F of D3D11.3 7.18.11: the longer has length sqrt((q + t) / 2), which is the
    /// specification's sqrt(2 F / (q - t)) as q^2 - t^2 = 4 F.
    void transformed(const Gradients& g, const Interval& det) {
        const Interval a = math_.sum_of_squares(g.x.v, g.y.v);
        const Interval c = math_.sum_of_squares(g.x.u, g.y.u);
        const Interval b = math_.mul(point(-2), math_.add(math_.mul(g.x.u, g.x.v), math_.mul(g.y.u, g.y.v)));
        const Interval p = math_.sub(a, c);
        const Interval q = math_.add(a, c);
        const Interval t = math_.sqrt(math_.sum_of_squares(p, b));
        const Interval major2 = math_.mul(point(0.5), math_.add(q, t));
        const Interval major = math_.sqrt(major2);
        const Interval minor = math_.div(det, major);

        // The direction of the longer axis: u^2 : v^2 as t - p : t + p. The difference from (t - p)(t + p) = B^2 where p is
        // large, so that it keeps its leading digits.
        Vector axis{{-major.high, major.high}, {-major.high, major.high}};
        if (t.low > 0) {
            const Interval root_two_t = math_.sqrt(math_.mul(point(2), t));
            const auto part = [&](const Interval& larger) { return math_.div(math_.sqrt(larger), root_two_t); };
            if (p.low >= 0) {
                const Interval v = part(math_.add(t, p));
                axis.v = math_.mul(major, v);
                axis.u = math_.mul(major, math_.div(math_.sub(point(0), b), math_.mul(math_.mul(point(2), t), v)));
            } else if (p.high <= 0) {
                const Interval u = part(math_.sub(t, p));
                const Interval v = math_.div(absolute(b), math_.mul(math_.mul(point(2), t), u));
                axis.v = math_.mul(major, v);
                axis.u = math_.mul(major, u);
                if (b.low > 0) axis.u = {-axis.u.high, -axis.u.low};
                // A line has no direction: where the sign of B is open, so is that of v.
                if (b.has_zero()) axis.v = hull(axis.v, {-axis.v.high, -axis.v.low});
            } else if (!b.has_zero()) {
                axis.u = math_.mul(major, part(math_.sub(t, p)));
                axis.v = math_.mul(major, part(math_.add(t, p)));
                if (b.low > 0) axis.u = {-axis.u.high, -axis.u.low};
            }
        }
        rule(axis, major, minor, major2, det);
    }

    void rule(const Vector& axis, const Interval& major, const Interval& minor, const Interval& major2, const Interval& det) {
        const Interval limit = point(limit_);
        switch (profile_.aniso_rule) {
            case gnomon::AnisoRule::D3d11: {
                // Both branches of "clamp ratio and compute LOD" at once: the longer of two minor axes.
                Interval shorter = max(math_.div(det, major), math_.div(major, limit));
                const Interval ratio = min(limit, math_.div(major2, det));
                Interval probes = ratio;
                if (shorter.low < 1) probes = max(point(1), math_.mul(ratio, min(shorter, point(1))));
                if (profile_.aniso_clamps_to_top) shorter = max(shorter, point(1));
                for (const int n : probe_counts(probes, limit_, profile_)) add(math_.log2(shorter), n, axis);
                return;
            }
            case gnomon::AnisoRule::OpenGl:
            case gnomon::AnisoRule::Vulkan: {
                // What a probe is as wide as takes the place of lengthMinor; its clamp leaves the number of probes alone, as
                // the line "lengthMinor = 1.0" does.
                const Interval ratio = max(point(1), min(limit, math_.div(major, minor)));
                for (const int n : probe_counts(ratio, limit_, profile_)) {
                    const bool whole = profile_.aniso_rule == gnomon::AnisoRule::OpenGl;
                    Interval shorter = math_.div(major, whole ? point(n) : ratio);
                    if (profile_.aniso_clamps_to_top) shorter = max(shorter, point(1));
                    add(math_.log2(shorter), n, axis);
                }
                return;
            }
            case gnomon::AnisoRule::Llvmpipe:
            case gnomon::AnisoRule::SwiftShader: return;
        }
    }

    void add(const Interval& lod, int probes, const Vector& axis) {
        found_.push_back({.lod = lod,
                          .probes = probes,
                          .axis_u = math_.div(axis.u, point(size_[0])),
                          .axis_v = math_.div(axis.v, point(size_[1]))});
    }

    std::array<int, 2> size_;
    Profile profile_;
    int limit_;
    IntervalMath math_;
    std::vector<Footprint> found_;
};

/// The gradients of the coordinates within the face, in texels. D3D11.3 7.18.11
///
/// The specification's own text leaves the sign of the major axis out of its derivative; the quotient rule has it:
/// d(s / |m|) = (|m| ds - s sign(m) dm) / m^2.
Gradients cube_gradients(const CubeFace& face, int size, const Profile& profile, const Question& question) {
    const Arithmetic arithmetic(profile);
    const IntervalMath math(arithmetic);
    const auto at = [&](const std::array<double, 3>& v, int i) { return arithmetic.round(v[static_cast<std::size_t>(i)]); };
    const Interval major = point(std::fabs(at(question.coordinate, face.major)));
    const auto component = [&](const std::array<double, 3>& d, std::size_t i) {
        const Interval s = point(face.sign[i] * at(question.coordinate, face.axis[i]));
        const Interval ds = point(face.sign[i] * at(d, face.axis[i]));
        const Interval dm = point(face.major_sign * at(d, face.major));
        const Interval quotient = math.div(math.det(major, ds, s, dm), math.square(major));
        return math.mul(math.mul(point(0.5), quotient), point(size));
    };
    const auto& g = *question.gradient;
    return {{component(g.dx, 0), component(g.dx, 1)}, {component(g.dy, 0), component(g.dy, 1)}};
}

}  // namespace

CubeFace cube_face(int face) {
    // s and t of each face: +X (-z, -y), -X (z, -y), +Y (x, z), -Y (x, -z), +Z (x, -y), -Z (-x, -y). D3D11.3 5.3.8
    static const std::array<CubeFace, 6> faces{CubeFace{0, 0, 1, {2, 1}, {-1, -1}}, CubeFace{1, 0, -1, {2, 1}, {1, -1}},
                                               CubeFace{2, 1, 1, {0, 2}, {1, 1}},   CubeFace{3, 1, -1, {0, 2}, {1, -1}},
                                               CubeFace{4, 2, 1, {0, 1}, {1, -1}},  CubeFace{5, 2, -1, {0, 1}, {-1, -1}}};
    return faces[static_cast<std::size_t>(face)];
}

std::vector<CubeFace> cube_faces(const std::array<double, 3>& direction) {
    std::vector<CubeFace> found;
    const bool nan = std::isnan(direction[0]) || std::isnan(direction[1]) || std::isnan(direction[2]);
    double largest = 0;
    for (const double d : direction) largest = std::fmax(largest, std::fabs(d));
    // Ties go to Z, then Y, then X.
    for (int axis = 2; axis >= 0; --axis) {
        const double d = direction[static_cast<std::size_t>(axis)];
        if (!nan && std::fabs(d) != largest) continue;
        const bool negative = std::signbit(d);
        if (negative || d == 0 || std::isnan(d)) found.push_back(cube_face(2 * axis + 1));
        if (!negative || d == 0 || std::isnan(d)) found.push_back(cube_face(2 * axis));
        if (!nan) break;
    }
    return found;
}

int anisotropy_limit(const Sampler& sampler, const Profile& profile) {
    if (profile.aniso_limits == gnomon::AnisoLimits::Any) return sampler.max_anisotropy;
    int limit = 1;
    for (const int step : kSteps)
        if (step <= sampler.max_anisotropy) limit = step;
    return limit;
}

std::vector<Footprint> footprints(Kind kind, std::array<int, 2> size, const Sampler& sampler, const Profile& profile,
                                  const Question& question) {
    const Arithmetic arithmetic(profile);
    if (!question.gradient) {
        const double lod = arithmetic.round(question.lod);
        return {{.lod_nan = std::isnan(lod), .lod = point(lod), .own = true}};
    }
    const IntervalMath math(arithmetic);
    const auto& g = *question.gradient;
    Gather gather(size, sampler, profile);

    if (kind == Kind::Cube) {
        std::array<double, 3> direction{};
        for (std::size_t i = 0; i < 3; ++i) direction[i] = arithmetic.round(question.coordinate[i]);
        const auto faces = cube_faces(direction);
        const double major = std::fabs(direction[static_cast<std::size_t>(faces.front().major)]);
        const bool regular = finite(direction[0]) && finite(direction[1]) && finite(direction[2]) && finite(g) &&
                             !math.may_overflow(point(major * major)) && major * major >= 0x1p-100 * (arithmetic.fp32 ? 1 : 0);
        // Where squares leave the range of the arithmetic anything may come out.
        bool open = !regular || major == 0;
        if (!open) {
            const Gradients texels = cube_gradients(faces.front(), size[0], profile, question);
            for (const Interval& i : {texels.x.u, texels.x.v, texels.y.u, texels.y.v}) open = open || math.may_overflow(i);
            if (!open) gather.isotropic(texels, false, false);
        }
        if (open) {
            gather.add_nan();
            gather.add({-HUGE_VAL, HUGE_VAL});
        }
        return gather.take();
    }

    const auto scaled = [&](double d, int n) { return math.mul(point(arithmetic.round(d)), point(n)); };
    // max() passes over what is no number: vectors where their lengths are compared, components where those are.
    const bool box = profile.lod_rule == gnomon::LodRule::Box;
    const auto vector = [&](const std::array<double, 3>& d) -> Vector {
        Vector v{};
        if (!std::isnan(d[0])) v.u = scaled(d[0], size[0]);
        if (!std::isnan(d[1])) v.v = scaled(d[1], size[1]);
        return v;
    };
    const auto passed_over = [&](const std::array<double, 3>& d) {
        return box ? std::isnan(d[0]) && std::isnan(d[1]) : std::isnan(d[0]) || std::isnan(d[1]);
    };
    const bool nan_x = passed_over(g.dx);
    const bool nan_y = passed_over(g.dy);
    const Gradients texels{vector(g.dx), vector(g.dy)};

    bool regular = true;
    bool may_overflow = false;
    for (const double d : {g.dx[0], g.dx[1], g.dy[0], g.dy[1]}) regular = regular && finite(d);
    for (const Interval& i : {texels.x.u, texels.x.v, texels.y.u, texels.y.v})
        may_overflow = may_overflow || math.may_overflow(i);
    if (anisotropy_limit(sampler, profile) <= 1 || !regular || may_overflow) {
        gather.isotropic(texels, nan_x, nan_y);
        if (anisotropy_limit(sampler, profile) <= 1 || !regular) return gather.take();
    }
    gather.anisotropic(texels);
    return gather.take();
}

namespace {

double nearest_even(double x) {
    const double whole = std::floor(x);
    const double rest = x - whole;
    return rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0) ? whole + 1 : whole;
}

MipChoice choose(double lod, const Levels& view, const Sampler& sampler, const Profile& profile) {
    const auto level = [&](double l) { return static_cast<int>(std::clamp(l, 0.0, static_cast<double>(view.count - 1))); };
    MipChoice choice{.magnified = lod <= 0};
    switch (sampler.mip) {
        case gnomon::MipFilter::Base: return choice;
        case gnomon::MipFilter::Nearest:
            switch (profile.mip_tie) {
                case gnomon::MipTie::Up: choice.fine = level(std::floor(lod + 0.5)); break;
                case gnomon::MipTie::Down: choice.fine = level(std::ceil(lod + 0.5) - 1); break;
                case gnomon::MipTie::Even: choice.fine = level(nearest_even(lod)); break;
            }
            choice.coarse = choice.fine;
            return choice;
        case gnomon::MipFilter::Linear:
            choice.fine = level(std::floor(lod));
            choice.coarse = level(std::floor(lod) + 1);
            choice.weight = choice.fine == choice.coarse ? 0 : lod - std::floor(lod);
            if (choice.weight == 0) choice.coarse = choice.fine;
            choice.weight_high = choice.weight;
            return choice;
    }
    return choice;
}

}  // namespace

std::vector<MipChoice> mip_choices(const Footprint& footprint, const Levels& view, const Sampler& sampler,
                                   const Profile& profile, const Question& question, double& width) {
    const Arithmetic arithmetic(profile);
    const IntervalMath math(arithmetic);
    const auto sampler_bias = static_cast<double>(sampler.lod_bias);
    const double bias = arithmetic.round(question.lod_bias);

    // Bias, then the clamps: min and max pass over NaN. D3D11.3 7.18.11, 3.1.3.1
    Interval lod = footprint.lod;
    if (footprint.own)
        lod = point(arithmetic.round(arithmetic.round(lod.low + sampler_bias) + bias));
    else
        lod = math.add(math.add(lod, point(sampler_bias)), point(bias));
    if (footprint.lod_nan) lod = point(std::nan(""));
    const auto view_min = static_cast<double>(view.min_lod - static_cast<float>(view.base));  // D3D11.3 5.8.3
    const auto clamped = [&](double x) {
        const double limited =
            std::fmax(static_cast<double>(sampler.min_lod), std::fmin(static_cast<double>(sampler.max_lod), x));
        // Levels past the ends are the ends; whole limits leave the rounding as it is.
        return std::clamp(std::fmax(view_min, limited), -2.0, static_cast<double>(view.count) + 1);
    };
    const double low = clamped(lod.low);
    const double high = clamped(lod.high);

    std::vector<MipChoice> choices;
    const auto add = [&](double x) {
        const MipChoice choice = choose(x, view, sampler, profile);
        if (std::find(choices.begin(), choices.end(), choice) == choices.end()) choices.push_back(choice);
    };
    width = 0;
    if (profile.lod_fraction_bits == gnomon::kExactBits) {
        width = high - low;
        add(low);
        for (int half = static_cast<int>(std::floor(2 * low)); half <= static_cast<int>(std::ceil(2 * high)); ++half)
            for (const double x : {std::nextafter(half * 0.5, -HUGE_VAL), half * 0.5, std::nextafter(half * 0.5, HUGE_VAL)})
                if (x >= low && x <= high) add(x);
        add(high);
        return choices;
    }
    const double one = std::ldexp(1.0, profile.lod_fraction_bits);
    const auto code = [&](double x) {
        return profile.lod_rounding == gnomon::FixedRounding::NearestEven ? nearest_even(x * one) : std::floor(x * one);
    };
    if (code(high) - code(low) <= 64) {
        for (double c = code(low); c <= code(high); ++c) add(c / one);
        return choices;
    }
    // Many: the ends of each stretch between whole and half levels, and the weights in between as an interval.
    for (double c = code(low); c <= code(high);) {
        const double next = std::fmin((std::floor(2 * c / one) + 1) * one / 2, code(high) + 1);
        MipChoice choice = choose(c / one, view, sampler, profile);
        const MipChoice last = choose((next - 1) / one, view, sampler, profile);
        add((next - 1) / one);
        choice.coarse = last.coarse;
        choice.weight_high = last.weight;
        choices.push_back(choice);
        c = next;
        if (choice.magnified) add(c / one);
    }
    return choices;
}

}  // namespace oracle
