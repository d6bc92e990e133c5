#include "sim/profile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

namespace gnomon {

namespace {

void write_field(nlohmann::ordered_json& json, const std::string& key, const std::string& value) { json[key] = value; }
void write_field(nlohmann::ordered_json& json, const std::string& key, bool value) { json[key] = value; }
void write_field(nlohmann::ordered_json& json, const std::string& key, int value) {
    if (value == kExactBits) {
        json[key] = "exact";
    } else {
        json[key] = value;
    }
}
template <std::size_t kCount>
void write_field(nlohmann::ordered_json& json, const std::string& key, const std::array<SamplePosition, kCount>& positions) {
    auto list = nlohmann::ordered_json::array();
    for (const SamplePosition& at : positions) list.push_back({at.x, at.y});
    json[key] = std::move(list);
}
template <NamedEnum E>
void write_field(nlohmann::ordered_json& json, const std::string& key, E value) {
    json[key] = name_of(value);
}

void read_field(const nlohmann::json& json, const std::string& what, std::string& value) {
    if (!json.is_string()) fail("{}: expected a string", what);
    value = json.get<std::string>();
}
void read_field(const nlohmann::json& json, const std::string& what, bool& value) {
    if (!json.is_boolean()) fail("{}: expected true or false", what);
    value = json.get<bool>();
}
/// What a field of whole numbers may be, by its name.
struct IntChoices {
    bool may_be_exact = false;
    bool is_sample_count = false;

    explicit IntChoices(std::string_view name)
        : may_be_exact(name.ends_with("texel_fraction_bits") || name.ends_with("lod_fraction_bits")),
          is_sample_count(name.ends_with("max_samples")) {}

    [[nodiscard]] bool has(int value) const {
        if (is_sample_count) return value == 1 || value == 2 || value == 4 || value == 8 || value == 16;
        return (value >= 1 && value <= 8) || (may_be_exact && value == kExactBits);
    }
    [[nodiscard]] std::string_view text() const {
        if (is_sample_count) return "expected 1, 2, 4, 8 or 16";
        return may_be_exact ? "expected a whole number from 1 to 8, or \"exact\"" : "expected a whole number from 1 to 8";
    }
};

void read_field(const nlohmann::json& json, const std::string& what, int& value) {
    const IntChoices choices(what);
    if (choices.may_be_exact && json.is_string() && json.get<std::string>() == "exact") {
        value = kExactBits;
        return;
    }
    if (!json.is_number_integer()) fail("{}: {}", what, choices.text());
    if (json < 1 || json > 16 || !choices.has(json.get<int>())) fail("{}: is {}; {}", what, json.dump(), choices.text());
    value = json.get<int>();
}
template <std::size_t kCount>
void read_field(const nlohmann::json& json, const std::string& what, std::array<SamplePosition, kCount>& value) {
    const auto whole = [](const nlohmann::json& x) { return x.is_number_integer() && x >= 0 && x <= 15; };
    const auto position = [&](const nlohmann::json& at) {
        return at.is_array() && at.size() == 2 && whole(at[0]) && whole(at[1]);
    };
    if (!json.is_array() || json.size() != kCount || !std::ranges::all_of(json, position))
        fail("{}: expected {} pairs [x, y] of whole numbers from 0 to 15, in sixteenths of a pixel", what, kCount);
    for (std::size_t i = 0; i < kCount; ++i) value[i] = {json[i][0].get<int>(), json[i][1].get<int>()};
}
template <NamedEnum E>
void read_field(const nlohmann::json& json, const std::string& what, E& value) {
    if (!json.is_string()) fail("{}: expected one of {}", what, names_of<E>());
    value = enum_from_name<E>(json.get<std::string>(), what);
}

void check_field(const std::string&, const std::string&) {}
void check_field(const std::string&, bool) {}
void check_field(const std::string& what, int value) {
    const IntChoices choices(what);
    if (!choices.has(value)) fail("{}: is {}; {}", what, value, choices.text());
}
template <std::size_t kCount>
void check_field(const std::string& what, const std::array<SamplePosition, kCount>& positions) {
    for (const SamplePosition& at : positions)
        if (at.x < 0 || at.x > 15 || at.y < 0 || at.y > 15)
            fail("{}: a sample at ({}, {}); expected 0 to 15, in sixteenths of a pixel", what, at.x, at.y);
}
template <NamedEnum E>
void check_field(const std::string& what, E value) {
    check_enum(value, what);
}

}  // namespace

void check_profile(const Profile& profile, std::string_view where) {
    for_each_field(profile,
                   [&](std::string_view name, const auto& value) { check_field(fmt::format("{}: {}", where, name), value); });
}

std::string profile_to_json(const Profile& profile) {
    nlohmann::ordered_json json;
    for_each_field(profile, [&](std::string_view name, const auto& value) { write_field(json, std::string(name), value); });
    return json.dump(2);
}

Profile profile_from_json(std::string_view text, std::string_view where) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_discarded()) fail("{}: not valid JSON; expected a profile object", where);
    if (!json.is_object()) fail("{}: expected a JSON object with profile fields", where);

    // Start from the base preset.
    Profile profile = profile_presets().front();
    if (const auto base = json.find("base"); base != json.end()) {
        if (!base->is_string()) fail("{}: base: expected the name of a preset", where);
        const auto wanted = base->get<std::string>();
        bool found = false;
        for (const Profile& preset : profile_presets()) {
            if (preset.name == wanted) {
                profile = preset;
                found = true;
            }
        }
        if (!found) fail("{}: base: '{}' is not a preset; see 'gnomon list profiles'", where, wanted);
    }

    // What differs from a preset does not go by its name: by the file's, unless it says another.
    profile.summary = "changed from " + profile.name;
    profile.name = std::filesystem::path(where).stem().string();

    // Take what the object mentions, and nothing that no field has.
    std::size_t known = json.contains("base") ? 1 : 0;
    for_each_field(profile, [&](std::string_view name, auto& value) {
        const auto entry = json.find(std::string(name));
        if (entry == json.end()) return;
        ++known;
        read_field(*entry, fmt::format("{}: {}", where, name), value);
    });
    for (const Profile& preset : profile_presets())
        if (profile.name == preset.name && profile != preset)
            fail("{}: name: '{}' is a preset's; choose another", where, preset.name);
    for (const std::string* text_field : {&profile.name, &profile.summary})
        if (std::ranges::any_of(*text_field, [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
            fail("{}: name and summary must be one line of text", where);
    if (known == json.size()) return profile;
    for (const auto& [key, value] : json.items()) {
        bool is_field = key == "base";
        for_each_field(profile, [&](std::string_view name, const auto&) { is_field = is_field || key == name; });
        if (!is_field) fail("{}: unknown field '{}'; 'gnomon list profiles --verbose' shows the fields", where, key);
    }
    return profile;
}

Profile load_profile(const std::string& name_or_path) {
    for (const Profile& preset : profile_presets())
        if (preset.name == name_or_path) return preset;
    std::error_code ignored;
    const bool regular = std::filesystem::is_regular_file(name_or_path, ignored);  // before opening: a pipe would wait
    std::ifstream file(regular ? name_or_path : std::string(), std::ios::binary);
    if (!file) fail("profile '{}': neither a preset (see 'gnomon list profiles') nor a file that can be read", name_or_path);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return profile_from_json(text, name_or_path);
}

}  // namespace gnomon
