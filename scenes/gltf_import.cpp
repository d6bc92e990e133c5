// glTF 2.0 to a Scene: the node hierarchy, its meshes, the first camera and light.
#include "scenes/auto_view.h"
#include "scenes/gltf.h"
#include "scenes/gltf_draco.h"
#include "scenes/gltf_mesh.h"
#include "sim/error.h"
#include "sim/warn.h"

#include <tiny_gltf.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

namespace gnomon::scenes {

namespace {

constexpr std::size_t kMaxInstances = 1u << 20;
constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;
constexpr int kMaxDepth = 1024;  // of the node hierarchy

/// The first line of a parser's complaint, without what ends it.
std::string first_line(const std::string& text) {
    std::string line = text.substr(0, text.find_first_of("\r\n"));
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line.empty() ? "cannot be parsed" : line;
}

std::vector<unsigned char> read_file(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
        fail("{}: is no regular file, expected a .gltf or .glb file", path.string());
    std::ifstream file(path, std::ios::binary);
    if (!file) fail("{}: cannot be read", path.string());
    std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (bytes.empty()) fail("{}: is empty, expected glTF 2.0", path.string());
    return bytes;
}

/// Nesting of brackets outside strings: the JSON parser recurses, so a hostile file could exhaust the stack.
void check_nesting(const unsigned char* text, std::size_t size, const std::string& file) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < size; ++i) {
        const char c = static_cast<char>(text[i]);
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > 256) fail("{}: JSON nested deeper than 256 levels", file);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

tinygltf::Model parse(const std::filesystem::path& path, std::vector<std::string>& notes) {
    const std::string file = path.string();
    auto bytes = read_file(path);
    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    if (binary) {
        // Header: magic, version, length; then the JSON chunk. glTF 2.0 section 4.4
        const auto word = [&](std::size_t at) {
            std::uint32_t value = 0;
            std::memcpy(&value, bytes.data() + at, 4);
            return value;
        };
        if (bytes.size() < 20) fail("{}: {} bytes, too short for a GLB file", file, bytes.size());
        if (word(4) != 2) fail("{}: GLB version {}, expected 2", file, word(4));
        if (word(8) > bytes.size()) fail("{}: truncated: {} bytes, the header says {}", file, bytes.size(), word(8));
        if (word(12) > bytes.size() - 20)
            fail("{}: truncated: the JSON chunk has {} bytes, the file {}", file, word(12), bytes.size());
        check_nesting(bytes.data() + 20, word(12), file);
    } else {
        check_nesting(bytes.data(), bytes.size(), file);
    }

    if (drop_draco_primitives(bytes, binary))
        notes.push_back("Draco compression is not supported; meshes without a fallback are left out");

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                             void*) { return true; },  // textures are not used
                          nullptr);
    tinygltf::Model model;
    std::string errors;
    std::string warnings;
    bool parsed = false;
    const std::string folder = path.parent_path().string();
    try {
        const auto size = static_cast<unsigned int>(bytes.size());
        parsed = binary ? loader.LoadBinaryFromMemory(&model, &errors, &warnings, bytes.data(), size, folder)
                        : loader.LoadASCIIFromString(&model, &errors, &warnings, reinterpret_cast<const char*>(bytes.data()),
                                                     size, folder);
    } catch (const std::exception& error) {
        fail("{}: not valid glTF 2.0: {}", file, first_line(error.what()));
    }
    if (!parsed) fail("{}: not valid glTF 2.0: {}", file, first_line(errors));
    if (!model.asset.version.starts_with("2.")) fail("{}: glTF version '{}', expected 2.0", file, model.asset.version);
    for (const std::string& extension : model.extensionsRequired)
        if (extension != "KHR_lights_punctual" && extension != "KHR_draco_mesh_compression" &&
            !extension.starts_with("KHR_materials"))
            notes.push_back("required extension " + extension + " is not supported");
    if (!model.animations.empty()) notes.push_back("animations are not supported; the scene stands still");
    return model;
}

