// What gnomon render counts: the tables of --counters, the traffic in report.json, and the picture of --derivatives; and the
// chart of the pipeline.
#include "pipeline/derivatives.h"
#include "studies/false_color.h"
#include "studies/image_io.h"
#include "studies/pipeline_chart.h"
#include "studies/report.h"
#include "techniques/frame.h"
#include "tests/unit/cli_run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <sstream>

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

studies::RenderResult two_passes() {
    studies::RenderResult result;
    result.passes.resize(2);
    result.passes[0].name = "light";
    result.passes[0].counters.vertices = 1234567;
    result.passes[0].traffic = {{"map", {0, 4096}}, {"mesh vertices", {72, 0}}};
    result.passes[1].name = "camera";
    result.passes[1].counters.quads_shaded = 8;
    result.passes[1].traffic = {{"map", {128, 0}}, {"colour", {0, 16}}, {"mesh vertices", {72, 0}}};
    return result;
}

std::set<studies::Rgb> colors_of(const studies::ByteImage& image) {
    std::set<studies::Rgb> colors;
    for (std::size_t i = 0; i < image.values.size(); i += 3)
        colors.insert({image.values[i], image.values[i + 1], image.values[i + 2]});
    return colors;
}

studies::ByteImage read_bytes(const std::filesystem::path& path) {
    const studies::ColorImage image = studies::read_image(path);
    studies::ByteImage bytes{image.width, image.height, 3, {}};
    for (const glm::vec4& color : image.values)
        for (int c = 0; c < 3; ++c) bytes.values.push_back(static_cast<std::uint8_t>(color[c] * 255.0f + 0.5f));
    return bytes;
}

}  // namespace

TEST_CASE("tables of counters leave out what is zero in every pass", "[counters][reports]") {
    CHECK(studies::counters_text(two_passes()) ==
          "counters             light        camera\n"
          "vertices         1,234,567             0\n"
          "quads_shaded             0             8\n"
          "\n"
          "bytes read            light        camera\n"
          "map                       0           128\n"
          "mesh vertices            72            72\n"
          "\n"
          "bytes written         light        camera\n"
          "map                   4,096             0\n"
          "colour                    0            16\n");
    CHECK(studies::counters_text(studies::RenderResult{}).empty());
}

TEST_CASE("a second resource of one label has a name of its own", "[counters][reports]") {
    Device device(Profile{}, 1);
    const TextureDesc small{.format = Format::R32Float, .width = 2, .height = 2};
    const TextureId first = device.create_texture("map", small);
    const TextureId unused = device.create_texture("map", small);
    const TextureId third = device.create_texture("map", small);
    device.enable_counters(true);
    device.execute(ClearColor{first, glm::vec4(0.0f)});
    device.execute(ClearColor{third, glm::vec4(0.0f)});
    device.execute(ClearColor{third, glm::vec4(0.0f)});
    CHECK(device.traffic(device.take_tally()) == std::vector<ResourceTraffic>{{"map", {0, 16}}, {"map 3", {0, 32}}});
    CHECK(device.texture(unused).width(0) == 2);
}

TEST_CASE("gnomon render reports traffic that adds up to the bytes it counts", "[cli][counters][reports]") {
    const TemporaryFolder folder;
    const auto run = gnomon_run(
        folder, "render --scene fence --technique vsm --size 96x72 --map 64 --blur 3 --reference none --counters --out o");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const auto report = nlohmann::json::parse(text_of(folder.path() / "o/report.json"));
    REQUIRE(report.at("traffic").size() == report.at("counters").size() - 1);  // no "frame"
    std::uint64_t frame = 0;
    for (const auto& [pass, resources] : report.at("traffic").items()) {
        std::uint64_t read = 0;
        std::uint64_t written = 0;
        for (const auto& [label, bytes] : resources.items()) {
            read += bytes.at("read").get<std::uint64_t>();
            written += bytes.at("written").get<std::uint64_t>();
            CHECK(bytes.at("read").get<std::uint64_t>() + bytes.at("written").get<std::uint64_t>() > 0);
        }
        INFO(pass);
        CHECK(read == report.at("counters").at(pass).at("bytes_read"));
        CHECK(written == report.at("counters").at(pass).at("bytes_written"));
        frame += read + written;
    }
    CHECK(frame > 100'000);
    // The clear alone writes every pixel once.
    CHECK(report.at("traffic").at("camera").at("colour").at("written").get<std::uint64_t>() >= 96 * 72 * 4);

    // The tables have every counter that is not zero, and no row of zeros.
    std::istringstream lines(run.out.substr(run.out.find("\ncounters ")));
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line);) {
        const auto words = words_of(line);
        if (words.empty() || words[0] == "counters" || words[0] == "bytes") continue;
        INFO(line);
        CHECK(std::ranges::any_of(words.begin() + 1, words.end(), [](const std::string& word) {
            return word.find_first_of("123456789") != std::string::npos;
        }));
        ++rows;
    }
    CHECK(rows > 20);
    for (const auto& [name, value] : report.at("counters").at("frame").items()) {
        INFO(name);
        CHECK((run.out.find("\n" + name + " ") != std::string::npos) == (value.get<std::uint64_t>() != 0));
    }
}

