// Named choices: parsed, checked, listed.
#include "techniques/common/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gnomon::techniques {

namespace {

/// Throws Error unless the text is a value of the parameter.
double parse(std::string_view technique, const Parameter& parameter, const std::string& text) {
    const auto refuse = [&] { fail("--set {}={}: {} expects {}", parameter.name, text, technique, range_of(parameter)); };
    if (parameter.kind == ParameterKind::Word) {
        const auto at = std::ranges::find(parameter.words, text);
        if (at == parameter.words.end()) refuse();
        return static_cast<double>(at - parameter.words.begin());
    }
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) refuse();
    if (!(value >= parameter.low && value <= parameter.high)) refuse();
    if (parameter.kind == ParameterKind::Number) return value;
    if (value != std::floor(value)) refuse();
    if (parameter.kind == ParameterKind::Odd && std::fmod(value, 2.0) == 0.0) refuse();
    return value;
}

}  // namespace

Parameter number(std::string_view name, double standard, double low, double high, std::string_view summary) {
    return {.name = name, .summary = summary, .kind = ParameterKind::Number, .standard = standard, .low = low, .high = high};
}

Parameter whole(std::string_view name, int standard, int low, int high, std::string_view summary) {
    return {.name = name,
            .summary = summary,
            .kind = ParameterKind::Whole,
            .standard = standard * 1.0,
            .low = low * 1.0,
            .high = high * 1.0};
}

Parameter odd(std::string_view name, int standard, int low, int high, std::string_view summary) {
    Parameter parameter = whole(name, standard, low, high, summary);
    parameter.kind = ParameterKind::Odd;
    return parameter;
}

std::vector<Parameter> operator+(std::vector<Parameter> first, const std::vector<Parameter>& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

std::string text_of(const Parameter& parameter, double value) {
    if (parameter.kind == ParameterKind::Word) return std::string(parameter.words.at(static_cast<std::size_t>(value)));
    return fmt::format("{:g}", value);
}

std::string range_of(const Parameter& parameter) {
    switch (parameter.kind) {
        case ParameterKind::Number: return fmt::format("a number from {:g} to {:g}", parameter.low, parameter.high);
        case ParameterKind::Whole: return fmt::format("a whole number from {} to {}", parameter.low, parameter.high);
        case ParameterKind::Odd: return fmt::format("an odd number from {} to {}", parameter.low, parameter.high);
        case ParameterKind::Word: break;
    }
    return fmt::format("{}", fmt::join(parameter.words, ", "));
}

ParameterValues::ParameterValues(std::string_view technique, std::span<const Parameter> parameters,
                                 const ParameterTexts& texts) {
    entries_.reserve(parameters.size());
    for (const Parameter& parameter : parameters) entries_.push_back({.parameter = parameter, .value = parameter.standard});
    for (const auto& [name, text] : texts) {
        const auto at = std::ranges::find(entries_, name, [](const Entry& entry) { return entry.parameter.name; });
        if (at == entries_.end()) {
            std::vector<std::string_view> names;
            names.reserve(parameters.size());
            for (const Parameter& parameter : parameters) names.push_back(parameter.name);
            if (names.empty()) fail("--set {}={}: {} has no parameters", name, text, technique);
            fail("--set {}={}: {} has no parameter of that name; expected one of {}", name, text, technique,
                 fmt::join(names, ", "));
        }
        at->value = parse(technique, at->parameter, text);
        at->is_set = true;
    }
}

std::optional<double> ParameterValues::value_of(std::string_view name) const {
    const auto at = std::ranges::find(entries_, name, [](const Entry& entry) { return entry.parameter.name; });
    return at == entries_.end() ? std::nullopt : std::optional(at->value);
}

void ParameterValues::settle(std::string_view name, double value) {
    const auto at = std::ranges::find(entries_, name, [](const Entry& entry) { return entry.parameter.name; });
    GNOMON_CHECK(at != entries_.end());
    at->value = value;
}

const ParameterValues::Entry& ParameterValues::find(std::string_view name) const {
    const auto at = std::ranges::find(entries_, name, [](const Entry& entry) { return entry.parameter.name; });
    GNOMON_CHECK(at != entries_.end());
    return *at;
}

}  // namespace gnomon::techniques
