// Levels of detail and anisotropy: measured numbers against those of the rules that a profile can name.
#include "tests/agree/fitting.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace gnomon::agree {
namespace {

using P = Profile;

struct Vector {
    double x = 0;
    double y = 0;
    [[nodiscard]] double length() const { return std::hypot(x, y); }
};
struct Pair {
    Vector dx;
    Vector dy;
    explicit Pair(const std::array<float, 4>& texels) : dx{texels[0], texels[1]}, dy{texels[2], texels[3]} {}
    [[nodiscard]] double area() const { return std::abs(dx.x * dy.y - dx.y * dy.x); }
    [[nodiscard]] double longest() const { return std::max(dx.length(), dy.length()); }
    [[nodiscard]] double shortest() const { return std::min(dx.length(), dy.length()); }
};

// log2 between powers of two as a line.
double line_log2(double x) {
    int exponent = 0;
    const double mantissa = 2 * std::frexp(x, &exponent);
    return exponent - 1 + (mantissa - 1);
}

double scale_factor(const Pair& pair, LodRule rule) {
    switch (rule) {
        case LodRule::Longest: return pair.longest();
        case LodRule::Box:
            return std::max({std::abs(pair.dx.x), std::abs(pair.dx.y), std::abs(pair.dy.x), std::abs(pair.dy.y)});
        case LodRule::Area: return std::sqrt(pair.area());
    }
    return 0;
}

Residual residual_of(std::span<const double> differences) {
    Residual residual;
    for (const double difference : differences) {
        residual.rms += difference * difference / static_cast<double>(differences.size());
        residual.largest = std::max(residual.largest, std::abs(difference));
    }
    residual.rms = std::sqrt(residual.rms);
    return residual;
}

// What rounding the level of detail may hide, plus that of a filter in binary32.
double tolerance(const Profile& profile) {
    return 1e-4 + (profile.lod_fraction_bits == kExactBits ? 0.0 : std::ldexp(1.0, -profile.lod_fraction_bits));
}

int counted(double ratio, ProbeCount rule) {
    switch (rule) {
        case ProbeCount::Ceil: return static_cast<int>(std::ceil(ratio));
        case ProbeCount::Round: return static_cast<int>(std::floor(ratio + 0.5));
        case ProbeCount::Steps:
            for (const int step : {1, 2, 4, 6, 8, 10, 12})
                if (ratio <= step) return step;
            return 16;
    }
    return 0;
}

// How a level of detail comes about under anisotropy; SwiftShader's is D3d11's of the derivatives themselves.
struct LodHypothesis {
    AnisoRule rule = AnisoRule::D3d11;
    bool transform = false;
};
std::string name_of_hypothesis(const LodHypothesis& hypothesis) {
    return fmt::format("{}{}", name_of(hypothesis.rule), hypothesis.transform ? " of the ellipse" : "");
}

double predicted_lod(const std::array<float, 4>& texels, const LodHypothesis& hypothesis, const Profile& profile) {
    constexpr double kLimit = 16;
    const Pair pair(texels);
    double major = pair.longest();
    double minor = pair.shortest();
    if (hypothesis.transform) {
        // The axes of the ellipse: singular values.
        const double sum = major * major + minor * minor;
        const double root = std::sqrt(std::max(0.0, sum * sum - 4 * pair.area() * pair.area()));
        major = std::sqrt((sum + root) / 2);
        minor = pair.area() / major;
    }
    const double cut = std::min(major / minor, kLimit);
    double counted_minor = major / cut;
    switch (hypothesis.rule) {
        case AnisoRule::D3d11:
        case AnisoRule::SwiftShader: counted_minor = major / std::min(major * major / pair.area(), kLimit); break;
        case AnisoRule::Vulkan: break;
        case AnisoRule::OpenGl:
            counted_minor = major / std::min(counted(std::max(cut, 1.0), profile.probe_count) * 1.0, kLimit);
            break;
        case AnisoRule::Llvmpipe: return std::max(0.0, std::floor(model_log2(minor, profile.log2_model)));
    }
    return std::max(0.0, stored_lod(model_log2(counted_minor, profile.log2_model), profile));
}

Residual lod_residual(const AnisoMeasurement& aniso, const LodHypothesis& hypothesis, const Profile& profile) {
    std::vector<double> differences;
    for (const auto* lods : {&aniso.straight, &aniso.oblique})
        for (const AnisoLod& lod : *lods) differences.push_back(lod.lod - predicted_lod(lod.texels, hypothesis, profile));
    return residual_of(differences);
}

void fit_probe_lines(Fitting& fit) {
    const AnisoMeasurement& aniso = fit.seen.aniso;
    std::vector<std::string> counts;
    int smooth = 0;
    std::array<int, 3> wrong{};
    double interior = 0;
    double centred = 0;
    float uneven = 0;
    bool halves_to_even = false;
    for (const ProbeLine& line : aniso.ratios) {
        smooth += line.is_smooth;
        const auto n = static_cast<int>(line.positions.size());
        if (std::fmod(line.ratio, 1.0f) == 0) counts.push_back(fmt::format("{}", n));
        for (const ProbeCount rule : {ProbeCount::Ceil, ProbeCount::Round, ProbeCount::Steps}) {
            const bool is_tie = rule == ProbeCount::Round && std::fmod(line.ratio, 1.0f) == 0.5f;
            wrong[static_cast<std::size_t>(rule)] += !is_tie && n != counted(line.ratio, rule);
        }
        if (line.ratio == 2.5f) halves_to_even = n == 2;
        for (int k = 0; k < n; ++k) {
            const double at = line.positions[static_cast<std::size_t>(k)];
            interior = std::max(interior, std::abs(at - ((k + 1.0) / (n + 1) - 0.5)));
            centred = std::max(centred, std::abs(at - ((k + 0.5) / n - 0.5)));
            uneven = std::max(uneven, std::abs(line.weights[static_cast<std::size_t>(k)] * static_cast<float>(n) - 1));
        }
    }
    if (2 * smooth > static_cast<int>(aniso.ratios.size())) {
        fit.set(&P::probe_placement, ProbePlacement::Ewa,
                fmt::format("the response to an edge has no steps at {} of {} ratios", smooth, aniso.ratios.size()));
        fit.keep(&P::probe_count, "not used: an ellipse is walked");
        fit.keep(&P::aniso_limits, "not used: an ellipse is walked");
        return;
    }

    const auto best = static_cast<std::size_t>(std::min_element(wrong.begin(), wrong.end()) - wrong.begin());
    const std::string seen = fmt::format("{} probes at ratios 1 to 16; of {} ratios against ceil {}, round {}, steps {}",
                                         fmt::join(counts, " "), aniso.ratios.size(), wrong[0], wrong[1], wrong[2]);
    if (wrong[best] == 0) {
        const char* ties = best != 1 ? "" : halves_to_even ? "; halves to even" : "; halves up";
        fit.set(&P::probe_count, static_cast<ProbeCount>(best), seen + ties);
    } else {
        fit.keep(&P::probe_count, seen);
    }
    constexpr double kClose = 0.01;
    const std::string places = fmt::format(
        "off i / (N + 1) - 1/2 by up to {:.4f}, off (k + 1/2) / N - 1/2 by {:.4f}; weights"
        " within {:.4f} of 1 / N",
        interior, centred, static_cast<double>(uneven));
    if (std::min(interior, centred) < kClose && std::max(interior, centred) > 2 * kClose) {
        fit.set(&P::probe_placement, interior < centred ? ProbePlacement::Interior : ProbePlacement::Centred, places);
    } else {
        fit.keep(&P::probe_placement, places);
    }

    // At a ratio of 16, as many probes as the limit.
    counts.clear();
    bool any = true;
    bool steps = true;
    for (const ProbeLine& line : aniso.limits) {
        const auto n = static_cast<int>(line.positions.size());
        int lower = 1;
        for (const int step : {2, 4, 6, 8, 10, 12, 16})
            if (line.limit >= step) lower = step;
        any = any && n == line.limit;
        steps = steps && n == lower;
        counts.push_back(fmt::format("{}", n));
    }
    const std::string limits = fmt::format("{} probes at limits 2 to 16", fmt::join(counts, " "));
    if (any != steps) {
        fit.set(&P::aniso_limits, any ? AnisoLimits::Any : AnisoLimits::Steps, limits);
    } else {
        fit.keep(&P::aniso_limits, limits);
    }
}

// Number of probes of the magnified footprint: 8 by its ratio, 4 by D3D11.3 7.18.11.
int magnified_probes(const AnisoMeasurement& aniso, ProbePlacement placement) {
    const auto& distances = placement == ProbePlacement::Interior ? aniso.magnified_interior : aniso.magnified_centred;
    return static_cast<int>(std::min_element(distances.begin(), distances.end()) - distances.begin()) + 1;
}

void fit_aniso_rule(Fitting& fit) {
    const AnisoMeasurement& aniso = fit.seen.aniso;
    const Profile& profile = fit.fitted.profile;
    struct Ranked {
        LodHypothesis hypothesis;
        Residual residual;
    };
    std::vector<Ranked> ranked;
    for (const LodHypothesis hypothesis : {LodHypothesis{AnisoRule::D3d11, true}, LodHypothesis{AnisoRule::D3d11, false},
                                           LodHypothesis{AnisoRule::OpenGl, true}, LodHypothesis{AnisoRule::OpenGl, false},
                                           LodHypothesis{AnisoRule::Vulkan, false}, LodHypothesis{AnisoRule::Llvmpipe, false}})
        ranked.push_back({hypothesis, lod_residual(aniso, hypothesis, profile)});
    std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.residual.rms < b.residual.rms; });
    const auto [best, residual] = ranked.front();
    std::string seen =
        fmt::format("levels of detail within {:.4f} of {}, next {} ({:.3f})", residual.largest, name_of_hypothesis(best),
                    name_of_hypothesis(ranked[1].hypothesis), ranked[1].residual.largest);
    if (residual.largest > tolerance(profile)) {
        fit.keep(&P::aniso_rule, seen);
        fit.keep(&P::ellipse_transform, seen);
        return;
    }
    fit.set(&P::ellipse_transform, best.transform, seen);
    if (best.rule == AnisoRule::Llvmpipe || profile.probe_placement == ProbePlacement::Ewa) {
        fit.set(&P::aniso_rule, best.rule, seen);
        return;
    }

    // D3d11, Vulkan of the ellipse and SwiftShader differ in the probes of a magnified footprint.
    const int probes = magnified_probes(aniso, profile.probe_placement);
    seen += fmt::format("; {} probes at ratio 8 with a minor axis of 1/2 texel", probes);
    if (best.rule != AnisoRule::D3d11 || probes == 4) {
        fit.set(&P::aniso_rule, best.rule, seen);
    } else if (probes == 8 && best.transform) {
        fit.set(&P::aniso_rule, AnisoRule::Vulkan, seen);
    } else if (probes == 8 && profile.probe_placement == ProbePlacement::Centred) {
        fit.set(&P::aniso_rule, AnisoRule::SwiftShader, seen);
    } else {
        fit.set(&P::aniso_rule, best.rule, seen, Basis::Assumed);
    }
}

