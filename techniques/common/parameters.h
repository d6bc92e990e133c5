// What a technique lets its user choose beyond format and filter: `--set name=value`, listed, checked and reported by name.
#pragma once

#include "sim/enum_names.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::techniques {

/// Words of parameters that are on or off.
enum class Switch { Off, On };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::Switch>{EnumName{techniques::Switch::Off, "off"},
                                                           EnumName{techniques::Switch::On, "on"}};
}  // namespace gnomon

namespace gnomon::techniques {

enum class ParameterKind {
    Number,  // finite decimal number
    Whole,   // integer
    Odd,     // odd integer
    Word,    // one of a list
};

/// One choice: its name, default and range.
struct Parameter {
    std::string_view name;
    std::string_view summary;  // one line, with units
    ParameterKind kind = ParameterKind::Number;
    double standard = 0;  // default; of words, the index
    double low = 0;
    double high = 0;
    std::vector<std::string_view> words{};
};

Parameter number(std::string_view name, double standard, double low, double high, std::string_view summary);
Parameter whole(std::string_view name, int standard, int low, int high, std::string_view summary);
Parameter odd(std::string_view name, int standard, int low, int high, std::string_view summary);

/// The names of an enumeration; `standard` is one of them.
template <NamedEnum E>
Parameter word(std::string_view name, E standard, std::string_view summary) {
    Parameter parameter{.name = name, .summary = summary, .kind = ParameterKind::Word};
    for (const auto& entry : kEnumNames<E>) {
        if (entry.value == standard) parameter.standard = static_cast<double>(parameter.words.size());
        parameter.words.push_back(entry.name);
    }
    parameter.high = static_cast<double>(parameter.words.size() - 1);
    return parameter;
}

/// Lists one after the other: what shared passes take, and what a technique adds.
std::vector<Parameter> operator+(std::vector<Parameter> first, const std::vector<Parameter>& second);

/// The default or a value, and what else is possible, as `gnomon list techniques` shows them.
std::string text_of(const Parameter& parameter, double value);
std::string range_of(const Parameter& parameter);

/// What a user sets: names and texts.
using ParameterTexts = std::vector<std::pair<std::string, std::string>>;

/// Every parameter of a technique with its value.
class ParameterValues {
public:
    ParameterValues() = default;
    /// Defaults, then `texts` in their order. Throws Error that names technique, parameter and what was expected.
    ParameterValues(std::string_view technique, std::span<const Parameter> parameters, const ParameterTexts& texts);

    /// Of a parameter that the technique has; anything else is our own mistake.
    [[nodiscard]] float number(std::string_view name) const { return static_cast<float>(find(name).value); }
    [[nodiscard]] int whole(std::string_view name) const { return static_cast<int>(find(name).value); }
    template <NamedEnum E>
    [[nodiscard]] E word(std::string_view name) const {
        return kEnumNames<E>.at(static_cast<std::size_t>(whole(name))).value;
    }
    /// Nothing for a parameter that the technique does not have.
    [[nodiscard]] std::optional<double> value_of(std::string_view name) const;
    /// Puts another value in the place of what was said: what it comes to.
    void settle(std::string_view name, double value);
    /// Whether the user, rather than the default, said so.
    [[nodiscard]] bool is_set(std::string_view name) const { return find(name).is_set; }

    /// A parameter, its value, and whether the user gave it.
    struct Entry {
        Parameter parameter;
        double value = 0;
        bool is_set = false;
    };
    [[nodiscard]] std::span<const Entry> entries() const { return entries_; }

private:
    [[nodiscard]] const Entry& find(std::string_view name) const;

    std::vector<Entry> entries_;
};

}  // namespace gnomon::techniques
