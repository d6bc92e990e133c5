// Compute commands as lines of a log.
#include "pipeline/parallel_primitives.h"
#include "tests/unit/compute_calls.h"
#include "traces/command_log.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <sstream>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

struct Scale {
    static constexpr GroupSize kGroupSize{4, 1, 1};
    RwBuffer<float> words;
    ReadImage image;
    float factor = 0.5f;

    static constexpr auto fields() {
        return std::tuple{Field{"words", &Scale::words}, Field{"image", &Scale::image}, Field{"factor", &Scale::factor}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(words, t.id.x, t.load(words, t.id.x) * typename G::Real(factor)); });
    }
};

}  // namespace

TEST_CASE("a log says which program a dispatch ran on which resources", "[traces][compute]") {
    Device device(load_profile("d3d11"), 1);
    std::vector<nlohmann::json> lines;
    device.set_observer([&](const Command& command) { lines.push_back(nlohmann::json::parse(traces::command_line(command))); });
    const BufferId words = device.create_zeroed_buffer("words", 64);
    const TextureId image = device.create_texture("image", {.width = 4, .height = 4, .levels = 2});
    const std::array<std::byte, 8> data{};
    device.execute(WriteBuffer{words, 16, data});
    dispatch(device, Scale{.words = {words}, .image = {image, 1, 0}}, 4, 2, 1);

    REQUIRE(lines.size() == 4);
    CHECK(lines[0].at("size") == 64);
    CHECK(lines[2].at("cmd") == "write_buffer");
    CHECK(lines[2].at("offset") == 16);
    CHECK(lines[2].at("data").at("bytes") == 8);
    const auto& line = lines[3];
    CHECK(line.at("cmd") == "dispatch");
    CHECK(line.at("label") == "test");
    CHECK(line.at("program") == "test.compute");
    CHECK(line.at("groups") == nlohmann::json::array({4, 2, 1}));
    const auto& constants = line.at("constants");
    CHECK(constants.at("words.buffer").at("buffer") == 1);
    CHECK(constants.at("image.texture").at("texture") == 1);
    CHECK(constants.at("image.level") == 1);
    CHECK(constants.at("factor") == 0.5);
}

TEST_CASE("primitives show as the dispatches that they are", "[traces][compute][primitives]") {
    Device device(load_profile("d3d11"), 1);
    std::map<std::string, int> programs;
    const BufferId keys = upload_words(device, std::vector<std::uint32_t>(9000, 5u));
    device.set_observer([&](const Command& command) {
        const auto line = nlohmann::json::parse(traces::command_line(command));
        if (line.at("cmd") == "dispatch") ++programs[line.at("program")];
    });
    ParallelPrimitives(device).radix_sort<std::uint32_t>(keys, 9000);
    CHECK(programs.at("sort.count") == 4);
    CHECK(programs.at("sort.scatter-keys") == 4);
    CHECK(programs.at("scan.sum") == 4);
}
