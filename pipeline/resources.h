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
    /// Throw Error for an id that was never created.
    [[nodiscard]] Texture& texture(TextureId id) const {
        const auto index = static_cast<std::size_t>(id);
        if (index == 0 || index > textures_.size()) fail("texture {}: no such texture; {} exist", index, textures_.size());
        return *textures_[index - 1];
    }
    [[nodiscard]] Buffer& buffer(BufferId id) const {
        const auto index = static_cast<std::size_t>(id);
        if (index == 0 || index > buffers_.size()) fail("buffer {}: no such buffer; {} exist", index, buffers_.size());
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
    static void check_next(std::string_view what, std::size_t id, std::size_t count) {
        if (id != count + 1) fail("{} {}: ids go up one by one; expected {}", what, id, count + 1);
    }

    std::vector<std::unique_ptr<Buffer>> buffers_;    // [id - 1]
    std::vector<std::unique_ptr<Texture>> textures_;  // [id - 1]
    std::vector<std::string> labels_;                 // of textures
};

}  // namespace gnomon
