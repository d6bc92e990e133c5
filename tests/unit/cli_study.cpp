// gnomon study and gnomon list studies as their user meets them.
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE("gnomon list studies names every study, its cases and scenes", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "list studies");
    CHECK(run.code == 0);
    for (const char* text :
         {"equal-storage", "formats", "exponents", "relaxation", "tables", "splits", "cases on", "source [Lauritzen08]"})
        CHECK(run.out.find(text) != std::string::npos);
    CHECK(run.out.find("profiles") == std::string::npos);
    CHECK(gnomon_run(folder, "list").out.find("equal-storage") != std::string::npos);
}

TEST_CASE("gnomon study writes its table twice, as it is printed and as JSON", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "study formats --scene planes --size 48x36 --reference center --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(files_in(folder.path() / "o") == std::set<std::string>{"formats.json", "formats.txt"});
    CHECK(text_of(folder.path() / "o" / "formats.txt") == run.out);
    CHECK(std::ranges::count(run.out, '\n') == 41);

    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "formats.json"));
    CHECK(json.at("study") == "formats");
    CHECK(json.at("size") == nlohmann::json({48, 36}));
    CHECK(json.at("reference") == "center");
    REQUIRE(json.at("rows").size() == 40);
    for (const auto& row : json.at("rows")) {
        CHECK(row.at("scene") == "planes");
        CHECK(row.at("technique") == "vsm");
        CHECK(row.at("profile") == "d3d11");
        CHECK(row.at("map") == 512);
        CHECK(row.at("set").contains("min-variance"));
        CHECK(row.at("metrics").at("pixels").get<int>() > 500);
        CHECK(row.at("map_texels").at("texels") == 512 * 512);
        CHECK(row.at("timings_ms").at("map").get<double>() > 0);
        CHECK(run.out.find(row.at("label").get<std::string>()) != std::string::npos);
    }
    // A folder that is there gets the new table.
    CHECK(json.at("rows")[0].at("format") == "rg32f");
    CHECK(json.at("rows")[1].at("filter") == "trilinear");
}

TEST_CASE("gnomon study: bad input is one line on stderr, exit code 2, and nothing written", "[cli][errors]") {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "file") << "a file";
    const auto before = files_in(folder.path());
    for (const std::string arguments : {
             "study",
             "study formats",
             "study nothing --out o",
             "study formats --scene nowhere --out o",
             "study formats --scene planes --scene nowhere --size 48x36 --out o",
             "study formats --scene planes --size 0x5 --out o",
             "study formats --scene planes --size 48 --out o",
             "study formats --scene planes --size 1x100000 --out o",
             "study formats --scene planes --reference none --out o",
             "study formats --scene planes --reference maybe --out o",
             "study formats --scene planes --threads -1 --out o",
             "study formats --scene planes --threads x --out o",
             "study formats --scene planes --map 64 --out o",
             "study formats --scene planes --size 48x36 --out file",
             "study formats exponents --out o",
             "list nothing",
         })
        check_refused(folder, arguments);
}

TEST_CASE("an interrupted study keeps the rows that it finished", "[cli]") {
    const TemporaryFolder folder;
    const std::string rows = (folder.path() / "rows.txt").string();
    // Ctrl-C after the header and two rows.
    const Outcome run = gnomon_run(
        folder, fmt::format("study formats --scene bench --size 160x120 --out o >'{}' 2>stopped.txt & pid=$!; "
                            "for i in $(seq 1 1000); do sleep 0.05; test \"$(cat '{}' | wc -l)\" -ge 3 && break; done; "
                            "kill -INT $pid; wait $pid; exit $?; true",
                            rows, rows));
    CHECK(run.code == 130);
    CHECK(files_in(folder.path() / "o") == std::set<std::string>{"formats.json", "formats.txt"});
    const std::string table = text_of(folder.path() / "o" / "formats.txt");
    CHECK(table == text_of(rows));
    const auto lines = std::ranges::count(table, '\n');
    CHECK(lines >= 3);
    CHECK(lines < 41);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "formats.json"));
    CHECK(static_cast<std::ptrdiff_t>(json.at("rows").size()) == lines - 1);
    CHECK(text_of(folder.path() / "stopped.txt") == "gnomon: stopped; what was finished is there\n");
}
