// Texels and weights; fit_levels.cpp has the rest.
#include "tests/agree/fit.h"

#include "tests/agree/fitting.h"
#include "tests/agree/names.h"

#include <algorithm>
#include <cmath>

namespace gnomon::agree {
namespace {

using P = Profile;

const WeightMeasurement& weights_of(const Measurements& seen, TexelFormat format) {
    return *std::find_if(seen.weights.begin(), seen.weights.end(),
                         [&](const WeightMeasurement& weights) { return weights.format == format; });
}

std::string rounding_text(StepRounding rounding) {
    switch (rounding) {
        case StepRounding::NearestEven: return "rounded to nearest, ties to even";
        case StepRounding::NearestUp: return "rounded to nearest, ties up";
        case StepRounding::NearestDown: return "rounded to nearest, ties down";
        case StepRounding::Truncate: return "truncated";
    }
    return "";
}

FixedRounding fixed_rounding(StepRounding rounding) {
    return rounding == StepRounding::Truncate ? FixedRounding::Truncate : FixedRounding::NearestEven;
}

// Sets a number of fraction bits and its rounding.
struct BitsFields {
    int P::* bits;
    FixedRounding P::* rounding;
};
void fit_steps(Fitting& fit, const BitsFields& fields, const StepTable& table, int fine_distinct, int fine_bits) {
    const StepRule rule = step_rule(table);
    const std::string seen = fmt::format("{} values at {} positions", table.distinct, table.last + 1);
    if (rule.is_exact) {
        const bool fine = fine_distinct == 1024;
        fit.set(fields.bits, kExactBits,
                fmt::format("{}, {} at 1024 more 2^-{} apart: {}", seen, fine_distinct, fine_bits,
                            fine ? "nothing is rounded" : "more bits than a profile can say"));
        fit.keep(fields.rounding, "not used: nothing is rounded");
    } else if (!rule.bits) {
        fit.keep(fields.bits, table.refused.empty() ? seen + ": no rule fits" : table.refused);
        fit.keep(fields.rounding, "no rule fits the steps");
    } else if (*rule.bits > 8) {
        fit.set(fields.bits, 8, fmt::format("{}: {} bits, of which a profile can say 8", seen, *rule.bits), Basis::Assumed);
        fit.set(fields.rounding, fixed_rounding(rule.rounding), rounding_text(rule.rounding));
    } else {
        fit.set(fields.bits, *rule.bits, seen);
        fit.set(fields.rounding, fixed_rounding(rule.rounding), rounding_text(rule.rounding));
    }
}

void fit_carry(Fitting& fit, const WeightMeasurement& weights) {
    const GatherMeasurement& gather = fit.seen.gather;
    const StepRule rule = step_rule(weights.ramp);
    if (!gather.refused.empty() || !rule.bits || rule.rounding == StepRounding::Truncate) {
        fit.keep(&P::texel_carry, !gather.refused.empty() ? gather.refused : "nothing rounds up to a whole texel");
        return;
    }
    const std::string seen = fmt::format("of {} positions, weight 1 from {}, gather's next texels from {}", gather.last,
                                         weights.first_one, gather.switch_position);
    if (weights.first_one >= weights.ramp.last) {
        fit.keep(&P::texel_carry, seen);
    } else if (std::abs(gather.switch_position - weights.first_one) <= 1) {
        fit.set(&P::texel_carry, TexelCarry::Texel, seen);
    } else if (gather.switch_position >= gather.last) {
        fit.set(&P::texel_carry, TexelCarry::Weight, seen);
    } else {
        fit.keep(&P::texel_carry, seen + ": neither");
    }
}

void fit_form(Fitting& fit) {
    const FormMeasurement& form = fit.seen.form;
    const auto all = [&](int count) { return form.samples > 0 && count == form.samples; };
    const std::string seen = fmt::format(
        "of {} results, a + w (b - a) gives {}, fused {}, a (1 - w) + b w {}; an infinity {} beside weights above 0"
        " and {} weight 0",
        form.samples, form.lerps, form.fused, form.products, form.keeps_infinity ? "stays" : "turns NaN",
        form.ignores_infinity ? "is left out at" : "leaks in at");
    if (all(form.lerps) + all(form.fused) + all(form.products) != 1) {
        fit.keep(&P::bilinear_form, form.refused.empty() ? seen : form.refused);
        return;
    }
    fit.set(&P::arithmetic, Arithmetic::Fp32, fmt::format("{} results are binary32's to the bit", form.samples));
    if (all(form.lerps)) {
        const bool whole = form.keeps_infinity && form.ignores_infinity;
        fit.set(&P::bilinear_form, whole ? BilinearForm::Lerp : BilinearForm::PlainLerp, seen);
    } else {
        fit.set(&P::bilinear_form, all(form.fused) ? BilinearForm::FusedLerp : BilinearForm::Products, seen);
    }
}

void fit_unorm(Fitting& fit) {
    int codes = 0;
    int divides = 0;
    int reciprocals = 0;
    const WeightMeasurement& bytes = weights_of(fit.seen, TexelFormat::Rgba8);
    for (const DecodeMeasurement& decode : fit.seen.decode) {
        // A filter of codes says nothing about how other formats decode.
        if (decode.format == TexelFormat::Rgba8 && bytes.between_codes == 2) continue;
        codes += decode.codes;
        divides += decode.divides;
        reciprocals += decode.reciprocals;
    }
    const FormMeasurement& form = fit.seen.form;
    const std::string seen = fmt::format(
        "of {} codes, {} are quotients, {} products with the reciprocal; of {} rg16unorm"
        " filters, {} were of codes, {} of numbers",
        codes, divides, reciprocals, form.samples, form.late_unorm, form.early_unorm);
    const bool late = form.late_unorm == form.samples && form.late_unorm > form.early_unorm;
    const bool early = form.early_unorm == form.samples && form.early_unorm > form.late_unorm;
    if (divides == codes && reciprocals < codes) {
        fit.set(&P::unorm_decode, UnormDecode::Divide, seen);
    } else if (reciprocals == codes && (late || early)) {
        fit.set(&P::unorm_decode, late ? UnormDecode::Late : UnormDecode::Reciprocal, seen);
    } else {
        fit.keep(&P::unorm_decode, seen);
    }

    const std::string between = fmt::format("{} values between neighbouring codes of rgba8", bytes.between_codes);
    if (bytes.between_codes == 2) {
        fit.set(&P::unorm_filter, UnormFilter::Llvmpipe, between + ": results are codes");
    } else if (bytes.between_codes > 2) {
        fit.set(&P::unorm_filter, UnormFilter::Float, between);
    } else {
        fit.keep(&P::unorm_filter, bytes.ramp.refused);
    }
}

// Boundaries between texels, of sizes that are not powers of two, at multiples of 2^-16.
int sixteen_bit_boundaries(const BoundaryMeasurement& measured, int& all) {
    int found = 0;
    all = 0;
    for (const TexelBoundary& boundary : measured.boundaries) {
        if ((boundary.size & (boundary.size - 1)) == 0) continue;
        ++all;
        found += std::fmod(double{boundary.coordinate} * 65536, 1.0) == 0;
    }
    return found;
}

void fit_addresses(Fitting& fit) {
    const StepRule floats = step_rule(weights_of(fit.seen, fit.seen.filtered).ramp);
    const WeightMeasurement& rgba8 = weights_of(fit.seen, TexelFormat::Rgba8);
    const StepRule bytes = step_rule(rgba8.ramp);
    int all = 0;
    int of_floats = 0;
    int of_bytes = 0;
    for (const BoundaryMeasurement& measured : fit.seen.boundaries) {
        if (measured.format == TexelFormat::R32f) of_floats = sixteen_bit_boundaries(measured, all);
        if (measured.format == TexelFormat::Rgba8) of_bytes = sixteen_bit_boundaries(measured, all);
    }
    if (floats.bits) {
        fit.set(&P::address_arithmetic, AddressArithmetic::FixedPoint, fmt::format("weights of {} bits", *floats.bits));
    } else if (floats.is_exact && bytes.bits == 8 && rgba8.between_codes == 2) {
        fit.set(&P::address_arithmetic, AddressArithmetic::Llvmpipe,
                "float weights are exact, those of rgba8 have 8 bits and its results are codes");
    } else if (floats.is_exact && all > 0 && of_bytes == all && of_floats < all) {
        fit.set(&P::address_arithmetic, AddressArithmetic::SwiftShader,
                fmt::format("float weights are exact; nearest boundaries of rgba8 lie at multiples of 2^-16 ({} of {}),"
                            " of r32f {}",
                            of_bytes, all, of_floats));
    } else {
        fit.keep(&P::address_arithmetic, "float weights are exact, by no arithmetic that a profile names");
    }
}

}  // namespace

Fitting::Fitting(const Measurements& measurements) : seen(measurements) {
    fitted.profile = profile_presets().front();
    fitted.profile.name = seen.device;
    fitted.profile.summary = "measured by gnomon_probe";
    for_each_field(fitted.profile, [&](std::string_view name, const auto&) {
        if (name != "name" && name != "summary")
            fitted.evidence.push_back({std::string(name), Basis::Assumed, "not measured; as d3d11"});
    });
}

void fit_texels(Fitting& fit) {
    const Measurements& seen = fit.seen;
    const WeightMeasurement& weights = weights_of(seen, seen.filtered);
    fit_steps(fit, {&P::texel_fraction_bits, &P::texel_rounding}, weights.ramp, weights.fine_distinct, 24);
    fit_carry(fit, weights);
    fit_form(fit);
    fit_unorm(fit);
    fit_addresses(fit);
    if (fit.fitted.profile.unorm_filter == UnormFilter::Llvmpipe && fit.fitted.profile.texel_fraction_bits == kExactBits)
        if (const StepRule bytes = step_rule(weights_of(seen, TexelFormat::Rgba8).ramp); bytes.bits)
            fit.set(&P::texel_rounding, fixed_rounding(bytes.rounding), "of rgba8: " + rounding_text(bytes.rounding));

    const WeightMeasurement& wide = weights_of(seen, TexelFormat::R32f);
    const std::string values = fmt::format("{} values between two texels of r32f", wide.ramp.distinct);
    fit.set(&P::filters_float32, wide.is_filtered, wide.ramp.refused.empty() ? values : wide.ramp.refused);
    const DenormalMeasurement& denormals = seen.denormals;
    if (denormals.refused.empty() && denormals.is_float32_filtered) {
        fit.set(&P::flush_denormals, denormals.filter_flushes,
                fmt::format("halfway between 2^-130 and 2^-129 lies {}; read alone {}; halfs are {}",
                            denormals.filter_flushes ? "0" : "a denormal", denormals.nearest_flushes ? "flushed" : "kept",
                            denormals.half_flushes ? "flushed" : "kept"));
    } else {
        fit.keep(&P::flush_denormals, "needs a filter of r32f");
    }
    if (seen.reported_subpixel_bits && *seen.reported_subpixel_bits >= 1 && *seen.reported_subpixel_bits <= 8)
        fit.set(&P::raster_subpixel_bits, *seen.reported_subpixel_bits, "the driver's limit", Basis::Reported);
    fit.keep(&P::float_narrowing, "a matter of stores, not of the texture unit");
    fit.keep(&P::border_precision, "the harness has border colours 0 and 1 only");
    fit.keep(&P::compare_reference, "the harness has no unorm depth format");
    fit.keep(&P::cube_edges, "the harness has no cubes");
    fit.keep(&P::cube_corner, "the harness has no cubes");
    fit.keep(&P::lod_sharing, "compute shaders have no quads of their own");
    fit.keep(&P::mip_generation, "a matter of the driver, not of the texture unit");
}

void fit_lod_steps(Fitting& fit) {
    const MipMeasurement& mips = fit.seen.mips;
    fit_steps(fit, {&P::lod_fraction_bits, &P::lod_rounding}, mips.ramp, mips.fine_distinct, 24);
}

FittedProfile fit_profile(const Measurements& measurements) {
    Fitting fit(measurements);
    fit_texels(fit);
    fit_lod_steps(fit);
    fit_levels(fit);
    fit_anisotropy(fit);
    return fit.fitted;
}

}  // namespace gnomon::agree
