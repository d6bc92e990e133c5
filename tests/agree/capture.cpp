#include "tests/agree/capture.h"

#include "tests/agree/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace gnomon::agree {
namespace {

constexpr std::size_t kMostSteps = 1100;  // of 10 bits and some

std::string steps_text(const StepTable& table) {
    if (!table.refused.empty()) return "refused: " + table.refused;
    std::string text =
        fmt::format("{} values at {} positions{}", table.distinct, table.last + 1, table.is_monotone ? "" : ", not monotone");
    if (table.steps.size() > kMostSteps) return text;
    text += ';';
    for (const StepTable::Step& step : table.steps) text += fmt::format(" {}={:.9g}", step.position, step.value);
    return text;
}

std::string line_text(const ProbeLine& line) {
    std::string text = fmt::format("ratio {:g} limit {}:", line.ratio, line.limit);
    if (line.is_smooth) return text + " smooth";
    for (std::size_t i = 0; i < line.positions.size(); ++i)
        text += fmt::format(" {:.4f}*{:.4f}", line.positions[i], line.weights[i]);
    return text;
}

class Lines {
public:
    template <class... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        text_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
};

void add_texels(Lines& lines, const Measurements& all) {
    for (const WeightMeasurement& weights : all.weights) {
        const std::string_view name = name_of(weights.format);
        lines.add("weights {}: {}", name, steps_text(weights.ramp));
        lines.add("weights {} first 1: {}; of 1024 fine positions: {}; between two codes: {}", name, weights.first_one,
                  weights.fine_distinct, weights.between_codes);
    }
    lines.add("gather footprint moves at: {} of {}{}", all.gather.switch_position, all.gather.last, all.gather.refused);
    for (const BoundaryMeasurement& measured : all.boundaries)
        for (const TexelBoundary& boundary : measured.boundaries)
            lines.add("nearest {} texel {} of {} from: {:a} ({:+.9g} texels)", name_of(measured.format), boundary.texel,
                      boundary.size, boundary.coordinate, boundary.offset_texels);
    for (const DecodeMeasurement& decode : all.decode)
        lines.add("decode {}: of {} codes, quotients {}, reciprocal products {}", name_of(decode.format), decode.codes,
                  decode.divides, decode.reciprocals);
    const FormMeasurement& form = all.form;
    lines.add("two texels {}: of {}, a + w (b - a) {}, fused {}, products {}; keeps infinity {}, ignores it at weight 0 {}",
              name_of(all.filtered), form.samples, form.lerps, form.fused, form.products, form.keeps_infinity,
              form.ignores_infinity);
    lines.add("two texels rg16unorm: of {}, codes filtered {}, numbers filtered {}", form.samples, form.late_unorm,
              form.early_unorm);
    lines.add("denormals flushed: filter of r32f {}, r32f alone {}, filter of rg16f {}", all.denormals.filter_flushes,
              all.denormals.nearest_flushes, all.denormals.half_flushes);
    lines.add("compare d32f filtered: {}", steps_text(all.compare.ramp));
    lines.add("compare d32f exact to the ulp: {}", all.compare.is_strict);
}

void add_levels(Lines& lines, const Measurements& all) {
    const MipMeasurement& mips = all.mips;
    lines.add("lod 0 to 1: {}", steps_text(mips.ramp));
    lines.add("lod of 1024 fine positions: {}", mips.fine_distinct);
    std::vector<std::string> switches;
    switches.reserve(mips.switch_lod.size());
    for (const float lod : mips.switch_lod) switches.push_back(fmt::format("{:a}", lod));
    lines.add("nearest levels from: {}; at halves: {}", fmt::join(switches, " "), fmt::join(mips.at_half, " "));
    lines.add("lod limits after bias: {}", mips.clamps_after_bias);
    std::string curve;
    for (const GradientLod& point : all.lod.isotropic) curve += fmt::format(" {:.7g}", point.lod);
    lines.add("lod of 2^(3 k / 200) texels, k = 0 to 200:{}", curve);
    for (const GradientLod& point : all.lod.oblique) lines.add("lod of {}: {:.7g}", fmt::join(point.texels, " "), point.lod);
}

void add_anisotropy(Lines& lines, const AnisoMeasurement& aniso) {
    if (!aniso.refused.empty()) lines.add("probes refused: {}", aniso.refused);
    for (const auto* group : {&aniso.ratios, &aniso.beyond, &aniso.limits})
        for (const ProbeLine& line : *group) lines.add("probes {}", line_text(line));
    for (const auto* group : {&aniso.straight, &aniso.oblique, &aniso.magnified})
        for (const AnisoLod& lod : *group)
            lines.add("anisotropic lod of {}, bias {:g}: {:.7g}", fmt::join(lod.texels, " "), lod.bias, lod.lod);
    for (const auto& [name, distances] :
         {std::pair{"interior", &aniso.magnified_interior}, std::pair{"centred", &aniso.magnified_centred}}) {
        std::vector<std::string> numbers;
        for (const double distance : *distances) numbers.push_back(fmt::format("{:.4f}", distance));
        lines.add("minor axis 1/2 texel, ratio 8, off 1 to 16 {} probes by: {}", name, fmt::join(numbers, " "));
    }
}

}  // namespace

std::string capture_text(const Measurements& all) {
    Lines lines;
    lines.add("device: {}", all.device);
    add_texels(lines, all);
    add_levels(lines, all);
    add_anisotropy(lines, all.aniso);
    return lines.text();
}

}  // namespace gnomon::agree
