// What techniques let their users choose: defaults, ranges, refusals, and the tables of every technique.
#include "techniques/technique.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <set>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

enum class Fruit { Apple, Pear };

const std::vector<Parameter>& parameters();

ParameterValues values(const ParameterTexts& texts) { return {"basket", parameters(), texts}; }

/// The message of a refusal.
std::string refusal(const ParameterTexts& texts) {
    try {
        (void)values(texts);
    } catch (const Error& error) {
        return error.what();
    }
    return "taken";
}

}  // namespace

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<Fruit>{EnumName{Fruit::Apple, "apple"}, EnumName{Fruit::Pear, "pear"}};
}  // namespace gnomon

namespace {

const std::vector<Parameter>& parameters() {
    static const std::vector all{number("weight", 0.5, 0, 2, "kg"), whole("count", 3, 1, 16, "of fruit"),
                                 odd("seeds", 5, 1, 63, "per fruit"), word("kind", Fruit::Pear, "of fruit")};
    return all;
}

}  // namespace

TEST_CASE("parameters: defaults, and what is set", "[parameters]") {
    const ParameterValues standard = values({});
    CHECK(standard.number("weight") == 0.5f);
    CHECK(standard.whole("count") == 3);
    CHECK(standard.whole("seeds") == 5);
    CHECK(standard.word<Fruit>("kind") == Fruit::Pear);
    CHECK(standard.entries().size() == 4);
    for (const auto& entry : standard.entries()) CHECK_FALSE(entry.is_set);

    const ParameterValues all = values({{"weight", "1.25e0"}, {"count", "16"}, {"seeds", "63"}, {"kind", "apple"}});
    CHECK(all.number("weight") == 1.25f);
    CHECK(all.whole("count") == 16);
    CHECK(all.whole("seeds") == 63);
    CHECK(all.word<Fruit>("kind") == Fruit::Apple);
    for (const auto& entry : all.entries()) CHECK(entry.is_set);

    // Set twice, the last wins; a default that is asked for counts as set.
    const ParameterValues twice = values({{"count", "4"}, {"kind", "apple"}, {"count", "3"}});
    CHECK(twice.whole("count") == 3);
    CHECK(twice.is_set("count"));
    CHECK(twice.is_set("kind"));
    CHECK_FALSE(twice.is_set("weight"));
}

TEST_CASE("parameters: ends of ranges are in them", "[parameters]") {
    CHECK(values({{"weight", "0"}}).number("weight") == 0.0f);
    CHECK(values({{"weight", "2"}}).number("weight") == 2.0f);
    CHECK(values({{"weight", "1e-30"}}).number("weight") == 1e-30f);
    CHECK(values({{"count", "1"}}).whole("count") == 1);
    CHECK(values({{"count", "16.0"}}).whole("count") == 16);
    CHECK(values({{"seeds", "1"}}).whole("seeds") == 1);
}

TEST_CASE("parameters: refusals say what was expected", "[parameters][errors]") {
    for (const char* text : {"-0.1", "2.0001", "nan", "inf", "-inf", "1e999", "", " 1", "1 ", "1x", "0x1", "+1", "one", "1,5"})
        CHECK(refusal({{"weight", text}}) == fmt::format("--set weight={}: basket expects a number from 0 to 2", text));
    for (const char* text : {"0", "17", "2.5", "-1", "nan", "3 apples"})
        CHECK(refusal({{"count", text}}) == fmt::format("--set count={}: basket expects a whole number from 1 to 16", text));
    for (const char* text : {"2", "0", "64", "65", "1.5"})
        CHECK(refusal({{"seeds", text}}) == fmt::format("--set seeds={}: basket expects an odd number from 1 to 63", text));
    for (const char* text : {"", "plum", "Apple", "0", "apple "})
        CHECK(refusal({{"kind", text}}) == fmt::format("--set kind={}: basket expects apple, pear", text));
    CHECK(refusal({{"colour", "red"}}) ==
          "--set colour=red: basket has no parameter of that name; expected one of weight, count, seeds, kind");
    CHECK(refusal({{"", "red"}}) ==
          "--set =red: basket has no parameter of that name; expected one of weight, count, seeds, kind");
    CHECK(refusal({{"count", "2"}, {"count", "x"}}) == "--set count=x: basket expects a whole number from 1 to 16");
    CHECK_THROWS_WITH(ParameterValues("plain", {}, {{"a", "b"}}), "--set a=b: plain has no parameters");
}

