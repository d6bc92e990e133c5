// Profiles as JSON: every preset survives the way there and back, and every mistake is named.
#include "sim/error.h"
#include "sim/profile.h"

#include <catch2/catch.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <unistd.h>

using namespace gnomon;

namespace {

std::string message_of(std::string_view json) {
    try {
        (void)profile_from_json(json, "test.json");
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

bool mentions(const std::string& message, std::string_view what) {
    return message.starts_with("test.json: ") && message.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE("presets round-trip through JSON", "[profile]") {
    REQUIRE(profile_presets().size() >= 2);
    CHECK(profile_presets().front().name == "d3d11");
    CHECK(profile_presets().front() == [] {
        Profile p;
        p.name = "d3d11";
        p.summary = profile_presets().front().summary;
        return p;
    }());
    for (const Profile& preset : profile_presets()) {
        CHECK(profile_from_json(profile_to_json(preset), "x") == preset);
        CHECK(load_profile(preset.name) == preset);
    }
}

namespace {

/// Another value than the one it has.
void change(std::string& value) { value += " \"changed\" \xc3\xa9"; }
void change(bool& value) { value = !value; }
void change(int& value) { value = value == 8 ? 5 : 8; }
template <std::size_t kCount>
void change(std::array<SamplePosition, kCount>& value) {
    value.back() = value.back() == SamplePosition{0, 15} ? SamplePosition{15, 0} : SamplePosition{0, 15};
}
template <NamedEnum E>
void change(E& value) {
    value = value == kEnumNames<E>.back().value ? kEnumNames<E>.front().value : kEnumNames<E>.back().value;
}

}  // namespace

TEST_CASE("every field round-trips when it differs from the default", "[profile]") {
    Profile profile;
    profile.name = "odd";
    for_each_field(profile, [](std::string_view, auto& value) { change(value); });
    CHECK(profile_from_json(profile_to_json(profile), "x") == profile);
    profile.texel_fraction_bits = profile.lod_fraction_bits = kExactBits;
    CHECK(profile_from_json(profile_to_json(profile), "x") == profile);

    // None is missing from fields(): each member alone makes profiles differ, and each is written by name.
    std::size_t fields = 0;
    for_each_field(profile, [&](std::string_view name, const auto&) {
        ++fields;
        CHECK(profile_to_json(profile).find('"' + std::string(name) + '"') != std::string::npos);
    });
    CHECK(fields == 56);
}

TEST_CASE("every field of every preset says how sure it is and why", "[profile]") {
    for (const Profile& preset : profile_presets()) {
        INFO(preset.name);
        std::vector<std::string_view> expected;
        for_each_field(preset, [&](std::string_view name, const auto&) {
            if (name != "name" && name != "summary") expected.push_back(name);
        });
        const auto said = provenance_of(preset.name);
        REQUIRE(said.size() == expected.size());
        for (std::size_t i = 0; i < said.size(); ++i) {
            CHECK(said[i].field == expected[i]);
            CHECK(said[i].source.size() > 5);
        }
    }
    CHECK(provenance_of("nobody").empty());
    // What nobody outside knows is called assumed: hardware_facts, not wishes.
    const auto certainty = [](std::string_view preset, std::string_view field) {
        for (const Provenance& entry : provenance_of(preset))
            if (entry.field == field) return entry.certainty;
        return Certainty::Specified;
    };
    CHECK(certainty("nv40", "texel_fraction_bits") == Certainty::Assumed);
    CHECK(certainty("g80", "texel_fraction_bits") == Certainty::Documented);
    CHECK(certainty("d3d11", "texel_fraction_bits") == Certainty::Specified);
    CHECK(certainty("d3d11", "probe_placement") == Certainty::Assumed);
}

TEST_CASE("a base gives what is not mentioned", "[profile]") {
    // What differs from a preset does not go by its name.
    const auto changed = [](const char* preset) {
        Profile profile = load_profile(preset);
        profile.name = "mine";
        profile.summary = std::string("changed from ") + preset;
        return profile;
    };
    Profile expected = changed("ideal");
    expected.raster_subpixel_bits = 4;
    CHECK(profile_from_json(R"({"base": "ideal", "raster_subpixel_bits": 4})", "folder/mine.json") == expected);
    expected = changed("d3d11");
    expected.lod_fraction_bits = kExactBits;
    CHECK(profile_from_json(R"({"lod_fraction_bits": "exact"})", "mine.json") == expected);
    CHECK(profile_from_json("{}", "mine.json") == changed("d3d11"));
    expected.name = "told";
    CHECK(profile_from_json(R"({"lod_fraction_bits": "exact", "name": "told"})", "mine.json") == expected);
    CHECK_THROWS_AS(profile_from_json(R"({"lod_fraction_bits": "exact", "name": "d3d11"})", "mine.json"), Error);
    CHECK_THROWS_AS(profile_from_json(R"({"name": "two\nlines"})", "mine.json"), Error);
}

TEST_CASE("mistakes in profiles are named", "[profile][errors]") {
    CHECK(mentions(message_of(""), "JSON"));
    CHECK(mentions(message_of("{"), "JSON"));
    CHECK(mentions(message_of("[1]"), "object"));
    CHECK(mentions(message_of("3"), "object"));
    CHECK(mentions(message_of(R"({"colour": 1})"), "colour"));
    CHECK(mentions(message_of(R"({"base": 1})"), "base"));
    CHECK(mentions(message_of(R"({"base": "g90"})"), "g90"));
    CHECK(mentions(message_of(R"({"base": "d3d11", "x": 1})"), "'x'"));
    CHECK(mentions(message_of(R"({"name": 1})"), "name"));
    CHECK(mentions(message_of(R"({"flush_denormals": 1})"), "flush_denormals"));
    CHECK(mentions(message_of(R"({"arithmetic": "fp16"})"), "fp16"));
    CHECK(mentions(message_of(R"({"arithmetic": 32})"), "arithmetic"));
    CHECK(mentions(message_of(R"({"raster_subpixel_bits": 0})"), "raster_subpixel_bits"));
    CHECK(mentions(message_of(R"({"raster_subpixel_bits": 9})"), "9"));
    CHECK(mentions(message_of(R"({"raster_subpixel_bits": -1})"), "-1"));
    CHECK(mentions(message_of(R"({"raster_subpixel_bits": "exact"})"), "raster_subpixel_bits"));
    CHECK(mentions(message_of(R"({"max_samples": 3})"), "1, 2, 4, 8 or 16"));
    CHECK(mentions(message_of(R"({"max_samples": 0})"), "max_samples"));
    CHECK(mentions(message_of(R"({"max_samples": 32})"), "32"));
    CHECK(mentions(message_of(R"({"max_targets": 9})"), "max_targets"));
    CHECK(mentions(message_of(R"({"texel_fraction_bits": 8.5})"), "texel_fraction_bits"));
    CHECK(mentions(message_of(R"({"texel_fraction_bits": -1})"), "texel_fraction_bits"));
    CHECK(mentions(message_of(R"({"texel_fraction_bits": 4294967298})"), "texel_fraction_bits"));
    CHECK(mentions(message_of(R"({"texel_fraction_bits": 18446744073709551615})"), "texel_fraction_bits"));
    CHECK(mentions(message_of(R"({"texel_fraction_bits": null})"), "texel_fraction_bits"));
    CHECK(mentions(message_of(R"({"lod_fraction_bits": "all"})"), "lod_fraction_bits"));
    CHECK(mentions(message_of(R"({"texel_rounding": "nearest"})"), "nearest-even"));  // lists the choices
    // Deep nesting is an error, not a crash.
    CHECK(message_of(std::string(100000, '[')) != "no error");
    CHECK(message_of("{\"name\": \"\xff\"}") != "no error");
}

TEST_CASE("a profile may come from a file", "[profile]") {
    CHECK_THROWS_AS(load_profile("/nonexistent/profile.json"), Error);
    CHECK_THROWS_AS(load_profile(""), Error);
    CHECK_THROWS_AS(load_profile("/"), Error);
    const std::string path =
        (std::filesystem::temp_directory_path() / fmt::format("gnomon_profile_{}.json", getpid())).string();
    {
        std::ofstream file(path);
        file << R"({"base": "ideal", "name": "mine"})";
    }
    CHECK(load_profile(path).name == "mine");
    CHECK(load_profile(path).arithmetic == Arithmetic::Fp64);
    std::remove(path.c_str());
}
