// The gnomon program as its user meets it: what it writes, what it refuses and how.
#include "techniques/technique.h"
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

using namespace gnomon;
using namespace gnomon::test;

namespace {

const std::set<std::string> kResultFiles{"color.png",   "difference.png", "reference.exr", "reference.png",
                                         "report.json", "visibility.exr", "visibility.png"};

}  // namespace

TEST_CASE("gnomon render writes all results, and the same hashes for any number of threads", "[cli]") {
    const TemporaryFolder folder;
    std::string hashes;
    for (const int threads : {1, 2, 8}) {
        const auto run =
            gnomon_run(folder, fmt::format("render --scene fence --technique vsm --size 96x72 --map 64 --reference area "
                                           "--threads {} --out r{}",
                                           threads, threads));
        INFO(run.err);
        REQUIRE(run.code == 0);
        CHECK(run.out.find("rmse") != std::string::npos);
        const auto results = folder.path() / fmt::format("r{}", threads);
        CHECK(files_in(results) == kResultFiles);
        const auto report = nlohmann::json::parse(text_of(results / "report.json"));
        for (const char* name : {"rmse", "mae", "p99", "leak", "acne", "pixels"}) CHECK(report.at("metrics").contains(name));
        CHECK(report.at("metrics").at("pixels").get<int>() > 100);
        CHECK(report.contains("counters"));
        CHECK(report.at("timings_ms").contains("camera"));
        CHECK(report.at("configuration").at("profile").at("texel_fraction_bits") == 8);
        const std::string now = report.at("hashes").dump();
        CHECK(report.at("hashes").at("visibility").get<std::string>().size() == 32);
        if (hashes.empty()) hashes = now;
        CHECK(now == hashes);
        if (threads == 1) continue;
        CHECK(text_of(results / "reference.exr") == text_of(folder.path() / "r1" / "reference.exr"));
        CHECK(text_of(results / "visibility.exr") == text_of(folder.path() / "r1" / "visibility.exr"));
    }
}

TEST_CASE("an exported scene renders the same bytes", "[cli]") {
    const TemporaryFolder folder;
    for (const char* scene : {"planes", "car", "fence", "bench", "windmill", "overlap", "city"}) {
        INFO(scene);
        REQUIRE(gnomon_run(folder, fmt::format("export --scene {} --out s.glb", scene)).code == 0);
        const std::string options = "--technique pcf --size 96x72 --map 128 --reference none";
        REQUIRE(gnomon_run(folder, fmt::format("render --scene {} {} --out a", scene, options)).code == 0);
        REQUIRE(gnomon_run(folder, fmt::format("render --scene s.glb {} --out b", options)).code == 0);
        const auto hashes = [&](const char* name) {
            return nlohmann::json::parse(text_of(folder.path() / name / "report.json")).at("hashes");
        };
        CHECK(hashes("a") == hashes("b"));
        CHECK(text_of(folder.path() / "a" / "color.png") == text_of(folder.path() / "b" / "color.png"));
    }
}

TEST_CASE("technique all has a folder per technique, and a contact sheet shows them", "[cli]") {
    const TemporaryFolder folder;
    REQUIRE(gnomon_run(folder, "render --scene planes --technique all --size 64x48 --map 64 --out o/planes").code == 0);
    std::set<std::string> names;
    for (const techniques::Technique& technique : techniques::all_techniques()) names.insert(std::string(technique.name));
    CHECK(files_in(folder.path() / "o/planes") == names);
    CHECK(files_in(folder.path() / "o/planes/vsm") == kResultFiles);
    REQUIRE(gnomon_run(folder, "contact-sheet o").code == 0);
    const std::string html = text_of(folder.path() / "o/index.html");
    for (const char* part : {"planes/vsm/color.png", "planes/pcf/difference.png", "shadow-map", "</html>"})
        CHECK(html.find(part) != std::string::npos);
}

TEST_CASE("gnomon list names what there is", "[cli]") {
    const TemporaryFolder folder;
    const std::string all = gnomon_run(folder, "list").out;
    for (const char* name : {"planes", "car", "fence", "bench", "windmill", "overlap", "city", "shadow-map", "pcf", "vsm",
                             "d3d11", "ideal", "rg16unorm", "d24"})
        CHECK(all.find(name) != std::string::npos);
    CHECK(gnomon_run(folder, "list profiles --verbose").out.find("texel_fraction_bits") != std::string::npos);
}

