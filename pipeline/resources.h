// The buffers and textures of a device, by id.
#pragma once

#include "pipeline/command.h"

#include <memory>
#include <string>
#include <vector>

namespace gnomon {

struct Buffer {
    std::string label;
    std::vector<std::byte> data;
};

class Resources {
public:
    /// Throw Error for an id that was never created; `what`, if there is any, begins the message.
    [[nodiscard]] Texture& texture(TextureId id, std::string_view what = {}) const {
        const auto index = static_cast<std::size_t>(id);
        if (index == 0 || index > textures_.size()) refuse("texture", index, textures_.size(), what);
        return *textures_[index - 1];
    }
    [[nodiscard]] Buffer& buffer(BufferId id, std::string_view what = {}) const {
        const auto index = static_cast<std::size_t>(id);
        if (index == 0 || index > buffers_.size()) refuse("buffer", index, buffers_.size(), what);
        return *buffers_[index - 1];
    }
    [[nodiscard]] const std::string& label(TextureId id) const { return labels_[static_cast<std::size_t>(id) - 1]; }

    /// Ids go up one by one; throw Error for any other.
    void add(BufferId id, Buffer buffer) {
        check_next("buffer", static_cast<std::size_t>(id), buffers_.size());
        buffers_.push_back(std::make_unique<Buffer>(std::move(buffer)));
    }
    void add(TextureId id, std::string_view label, const TextureDesc& desc) {
        check_next("texture", static_cast<std::size_t>(id), textures_.size());
        textures_.push_back(std::make_unique<Texture>(desc));
        labels_.emplace_back(label);
    }
    [[nodiscard]] std::size_t textures() const { return textures_.size(); }
    [[nodiscard]] std::size_t buffers() const { return buffers_.size(); }
    [[nodiscard]] const std::vector<std::unique_ptr<Texture>>& table() const { return textures_; }
    [[nodiscard]] const std::vector<std::unique_ptr<Buffer>>& buffer_table() const { return buffers_; }

private:
    [[noreturn]] static void refuse(std::string_view kind, std::size_t index, std::size_t count, std::string_view what) {
        if (what.empty()) fail("{} {}: no such {}; {} exist", kind, index, kind, count);
        if (index == 0) fail("{}: names no {}", what, kind);
        fail("{}: {} {}: no such {}; {} exist", what, kind, index, kind, count);
    }
    static void check_next(std::string_view what, std::size_t id, std::size_t count) {
        if (id != count + 1) fail("{} {}: ids go up one by one; expected {}", what, id, count + 1);
    }

    std::vector<std::unique_ptr<Buffer>> buffers_;    // [id - 1]
    std::vector<std::unique_ptr<Texture>> textures_;  // [id - 1]
    std::vector<std::string> labels_;                 // of textures
};

}  // namespace gnomon
