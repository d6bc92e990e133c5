// gnomon render --frames as its user meets it: what it writes, keeps and refuses.
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sstream>
#include <string>
#include <vector>

using namespace gnomon;
using namespace gnomon::test;

namespace {

const std::string kSmall = "render --scene fence --technique vsm --cascades 3 --map 64 --size 96x72 ";

/// The lines of a table but for their last two columns, which are times.
std::vector<std::string> lines_without_times(const std::string& table) {
    std::vector<std::string> lines;
    std::istringstream stream(table);
    for (std::string line; std::getline(stream, line);) {
        const bool is_row = line.size() > 22 && line[4] >= '0' && line[4] <= '9';
        lines.push_back(is_row ? line.substr(0, line.size() - 22) : line);
    }
    return lines;
}

/// sequence.json without what differs from run to run.
nlohmann::json json_without_times(const std::filesystem::path& folder) {
    nlohmann::json json = nlohmann::json::parse(text_of(folder / "sequence.json"));
    for (auto& row : json.at("rows")) row.erase("timings_ms");
    return json;
}

}  // namespace

TEST_CASE("a sequence writes three files per frame and one table, the same for any number of threads", "[cli][sequence]") {
    const TemporaryFolder folder;
    for (const int threads : {1, 2}) {
        const Outcome run =
            gnomon_run(folder, kSmall + fmt::format("--frames 4 --path strafe --threads {} --out t{}", threads, threads));
        INFO(run.err);
        REQUIRE(run.code == 0);
        const auto out = folder.path() / fmt::format("t{}", threads);
        CHECK(files_in(out) == std::set<std::string>{"frames", "sequence.json", "sequence.txt"});
        CHECK(text_of(out / "sequence.txt") == run.out);
    }
    const auto one = folder.path() / "t1";
    const auto two = folder.path() / "t2";
    const std::set<std::string> names = files_in(one / "frames");
    CHECK(names.size() == 12);
    for (const char* name : {"0000_color.png", "0003_difference.png", "0002_visibility.exr"}) CHECK(names.contains(name));
    CHECK(files_in(two / "frames") == names);
    for (const std::string& name : names) CHECK(text_of(one / "frames" / name) == text_of(two / "frames" / name));
    CHECK(text_of(one / "frames" / "0000_color.png") != text_of(one / "frames" / "0003_color.png"));
    CHECK(lines_without_times(text_of(one / "sequence.txt")) == lines_without_times(text_of(two / "sequence.txt")));

    const nlohmann::json json = json_without_times(one);
    CHECK(json == json_without_times(two));
    CHECK(json.at("path") == "strafe");
    CHECK(json.at("frames") == 4);
    CHECK(json.at("configuration").at("cascades") == 3);
    REQUIRE(json.at("rows").size() == 4);
    CHECK(json.at("rows")[3].at("frame") == 3);
    CHECK(json.at("rows")[3].at("time") == 0.75);
    CHECK(json.at("rows")[3].at("metrics").at("pixels").get<int>() > 500);
    CHECK(json.at("flicker").at("points").get<int>() > 20);
    for (const char* what : {"visibility", "truth", "error"})
        for (const char* name : {"mean", "p95", "p99", "worst", "change"})
            CHECK(json.at("flicker").at(what).at(name).get<double>() >= 0.0);
    CHECK(json.at("flicker").at("visibility").at("mean").get<double>() > 0.0);
}

TEST_CASE("without truth a sequence is frames alone, and a new one leaves nothing of an older one", "[cli][sequence]") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "o";
    REQUIRE(gnomon_run(folder, kSmall + "--frames 3 --out o").code == 0);
    CHECK(nlohmann::json::parse(text_of(out / "sequence.json")).at("path") == "walk");
    for (const char* name : {"0007_notes.txt", "0007_color.png", "9_color.png"}) std::ofstream(out / "frames" / name) << "mine";

    const Outcome run = gnomon_run(folder, kSmall + "--frames 1 --reference none --out o");
    REQUIRE(run.code == 0);
    CHECK(files_in(out / "frames") ==
          std::set<std::string>{"0000_color.png", "0000_visibility.exr", "0007_notes.txt", "9_color.png"});
    CHECK(text_of(out / "sequence.txt") == run.out);
    CHECK(run.out.find("flicker") == std::string::npos);
    const auto json = nlohmann::json::parse(text_of(out / "sequence.json"));
    CHECK(json.at("flicker").is_null());
    REQUIRE(json.at("rows").size() == 1);
    CHECK(json.at("rows")[0].at("metrics").is_null());

    // With truth, a single frame has errors but no flicker.
    const Outcome single = gnomon_run(folder, kSmall + "--frames 1 --out o");
    REQUIRE(single.code == 0);
    CHECK(files_in(out / "frames").contains("0000_difference.png"));
    CHECK(single.out.find("no point was judged in 3 frames") != std::string::npos);
    CHECK(nlohmann::json::parse(text_of(out / "sequence.json")).at("rows")[0].at("metrics").at("rmse").get<double>() > 0);
}

TEST_CASE("bad sequences are one line on stderr, exit code 2, and nothing written", "[cli][sequence][errors]") {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "busy");
    std::ofstream(folder.path() / "busy" / "frames") << "a file";
    std::filesystem::create_directories(folder.path() / "taken" / "frames" / "0001_color.png");
    for (const char* arguments : {
             "--path walk --out o",
             "--frames 0 --out o",
             "--frames -1 --out o",
             "--frames 10001 --out o",
             "--frames x --out o",
             "--frames 2.5 --out o",
             "--frames 2 --path fly --out o",
             "--frames 2 --log-commands log.txt --out o",
             "--frames 2 --counters --out o",
             "--frames 2 --derivatives --out o",
             "--frames 2 --set snap=maybe --out o",
             "--frames 2 --out busy",
             "--frames 2 --out taken",
             "--frames 2",
         })
        check_refused(folder, kSmall + arguments);
    check_refused(folder, "render --scene planes --technique all --frames 2 --out o");
    check_refused(folder, "render --scene nowhere --technique vsm --frames 2 --out o");
    CHECK(files_in(folder.path() / "busy") == std::set<std::string>{"frames"});
}

TEST_CASE("an interrupted sequence keeps the frames that it finished", "[cli][sequence]") {
    const TemporaryFolder folder;
    const std::string rows = (folder.path() / "rows.txt").string();
    // Ctrl-C after the five lines of the header and two frames.
    const Outcome run = gnomon_run(
        folder,
        fmt::format("render --scene fence --technique vsm --size 160x120 --frames 2000 --path pan --out o >'{}' 2>stopped.txt "
                    "& pid=$!; for i in $(seq 1 1000); do sleep 0.05; test \"$(cat '{}' | wc -l)\" -ge 7 && break; done; "
                    "kill -INT $pid; wait $pid; exit $?; true",
                    rows, rows));
    CHECK(run.code == 130);
    CHECK(text_of(folder.path() / "stopped.txt") == "gnomon: stopped; what was finished is there\n");
    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "sequence.json"));
    const std::size_t finished = json.at("rows").size();
    CHECK(finished >= 2);
    CHECK(finished < 2000);
    CHECK(files_in(folder.path() / "o" / "frames").size() == 3 * finished);
    const std::string table = text_of(folder.path() / "o" / "sequence.txt");
    CHECK(table.starts_with(text_of(rows)));
}
