// gnomon sample, convert and list profiles as scripts meet them: what they print, what they refuse and how.
#include "sim/profile.h"
#include "studies/image_io.h"
#include "tests/unit/cli_run.h"
#include "texunit/record.h"
#include "texunit/upload.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

Texture ramp(int width, int height, Format format) {
    Texture texture({.format = format, .width = width, .height = height});
    std::vector<glm::vec4> colors;
    const auto share = [](int i, int count) {
        return count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0.0f;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            colors.emplace_back(share(x, width), share(y, height), share(y * width + x, width * height), 1.0f);
    set_level_colors(texture, 0, colors, Narrowing::TowardZero);
    return texture;
}

}  // namespace

TEST_CASE("gnomon sample prints what the library returns, bit for bit", "[cli]") {
    const TemporaryFolder folder;
    const std::string input =
        "0.3 0.6\n  # a comment\n0x1.8p-1 -0.25 0.1 0.02 -0.03 0.2 # behind numbers\r\ninf nan\n-1e30 5\n";
    for (const Profile& profile : profile_presets()) {
        const Texture texture = ramp(7, 4, Format::Rg16Float);
        const Sampler sampler{.address_u = AddressMode::Mirror, .address_v = AddressMode::Mirror};
        const double inf = HUGE_VAL;
        std::vector<SampleRequest> requests(4);
        requests[0].coordinate = {0.3, 0.6, 0};
        requests[1].coordinate = {0.75, -0.25, 0};
        requests[1].gradient = SampleRequest::Gradient{.dx = {0.1, 0.02, 0}, .dy = {-0.03, 0.2, 0}};
        requests[2].coordinate = {inf, std::nan(""), 0};
        requests[3].coordinate = {-1e30, 5, 0};
        std::string expected;
        if (profile.float_narrowing == Narrowing::TowardZero)  // the ramp above was stored so
            for (const SampleResult& r : sample_all(texture, sampler, profile, requests))
                expected += fmt::format("{:a} {:a} {:a} {:a} {:a}\n", r.lod, r.color[0], r.color[1], r.color[2], r.color[3]);
        const Outcome run =
            gnomon_run(folder, "sample --ramp 7x4 --format rg16f --address mirror --profile " + profile.name, input);
        INFO(profile.name << " " << run.err);
        CHECK(run.code == 0);
        CHECK(lines_of(run.out).size() == 4);
        if (!expected.empty()) CHECK(run.out == expected);
    }
}

TEST_CASE("gnomon sample prints the footprint as JSON that adds up", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "sample --checker 16x16 --mips --filter aniso --address wrap --footprint",
                                   "0.4 0.3 0.3 0 0 0.05\ninf 0\n");
    REQUIRE(run.code == 0);
    const std::vector<std::string> lines = lines_of(run.out);
    REQUIRE(lines.size() == 2);
    const auto json = nlohmann::json::parse(lines[0]);
    CHECK(json["probes"].size() > 3);
    double weights = 0;
    for (const auto& probe : json["probes"]) {
        weights += probe["weight"].get<double>();
        for (const auto& level : probe["levels"]) {
            double taps = 0;
            for (const auto& tap : level["taps"]) taps += tap["weight"].get<double>();
            CHECK(taps == 1.0);
        }
    }
    CHECK(weights == Approx(1.0).margin(1e-6));
    CHECK(nlohmann::json::parse(lines[1])["probes"][0]["u"] == "inf");
}

