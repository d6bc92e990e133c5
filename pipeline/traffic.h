// Bytes that the stages of the pipeline ask of each resource, before any cache. Kept only while the device counts.
#pragma once

#include "pipeline/command.h"
#include "sim/counters.h"

#include <string>
#include <vector>

namespace gnomon {

struct Bytes {
    std::uint64_t read = 0;
    std::uint64_t written = 0;

    Bytes& operator+=(const Bytes& other) {
        read += other.read;
        written += other.written;
        return *this;
    }
    bool operator==(const Bytes&) const = default;
};

/// What draws and other commands counted: the sums, and the bytes of each texture and buffer by its id.
class Tally {
public:
    Counters counters;

    void read(TextureId id, std::uint64_t bytes) { add(textures_, static_cast<std::size_t>(id), {bytes, 0}); }
    void write(TextureId id, std::uint64_t bytes) { add(textures_, static_cast<std::size_t>(id), {0, bytes}); }
    void read(BufferId id, std::uint64_t bytes) { add(buffers_, static_cast<std::size_t>(id), {bytes, 0}); }
    void write(BufferId id, std::uint64_t bytes) { add(buffers_, static_cast<std::size_t>(id), {0, bytes}); }

    [[nodiscard]] Bytes of(TextureId id) const { return at(textures_, static_cast<std::size_t>(id)); }
    [[nodiscard]] Bytes of(BufferId id) const { return at(buffers_, static_cast<std::size_t>(id)); }

    Tally& operator+=(const Tally& other) {
        counters += other.counters;
        merge(textures_, other.textures_);
        merge(buffers_, other.buffers_);
        return *this;
    }

private:
    void add(std::vector<Bytes>& list, std::size_t index, const Bytes& bytes) {
        if (index >= list.size()) list.resize(index + 1);
        list[index] += bytes;
        counters.bytes_read += bytes.read;
        counters.bytes_written += bytes.written;
    }
    static Bytes at(const std::vector<Bytes>& list, std::size_t index) { return index < list.size() ? list[index] : Bytes{}; }
    static void merge(std::vector<Bytes>& to, const std::vector<Bytes>& from) {
        if (to.size() < from.size()) to.resize(from.size());
        for (std::size_t i = 0; i < from.size(); ++i) to[i] += from[i];
    }

    std::vector<Bytes> textures_;  // [id]
    std::vector<Bytes> buffers_;   // [id]
};

/// The bytes of one resource, for reports.
struct ResourceTraffic {
    std::string label;  // as it was created; the second of the same label is "label 2"
    Bytes bytes;

    bool operator==(const ResourceTraffic&) const = default;
};

}  // namespace gnomon
