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
    if (c.desc.samples != 1) json["samples"] = c.desc.samples;
    return json;
}

Json to_json(const WriteTexture& c) {
    Json json{{"cmd", "write_texture"}, {"id", number(c.id)}, {"level", c.level}};
    if (c.layer != 0) json["layer"] = c.layer;
    if (c.sample != 0) json["sample"] = c.sample;
    json["data"] = data_json(c.data);
    return json;
}

/// Just the number of a texture where the view is its level 0 and layer 0.
Json view_json(const TargetView& view) {
    if (view == TargetView(view.texture)) return number(view.texture);
    return {{"id", number(view.texture)}, {"level", view.level}, {"layer", view.first_layer}, {"layers", view.layers}};
}

Json to_json(const ClearColor& c) { return {{"cmd", "clear_color"}, {"id", view_json(c.target)}, {"value", json_of(c.value)}}; }

Json to_json(const ClearDepth& c) { return {{"cmd", "clear_depth"}, {"id", view_json(c.target)}, {"value", json_of(c.value)}}; }

Json to_json(const ClearStencil& c) { return {{"cmd", "clear_stencil"}, {"id", view_json(c.target)}, {"value", c.value}}; }

Json to_json(const GenerateMips& c) { return {{"cmd", "generate_mips"}, {"id", number(c.id)}}; }

Json to_json(const Resolve& c) {
    return {{"cmd", "resolve"}, {"source", view_json(c.source)}, {"destination", view_json(c.destination)}};
}

Json viewport_json(const Viewport& v) {
    return {json_of(v.x), json_of(v.y), json_of(v.width), json_of(v.height), json_of(v.min_depth), json_of(v.max_depth)};
}

/// The geometry of a draw; what stands at its default is left out, so that lines stay readable.
void add_geometry(Json& json, const Draw& c) {
    const Draw standard;
    if (c.topology != standard.topology) json["topology"] = name_of(c.topology);
    json["vertices"] = number(c.vertices);
    if (c.instances != BufferId::None) json["instances"] = number(c.instances);
    json["indices"] = number(c.indices);
    if (c.index_type != standard.index_type) json["index_type"] = name_of(c.index_type);
    if (c.primitive_restart) json["primitive_restart"] = true;
    json["first"] = c.first;
    json["count"] = c.count;
    if (c.base_vertex != 0) json["base_vertex"] = c.base_vertex;
    if (c.first_instance != 0) json["first_instance"] = c.first_instance;
    if (c.instance_count != 1) json["instance_count"] = c.instance_count;
}

void add_output(Json& json, const Draw& c, std::size_t targets) {
    const OutputState standard;
    for (std::size_t i = 0; i < targets; ++i) {
        if (c.output.blend[i] == standard.blend[i]) continue;
        json["blend"] = Json::array();
        for (std::size_t k = 0; k < targets; ++k) json["blend"].push_back(json_of(c.output.blend[k]));
        break;
    }
    if (c.output.blend_constant != standard.blend_constant) json["blend_constant"] = json_of(c.output.blend_constant);
    if (c.output.sample_mask != standard.sample_mask) json["sample_mask"] = c.output.sample_mask;
    if (c.output.alpha_to_coverage) json["alpha_to_coverage"] = true;
}

Json to_json(const Draw& c) {
    Json json{{"cmd", "draw"}, {"label", c.label}};
    std::size_t targets = 0;
    if (c.program != nullptr) {
        json["program"] = c.program->name;
        json["vertex_constants"] = constants_json(c.program->vertex_constants, c.vertex_constants);
        json["pixel_constants"] = constants_json(c.program->pixel_constants, c.pixel_constants);
        targets = static_cast<std::size_t>(c.program->targets());
    }
    add_geometry(json, c);
    json["raster"] = json_of(c.raster);
    json["depth_state"] = json_of(c.depth_state);
    if (c.stencil != StencilState{}) json["stencil"] = json_of(c.stencil);
    add_output(json, c, targets);
    json["viewport"] = viewport_json(c.viewport);
    for (const Viewport& viewport : c.viewports) json["viewports"].push_back(viewport_json(viewport));
    for (const ScissorRect& r : c.scissors) json["scissors"].push_back({r.x0, r.y0, r.x1, r.y1});
    json["color"] = Json::array();
    for (std::size_t i = 0; i < targets; ++i) json["color"].push_back(view_json(c.color[i]));
    json["depth"] = view_json(c.depth);
    if (c.derivative_report != TextureId::None) json["derivative_report"] = number(c.derivative_report);
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