TEST_CASE("gnomon sample reads images and explicit mip chains", "[cli]") {
    const TemporaryFolder folder;
    studies::ByteImage image{2, 1, 3, {255, 0, 51, 0, 255, 102}};
    studies::write_png(folder.path() / "two.png", image);
    const Outcome png = gnomon_run(folder, "sample --image two.png --format rgba8unorm --filter nearest", "0.1 0.5\n0.9 0.5\n");
    CHECK(png.err.empty());
    CHECK(png.out == "0x0p+0 0x1p+0 0x0p+0 0x1.99999ap-3 0x1p+0\n0x0p+0 0x0p+0 0x1p+0 0x1.99999ap-2 0x1p+0\n");

    std::filesystem::create_directory(folder.path() / "levels");
    for (int level = 0; level < 3; ++level) {
        const int side = 4 >> level;
        const std::vector<float> values(static_cast<std::size_t>(side * side), static_cast<float>(level));
        studies::write_exr(folder.path() / "levels" / fmt::format("{}.exr", level), {side, side, values}, values);
    }
    const Outcome chain = gnomon_run(folder, "sample --levels-from levels --format r32f --filter trilinear",
                                     "0.5 0.5 0.5 0 0 0.5\n0.5 0.5 0.3535533905932738 0 0 0.1\n");
    CHECK(chain.err.empty());
    CHECK(chain.out == "0x1p+0 0x1p+0 0x0p+0 0x0p+0 0x1p+0\n0x1.fffffep-2 0x1p-1 0x0p+0 0x0p+0 0x1p+0\n");
    std::filesystem::remove(folder.path() / "levels" / "1.exr");
    CHECK(gnomon_run(folder, "sample --levels-from levels", "0 0\n").err.find("has 2.exr but no 1.exr") != std::string::npos);
    std::filesystem::copy(folder.path() / "levels" / "2.exr", folder.path() / "levels" / "1.exr");
    const Outcome wrong = gnomon_run(folder, "sample --levels-from levels", "0 0\n");
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find("1.exr: 1x1 pixels, expected 2x2") != std::string::npos);
}

TEST_CASE("gnomon sample and convert refuse bad input in one line and print nothing", "[cli]") {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "text.png") << "not an image";
    const std::string ok = "0 0\n";
    const std::vector<std::tuple<std::string, std::string, std::string>> cases{
        {"sample", ok, "expected one of --image"},
        {"sample --checker 4x4 --ramp 4x4", ok, "expected one of --image"},
        {"sample --checker 0x4", ok, "--checker 0x4"},
        {"sample --checker 16385x1", ok, "--checker 16385x1"},
        {"sample --checker 16384x16384 --format rgba32f", ok, "2 GiB"},
        {"sample --checker 4x4 --format rgb8", ok, "'rgb8'"},
        {"sample --checker 4x4 --filter cubic", ok, "--filter cubic"},
        {"sample --checker 4x4 --max-aniso 8", ok, "--filter aniso"},
        {"sample --checker 4x4 --filter aniso --max-aniso 17", ok, "--max-aniso 17"},
        {"sample --checker 4x4 --address repeat", ok, "'repeat'"},
        {"sample --checker 4x4 --border 1,2", ok, "--border 1,2"},
        {"sample --checker 4x4 --border 1,2,3,nan", ok, "--border"},
        {"sample --checker 4x4 --compare same", "0 0 0\n", "'same'"},
        {"sample --checker 4x4 --lod-bias 16", ok, "--lod-bias 16"},
        {"sample --checker 4x4 --offset 8,0", ok, "--offset 8,0"},
        {"sample --checker 4x4 --offset 0.5,0", ok, "--offset 0.5,0"},
        {"sample --checker 4x4 --profile nobody", ok, "nobody"},
        {"sample --checker 4x4 --format r32ui", ok, "r32ui"},
        {"sample --checker 4x4 --format r32f --profile nv40", ok, "--filter bilinear: profile nv40 does not filter r32f"},
        {"sample --checker 4x4 --format rg32f --filter aniso --profile nv40", ok, "does not filter rg32f"},
        {"sample --checker 4x4 --format r32ui --filter nearest --mips", ok, "r32ui"},
        {"sample --image missing.png", ok, "missing.png"},
        {"sample --image text.png", ok, "text.png"},
        {"sample --image .", ok, "not a file"},
        {"sample --levels-from missing", ok, "not a folder"},
        {"sample --levels-from .", ok, "no 0.exr"},
        {"sample --checker 4x4", "0\n", "stdin line 1: 1 numbers"},
        {"sample --checker 4x4", "0 0\n1 2 3\n", "stdin line 2: 3 numbers"},
        {"sample --checker 4x4", "0 zero\n", "'zero'"},
        {"sample --checker 4x4 --compare less", "0 0\n", "expected 3"},
        {"convert --from f32 --to f8", "1\n", "'f8'"},
        {"convert --from f32 --to f16 --round up", "1\n", "--round up"},
        {"convert --from f32 --to f16", "1\nx\n", "stdin line 2"},
        {"convert --from f32 --to f16", "1 2\n", "2 words"},
        {"convert --from f16 --to f32", "0x10000\n", "0xffff"},
        {"convert --from unorm8 --to f32", "-1\n", "'-1'"},
        {"convert --to f32", "1\n", "--from"},
    };
    for (const auto& [arguments, input, needle] : cases) {
        const Outcome run = gnomon_run(folder, arguments, input);
        INFO("gnomon " << arguments << " < " << input << " : " << run.err);
        CHECK(run.code == 2);
        CHECK(run.out.empty());
        CHECK(std::ranges::count(run.err, '\n') == 1);
        CHECK(run.err.find(needle) != std::string::npos);
    }
    CHECK(gnomon_run(folder, "sample --checker 4x4", "").code == 0);
    CHECK(gnomon_run(folder, "sample --checker 4x4 --format r32f --filter nearest --profile nv40", ok).code == 0);
    CHECK(gnomon_run(folder, "sample --checker 4x4 --format rg16f --profile nv40", ok).code == 0);
}