TEST_CASE("parameters: as lists show them", "[parameters]") {
    CHECK(text_of(parameters()[0], 0.5) == "0.5");
    CHECK(text_of(parameters()[0], 1e-5) == "1e-05");
    CHECK(text_of(parameters()[1], 3) == "3");
    CHECK(text_of(parameters()[3], parameters()[3].standard) == "pear");
    CHECK(range_of(parameters()[3]) == "apple, pear");
}

TEST_CASE("every technique has a name, summary, source, formats, filters and parameters of their own names", "[techniques]") {
    std::set<std::string_view> names;
    for (const Technique& technique : all_techniques()) {
        INFO(technique.name);
        CHECK(names.insert(technique.name).second);
        CHECK(&find_technique(technique.name) == &technique);
        CHECK_FALSE(technique.summary.empty());
        CHECK(technique.summary.find('\n') == std::string_view::npos);
        CHECK(technique.source.starts_with("["));
        CHECK_FALSE(technique.formats.empty());
        CHECK_FALSE(technique.filters.empty());
        CHECK(technique.make != nullptr);
        CHECK(std::set(technique.formats.begin(), technique.formats.end()).size() == technique.formats.size());
        CHECK(std::set(technique.filters.begin(), technique.filters.end()).size() == technique.filters.size());

        std::set<std::string_view> parameter_names;
        for (const Parameter& parameter : technique.parameters) {
            INFO(parameter.name);
            CHECK(parameter_names.insert(parameter.name).second);
            CHECK_FALSE(parameter.summary.empty());
            CHECK((parameter.low <= parameter.standard && parameter.standard <= parameter.high));
            // What a list shows as the default is taken, and is the default: six digits name it.
            const std::string text = text_of(parameter, parameter.standard);
            const ParameterValues set("t", technique.parameters, {{std::string(parameter.name), text}});
            const auto at = std::ranges::find(set.entries(), parameter.name, [](const auto& e) { return e.parameter.name; });
            CHECK(at->value == Approx(parameter.standard).epsilon(1e-5));
        }
    }
    CHECK_THROWS_AS(find_technique("vsm "), Error);
}

TEST_CASE("every technique can say what a texel of its map takes, in every format", "[techniques]") {
    for (const Technique& technique : all_techniques())
        for (const Format format : technique.formats) {
            INFO(technique.name << " " << name_of(format));
            const auto of = [&](int size, int samples) {
                return storage_per_texel(
                    technique, resolve_settings(technique, {.map_size = size, .map_samples = samples, .format = format}));
            };
            CHECK(of(64, 1) >= 1);
            CHECK(of(64, 1) == of(16, 1));
            CHECK(of(64, 1) == of(64, 4));  // samples are resolved before anything reads them
        }
    const auto lvsm = [](const char* layers) {
        const Technique& technique = find_technique("lvsm");
        return storage_per_texel(technique, resolve_settings(technique, {.map_size = 16, .set = {{"layers", layers}}}));
    };
    CHECK(lvsm("1") == 4);
    CHECK(lvsm("2") == 8);
    CHECK(lvsm("3") == 16);
    CHECK(lvsm("16") == 64);
}

namespace {

std::string settings_refusal(std::string_view technique, const TechniqueRequest& request, const char* profile = "d3d11") {
    try {
        (void)resolve_settings(find_technique(technique), request, load_profile(profile));
    } catch (const Error& error) {
        return error.what();
    }
    return "taken";
}

}  // namespace

