// Single texels of one level by lane, through the format's codec: what compute functors read and write.
// D3D11.3 22.4.8 (ld_uav_typed), 22.4.9 (store_uav_typed)
//
// Components a format lacks are read as 0, alpha as 1, and not written. Lanes that are not `valid` touch nothing and read 0,
// like an access out of bounds; `valid` lanes must be inside the level.
#pragma once

#include "sim/half.h"
#include "sim/vec.h"
#include "texunit/texture.h"

namespace gnomon {

/// One level of one layer.
struct ImageLevel {
    Texture& texture;
    int level = 0;
    int layer = 0;

    [[nodiscard]] int width() const { return texture.width(level); }
    [[nodiscard]] int height() const { return texture.height(level); }
};

/// Float or Double lanes.
template <class Real>
Vec4<Real> load_texels(const ImageLevel& image, Int x, Int y, Mask valid);
template <class Real>
void store_texels(const ImageLevel& image, Int x, Int y, const Vec4<Real>& color, Narrowing narrowing, Mask valid);

/// The codes of formats of unsigned integers.
Vec4<Int> load_texel_codes(const ImageLevel& image, Int x, Int y, Mask valid);
void store_texel_codes(const ImageLevel& image, Int x, Int y, const Vec4<Int>& codes, Mask valid);

}  // namespace gnomon