/// A node's own transform. glTF 2.0 section 3.5.3
glm::dmat4 local_transform(const tinygltf::Node& node, const std::string& where) {
    const auto check = [&](const std::vector<double>& values, std::size_t expected, const char* what) {
        if (values.size() != expected) fail("{}: {} has {} numbers, expected {}", where, what, values.size(), expected);
        for (const double value : values)
            if (!std::isfinite(value)) fail("{}: {} holds {}, expected finite numbers", where, what, value);
    };
    glm::dmat4 transform(1.0);
    if (!node.matrix.empty()) {
        check(node.matrix, 16, "matrix");
        for (int i = 0; i < 16; ++i) transform[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
        return transform;
    }
    if (!node.rotation.empty()) {
        check(node.rotation, 4, "rotation");
        const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
        transform[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0};
        transform[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0};
        transform[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0};
    }
    if (!node.scale.empty()) {
        check(node.scale, 3, "scale");
        for (int c = 0; c < 3; ++c) transform[c] *= node.scale[static_cast<std::size_t>(c)];
    }
    if (!node.translation.empty()) {
        check(node.translation, 3, "translation");
        transform[3] = {node.translation[0], node.translation[1], node.translation[2], 1};
    }
    return transform;
}

/// The rotation and place of a transform that may scale, shear or mirror: what cameras and lights take from their node. Their
/// direction, -z, stays; x and y are made perpendicular to it.
glm::mat4 rigid(const glm::dmat4& m, const std::string& where) {
    const auto unit = [&](const glm::dvec3& v) {
        const double length2 = glm::dot(v, v);
        if (!(length2 > 1e-60)) fail("{}: the transform of a camera or light has no extent", where);
        return v / std::sqrt(length2);
    };
    const glm::dvec3 z = unit(glm::dvec3(m[2]));
    const glm::dvec3 y = unit(glm::dvec3(m[1]) - glm::dot(glm::dvec3(m[1]), z) * z);
    const glm::dvec3 x = glm::cross(y, z);
    // One that is rigid already keeps its bits.
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a - b, a - b) < 1e-12; };
    if (near(x, glm::dvec3(m[0])) && near(y, glm::dvec3(m[1])) && near(z, glm::dvec3(m[2]))) return glm::mat4(m);
    return glm::mat4(glm::dmat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), m[3]));
}

class Importer {
public:
    Importer(const tinygltf::Model& model, std::string file, std::vector<std::string>& notes)
        : model_(model), file_(std::move(file)), notes_(notes) {}

    Scene run() {
        visit_roots();
        if (camera_) scene_.camera = *camera_;
        if (light_) scene_.light = *light_;
        if (scene_.triangle_count() == 0)
            fail("{}: no triangles to render{}", file_, notes_.empty() ? "" : " (" + notes_.front() + ")");
        const Bounds box = scene_.bounds();
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(box.lower[c]) || !std::isfinite(box.upper[c]) || !std::isfinite(box.upper[c] - box.lower[c]))
                fail("{}: the scene reaches beyond the range of single precision", file_);
        return std::move(scene_);
    }

    [[nodiscard]] bool has_camera() const { return camera_.has_value(); }
    [[nodiscard]] bool has_light() const { return light_.has_value(); }
    [[nodiscard]] const std::optional<Light>& point_light() const { return point_light_; }

