// A Scene to GLB, so that reading it back gives the same bits: numbers are written as doubles that hold the floats exactly.
#include "scenes/gltf.h"
#include "sim/error.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

namespace gnomon::scenes {

namespace {

std::vector<double> as_doubles(const glm::mat4& m) {
    std::vector<double> values(16);
    for (int i = 0; i < 16; ++i) values[static_cast<std::size_t>(i)] = static_cast<double>(m[i / 4][i % 4]);
    return values;
}

/// Appends data to the one buffer and returns the index of a view of it.
int add_view(tinygltf::Model& model, const void* data, std::size_t size, int stride, int target) {
    auto& bytes = model.buffers.front().data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = size;
    view.byteStride = static_cast<std::size_t>(stride);
    view.target = target;
    bytes.resize(bytes.size() + size);
    std::memcpy(bytes.data() + view.byteOffset, data, size);
    model.bufferViews.push_back(view);
    return static_cast<int>(model.bufferViews.size() - 1);
}

int add_accessor(tinygltf::Model& model, int view, std::size_t offset, std::size_t count, int component_type, int type) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.byteOffset = offset;
    accessor.count = count;
    accessor.componentType = component_type;
    accessor.type = type;
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size() - 1);
}

void add_mesh(tinygltf::Model& model, const Mesh& mesh) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    const int vertices = add_view(model, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vertex), sizeof(Vertex),
                                  TINYGLTF_TARGET_ARRAY_BUFFER);
    const std::size_t count = mesh.vertices.size();
    const int position = add_accessor(model, vertices, 0, count, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
    const int normal =
        add_accessor(model, vertices, sizeof(glm::vec3), count, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
    primitive.attributes = {{"POSITION", position}, {"NORMAL", normal}};
    const int indices = add_view(model, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t), 0,
                                 TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.indices =
        add_accessor(model, indices, 0, mesh.indices.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);

    // glTF 2.0 section 3.7.2.1: position accessors state their bounds.
    auto& bounds = model.accessors[static_cast<std::size_t>(position)];
    for (int c = 0; c < 3; ++c) {
        const auto [low, high] = std::ranges::minmax(mesh.vertices, {}, [c](const Vertex& v) { return v.position[c]; });
        bounds.minValues.push_back(static_cast<double>(low.position[c]));
        bounds.maxValues.push_back(static_cast<double>(high.position[c]));
    }

    tinygltf::Material material;
    material.name = mesh.name;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.baseColorFactor = {static_cast<double>(mesh.base_color.r),
                                                     static_cast<double>(mesh.base_color.g),
                                                     static_cast<double>(mesh.base_color.b), 1.0};
    model.materials.push_back(material);
    primitive.material = static_cast<int>(model.materials.size() - 1);

    tinygltf::Mesh out;
    out.name = mesh.name;
    out.primitives.push_back(primitive);
    model.meshes.push_back(out);
}

int add_node(tinygltf::Model& model, const glm::mat4& transform, const std::string& name) {
    tinygltf::Node node;
    node.name = name;
    node.matrix = as_doubles(transform);
    model.nodes.push_back(node);
    const int index = static_cast<int>(model.nodes.size() - 1);
    model.scenes.front().nodes.push_back(index);
    return index;
}

void add_camera(tinygltf::Model& model, const Camera& camera) {
    tinygltf::Camera out;
    out.type = "perspective";
    out.perspective.yfov = static_cast<double>(camera.yfov_rad);
    out.perspective.znear = static_cast<double>(camera.znear);
    out.perspective.zfar = static_cast<double>(camera.zfar);
    model.cameras.push_back(out);
    const int node = add_node(model, camera.world_from_camera, "camera");
    model.nodes[static_cast<std::size_t>(node)].camera = 0;
}

void add_light(tinygltf::Model& model, const Light& light) {
    tinygltf::Light out;
    out.type = light.kind == LightKind::Spot ? "spot" : "directional";
    out.intensity = 1;
    out.color = {static_cast<double>(light.color.r), static_cast<double>(light.color.g), static_cast<double>(light.color.b)};
    if (light.kind == LightKind::Spot) out.spot.outerConeAngle = static_cast<double>(light.outer_cone_rad);
    if (light.kind == LightKind::Spot) out.spot.innerConeAngle = 0;
    model.lights.push_back(out);
    const int node = add_node(model, light.world_from_light, "light");
    model.nodes[static_cast<std::size_t>(node)].extensions["KHR_lights_punctual"] =
        tinygltf::Value(tinygltf::Value::Object{{"light", tinygltf::Value(0)}});
}

}  // namespace

void save_glb(const Scene& scene, const std::filesystem::path& path) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "Gnomon";
    model.buffers.emplace_back();
    model.scenes.emplace_back();
    model.scenes.front().name = scene.name;
    model.defaultScene = 0;
    for (const Mesh& mesh : scene.meshes) add_mesh(model, mesh);
    for (const Instance& instance : scene.instances) {
        const int node = add_node(model, instance.world_from_object, scene.meshes[instance.mesh].name);
        model.nodes[static_cast<std::size_t>(node)].mesh = static_cast<int>(instance.mesh);
    }
    add_camera(model, scene.camera);
    add_light(model, scene.light);

    std::ostringstream stream(std::ios::binary);
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, stream, false, true))
        fail("{}: the scene cannot be written as glTF", path.string());
    const std::string bytes = stream.str();

    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (file) return;
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    fail("{}: cannot be written", path.string());
}

}  // namespace gnomon::scenes
