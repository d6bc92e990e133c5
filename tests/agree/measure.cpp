// Texels and weights; measure_levels.cpp has levels of detail and anisotropy.
#include "tests/agree/measure.h"

#include "sim/error.h"
#include "tests/agree/made_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gnomon::agree {
namespace {

constexpr int kRampSteps = 1 << 16;
constexpr int kFineSteps = 1024;

double rounded(double x, StepRounding rounding) {
    switch (rounding) {
        case StepRounding::NearestEven: return std::nearbyint(x);
        case StepRounding::NearestUp: return std::floor(x + 0.5);
        case StepRounding::NearestDown: return std::ceil(x - 0.5);
        case StepRounding::Truncate: return std::floor(x);
    }
    return x;
}

// Whether the table changes only where the rule's values do, and nearly everywhere they do (results may be coarser).
bool explains(const StepTable& table, StepRule& rule) {
    const double scale = std::ldexp(1.0, *rule.bits);
    const auto predicted = [&](int i) { return rounded(i * scale / table.last, rule.rounding) / scale; };
    int changes = 0;
    std::size_t next = 0;
    float value = 0;
    rule.largest_error = 0;
    for (int i = 0; i <= table.last; ++i) {
        const bool is_step = next < table.steps.size() && table.steps[next].position == i;
        const bool is_change = i != 0 && predicted(i) != predicted(i - 1);
        if (is_step) value = table.steps[next++].value;
        if (is_step && i != 0 && !is_change) return false;
        changes += is_change ? 1 : 0;
        rule.largest_error = std::max(rule.largest_error, std::abs(value - predicted(i)));
    }
    return static_cast<double>(table.steps.size() - 1) >= 0.9 * changes && rule.largest_error < 1.0 / scale;
}

std::vector<Point> along_u(int count, double first, double step) {
    std::vector<Point> points;
    points.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) points.push_back({.u = static_cast<float>(first + i * step), .v = 0.5f});
    return points;
}

int count_distinct(std::vector<float> values) {
    std::sort(values.begin(), values.end());
    return static_cast<int>(std::unique(values.begin(), values.end()) - values.begin());
}

// The ways to combine two texels, each operation rounded once; in double, where sums and products of floats are exact enough
// for that.
using Form = float (*)(float, float, float);
float narrow(double x) { return static_cast<float>(x); }
float times(float a, float b) { return narrow(double{a} * b); }
float plus(float a, float b) { return narrow(double{a} + b); }
float lerp_form(float a, float b, float w) { return plus(a, times(w, plus(b, -a))); }
float fused_form(float a, float b, float w) { return std::fma(w, plus(b, -a), a); }
float product_form(float a, float b, float w) { return plus(times(a, 1 - w), times(b, w)); }
constexpr std::array<Form, 3> kForms{lerp_form, fused_form, product_form};

// Pairs of texels side by side and points between them at weights that so many bits hold.
struct Pairs {
    static constexpr int kCount = 256;
    std::vector<Point> points{};
    std::vector<float> weights{};
    std::vector<std::size_t> pair{};

    explicit Pairs(int weight_bits) {
        const int steps = 1 << weight_bits;
        Sequence random;
        for (int j = 0; j < kCount; ++j)
            for (int i = 0; i < 4; ++i) {
                const double weight = std::floor(1 + random.next() * (steps - 1)) / steps;
                points.push_back({.u = narrow((2 * j + 0.5 + weight) / (2 * kCount)), .v = 0.5f});
                weights.push_back(narrow(weight));
                pair.push_back(static_cast<std::size_t>(j));
            }
    }
};