TEST_CASE("gnomon render --derivatives adds a picture and changes nothing else", "[cli][reports][22.5]") {
    const TemporaryFolder folder;
    const std::string options = "--scene fence --size 96x72 --map 64 --reference none --technique ";
    REQUIRE(gnomon_run(folder, "render " + options + "vsm --filter trilinear --out plain").code == 0);
    REQUIRE(gnomon_run(folder, "render " + options + "vsm --filter trilinear --derivatives --out o").code == 0);
    REQUIRE(gnomon_run(folder, "render " + options + "pcf --derivatives --out p").code == 0);
    CHECK(!std::filesystem::exists(folder.path() / "plain/derivatives.png"));
    const auto report = [&](const char* name) { return nlohmann::json::parse(text_of(folder.path() / name / "report.json")); };
    for (const char* part : {"counters", "traffic", "hashes"}) CHECK(report("plain").at(part) == report("o").at(part));
    CHECK(text_of(folder.path() / "plain/color.png") == text_of(folder.path() / "o/color.png"));

    // Trilinear lookups at silhouettes use helper lanes; nothing is discarded. Comparisons at level 0 take no derivatives.
    const studies::ByteImage picture = read_bytes(folder.path() / "o/derivatives.png");
    CHECK(picture.width == 96);
    CHECK(picture.height == 72);
    CHECK(colors_of(picture) ==
          std::set<studies::Rgb>{studies::kNotJudged, studies::kDerivativeColors[0], studies::kDerivativeColors[kFromHelper]});
    CHECK(colors_of(read_bytes(folder.path() / "p/derivatives.png")) ==
          std::set<studies::Rgb>{studies::kNotJudged, studies::kDerivativeColors[0]});

    // Rendering there again without the option leaves no picture of another run.
    REQUIRE(gnomon_run(folder, "render " + options + "vsm --out o").code == 0);
    CHECK(!std::filesystem::exists(folder.path() / "o/derivatives.png"));
}

TEST_CASE("every mixture of causes has a colour of its own", "[reports][22.5]") {
    std::set<studies::Rgb> colors(studies::kDerivativeColors.begin(), studies::kDerivativeColors.end());
    colors.insert(studies::kNotJudged);
    CHECK(colors.size() == 9);
    const std::vector<std::uint32_t> causes{0, kFromHelper, kFromKilled | kFromInactive, 0};
    const studies::FloatImage visibility{2, 2, {1.0f, 0.5f, 0.0f, techniques::Frame::kNoSurface}};
    const studies::ByteImage image = studies::derivative_image(causes, visibility);
    const std::vector<studies::Rgb> expected{studies::kDerivativeColors[0], studies::kDerivativeColors[1],
                                             studies::kDerivativeColors[6], studies::kNotJudged};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t c = 0; c < 3; ++c) CHECK(image.values[3 * i + c] == expected[i][c]);
}

TEST_CASE("gnomon pipeline-chart draws the panels, the same for any number of threads", "[cli][charts]") {
    const TemporaryFolder folder;
    for (const int threads : {1, 2}) {
        const auto run = gnomon_run(folder, fmt::format("pipeline-chart --threads {} --out c{}.png", threads, threads));
        INFO(run.err);
        REQUIRE(run.code == 0);
    }
    CHECK(text_of(folder.path() / "c1.png") == text_of(folder.path() / "c2.png"));
    const studies::ByteImage chart = read_bytes(folder.path() / "c1.png");
    constexpr int kStep = studies::kPanelSide + studies::kPanelMargin;
    CHECK(chart.width == studies::kPanelColumns * kStep + studies::kPanelMargin);
    CHECK(chart.height == studies::kPanelRows * kStep + studies::kPanelMargin);
    const auto panel = [&](int column, int row) {
        studies::ByteImage image{studies::kPanelSide, studies::kPanelSide, 3, {}};
        for (int y = 0; y < studies::kPanelSide; ++y) {
            const auto first =
                chart.values.begin() +
                ((row * kStep + studies::kPanelMargin + y) * chart.width + column * kStep + studies::kPanelMargin) * 3;
            image.values.insert(image.values.end(), first, first + studies::kPanelSide * 3);
        }
        return colors_of(image);
    };
    // One sample per pixel: paper and two inks; with four, mixtures of them. The same for lines.
    CHECK(panel(0, 0).size() == 3);
    CHECK(panel(1, 0).size() > 3);
    CHECK(panel(2, 0).size() == 3);
    CHECK(panel(3, 0).size() > 3);
    CHECK(panel(0, 1).size() > 50);
    CHECK(panel(1, 1).size() > 5);
    CHECK(panel(2, 1).size() > 7);
    // Every single cause is there.
    const auto causes = panel(3, 1);
    for (const std::size_t i : {0u, 1u, 2u, 4u}) CHECK(causes.contains(studies::kDerivativeColors[i]));

    for (const char* bad : {"pipeline-chart", "pipeline-chart --out c.jpg", "pipeline-chart --out c.png --profile nobody",
                            "pipeline-chart --out c.png --threads x", "pipeline-chart --out nowhere/c.png"}) {
        const auto run = gnomon_run(folder, bad);
        INFO(bad);
        CHECK(run.code == 2);
        CHECK(std::ranges::count(run.err, '\n') == 1);
    }
}
