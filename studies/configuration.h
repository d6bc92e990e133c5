// What a run was told, for machines and for people.
#pragma once

#include "studies/experiment.h"
#include "traces/json_values.h"

#include <cstdint>
#include <string>

namespace gnomon::studies {

/// Everything it takes to render the same bytes again. `technique` of the request is the one that ran.
traces::Json configuration_json(const RenderRequest& request, const techniques::TechniqueSettings& settings,
                                const Profile& profile);

/// Named numbers and counts, by name.
template <HasFields T>
traces::Json fields_json(const T& values) {
    traces::Json json;
    for_each_field(values, [&](std::string_view name, const auto& value) { json[std::string(name)] = value; });
    return json;
}

/// JSON as files hold it: indented, a line end behind it; bytes that are not UTF-8 (names of files) are replaced.
std::string file_text(const traces::Json& json);

/// What the technique was told, as on the command line; only what it takes.
std::string settings_text(const std::string& technique_name, const techniques::TechniqueSettings& settings);

/// 1234567 as 1,234,567.
std::string grouped(std::uint64_t value);

}  // namespace gnomon::studies
