// glTF in and out: topologies, accessors, hierarchies, everything malformed, and the round trip.
#include "scenes/gltf.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/unit/scenes_files.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cstdint>
#include <limits>

using namespace gnomon;
using namespace gnomon::scenes;
using namespace gnomon::test;

namespace {

const std::vector<float> kQuad{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<std::uint8_t> kNoIndices;

/// The corners of all triangles, in order.
std::vector<glm::vec3> corners(const Mesh& mesh) {
    std::vector<glm::vec3> out;
    for (const std::uint32_t i : mesh.indices) out.push_back(mesh.vertices[i].position);
    return out;
}

Scene load(const GltfText& text) {
    const TemporaryFolder folder;
    return load_gltf(folder.write("test.gltf", text.str()));
}

std::string error_of(const std::string& name, const std::string& bytes) {
    const TemporaryFolder folder;
    try {
        (void)load_gltf(folder.write(name, bytes));
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}
std::string error_of(const GltfText& text) { return error_of("test.gltf", text.str()); }

glm::vec3 at(int i) { return {kQuad[static_cast<std::size_t>(3 * i)], kQuad[static_cast<std::size_t>(3 * i + 1)], 0}; }

}  // namespace

TEST_CASE("triangle lists, strips and fans, indexed or not, give the same triangles", "[scenes][gltf]") {
    const std::vector<glm::vec3> list{at(0), at(1), at(2), at(0), at(2), at(3)};
    const auto expect = [&](const GltfText& text, const std::vector<glm::vec3>& expected) {
        const Scene scene = load(text);
        REQUIRE(scene.meshes.size() == 1);
        CHECK(corners(scene.meshes[0]) == expected);
        for (const Vertex& vertex : scene.meshes[0].vertices)
            CHECK(vertex.normal == glm::vec3(0, 0, 1));  // flat, both wound alike
    };
    expect(make_gltf(kQuad, std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3}, 4), list);
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 4), list);
    expect(make_gltf(kQuad, std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, 4), list);
    // glTF 2.0 section 3.7.2.1: strip p_i, p_(i+1+i%2), p_(i+2-i%2); fan p_(i+1), p_(i+2), p_0
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 3, 2}, 5), {at(0), at(1), at(3), at(1), at(2), at(3)});
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 2, 3}, 6), {at(1), at(2), at(0), at(2), at(3), at(0)});
    expect(make_gltf(kQuad, kNoIndices, 6), {at(1), at(2), at(0), at(2), at(3), at(0)});
    const std::vector<float> triangle(kQuad.begin(), kQuad.begin() + 9);
    expect(make_gltf(triangle, kNoIndices, 4), {at(0), at(1), at(2)});
}

TEST_CASE("sparse accessors replace single elements, with and without a base", "[scenes][gltf]") {
    std::vector<unsigned char> bytes;
    append_bytes(bytes, kQuad);                          // 0..47
    append_bytes(bytes, std::vector<std::uint16_t>{2});  // 48
    append_bytes(bytes, std::vector<float>{5, 6, 7});    // 52
    GltfText text = make_gltf(kQuad, kNoIndices, 6);
    text.buffers = fmt::format(R"({{"byteLength":{},"uri":"{}"}})", bytes.size(), data_uri(bytes));
    text.views =
        R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":2},{"buffer":0,"byteOffset":52,"byteLength":12})";
    const std::string sparse =
        R"("sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}})";
    text.accessors = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)" + sparse + "}";
    CHECK(corners(load(text).meshes[0])[1] == glm::vec3(5, 6, 7));
    CHECK(corners(load(text).meshes[0])[0] == at(1));
    text.accessors = R"({"bufferView":0,"componentType":5126,"count":2,"type":"VEC3",)" + sparse + "}";
    CHECK_THAT(error_of(text), Catch::Contains("index 2, expected 0 to 1"));
}