void measure_float_form(const Source& source, TexelFormat format, const Pairs& pairs, FormMeasurement& result) {
    // Exponents far apart, so that every form rounds.
    Sequence random;
    std::vector<float> texels;
    for (int i = 0; i < 2 * Pairs::kCount; ++i) {
        const double mantissa = std::floor((1 + random.next()) * 1024) / 1024 + (format == TexelFormat::R32f ? 0x1.8p-20 : 0);
        texels.push_back(narrow(std::ldexp(mantissa, static_cast<int>(random.next() * 20) - 10)));
    }
    const Levels texture =
        made_levels(format, {2 * Pairs::kCount, 1}, 1, [&](int, int x, int) { return texels[static_cast<std::size_t>(x)]; });
    const std::vector<float> values =
        try_samples(source, texture, clamped(Filter::Linear), Instruction::Lod, pairs.points, result.refused);
    std::array<int, 3> equal{};
    for (std::size_t i = 0; i < values.size(); ++i)
        for (std::size_t form = 0; form < kForms.size(); ++form)
            equal[form] +=
                values[i] == kForms[form](texels[2 * pairs.pair[i]], texels[2 * pairs.pair[i] + 1], pairs.weights[i]);
    result.samples = static_cast<int>(values.size());
    result.lerps = equal[0];
    result.fused = equal[1];
    result.products = equal[2];
}

void measure_unorm_form(const Source& source, const Pairs& pairs, FormMeasurement& result) {
    constexpr float kLargest = 65535.0f;
    Sequence random;
    std::vector<float> codes;
    codes.reserve(std::size_t{2} * Pairs::kCount);
    for (int i = 0; i < 2 * Pairs::kCount; ++i) codes.push_back(narrow(std::floor(random.next() * 65536)));
    const Levels texture = made_levels(TexelFormat::Rg16Unorm, {2 * Pairs::kCount, 1}, 1,
                                       [&](int, int x, int) { return codes[static_cast<std::size_t>(x)] / kLargest; });
    std::string refused;
    const std::vector<float> values =
        try_samples(source, texture, clamped(Filter::Linear), Instruction::Lod, pairs.points, refused);
    constexpr float kReciprocal = 1.0f / kLargest;
    for (const Form form : kForms) {
        std::array<int, 3> equal{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const float a = codes[2 * pairs.pair[i]];
            const float b = codes[2 * pairs.pair[i] + 1];
            const float w = pairs.weights[i];
            equal[0] += values[i] == times(form(a, b, w), kReciprocal);
            equal[1] += values[i] == form(times(a, kReciprocal), times(b, kReciprocal), w);
            equal[2] += values[i] == form(a / kLargest, b / kLargest, w);
        }
        result.late_unorm = std::max(result.late_unorm, equal[0]);
        result.early_unorm = std::max({result.early_unorm, equal[1], equal[2]});
    }
}

}  // namespace

StepRule step_rule(const StepTable& table) {
    StepRule rule;
    rule.is_exact = table.last > 0 && table.distinct == table.last + 1;
    if (rule.is_exact || table.distinct < 2) return rule;
    for (int bits = 1; bits <= 12 && (1 << bits) < table.last; ++bits)
        for (const StepRounding rounding :
             {StepRounding::NearestEven, StepRounding::NearestUp, StepRounding::NearestDown, StepRounding::Truncate}) {
            rule.bits = bits;
            rule.rounding = rounding;
            if (explains(table, rule)) return rule;
        }
    return {};
}

WeightMeasurement measure_weights(const Source& source, TexelFormat format) {
    WeightMeasurement result{.format = format};
    const Levels edge = made_levels(format, {2, 1}, 1, [](int, int x, int) { return static_cast<float>(x); });
    const auto sweep = [&](const Levels& texture, int count, double step) {
        return try_samples(source, texture, clamped(Filter::Linear), Instruction::Lod, along_u(count, 0.25, step),
                           result.ramp.refused);
    };
    const std::vector<float> ramp = sweep(edge, kRampSteps + 1, 0x1p-17);
    if (ramp.empty()) return result;
    result.ramp = step_table(ramp);
    result.fine_distinct = count_distinct(sweep(edge, kFineSteps, 0x1p-25));
    result.is_filtered = result.ramp.distinct > 2;
    result.first_one = static_cast<int>(std::find(ramp.begin(), ramp.end(), ramp.back()) - ramp.begin());
    if (const float largest = largest_code(format); largest > 1) {
        const Levels near = made_levels(format, {2, 1}, 1, [&](int, int x, int) { return narrow((10.0 + x) / largest); });
        result.between_codes = count_distinct(sweep(near, kRampSteps + 1, 0x1p-17));
    }
    return result;
}

