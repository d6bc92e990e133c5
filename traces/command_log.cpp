#include "traces/command_log.h"

#include "pipeline/compute_program.h"
#include "traces/hash.h"
#include "traces/json_values.h"

namespace gnomon::traces {

namespace {

template <class Id>
std::uint32_t number(Id id) {
    return static_cast<std::uint32_t>(id);
}

Json data_json(std::span<const std::byte> data) { return {{"bytes", data.size()}, {"xxh3_128", xxh3_128_hex(data)}}; }

Json constants_json(std::vector<NamedConstant> (*read)(std::span<const std::byte>), std::span<const std::byte> bytes) {
    Json json = Json::object();
    if (read == nullptr || bytes.empty()) return json;
    for (const NamedConstant& constant : read(bytes)) json[constant.name] = json_of(constant.value);
    return json;
}

Json to_json(const CreateBuffer& c) {
    Json json{{"cmd", "create_buffer"}, {"id", number(c.id)}, {"label", c.label}, {"data", data_json(c.data)}};
    if (c.size != 0) json["size"] = c.size;
    return json;
}

Json to_json(const WriteBuffer& c) {
    return {{"cmd", "write_buffer"}, {"id", number(c.id)}, {"offset", c.offset}, {"data", data_json(c.data)}};
}

Json to_json(const CreateTexture& c) {
    Json json{{"cmd", "create_texture"},          {"id", number(c.id)},    {"label", c.label},
              {"format", name_of(c.desc.format)}, {"width", c.desc.width}, {"height", c.desc.height},
              {"levels", c.desc.levels}};
    if (c.desc.kind != TextureKind::Flat) {
        json["kind"] = name_of(c.desc.kind);
        json["layers"] = c.desc.layers;
    }
    return json;
}

Json to_json(const WriteTexture& c) {
    return {{"cmd", "write_texture"}, {"id", number(c.id)}, {"level", c.level}, {"data", data_json(c.data)}};
}

Json to_json(const ClearColor& c) { return {{"cmd", "clear_color"}, {"id", number(c.id)}, {"value", json_of(c.value)}}; }

Json to_json(const ClearDepth& c) { return {{"cmd", "clear_depth"}, {"id", number(c.id)}, {"value", json_of(c.value)}}; }

Json to_json(const GenerateMips& c) { return {{"cmd", "generate_mips"}, {"id", number(c.id)}}; }

Json to_json(const Draw& c) {
    Json json{{"cmd", "draw"}, {"label", c.label}};
    std::size_t targets = 0;
    if (c.program != nullptr) {
        json["program"] = c.program->name;
        json["vertex_constants"] = constants_json(c.program->vertex_constants, c.vertex_constants);
        json["pixel_constants"] = constants_json(c.program->pixel_constants, c.pixel_constants);
        targets = static_cast<std::size_t>(c.program->targets);
    }
    json["vertices"] = number(c.vertices);
    json["indices"] = number(c.indices);
    json["first"] = c.first;
    json["count"] = c.count;
    json["raster"] = json_of(c.raster);
    json["depth_state"] = json_of(c.depth_state);
    json["viewport"] = {c.viewport.x, c.viewport.y, c.viewport.width, c.viewport.height};
    json["color"] = Json::array();
    for (std::size_t i = 0; i < targets; ++i) json["color"].push_back(number(c.color[i]));
    json["depth"] = number(c.depth);
    return json;
}

Json to_json(const Dispatch& c) {
    Json json{{"cmd", "dispatch"}, {"label", c.label}};
    if (c.program != nullptr) {
        json["program"] = c.program->name;
        json["constants"] = constants_json(c.program->named_constants, c.constants);
    }
    json["groups"] = {c.groups_x, c.groups_y, c.groups_z};
    return json;
}

}  // namespace

std::string command_line(const Command& command) {
    return to_line(std::visit([](const auto& c) { return to_json(c); }, command));
}

void CommandLog::write(const Command& command) {
    out_ << command_line(command) << '\n';
    ++count_;
}

}  // namespace gnomon::traces