TEST_CASE("bad input is one line on stderr, exit code 2, and nothing written", "[cli][errors]") {
    const TemporaryFolder folder;
    {
        std::ofstream(folder.path() / "broken.glb") << "glTF";
    }
    {
        std::ofstream(folder.path() / "bad.json") << R"({"texel_fraction_bits": 99})";
    }
    {
        std::ofstream(folder.path() / "unknown.json") << R"({"texel_bits": 8})";
    }
    {
        std::ofstream(folder.path() / "file") << "a file";
    }
    const auto before = files_in(folder.path());
    const std::string good = "--scene planes --technique vsm --size 32x24 --map 32 --out o";
    const std::vector<std::string> bad{
        "",
        "frobnicate",
        "render",
        "render --scene nowhere --technique vsm --out o",
        "render --scene broken.glb --technique vsm --out o",
        "render --scene . --technique vsm --out o",
        "render --scene planes --technique esm2 --out o",
        "render --scene planes --technique vsm --map 0 --out o",
        "render --scene planes --technique vsm --map -1 --out o",
        "render --scene planes --technique vsm --map 1e3 --out o",
        "render --scene planes --technique vsm --map 99999 --out o",
        "render --scene planes --technique vsm --size 1x100000 --out o",
        "render --scene planes --technique vsm --size 0x5 --out o",
        "render --scene planes --technique vsm --size 12 --out o",
        "render --scene planes --technique vsm --format d16 --out o",
        "render --scene planes --technique vsm --format foo --out o",
        "render --scene planes --technique shadow-map --filter trilinear --out o",
        "render --scene planes --technique pcf --taps 0 --out o",
        "render --scene planes --technique shadow-map --taps 3 --out o",
        "render --scene planes --technique vsm --blur 4 --out o",
        "render --scene planes --technique vsm --min-variance nan --out o",
        "render --scene planes --technique vsm --set blur --out o",
        "render --scene planes --technique vsm --set =3 --out o",
        "render --scene planes --technique vsm --set blur= --out o",
        "render --scene planes --technique vsm --set blur=2 --out o",
        "render --scene planes --technique vsm --set blur=3x --out o",
        "render --scene planes --technique vsm --set depth=z --out o",
        "render --scene planes --technique vsm --set brightness=1 --out o",
        "render --scene planes --technique all --set brightness=1 --out o",
        "render --scene planes --technique all --set taps=99 --out o",
        "render --scene planes --technique all --format r11g11b10f --out o",
        "render --scene planes --technique vsm --set min-variance=inf --out o",
        "render --scene planes --technique vsm --aniso 0 --out o",
        "render --scene planes --technique vsm --aniso 17 --out o",
        "render --scene planes --technique vsm --aniso 2 --filter shader-bilinear --out o",
        "render --scene planes --technique vsm --map-samples 3 --out o",
        "render --scene planes --technique vsm --map-samples 32 --out o",
        "render --scene planes --technique vsm --map-samples 8 --profile nv40 --out o",
        "render --scene planes --technique vsm --threads -1 --out o",
        "render --scene planes --technique vsm --reference maybe --out o",
        "render --scene planes --technique vsm --seed x --out o",
        "render --scene planes --technique vsm --profile nothing --out o",
        "render --scene planes --technique vsm --profile bad.json --out o",
        "render --scene planes --technique vsm --profile nv40 --filter bilinear --out o",
        "render --scene planes --technique vsm --profile unknown.json --out o",
        "render --scene planes --technique vsm --ground --out o",
        "render --scene planes --technique vsm --size 32x24 --map 32 --out file",
        "render --scene planes --technique vsm --size 32x24 --map 32 --out /proc/gnomon",
        "render " + good + " --no-such-option",
        "export --scene planes --out o.obj",
        "export --scene planes --out /nonexistent/o.glb",
        "export --scene nowhere --out o.glb",
        "contact-sheet nowhere",
    };
    for (const std::string& arguments : bad) check_refused(folder, arguments);
    CHECK(!std::filesystem::exists("/nonexistent"));
    CHECK(gnomon_run(folder, "render " + good).code == 0);  // and the good one is good
}

TEST_CASE("an interrupted render leaves nothing half-written", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run =
        gnomon_run(folder,
                   "render --scene bench --technique vsm --size 4096x4096 --reference area --out o 2>stopped.txt & pid=$!; "
                   "sleep 1; kill -INT $pid; wait $pid; exit $?; true");
    CHECK(run.code == 130);
    CHECK(!std::filesystem::exists(folder.path() / "o"));
}