TEST_CASE("node transforms compose from the root down", "[scenes][gltf]") {
    GltfText text = make_gltf(kQuad, kNoIndices, 6);
    text.nodes =
        R"([{"translation":[1,2,3],"children":[1]},{"rotation":[0,0,0.70710678118,0.70710678118],"scale":[2,3,4],"mesh":0}])";
    const glm::mat4 m = load(text).instances.at(0).world_from_object;
    const glm::vec4 x = m * glm::vec4(1, 0, 0, 1);  // scaled by 2, turned to y, moved
    CHECK(x.x == Approx(1).margin(1e-6));
    CHECK(x.y == Approx(4).margin(1e-6));
    CHECK(x.z == Approx(3).margin(1e-6));

    text.nodes = R"([{"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1],"mesh":0}])";
    CHECK(load(text).instances.at(0).world_from_object[3] == glm::vec4(7, 8, 9, 1));

    // A mirroring instance gets its own mesh with the winding turned over.
    text.nodes = R"([{"scale":[-1,1,1],"mesh":0}])";
    CHECK(corners(load(text).meshes.at(0))[1] == at(0));
}

TEST_CASE("cameras and lights of the file are used, and sensible ones where it has none", "[scenes][gltf]") {
    GltfText text = make_gltf(kQuad, kNoIndices, 6);
    const Scene plain = load(text);
    CHECK(plain.camera.zfar > plain.camera.znear);
    CHECK(plain.light.kind == LightKind::Spot);
    CHECK(plain.light.outer_cone_rad > 0.1f);

    text.nodes = R"([{"mesh":0},{"camera":0,"translation":[0,0,5]},{"extensions":{"KHR_lights_punctual":{"light":0}}}])";
    text.scene_nodes = "[0,1,2]";
    text.extra = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.25,"zfar":64}}],)"
                 R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional","color":[1,0.5,0.25]}]}})";
    const Scene given = load(text);
    CHECK(given.camera.yfov_rad == 0.5f);
    CHECK(given.camera.znear == 0.25f);
    CHECK(given.camera.zfar == 64.0f);
    CHECK(given.camera.world_from_camera[3] == glm::vec4(0, 0, 5, 1));
    CHECK(given.light.kind == LightKind::Directional);
    CHECK(given.light.color == glm::vec3(1, 0.5, 0.25));
}

TEST_CASE("a ground adds a plane at the lowest point and changes neither camera nor light", "[scenes][gltf]") {
    const TemporaryFolder folder;
    const auto file = folder.write("test.gltf", make_gltf(kQuad, kNoIndices, 6).str());
    const Scene without = load_gltf(file);
    const Scene with = load_gltf(file, {.ground = true});
    REQUIRE(with.meshes.size() == without.meshes.size() + 1);
    CHECK(with.bounds().lower.y == without.bounds().lower.y);
    CHECK(with.bounds().upper.x > 4 * without.bounds().upper.x);
    CHECK(with.camera.world_from_camera == without.camera.world_from_camera);
    CHECK(with.light.world_from_light == without.light.world_from_light);
}

