// gnomon chart as its user meets it: what it writes, what it refuses and how.
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE("gnomon chart writes three pictures per chart and a page, the same for any number of threads", "[cli][charts]") {
    const TemporaryFolder folder;
    for (const int threads : {1, 2}) {
        const Outcome run = gnomon_run(
            folder, fmt::format("chart --profile d3d11,ideal --size 48x32 --threads {} --out o/c{}", threads, threads));
        INFO(run.err);
        REQUIRE(run.code == 0);
    }
    std::set<std::string> expected{"index.html"};
    for (const char* scene : {"plane", "tunnel", "angles"})
        for (const char* profile : {"d3d11", "ideal"})
            for (const char* filter : {"trilinear", "aniso"})
                for (const char* suffix : {"", "_lod", "_probes"})
                    expected.insert(fmt::format("{}_{}_{}{}.png", scene, profile, filter, suffix));
    CHECK(files_in(folder.path() / "o/c1") == expected);
    const std::string page = text_of(folder.path() / "o/c1/index.html");
    for (const std::string& name : expected) {
        INFO(name);
        CHECK(text_of(folder.path() / "o/c1" / name) == text_of(folder.path() / "o/c2" / name));
        if (name != "index.html") CHECK(page.find(name) != std::string::npos);
    }
}

TEST_CASE("gnomon chart draws one scene with any filter and format", "[cli][charts]") {
    const TemporaryFolder folder;
    {
        std::ofstream(folder.path() / "six.json") << R"({"texel_fraction_bits": 6})";
    }
    const Outcome run =
        gnomon_run(folder,
                   "chart --scene angles --profile six.json --filter nearest,aniso --max-aniso 4 --format rg16f "
                   "--size 7x5 --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(files_in(folder.path() / "o") == std::set<std::string>{"angles_six_aniso.png", "angles_six_aniso_lod.png",
                                                                 "angles_six_aniso_probes.png", "angles_six_nearest.png",
                                                                 "angles_six_nearest_lod.png", "angles_six_nearest_probes.png",
                                                                 "index.html"});
}

TEST_CASE("bad options of gnomon chart are one line on stderr, exit code 2, and nothing written", "[cli][errors][charts]") {
    const TemporaryFolder folder;
    {
        std::ofstream(folder.path() / "file") << "a file";
    }
    {
        std::ofstream(folder.path() / "slash.json") << R"({"name": "../up"})";
    }
    {
        std::ofstream(folder.path() / "same.json") << R"({"name": "d3d11"})";
    }
    const auto before = files_in(folder.path());
    const std::vector<std::string> bad{
        "chart",
        "chart --scene cave --out o",
        "chart --scene plane,tunnel --out o",
        "chart --profile nothing --out o",
        "chart --profile d3d11, --out o",
        "chart --profile '' --out o",
        "chart --profile d3d11,d3d11 --out o",
        "chart --profile d3d11,same.json --out o",
        "chart --profile slash.json --out o",
        "chart --filter cubic --out o",
        "chart --filter trilinear,,aniso --out o",
        "chart --filter aniso,aniso --out o",
        "chart --max-aniso 0 --out o",
        "chart --max-aniso 17 --out o",
        "chart --max-aniso 4 --filter trilinear --out o",
        "chart --format foo --out o",
        "chart --format rgba32ui --out o",
        "chart --size 12 --out o",
        "chart --size 0x5 --out o",
        "chart --size 1x100000 --out o",
        "chart --threads -1 --out o",
        "chart --size 8x8 --out file",
        "chart --size 8x8 --out /proc/gnomon",
        "chart --size 8x8 --out o extra",
        "chart --no-such-option --out o",
    };
    for (const std::string& arguments : bad) check_refused(folder, arguments);
}

TEST_CASE("an interrupted chart leaves nothing half-written", "[cli][charts]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder,
                                   "chart --profile ideal --size 8192x8192 --out o 2>stopped.txt & pid=$!; "
                                   "sleep 1; kill -INT $pid; wait $pid; exit $?; true");
    CHECK(run.code == 130);
    CHECK(!std::filesystem::exists(folder.path() / "o"));
}
