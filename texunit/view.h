// What an instruction sees of a texture: some of its levels. D3D11.3 5.2 (views), 5.8 (per-resource mipmap clamping)
#pragma once

#include "texunit/texture.h"

namespace gnomon {

class TextureView {
public:
    /// Every level of the texture, which must outlive the view.
    TextureView(const Texture& texture) : TextureView(texture, 0, texture.desc().levels) {}

    /// Levels `base` to `base + levels - 1`. `min_lod` counts levels of the texture, [0, its levels): finer ones are clamped
    /// off. Throws Error for levels that the texture lacks.
    TextureView(const Texture& texture, int base, int levels, float min_lod = 0.0f);

    [[nodiscard]] const Texture& texture() const { return *texture_; }
    [[nodiscard]] int base() const { return base_; }
    [[nodiscard]] int levels() const { return levels_; }
    /// Lower limit of the level of detail, in levels of the view. D3D11.3 5.8.3
    [[nodiscard]] float min_lod() const { return min_lod_ - static_cast<float>(base_); }
    /// The clamp leaves no level of the view: every access is out of bounds. D3D11.3 5.8.5
    [[nodiscard]] bool empty() const { return min_lod() > static_cast<float>(levels_ - 1); }
    /// Sides of the view's finest level, texels.
    [[nodiscard]] int width() const { return texture_->width(base_); }
    [[nodiscard]] int height() const { return texture_->height(base_); }

private:
    const Texture* texture_;
    int base_;
    int levels_;
    float min_lod_;
};

}  // namespace gnomon