TEST_CASE("resolve_settings fills in defaults", "[techniques]") {
    for (const Technique& technique : all_techniques()) {
        INFO(technique.name);
        const TechniqueSettings settings = resolve_settings(technique, {});
        CHECK(settings.map_size == 1024);
        CHECK(settings.map_samples == 1);
        CHECK(settings.format == technique.formats.front());
        CHECK(settings.filter == technique.filters.front());
        CHECK(settings.anisotropy == technique.default_anisotropy);
        CHECK(settings.depth_bias == technique.default_depth_bias);
        CHECK(settings.slope_bias == technique.default_slope_bias);
        CHECK(settings.cascades == technique.default_cascades);
        const std::size_t of_splits = technique.default_cascades > 0 ? cascade_parameters().size() : 0;
        CHECK(settings.parameters.entries().size() == technique.parameters.size() + of_splits);
    }
    const TechniqueSettings chosen = resolve_settings(find_technique("vsm"), {.map_size = 1,
                                                                              .map_samples = 16,
                                                                              .format = Format::Rg16Unorm,
                                                                              .filter = MapFilter::Nearest,
                                                                              .anisotropy = 16,
                                                                              .depth_bias = -3,
                                                                              .slope_bias = 1.5f});
    CHECK(chosen.map_size == 1);
    CHECK(chosen.map_samples == 16);
    CHECK(chosen.format == Format::Rg16Unorm);
    CHECK(chosen.filter == MapFilter::Nearest);
    CHECK(chosen.anisotropy == 16);
    CHECK(chosen.depth_bias == -3);
    CHECK(chosen.slope_bias == 1.5f);
}

TEST_CASE("resolve_settings refuses what a technique or a profile has not", "[techniques][errors]") {
    CHECK(settings_refusal("vsm", {}) == "taken");
    for (const int size : {0, -1, 16385})
        CHECK(settings_refusal("vsm", {.map_size = size}) == fmt::format("--map {}: expected 1 to 16384 texels", size));
    for (const int samples : {0, -1, 3, 32})
        CHECK(settings_refusal("vsm", {.map_samples = samples}) ==
              fmt::format("--map-samples {}: expected 1, 2, 4, 8 or 16, and for profile d3d11 up to 16", samples));
    CHECK(settings_refusal("vsm", {.map_samples = 8}, "llvmpipe") ==
          "--map-samples 8: expected 1, 2, 4, 8 or 16, and for profile llvmpipe up to 4");
    CHECK(settings_refusal("vsm", {.format = Format::D16}) ==
          "--format d16: vsm does not offer it; expected one of rg32f, rg16f, rg16unorm, rg8unorm, rgba16f");
    CHECK(settings_refusal("esm", {.format = Format::Rg32Float}) ==
          "--format rg32f: esm does not offer it; expected one of r32f, r16f");
    CHECK(settings_refusal("pcf", {.filter = MapFilter::Trilinear}) ==
          "--filter trilinear: pcf does not offer it; expected one of nearest");
    for (const int anisotropy : {0, -1, 17})
        CHECK(settings_refusal("vsm", {.anisotropy = anisotropy}) == fmt::format("--aniso {}: expected 1 to 16", anisotropy));
    CHECK(settings_refusal("vsm", {.filter = MapFilter::ShaderBilinear, .anisotropy = 2}) ==
          "--aniso 2: shader-bilinear is one sample in the shader; expected 1");
    CHECK(settings_refusal("vsm", {.set = {{"taps", "3"}}}).starts_with("--set taps=3: vsm has no parameter of that name"));
    // nv40 does not filter 32-bit floats: a wish is refused, a default gives way.
    CHECK(settings_refusal("vsm", {.filter = MapFilter::Bilinear}, "nv40") ==
          "--filter bilinear: profile nv40 does not filter rg32f; expected shader-bilinear, nearest, or another --format");
    CHECK(resolve_settings(find_technique("vsm"), {}, load_profile("nv40")).filter == MapFilter::ShaderBilinear);
    CHECK(resolve_settings(find_technique("vsm"), {.format = Format::Rg16Float}, load_profile("nv40")).filter ==
          MapFilter::Trilinear);
}