private:
    struct Visit {
        int node;
        glm::dmat4 parent;
        bool root;
        int depth;
    };

    void visit_roots() {
        std::vector<int> roots;
        if (!model_.scenes.empty()) {
            const int chosen = model_.defaultScene < 0 ? 0 : model_.defaultScene;
            if (static_cast<std::size_t>(chosen) >= model_.scenes.size())
                fail("{}: scene {}, expected 0 to {}", file_, chosen, model_.scenes.size() - 1);
            roots = model_.scenes[static_cast<std::size_t>(chosen)].nodes;
        } else {
            // No scene: every node that nobody has as a child.
            std::vector<bool> is_child(model_.nodes.size(), false);
            for (const auto& node : model_.nodes)
                for (const int child : node.children)
                    if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
                        is_child[static_cast<std::size_t>(child)] = true;
            for (std::size_t i = 0; i < is_child.size(); ++i)
                if (!is_child[i]) roots.push_back(static_cast<int>(i));
        }

        // Depth first, in the order of the file. Every node has one parent, so one seen twice means a cycle or a shared child.
        std::vector<bool> seen(model_.nodes.size(), false);
        std::vector<Visit> stack;
        for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, glm::dmat4(1.0), true, 0});
        while (!stack.empty()) {
            const Visit visit = stack.back();
            stack.pop_back();
            if (visit.node < 0 || static_cast<std::size_t>(visit.node) >= model_.nodes.size())
                fail("{}: node {}, expected 0 to {}", file_, visit.node, static_cast<std::ptrdiff_t>(model_.nodes.size()) - 1);
            const auto index = static_cast<std::size_t>(visit.node);
            const std::string where = fmt::format("{}: nodes[{}]", file_, index);
            if (seen[index]) fail("{}: reached twice; the node hierarchy must be a tree", where);
            if (visit.depth > kMaxDepth) fail("{}: nested deeper than {} nodes", where, kMaxDepth);
            seen[index] = true;
            const tinygltf::Node& node = model_.nodes[index];
            const glm::dmat4 local = local_transform(node, where);
            const glm::dmat4 world = visit.root ? local : visit.parent * local;
            add_node(node, world, where);
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
                stack.push_back({*child, world, false, visit.depth + 1});
        }
    }

    void add_node(const tinygltf::Node& node, const glm::dmat4& world, const std::string& where) {
        for (int i = 0; i < 16; ++i)
            if (!std::isfinite(static_cast<float>(world[i / 4][i % 4])))
                fail("{}: its transform overflows single precision", where);
        if (node.skin >= 0) notes_.push_back("skins are not supported; meshes keep their rest pose");
        if (node.mesh >= 0) add_mesh(node.mesh, world, where);
        if (node.camera >= 0 && !camera_) add_camera(node.camera, world, where);
        const auto light = node.extensions.find("KHR_lights_punctual");
        if (light != node.extensions.end() && light->second.IsObject() && light->second.Has("light")) {
            if (!light->second.Get("light").IsInt()) fail("{}: KHR_lights_punctual: light is no whole number", where);
            add_light(light->second.Get("light").GetNumberAsInt(), world, where);
        }
    }

    void add_mesh(int index, const glm::dmat4& world, const std::string& where) {
        if (static_cast<std::size_t>(index) >= model_.meshes.size())
            fail("{}: mesh {}, expected 0 to {}", where, index, static_cast<std::ptrdiff_t>(model_.meshes.size()) - 1);
        const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(index)];
        const bool mirrored = glm::determinant(glm::dmat3(world)) < 0;
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
            const auto key = std::tuple(index, p, mirrored);
            auto known = meshes_.find(key);
            if (known == meshes_.end()) {
                std::string name = mesh.name.empty() ? fmt::format("mesh{}", index) : mesh.name;
                if (mesh.primitives.size() > 1) name += fmt::format(".{}", p);
                auto read = read_primitive(model_, mesh.primitives[p], name, mirrored, file_, notes_);
                std::optional<std::uint32_t> place;
                if (read && !read->indices.empty()) {
                    place = static_cast<std::uint32_t>(scene_.meshes.size());
                    scene_.meshes.push_back(std::move(*read));
                }
                known = meshes_.emplace(key, place).first;
            }
            if (!known->second) continue;
            scene_.instances.push_back({*known->second, glm::mat4(world)});
            triangles_ += scene_.meshes[*known->second].indices.size() / 3;
            if (scene_.instances.size() > kMaxInstances || triangles_ > kMaxTriangles)
                fail("{}: more than {} instances or {} triangles", file_, kMaxInstances, kMaxTriangles);
        }
    }

    void add_camera(int index, const glm::dmat4& world, const std::string& where) {
        if (static_cast<std::size_t>(index) >= model_.cameras.size())
            fail("{}: camera {}, expected 0 to {}", where, index, static_cast<std::ptrdiff_t>(model_.cameras.size()) - 1);
        const tinygltf::Camera& camera = model_.cameras[static_cast<std::size_t>(index)];
        if (camera.type != "perspective") {
            notes_.push_back("orthographic cameras are not supported; one is chosen instead");
            return;
        }
        const auto& lens = camera.perspective;
        // Without a far plane: far beyond anything. glTF 2.0 section 3.10.3
        const double zfar = lens.zfar > 0 ? lens.zfar : 10000.0 * lens.znear;
        const Camera narrowed{.world_from_camera = rigid(world, where),
                              .yfov_rad = static_cast<float>(lens.yfov),
                              .znear = static_cast<float>(lens.znear),
                              .zfar = static_cast<float>(zfar)};
        // What counts is what single precision makes of it: planes that differ by less than its step are one plane.
        if (!(narrowed.yfov_rad > 1e-4f && narrowed.yfov_rad < 3.1415f && narrowed.znear > 1e-30f && narrowed.zfar < 1e30f &&
              narrowed.zfar > narrowed.znear * 1.0001f))
            fail("{}: cameras[{}]: yfov {}, znear {}, zfar {}; expected 0 < yfov < pi and 0 < znear < zfar in single precision",
                 where, index, lens.yfov, lens.znear, lens.zfar);
        camera_ = narrowed;
    }

    void add_light(int index, const glm::dmat4& world, const std::string& where) {
        if (index < 0 || static_cast<std::size_t>(index) >= model_.lights.size())
            fail("{}: light {}, expected 0 to {}", where, index, static_cast<std::ptrdiff_t>(model_.lights.size()) - 1);
        const tinygltf::Light& source = model_.lights[static_cast<std::size_t>(index)];
        if (light_ || (point_light_ && source.type == "point")) return;
        Light light{
            .kind = LightKind::Spot, .world_from_light = rigid(world, where), .outer_cone_rad = 0.5f, .color = glm::vec3(1.0f)};
        for (std::size_t c = 0; c < 3 && source.color.size() == 3; ++c) {
            if (!(source.color[c] >= 0 && source.color[c] < 1e30))
                fail("{}: lights[{}]: colour {}, expected 0 or more", where, index, source.color[c]);
            light.color[static_cast<int>(c)] = static_cast<float>(source.color[c]);
        }
        if (source.type == "directional") {
            light.kind = LightKind::Directional;
            light_ = light;
        } else if (source.type == "spot") {
            const double outer = source.spot.outerConeAngle;
            if (!(outer > 1e-4 && outer < 1.5707))
                fail("{}: lights[{}]: outerConeAngle {}, expected more than 0 and less than pi/2", where, index, outer);
            light.outer_cone_rad = static_cast<float>(outer);
            light_ = light;
        } else if (source.type == "point") {
            point_light_ = light;
        } else {
            fail("{}: lights[{}]: type '{}', expected spot, directional or point", where, index, source.type);
        }
    }

    const tinygltf::Model& model_;
    std::string file_;
    std::vector<std::string>& notes_;  // what is not supported and what was done instead
    Scene scene_;
    std::map<std::tuple<int, std::size_t, bool>, std::optional<std::uint32_t>> meshes_;
    std::size_t triangles_ = 0;
    std::optional<Camera> camera_;
    std::optional<Light> light_;
    std::optional<Light> point_light_;
};

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const GltfOptions& options) {
    std::vector<std::string> notes;
    const tinygltf::Model model = parse(path, notes);
    Importer importer(model, path.string(), notes);
    Scene scene = importer.run();
    scene.name = path.stem().string();

    // What the file lacks follows from the model alone, so that a ground changes neither camera nor light.
    const Bounds box = scene.bounds();
    if (!importer.has_camera() || options.automatic_view) scene.camera = automatic_camera(box);
    if (!importer.has_light() || options.automatic_view) {
        scene.light = automatic_light(box);
        if (const auto& point = importer.point_light(); point && !options.automatic_view) {
            notes.push_back("point lights are not supported; a spot at the same place is aimed at the scene");
            scene.light = spot_at(glm::dvec3(point->world_from_light[3]), box);
            scene.light.color = point->color;
        }
    }
    if (options.ground) {
        scene.meshes.push_back(ground_plane(box));
        scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size() - 1), glm::mat4(1.0f)});
    }
    for (const std::string& note : notes) warn_once(path.string() + ": " + note);
    return scene;
}

}  // namespace gnomon::scenes