void fit_magnified_lod(Fitting& fit) {
    bool clamps = !fit.seen.aniso.magnified.empty();
    bool keeps = clamps;
    std::vector<std::string> lods;
    for (const AnisoLod& lod : fit.seen.aniso.magnified) {
        const double close = 0.05 + tolerance(fit.fitted.profile);
        clamps = clamps && std::abs(lod.lod - lod.bias) < close;
        keeps = keeps && std::abs(lod.lod - (std::log2(lod.texels[3]) + lod.bias)) < close;
        lods.push_back(fmt::format("{:.3f}", lod.lod));
    }
    const std::string seen =
        fmt::format("with a bias of 3, minor axes of 1/4, 1/2, 1/2 texel give levels {}", fmt::join(lods, ", "));
    if (clamps != keeps) {
        fit.set(&P::aniso_clamps_to_top, clamps, seen);
    } else {
        fit.keep(&P::aniso_clamps_to_top, seen);
    }
}

void fit_mip_tie(Fitting& fit) {
    const std::vector<int>& at_half = fit.seen.mips.at_half;
    const std::string seen =
        fmt::format("levels {} at 1/2, 3/2, 5/2, 7/2; level 1 from {}", fmt::join(at_half, ", "),
                    fit.seen.mips.switch_lod.empty() ? "nowhere" : fmt::format("{:.9g}", fit.seen.mips.switch_lod[0]));
    if (at_half == std::vector{1, 2, 3, 4}) {
        fit.set(&P::mip_tie, MipTie::Up, seen);
    } else if (at_half == std::vector{0, 1, 2, 3}) {
        fit.set(&P::mip_tie, MipTie::Down, seen);
    } else if (at_half == std::vector{0, 2, 2, 4}) {
        fit.set(&P::mip_tie, MipTie::Even, seen);
    } else {
        fit.keep(&P::mip_tie, seen);
    }
}

}  // namespace

