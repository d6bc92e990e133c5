// Small glTF files for tests, written where nobody else looks.
#pragma once

#include "scenes/gltf.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace gnomon::test {

/// A folder of this process's own, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder()
        : path_(std::filesystem::temp_directory_path() / fmt::format("gnomon-test-{}-{}", ::getpid(), counter()++)) {
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        const auto file = path_ / name;
        std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return file;
    }

private:
    static int& counter() {
        static int count = 0;
        return count;
    }
    std::filesystem::path path_;
};

/// Bytes as a data URI. RFC 4648
inline std::string data_uri(const std::vector<unsigned char>& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text = "data:application/octet-stream;base64,";
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63u];
    }
    return text;
}

template <class T>
void append_bytes(std::vector<unsigned char>& bytes, const std::vector<T>& values) {
    const std::size_t at = bytes.size();
    bytes.resize(at + values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes.data() + at, values.data(), values.size() * sizeof(T));
    while (bytes.size() % 4 != 0) bytes.push_back(0);
}

/// A glTF file with one mesh of the given parts; `extra` goes into the top-level object.
struct GltfText {
    std::string buffers, views, accessors, primitives;
    std::string nodes = R"([{"mesh":0}])";
    std::string scene_nodes = "[0]";
    std::string extra;

    [[nodiscard]] std::string str() const {
        return fmt::format(
            R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":{}}}],"nodes":{},"meshes":[{{"name":"m",)"
            R"("primitives":[{}]}}],"buffers":[{}],"bufferViews":[{}],"accessors":[{}]{}}})",
            scene_nodes, nodes, primitives, buffers, views, accessors, extra);
    }
};

/// One primitive over `positions` (3 floats each) with indices of a given type, or none where `indices` is empty.
template <class Index>
GltfText make_gltf(const std::vector<float>& positions, const std::vector<Index>& indices, int mode) {
    std::vector<unsigned char> bytes;
    append_bytes(bytes, positions);
    const std::size_t split = bytes.size();
    append_bytes(bytes, indices);
    const int type = sizeof(Index) == 1 ? 5121 : sizeof(Index) == 2 ? 5123 : 5125;
    GltfText text;
    text.buffers = fmt::format(R"({{"byteLength":{},"uri":"{}"}})", bytes.size(), data_uri(bytes));
    text.views = fmt::format(R"({{"buffer":0,"byteOffset":0,"byteLength":{}}})", positions.size() * 4);
    text.accessors = fmt::format(R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}})", positions.size() / 3);
    text.primitives = fmt::format(R"({{"attributes":{{"POSITION":0}},"mode":{}}})", mode);
    if (!indices.empty()) {
        text.views += fmt::format(R"(,{{"buffer":0,"byteOffset":{},"byteLength":{}}})", split, indices.size() * sizeof(Index));
        text.accessors +=
            fmt::format(R"(,{{"bufferView":1,"componentType":{},"count":{},"type":"SCALAR"}})", type, indices.size());
        text.primitives = fmt::format(R"({{"attributes":{{"POSITION":0}},"indices":1,"mode":{}}})", mode);
    }
    return text;
}

}  // namespace gnomon::test
