// The command interface seen from outside: a log names programs, constants and states, and tells frames apart.
#include "scenes/procedural.h"
#include "techniques/frame.h"
#include "traces/command_log.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <sstream>

using namespace gnomon;

namespace {

std::string log_of(std::string_view technique, const techniques::TechniqueRequest& request) {
    std::ostringstream out;
    traces::CommandLog log(out);
    Device device(load_profile("d3d11"), 1);
    device.set_observer([&log](const Command& command) { log.write(command); });
    techniques::FrameDesc desc{.width = 32, .height = 24, .technique = techniques::find_technique(technique)};
    desc.settings = techniques::resolve_settings(desc.technique, request);
    techniques::Frame frame(device, scenes::procedural_scenes()[0].make(), desc);
    techniques::PassTimer timer(device);
    frame.render(timer);
    const std::string text = out.str();
    CHECK(static_cast<std::size_t>(std::ranges::count(text, '\n')) == log.count());
    return text;
}

}  // namespace

TEST_CASE("a command log is one JSON object per line with every constant by name", "[traces]") {
    std::istringstream lines(log_of("vsm", {.map_size = 32, .set = {{"blur", "3"}}}));
    std::map<std::string, int> programs;
    std::map<std::string, int> commands;
    for (std::string line; std::getline(lines, line);) {
        const auto json = nlohmann::json::parse(line);
        ++commands[json.at("cmd")];
        if (json.at("cmd") != "draw") continue;
        ++programs[json.at("program")];
        if (json.at("program") == "vsm.receive") {
            const auto& constants = json.at("pixel_constants");
            CHECK(constants.at("receiver.map.texture").at("texture") == 1);
            CHECK(constants.at("receiver.min_variance").get<float>() == 1e-5f);
            CHECK(constants.at("receiver.map.sampler").at("mip") == "linear");
            CHECK(json.at("vertex_constants").at("clip_from_object").size() == 4);
        }
        if (json.at("program") == "gaussian-blur") CHECK(json.at("pixel_constants").at("weights").size() >= 3);
    }
    CHECK(programs.at("vsm.cast") == 2);
    CHECK(programs.at("vsm.receive") == 2);
    CHECK(programs.at("gaussian-blur") == 2);
    CHECK(commands.at("generate_mips") == 1);
    CHECK(commands.at("clear_depth") == 2);
}

TEST_CASE("the same frame gives the same log, another one another", "[traces]") {
    CHECK(log_of("pcf", {.map_size = 32}) == log_of("pcf", {.map_size = 32}));
    CHECK(log_of("pcf", {.map_size = 32}) != log_of("pcf", {.map_size = 33}));
    CHECK(log_of("pcf", {.map_size = 32, .set = {{"taps", "5"}}}) != log_of("pcf", {.map_size = 32}));
}