TEST_CASE("what is malformed is refused with one line that says what and where", "[scenes][gltf][errors]") {
    const auto quad = [] { return make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 4); };
    const auto expect = [](const GltfText& text, const std::string& words) {
        const std::string message = error_of(text);
        CHECK_THAT(message, Catch::Contains(words));
        CHECK(message.find('\n') == std::string::npos);
    };
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 9}, 4), "index 2 is 9, but there are 4 vertices");
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1}, 4), "multiple of 3");
    expect(make_gltf(kQuad, std::vector<std::uint16_t>{0, 1}, 5), "expected at least 3");
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    expect(make_gltf(std::vector<float>{0, 0, 0, 1, nan, 0, 1, 1, 0}, kNoIndices, 4), "position 1 is nan");
    expect(make_gltf(std::vector<float>{0, 0, infinity, 1, 0, 0, 1, 1, 0}, kNoIndices, 4), "position 0 is inf");
    expect(make_gltf(std::vector<float>{-3e38f, 0, 0, 3e38f, 0, 0, 1, 1, 0}, kNoIndices, 4), "single precision");

    GltfText text = quad();
    text.nodes = R"([{"mesh":0,"children":[1]},{"children":[0]}])";
    expect(text, "must be a tree");
    text = quad();
    text.nodes = R"([{"mesh":7}])";
    expect(text, "mesh 7");
    text = quad();
    text.nodes = R"([{"translation":[0,0,0]}])";
    expect(text, "no triangles");
    text = quad();
    text.scene_nodes = "[4]";
    expect(text, "node 4");
    text = quad();
    text.views = R"({"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":1200})";
    expect(text, "1200 bytes at 48");
    text = quad();
    text.accessors = R"({"bufferView":0,"componentType":5126,"count":400,"type":"VEC3"})";
    expect(text, "accessor");
    text = quad();
    text.accessors = R"({"bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3"},)"
                     R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"})";
    CHECK(error_of(text) != "no error");
    text = quad();
    text.buffers = R"({"byteLength":60,"uri":"missing.bin"})";
    expect(text, "missing.bin");
    text = quad();
    text.extra = R"(,"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[2,0,0,1]}}])";
    text.primitives = R"({"attributes":{"POSITION":0},"indices":1,"mode":4,"material":0})";
    expect(text, "baseColorFactor 2");
    text.primitives = R"({"attributes":{"POSITION":0},"indices":1,"mode":4,"material":3})";
    expect(text, "material 3");

    // Cameras that single precision makes degenerate, light indices that are no index.
    const auto with_camera = [&](const std::string& lens) {
        GltfText camera = quad();
        camera.nodes = R"([{"mesh":0,"camera":0}])";
        camera.extra = R"(,"cameras":[{"type":"perspective","perspective":)" + lens + "}]";
        return camera;
    };
    expect(with_camera(R"({"yfov":0.5,"znear":1e-300,"zfar":1})"), "znear");
    expect(with_camera(R"({"yfov":0.5,"znear":1.0,"zfar":1.00000001})"), "zfar");
    expect(with_camera(R"({"yfov":1e-30,"znear":1.0,"zfar":10})"), "yfov");
    for (const char* index : {"\"a\"", "0.7", "1e30"}) {
        text = quad();
        text.nodes = fmt::format(R"([{{"mesh":0,"extensions":{{"KHR_lights_punctual":{{"light":{}}}}}}}])", index);
        text.extra = R"(,"extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional"}]}})";
        expect(text, "light");
    }

    CHECK_THAT(error_of("a.gltf", ""), Catch::Contains("is empty"));
    CHECK_THAT(error_of("a.gltf", "{"), Catch::Contains("not valid glTF 2.0"));
    CHECK_THAT(error_of("a.gltf", R"({"asset":{"version":"1.0"}})"), Catch::Contains("expected 2.0"));
    CHECK_THAT(error_of("a.gltf", std::string(100000, '[')), Catch::Contains("nested deeper"));
    CHECK_THAT(error_of("a.glb", "glTF"), Catch::Contains("too short"));
    CHECK_THAT(error_of("a.glb", std::string("glTF\1\0\0\0\xff\0\0\0aaaaaaaaaaaaaaaa", 28)), Catch::Contains("version 1"));
    CHECK_THAT(error_of("a.glb", std::string("glTF\2\0\0\0\xff\0\0\0aaaaaaaaaaaaaaaa", 28)), Catch::Contains("truncated"));
    CHECK_THROWS_AS(load_gltf("/nonexistent/file.glb"), Error);
    CHECK_THROWS_AS(load_gltf("/"), Error);
}

