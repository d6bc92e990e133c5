// gnomon seam, gnomon list seams, and cascades on the command line, as their user meets them.
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::array kPictures{"choice", "disagreeing", "lod-error", "lod", "probes", "derivatives", "value"};

/// The files of these cures.
std::set<std::string> files_of(std::initializer_list<const char*> cures) {
    std::set<std::string> names{"seams.txt", "seams.json"};
    for (const char* cure : cures)
        for (const char* picture : kPictures) names.insert(fmt::format("{}-{}.png", cure, picture));
    return names;
}

}  // namespace

TEST_CASE("gnomon list paths names every path of the camera", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "list paths");
    CHECK(run.code == 0);
    for (const char* name : {"still", "walk", "strafe", "pan", "pitch", "orbit", "dolly-turn"})
        CHECK(run.out.find(fmt::format("  {} ", name)) != std::string::npos);
    check_refused(folder, "list roads");
}

TEST_CASE("gnomon seam on a scene: a row and pictures for every cure", "[cli][seam]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "seam --scene fence --size 160x120 --map 128 --cascades 8 --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(files_in(folder.path() / "o") == files_of({"none", "quad-min", "quad-max", "quad-broadcast", "explicit-gradients",
                                                     "derivative-of-position", "sample-all"}));
    CHECK(text_of(folder.path() / "o" / "seams.txt") == run.out);
    CHECK(std::ranges::count(run.out, '\n') == 8);

    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "seams.json"));
    CHECK(json.at("configuration").at("technique") == "psvsm");
    CHECK(json.at("configuration").at("cascades") == 8);
    CHECK(json.at("configuration").at("parameters").at("lambda") == 0.5);
    REQUIRE(json.at("cures").size() == 7);
    const auto& none = json.at("cures")[0];
    CHECK(none.at("cure") == "none");
    CHECK(none.at("seam").at("bad_quads").get<int>() > 20);
    CHECK(none.at("seam").at("worst_lod_error").get<double>() > 1);
    for (const auto& cure : json.at("cures")) {
        CHECK(cure.at("seam").at("pixels") == none.at("seam").at("pixels"));
        CHECK(cure.at("counters").at("texture_instructions").get<int>() > 0);
        if (cure.at("cure") == "explicit-gradients") CHECK(cure.at("seam").at("bad_pixels") == 0);
    }

    // One cure into a folder that is there replaces its files and the table.
    REQUIRE(gnomon_run(folder, "seam --scene fence --size 160x120 --map 128 --cure quad-max --out o").code == 0);
    CHECK(std::ranges::count(text_of(folder.path() / "o" / "seams.txt"), '\n') == 2);
    CHECK(files_in(folder.path() / "o") == files_of({"quad-max"}));  // those of other cures are of an earlier table
}

TEST_CASE("gnomon seam gives a technique without splits four, and takes odd sizes", "[cli][seam]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "seam --scene car --technique esm --size 101x77 --map 64 --cure none --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "seams.json"));
    CHECK(json.at("configuration").at("cascades") == 4);
    CHECK(json.at("configuration").at("technique") == "esm");
}

TEST_CASE("gnomon seam draws every small case of gnomon list seams", "[cli][seam]") {
    const TemporaryFolder folder;
    const Outcome list = gnomon_run(folder, "list seams");
    REQUIRE(list.code == 0);
    for (const char* name : {"lvsm-layers", "pages", "cube-faces", "atlas", "wrap", "centroid", "branch", "discard"}) {
        INFO(name);
        CHECK(list.out.find(fmt::format("  {} ", name)) != std::string::npos);
        const Outcome run = gnomon_run(folder, fmt::format("seam --case {} --out {}", name, name));
        INFO(run.err);
        REQUIRE(run.code == 0);
        const auto json = nlohmann::json::parse(text_of(folder.path() / name / "seams.json"));
        CHECK(json.at("configuration").at("case") == name);
        CHECK(json.at("cures")[0].at("seam").at("disagreeing_quads").get<int>() > 50);
        CHECK(json.at("cures").size() * kPictures.size() + 2 == files_in(folder.path() / name).size());
    }
}

TEST_CASE("gnomon seam and cascades: bad input is one line on stderr, exit code 2, and nothing written",
          "[cli][seam][errors]") {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "file") << "a file";
    for (const std::string arguments : {
             "seam",
             "seam --out o",
             "seam --scene fence",
             "seam --case atlas",
             "seam --case nothing --out o",
             "seam --case atlas --scene fence --out o",
             "seam --case atlas --cure quad-min --out o",
             "seam --case atlas --cascades 8 --out o",
             "seam --case atlas --set lambda=2 --out o",
             "seam --case atlas --size 3x3 --out o",
             "seam --case atlas --profile nowhere --out o",
             "seam --scene nowhere --out o",
             "seam --scene fence --technique all --out o",
             "seam --scene fence --technique magic --out o",
             "seam --scene fence --cure aspirin --out o",
             "seam --scene fence --set cure=none --out o",
             "seam --scene fence --cascades 0 --out o",
             "seam --scene fence --cascades 9 --out o",
             "seam --scene fence --cascades two --out o",
             "seam --scene fence --size 0x10 --out o",
             "seam --scene fence --set lambda=2 --out o",
             "seam --scene fence --out file",
             "render --scene fence --technique vsm --cascades 9 --out o",
             "render --scene fence --technique vsm --cascades -1 --out o",
             "render --scene fence --technique vsm --set lambda=0.5 --out o",
             "render --scene fence --technique psvsm --set splits=random --out o",
             "render --scene fence --technique psvsm --set reach=-1 --out o",
             "render --scene fence --technique psvsm --set snap=on --set splits=minmax --out o",
         })
        check_refused(folder, arguments);
}

TEST_CASE("gnomon render with cascades: the report says what there was", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder,
                                   "render --scene car --technique vsm --cascades 3 --set lambda=0.75 --set cure=quad-max "
                                   "--map 64 --size 64x48 --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(run.out.find("3 cascades") != std::string::npos);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "o" / "report.json"));
    CHECK(json.at("configuration").at("cascades") == 3);
    CHECK(json.at("configuration").at("parameters").at("lambda") == 0.75);
    CHECK(json.at("configuration").at("parameters").at("cure") == "quad-max");
    CHECK(json.at("map_bytes_per_texel") == 8);
    for (const char* pass : {"light", "light 2", "light 3", "mips 3", "camera"}) CHECK(json.at("counters").contains(pass));
    CHECK(gnomon_run(folder, "list techniques --verbose").out.find("--set lambda=0.5") != std::string::npos);
}
