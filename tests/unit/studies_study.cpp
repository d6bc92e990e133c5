// Studies: the table of cases, and rows in their order with what the renderer says of each alone.
#include "studies/study.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

Study small_study() {
    const auto in_group = [](const char* group, const char* label, const char* technique,
                             techniques::TechniqueRequest request) {
        return StudyCase{.group = group, .label = label, .technique = technique, .request = std::move(request)};
    };
    Study study{
        .name = "small", .summary = "three cases", .source = "[Donnelly06] 5.3", .scenes = {"planes", "fence"}, .cases = {}};
    study.cases = {in_group("8 bytes", "vsm", "vsm", {.map_size = 64, .set = {{"min-variance", "0"}}}),
                   in_group("8 bytes", "evsm2, two samples", "evsm2",
                            {.map_size = 64,
                             .map_samples = 2,
                             .format = Format::Rg16Float,
                             .filter = techniques::MapFilter::Bilinear,
                             .anisotropy = 2}),
                   in_group("4 bytes", "shadow-map", "shadow-map", {.map_size = 32})};
    study.cases.back().profile = "g80";
    return study;
}

StudyOptions small_options() { return {.scenes = {}, .width = 48, .height = 36, .truth = Truth::Center, .threads = 2}; }

std::vector<StudyRow> rows_of(const Study& study, const StudyOptions& options) {
    std::vector<StudyRow> rows;
    run_study(study, options, {}, [&](const StudyRow& row) { rows.push_back(row); });
    return rows;
}

}  // namespace

TEST_CASE("every study has cases of its own labels, on scenes that there are", "[studies]") {
    std::set<std::string_view> names;
    for (const Study& study : all_studies()) {
        INFO(study.name);
        CHECK(names.insert(study.name).second);
        CHECK(&find_study(study.name) == &study);
        CHECK_FALSE(study.summary.empty());
        CHECK(study.source.starts_with("["));
        CHECK_FALSE(study.scenes.empty());
        for (const std::string& scene : study.scenes) CHECK_FALSE(find_scene(scene, {}).meshes.empty());
        std::set<std::string> labels;
        for (const StudyCase& what : study.cases) CHECK(labels.insert(what.group + ": " + what.label).second);
        CHECK(labels.size() > 5);
    }
    CHECK_THROWS_AS(find_study("nothing"), Error);
}

TEST_CASE("a study's rows are its scenes' cases, each as it is rendered alone", "[studies]") {
    const Study study = small_study();
    const std::vector<StudyRow> rows = rows_of(study, small_options());
    REQUIRE(rows.size() == 6);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const StudyRow& row = rows[i];
        CHECK(row.scene == study.scenes[i / 3]);
        CHECK(row.what.label == study.cases[i % 3].label);
        RenderRequest request{
            .scene = row.scene, .technique = row.what.technique, .choices = row.what.request, .width = 48, .height = 36};
        request.profile = row.what.profile;
        request.threads = 1;
        Experiment experiment(request);
        const RenderResult alone = experiment.run(experiment.runs().front(), {});
        CHECK(row.metrics == alone.metrics);
        CHECK(row.map == alone.map);
        CHECK(row.bytes_per_texel == alone.bytes_per_texel);
        CHECK(row.map_ms > 0);
        CHECK(row.camera_ms > 0);
    }
    CHECK(rows[0].bytes_per_texel == 8);
    CHECK(rows[1].bytes_per_texel == 4);
    CHECK(rows[0].map.texels == 64 * 64);

    // Other scenes instead.
    StudyOptions options = small_options();
    options.scenes = {"overlap"};
    const std::vector<StudyRow> other = rows_of(study, options);
    REQUIRE(other.size() == 3);
    CHECK(other[2].scene == "overlap");
}

TEST_CASE("a study's JSON has all that repeats a row", "[studies]") {
    const Study study = small_study();
    StudyOptions options = small_options();
    options.scenes = {"planes"};
    const std::vector<StudyRow> rows = rows_of(study, options);
    const auto json = nlohmann::json::parse(study_json(study, options, rows));
    CHECK(json.at("study") == "small");
    CHECK(json.at("source") == "[Donnelly06] 5.3");
    CHECK(json.at("size") == nlohmann::json({48, 36}));
    CHECK(json.at("reference") == "center");
    REQUIRE(json.at("rows").size() == 3);
    const auto& first = json.at("rows")[0];
    CHECK(first.at("scene") == "planes");
    CHECK(first.at("group") == "8 bytes");
    CHECK(first.at("technique") == "vsm");
    CHECK(first.at("profile") == "d3d11");
    CHECK(first.at("map") == 64);
    CHECK(first.at("map_samples") == 1);
    CHECK(first.at("format").is_null());
    CHECK(first.at("set") == nlohmann::json({{"min-variance", "0"}}));
    CHECK(first.at("metrics").at("rmse") == rows[0].metrics->rmse);
    CHECK(first.at("map_texels").at("texels") == 4096);
    const auto& second = json.at("rows")[1];
    CHECK(second.at("map_samples") == 2);
    CHECK(second.at("format") == "rg16f");
    CHECK(second.at("filter") == "bilinear");
    CHECK(second.at("aniso") == 2);
    CHECK(json.at("rows")[2].at("profile") == "g80");
}

TEST_CASE("a row without a pixel to judge has no errors, rather than errors of zero", "[studies]") {
    StudyRow row{.scene = "planes", .what = small_study().cases[0], .bytes_per_texel = 8, .metrics = {}, .map = {}};
    CHECK(study_line(row).find("0.00000") == std::string::npos);
    CHECK(std::ranges::count(study_line(row), '\n') == 1);
    const auto json = nlohmann::json::parse(study_json(small_study(), small_options(), std::vector{row}));
    CHECK(json.at("rows")[0].at("metrics").is_null());
    row.metrics = Metrics{};
    CHECK(study_line(row).find("0.00000") != std::string::npos);
    // Lines have the columns of their header.
    CHECK(study_line(row).size() == study_header().size());
}

TEST_CASE("a study with a name that there is not fails before its first row", "[studies][errors]") {
    const auto refusal = [](const Study& study, const StudyOptions& options) {
        std::size_t rows = 0;
        std::string message;
        try {
            run_study(study, options, {}, [&](const StudyRow&) { ++rows; });
        } catch (const Error& error) {
            message = error.what();
        }
        CHECK(rows == 0);
        return message;
    };
    StudyOptions options = small_options();
    options.scenes = {"planes", "nowhere"};
    CHECK(refusal(small_study(), options).starts_with("--scene 'nowhere': neither a built-in scene"));
    Study study = small_study();
    study.cases.back().technique = "nothing";
    CHECK(refusal(study, small_options()).starts_with("technique 'nothing': not known"));
    study = small_study();
    study.cases.back().request.set = {{"taps", "0"}};
    CHECK(refusal(study, small_options()).starts_with("--set taps=0: shadow-map"));
    study = small_study();
    study.cases.back().profile = "nothing";
    CHECK_FALSE(refusal(study, small_options()).empty());
}

TEST_CASE("a stopped study keeps to the rows that it finished", "[studies]") {
    std::atomic<bool> stop{false};
    std::vector<StudyRow> rows;
    const Progress progress{.report = {}, .stop = &stop};
    CHECK_THROWS_AS(run_study(small_study(), small_options(), progress,
                              [&](const StudyRow& row) {
                                  rows.push_back(row);
                                  stop = rows.size() == 2;
                              }),
                    Stopped);
    CHECK(rows.size() == 2);
}
