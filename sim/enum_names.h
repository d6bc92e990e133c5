// Enumerations and their names on the command line, in profiles, reports and traces.
//
// An enumeration takes part by specialising kEnumNames<E> with an array of {value, name}.
#pragma once

#include "sim/error.h"

#include <array>
#include <string>
#include <string_view>
#include <type_traits>

namespace gnomon {

template <class E>
struct EnumName {
    E value;
    std::string_view name;
};

template <class E>
inline constexpr std::array<EnumName<E>, 0> kEnumNames{};

template <class E>
concept NamedEnum = std::is_enum_v<E> && (kEnumNames<E>.size() > 0);

/// Whether it is one of the named values; casts and foreign callers make others.
template <NamedEnum E>
constexpr bool is_valid(E value) {
    for (const auto& entry : kEnumNames<E>)
        if (entry.value == value) return true;
    return false;
}

template <NamedEnum E>
std::string_view name_of(E value) {
    for (const auto& entry : kEnumNames<E>)
        if (entry.value == value) return entry.name;
    return "?";
}

/// All names, comma separated: for messages and help.
template <NamedEnum E>
std::string names_of() {
    std::string all;
    for (const auto& entry : kEnumNames<E>) {
        if (!all.empty()) all += ", ";
        all += entry.name;
    }
    return all;
}

/// Throws Error, which names `what` and lists the choices, unless the value is one of them.
template <NamedEnum E>
void check_enum(E value, std::string_view what) {
    if (!is_valid(value)) fail("{}: value {} is not one of {}", what, static_cast<long long>(value), names_of<E>());
}

/// The value with this name; throws Error that names `what` and lists the choices.
template <NamedEnum E>
E enum_from_name(std::string_view name, std::string_view what) {
    for (const auto& entry : kEnumNames<E>)
        if (entry.name == name) return entry.value;
    fail("{}: '{}' is not one of {}", what, name, names_of<E>());
}

}  // namespace gnomon