TEST_CASE("gnomon convert goes through every format by the specification's rules", "[cli][3.2.2]") {
    const TemporaryFolder folder;
    const auto convert = [&](const std::string& options, const std::string& input) {
        return gnomon_run(folder, "convert " + options, input).out;
    };
    CHECK(convert("--from f32 --to f16", "65520\n-0\nnan\n0x1p-25\n") ==
          "0x7bff 0x1.ffcp+15\n0x8000 -0x0p+0\n0x7e00 nan\n0x0000 0x0p+0\n");
    CHECK(convert("--from f32 --to f16 --round nearest-even", "65520\n0x1.8p-25\n") == "0x7c00 inf\n0x0001 0x1p-24\n");
    CHECK(convert("--from f64 --to f32", "0x1.0000019p+0\n") == "0x3f800000 0x1p+0\n");
    CHECK(convert("--from f64 --to f32 --round nearest-even", "0x1.0000019p+0\n") == "0x3f800001 0x1.000002p+0\n");
    CHECK(convert("--from f32 --to f11", "-1\n1\ninf\n") == "0x000 0x0p+0\n0x3c0 0x1p+0\n0x7c0 inf\n");
    CHECK(convert("--from f32 --to snorm8", "-1\n1\n") == "0x81 -0x1p+0\n0x7f 0x1p+0\n");
    CHECK(convert("--from snorm8 --to f32", "128\n") == "0xbf800000 -0x1p+0\n");
    CHECK(convert("--from unorm8 --to srgb8", "255\n0x80\n") == "0xff 0x1p+0\n0xbc 0x1.017a56p-1\n");
    CHECK(convert("--from f32 --to u32", "-3\n4294967295\nnan\n2.9\n") ==
          "0x00000000 0x0p+0\n0xffffffff 0x1.fffffffep+31\n0x00000000 0x0p+0\n0x00000002 0x1p+1\n");
}

TEST_CASE("gnomon list profiles --verbose names a source for every field", "[cli]") {
    const TemporaryFolder folder;
    const Outcome run = gnomon_run(folder, "list profiles --verbose");
    CHECK(run.code == 0);
    for (const Profile& profile : profile_presets())
        for (const Provenance& entry : provenance_of(profile.name))
            CHECK(run.out.find(std::string(entry.source)) != std::string::npos);
    for (const char* certainty : {" specified ", " documented ", " measured ", " assumed "})
        CHECK(run.out.find(certainty) != std::string::npos);
}
