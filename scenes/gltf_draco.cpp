#include "scenes/gltf_draco.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <string_view>

namespace gnomon::scenes {

namespace {

constexpr std::string_view kExtension = "KHR_draco_mesh_compression";

/// Whether some attribute of a Draco primitive has no bytes of its own.
bool lacks_fallback(const nlohmann::json& primitive, const nlohmann::json& accessors) {
    const auto extensions = primitive.find("extensions");
    const auto attributes = primitive.find("attributes");
    if (extensions == primitive.end() || !extensions->is_object() || !extensions->contains(kExtension)) return false;
    if (attributes == primitive.end() || !attributes->is_object()) return false;
    for (const auto& [name, index] : attributes->items()) {
        if (!index.is_number_unsigned() || index.get<std::size_t>() >= accessors.size()) continue;
        const auto& accessor = accessors[index.get<std::size_t>()];
        if (accessor.is_object() && !accessor.contains("bufferView")) return true;
    }
    return false;
}

/// True when something was removed.
bool drop_primitives(nlohmann::json& gltf) {
    const auto meshes = gltf.find("meshes");
    const auto accessors = gltf.find("accessors");
    if (meshes == gltf.end() || !meshes->is_array() || accessors == gltf.end() || !accessors->is_array()) return false;
    bool dropped = false;
    for (auto& mesh : *meshes) {
        const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
        if (!mesh.is_object() || primitives == mesh.end() || !primitives->is_array()) continue;
        nlohmann::json kept = nlohmann::json::array();
        for (const auto& primitive : *primitives) {
            if (primitive.is_object() && lacks_fallback(primitive, *accessors)) {
                dropped = true;
            } else {
                kept.push_back(primitive);
            }
        }
        *primitives = std::move(kept);
    }
    return dropped;
}

void append_word(std::vector<unsigned char>& bytes, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<unsigned char>(value >> shift & 0xffu));
}

}  // namespace

bool drop_draco_primitives(std::vector<unsigned char>& bytes, bool binary) {
    // GLB: 12 bytes of header, then the JSON chunk behind its length and type. glTF 2.0 section 4.4
    std::size_t begin = 0;
    std::size_t size = bytes.size();
    if (binary) {
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, 4);
        begin = 20;
        size = length;
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + begin, size);
    if (text.find(kExtension) == std::string_view::npos) return false;
    auto gltf = nlohmann::json::parse(text, nullptr, false);
    if (!gltf.is_object() || !drop_primitives(gltf)) return false;

    std::string rewritten = gltf.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (!binary) {
        bytes.assign(rewritten.begin(), rewritten.end());
        return true;
    }
    rewritten.resize((rewritten.size() + 3) / 4 * 4, ' ');
    std::vector<unsigned char> out(bytes.begin(), bytes.begin() + 8);
    append_word(out, bytes.size() - size + rewritten.size());
    append_word(out, rewritten.size());
    out.insert(out.end(), bytes.begin() + 16, bytes.begin() + 20);
    out.insert(out.end(), rewritten.begin(), rewritten.end());
    out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(begin + size), bytes.end());
    bytes = std::move(out);
    return true;
}

}  // namespace gnomon::scenes