GatherMeasurement measure_gather(const Source& source) {
    GatherMeasurement result{.last = kRampSteps};
    const Levels texture = made_levels(TexelFormat::R32f, {4, 1}, 1, [](int, int x, int) { return static_cast<float>(x); });
    std::vector<Sample> samples;
    try {
        samples = source(texture, clamped(Filter::Nearest), Instruction::Gather,
                         along_u(kRampSteps + 1, 0.375, 0x1p-18));  // from the centre of texel 1
    } catch (const Error& error) {
        result.refused = error.what();
    }
    while (result.switch_position < static_cast<int>(samples.size()) &&
           samples[static_cast<std::size_t>(result.switch_position)][3] < 1.5f)
        ++result.switch_position;
    return result;
}

BoundaryMeasurement measure_boundaries(const Source& source, TexelFormat format) {
    BoundaryMeasurement result{.format = format};
    const float largest = largest_code(format);
    for (const int size : {2, 8, 256, 3, 7, 100}) {
        const Levels texture =
            made_levels(format, {size, 1}, 1, [&](int, int x, int) { return static_cast<float>(x) / largest; });
        std::vector<int> texels{1};
        for (const int k : {size / 2, size - 1})
            if (k > texels.back()) texels.push_back(k);
        std::vector<Search> searches;
        searches.reserve(texels.size());
        for (const int k : texels)
            searches.push_back({.below = narrow((k - 0.5) / size),
                                .above = narrow((k + 0.5) / size),
                                .threshold = narrow((k - 0.5) / largest)});
        const std::vector<float> found = find_thresholds(searches, [&](std::span<const float> coordinates) {
            std::vector<Point> points;
            for (const float u : coordinates) points.push_back({.u = u, .v = 0.5f});
            return try_samples(source, texture, clamped(Filter::Nearest), Instruction::Lod, points, result.refused);
        });
        for (std::size_t i = 0; i < found.size(); ++i)
            result.boundaries.push_back({size, texels[i], found[i], double{found[i]} * size - texels[i]});
    }
    return result;
}

DecodeMeasurement measure_decode(const Source& source, TexelFormat format) {
    const int largest = static_cast<int>(largest_code(format));
    const int height = (largest + 1) / 256;
    DecodeMeasurement result{.format = format, .codes = largest + 1};
    const auto code = [](int x, int y) { return static_cast<float>(y * 256 + x); };
    const Levels texture =
        made_levels(format, {256, height}, 1, [&](int, int x, int y) { return code(x, y) / static_cast<float>(largest); });
    std::vector<Point> points;
    for (int i = 0; i <= largest; ++i)
        points.push_back({.u = narrow((i % 256 + 0.5) / 256), .v = narrow((i / 256 + 0.5) / height)});
    const std::vector<float> values =
        try_samples(source, texture, clamped(Filter::Nearest), Instruction::Lod, points, result.refused);
    const float reciprocal = 1.0f / static_cast<float>(largest);
    for (std::size_t i = 0; i < values.size(); ++i) {
        result.divides += values[i] == static_cast<float>(i) / static_cast<float>(largest);
        result.reciprocals += values[i] == times(static_cast<float>(i), reciprocal);
    }
    return result;
}

FormMeasurement measure_form(const Source& source, TexelFormat format, int weight_bits) {
    FormMeasurement result;
    const Pairs pairs(weight_bits);
    measure_float_form(source, format, pairs, result);
    if (!result.refused.empty()) return result;
    measure_unorm_form(source, pairs, result);

    // inf 1 1 inf: halfway between the first two, and the third alone.
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const Levels texture = made_levels(format, {4, 1}, 1, [](int, int x, int) { return x == 0 || x == 3 ? kInfinity : 1.0f; });
    const std::vector<Point> points{{.u = 1.0f / 4, .v = 0.5f}, {.u = 2.5f / 4, .v = 0.5f}};
    const std::vector<float> values =
        try_samples(source, texture, clamped(Filter::Linear), Instruction::Lod, points, result.refused);
    if (values.size() != points.size()) return result;
    result.keeps_infinity = values[0] == kInfinity;
    result.ignores_infinity = values[1] == 1.0f;
    return result;
}