double model_log2(double texels, Log2Model model) {
    switch (model) {
        case Log2Model::Exact: return std::log2(texels);
        case Log2Model::Linear2: return line_log2(texels * texels) / 2;
        case Log2Model::Linear4: return line_log2(texels * texels * texels * texels) / 4;
    }
    return 0;
}

double stored_lod(double lod, const Profile& profile) {
    if (profile.lod_fraction_bits == kExactBits) return lod;
    const double steps = std::ldexp(1.0, profile.lod_fraction_bits);
    return (profile.lod_rounding == FixedRounding::NearestEven ? std::nearbyint(lod * steps) : std::floor(lod * steps)) / steps;
}

std::array<Residual, 3> log2_residuals(const LodMeasurement& lod, const Profile& profile) {
    std::array<Residual, 3> residuals;
    for (const Log2Model model : {Log2Model::Exact, Log2Model::Linear2, Log2Model::Linear4}) {
        std::vector<double> differences;
        differences.reserve(lod.isotropic.size());
        for (const GradientLod& point : lod.isotropic)
            differences.push_back(point.lod - stored_lod(model_log2(point.texels[0], model), profile));
        residuals[static_cast<std::size_t>(model)] = residual_of(differences);
    }
    return residuals;
}

void fit_levels(Fitting& fit) {
    const LodMeasurement& lod = fit.seen.lod;
    fit_mip_tie(fit);
    if (lod.isotropic.empty()) {
        fit.keep(&P::log2_model, lod.refused);
        fit.keep(&P::lod_rule, lod.refused);
        return;
    }
    const std::array<Residual, 3> residuals = log2_residuals(lod, fit.fitted.profile);
    const auto best =
        static_cast<std::size_t>(std::min_element(residuals.begin(), residuals.end(),
                                                  [](const Residual& a, const Residual& b) { return a.rms < b.rms; }) -
                                 residuals.begin());
    const std::string curve = fmt::format("levels off log2 by up to {:.4f}, off linear-2 by {:.4f}, off linear-4 by {:.4f}",
                                          residuals[0].largest, residuals[1].largest, residuals[2].largest);
    if (residuals[best].largest <= tolerance(fit.fitted.profile)) {
        fit.set(&P::log2_model, static_cast<Log2Model>(best), curve);
    } else {
        fit.keep(&P::log2_model, curve);
    }

    std::array<Residual, 3> rules;
    for (const LodRule rule : {LodRule::Longest, LodRule::Box, LodRule::Area}) {
        std::vector<double> differences;
        differences.reserve(lod.oblique.size());
        for (const GradientLod& point : lod.oblique)
            differences.push_back(point.lod - stored_lod(std::max(0.0, model_log2(scale_factor(Pair(point.texels), rule),
                                                                                  fit.fitted.profile.log2_model)),
                                                         fit.fitted.profile));
        rules[static_cast<std::size_t>(rule)] = residual_of(differences);
    }
    const auto rule = static_cast<std::size_t>(
        std::min_element(rules.begin(), rules.end(), [](const Residual& a, const Residual& b) { return a.rms < b.rms; }) -
        rules.begin());
    const std::string seen = fmt::format("oblique pairs off longest by up to {:.4f}, off box by {:.4f}, off area by {:.4f}",
                                         rules[0].largest, rules[1].largest, rules[2].largest);
    if (rules[rule].largest <= tolerance(fit.fitted.profile)) {
        fit.set(&P::lod_rule, static_cast<LodRule>(rule), seen);
    } else {
        fit.keep(&P::lod_rule, seen);
    }
}

void fit_anisotropy(Fitting& fit) {
    if (!fit.seen.aniso.ratios.empty()) {
        fit_probe_lines(fit);
        fit_aniso_rule(fit);
        fit_magnified_lod(fit);
        return;
    }
    fit.keep(&P::aniso_rule, fit.seen.aniso.refused);
    fit.keep(&P::probe_count, fit.seen.aniso.refused);
    fit.keep(&P::probe_placement, fit.seen.aniso.refused);
}

}  // namespace gnomon::agree
