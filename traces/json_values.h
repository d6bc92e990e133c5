// Values of the machine as JSON: numbers that read back to the same bits, structs by field name.
//
// A float is written as the shortest decimal that gives it back; NaN and infinities, which JSON lacks, are strings.
#pragma once

#include "pipeline/program.h"

#include <nlohmann/json.hpp>

namespace gnomon::traces {

using Json = nlohmann::ordered_json;

/// 0.1f is 0.1, an infinity "inf" or "-inf", a NaN "nan:" and its eight hexadecimal digits.
Json json_of(float value);

Json json_of(const glm::vec2& value);
Json json_of(const glm::vec3& value);
Json json_of(const glm::vec4& value);
Json json_of(const glm::mat4& value);  // four columns

/// A texture constant is {"texture": id}, a buffer {"buffer": id}; everything else is a number, an array or an object with
/// named fields.
Json json_of(const ConstantValue& value);

inline Json json_of(bool value) { return value; }
inline Json json_of(int value) { return value; }
template <NamedEnum E>
Json json_of(E value) {
    return name_of(value);
}

/// Every field of a plain struct, in order.
template <HasFields T>
Json json_of(const T& object) {
    Json json = Json::object();
    for_each_field(object, [&](std::string_view name, const auto& value) { json[std::string(name)] = json_of(value); });
    return json;
}

/// One line; bytes that are not UTF-8 (names from files) are replaced, never an error.
std::string to_line(const Json& json);

}  // namespace gnomon::traces