DenormalMeasurement measure_denormals(const Source& source, TexelFormat format) {
    DenormalMeasurement result{.is_float32_filtered = format == TexelFormat::R32f};
    const auto at = [&](TexelFormat of, float first, Filter filter, float u) {
        const Levels texture = made_levels(of, {2, 1}, 1, [&](int, int x, int) { return x == 0 ? first : 2 * first; });
        const std::vector<float> values = try_samples(source, texture, clamped(filter), Instruction::Lod,
                                                      std::vector<Point>{{.u = u, .v = 0.5f}}, result.refused);
        return values.empty() ? 0.0f : values[0];
    };
    // A comparison with 0 could itself flush.
    const auto is_zero = [](float x) { return std::bit_cast<std::uint32_t>(x) << 1 == 0; };
    result.filter_flushes = is_zero(at(TexelFormat::R32f, 0x1p-130f, Filter::Linear, 0.5f));
    result.nearest_flushes = is_zero(at(TexelFormat::R32f, 0x1p-130f, Filter::Nearest, 0.25f));
    result.half_flushes = is_zero(at(TexelFormat::Rg16f, 0x1p-24f, Filter::Linear, 0.5f));
    return result;
}

CompareMeasurement measure_compare(const Source& source) {
    CompareMeasurement result;
    const Levels texture = made_levels(TexelFormat::D32f, {2, 1}, 1, [](int, int x, int) { return x == 0 ? 0.25f : 0.75f; });
    std::vector<Point> points = along_u(4097, 0.25, 0x1p-13);
    for (Point& point : points) point.reference = 0.5f;
    SamplerState sampler = clamped(Filter::Linear);
    sampler.compare = Compare::LessEqual;
    const std::vector<float> ramp = try_samples(source, texture, sampler, Instruction::Lod, points, result.ramp.refused);
    if (!ramp.empty()) result.ramp = step_table(ramp);

    sampler = clamped(Filter::Nearest);
    sampler.compare = Compare::LessEqual;
    std::vector<Point> close(3, {.u = 0.25f, .v = 0.5f, .reference = 0.25f});
    close[0].reference = std::nextafter(0.25f, 0.0f);
    close[2].reference = std::nextafter(0.25f, 1.0f);
    result.is_strict =
        try_samples(source, texture, sampler, Instruction::Lod, close, result.refused) == std::vector<float>{1.0f, 1.0f, 0.0f};
    return result;
}

Measurements measure_all(const Source& source) {
    Measurements all;
    for (const TexelFormat format : {TexelFormat::R32f, TexelFormat::Rg16f, TexelFormat::Rgba8, TexelFormat::Rg16Unorm})
        all.weights.push_back(measure_weights(source, format));
    all.gather = measure_gather(source);
    for (const TexelFormat format : {TexelFormat::R32f, TexelFormat::Rgba8, TexelFormat::Rg16Unorm})
        all.boundaries.push_back(measure_boundaries(source, format));
    for (const TexelFormat format : {TexelFormat::Rgba8, TexelFormat::Rg16Unorm})
        all.decode.push_back(measure_decode(source, format));

    // What cannot filter r32f is measured with halfs from here on.
    const bool wide = all.weights[0].is_filtered;
    all.filtered = wide ? TexelFormat::R32f : TexelFormat::Rg16f;
    const StepRule rule = step_rule(all.weights[wide ? 0 : 1].ramp);
    all.form = measure_form(source, all.filtered, rule.is_exact ? 8 : std::min(8, rule.bits.value_or(4)));
    all.denormals = measure_denormals(source, all.filtered);
    all.compare = measure_compare(source);
    all.mips = measure_mips(source, all.filtered);
    all.lod = measure_lod(source, all.filtered);
    all.aniso = measure_anisotropy(source, all.filtered);
    return all;
}

}  // namespace gnomon::agree