TEST_CASE("any damage to a file is refused or rendered, never a crash", "[scenes][gltf][errors]") {
    const TemporaryFolder folder;
    Scene scene = procedural_scenes()[0].make();
    save_glb(scene, folder.path() / "whole.glb");
    std::ifstream in(folder.path() / "whole.glb", std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    const std::string text = make_gltf(kQuad, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 4).str();

    int refused = 0;
    int accepted = 0;
    const auto attempt = [&](const std::string& name, const std::string& bytes) {
        try {
            const Scene loaded = load_gltf(folder.write(name, bytes));
            for (const Mesh& mesh : loaded.meshes)
                for (const std::uint32_t index : mesh.indices) REQUIRE(index < mesh.vertices.size());
            ++accepted;
        } catch (const Error&) {
            ++refused;
        }
    };
    for (std::size_t size = 0; size < whole.size(); size += 37) attempt("cut.glb", whole.substr(0, size));
    for (std::size_t size = 0; size < text.size(); size += 11) attempt("cut.gltf", text.substr(0, size));
    std::uint64_t state = 1;
    for (int i = 0; i < 1500; ++i) {
        std::string damaged = i % 2 == 0 ? whole : text;
        for (int k = 0; k < 1 + i % 3; ++k) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            char& byte = damaged[(state >> 20) % damaged.size()];
            byte = static_cast<char>(byte ^ (1 << (state >> 56) % 5));  // stays text where it was text
        }
        attempt(i % 2 == 0 ? "flip.glb" : "flip.gltf", damaged);
    }
    CHECK(refused > 300);
    CHECK(accepted > 100);
}

TEST_CASE("every procedural scene survives a round trip through GLB bit for bit", "[scenes][gltf]") {
    const TemporaryFolder folder;
    for (const ProceduralScene& source : procedural_scenes()) {
        const Scene scene = source.make();
        save_glb(scene, folder.path() / "scene.glb");
        const Scene back = load_gltf(folder.path() / "scene.glb");
        REQUIRE(back.meshes.size() == scene.meshes.size());
        for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
            CHECK(back.meshes[m].vertices == scene.meshes[m].vertices);
            CHECK(back.meshes[m].indices == scene.meshes[m].indices);
            CHECK(back.meshes[m].base_color == scene.meshes[m].base_color);
        }
        REQUIRE(back.instances.size() == scene.instances.size());
        for (std::size_t i = 0; i < scene.instances.size(); ++i) {
            CHECK(back.instances[i].mesh == scene.instances[i].mesh);
            CHECK(back.instances[i].world_from_object == scene.instances[i].world_from_object);
        }
        CHECK(back.camera.world_from_camera == scene.camera.world_from_camera);
        CHECK(back.camera.yfov_rad == scene.camera.yfov_rad);
        CHECK(back.camera.znear == scene.camera.znear);
        CHECK(back.camera.zfar == scene.camera.zfar);
        CHECK(back.light.kind == scene.light.kind);
        CHECK(back.light.world_from_light == scene.light.world_from_light);
        CHECK((back.light.outer_cone_rad == scene.light.outer_cone_rad || scene.light.kind == LightKind::Directional));
        CHECK(back.light.color == scene.light.color);
    }
    CHECK_THROWS_AS(save_glb(procedural_scenes()[0].make(), "/nonexistent/folder/scene.glb"), Error);
    CHECK(!std::filesystem::exists("/nonexistent"));
}

TEST_CASE("every glTF file of assimp-testmodels loads or is refused", "[scenes][gltf][assimp]") {
    const std::filesystem::path root = "/usr/share/assimp/models";
    if (!std::filesystem::exists(root)) {
        WARN("SKIPPED: assimp-testmodels is not installed");
        return;
    }
    int loaded = 0;
    int refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
        if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
        INFO(entry.path().string());
        try {
            const Scene scene = load_gltf(entry.path(), {.ground = true});
            CHECK(scene.triangle_count() > 0);
            ++loaded;
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find('\n') == std::string::npos);
            ++refused;
        }
    }
    CHECK(loaded >= 25);
    CHECK(refused >= 15);
}
