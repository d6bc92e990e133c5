#include "texunit/upload.h"

#include "texunit/codec.h"
#include "texunit/store.h"

#include <algorithm>

namespace gnomon {

void set_level_colors(Texture& texture, int level, std::span<const glm::vec4> colors, Narrowing narrowing, int layer) {
    const int width = texture.width(level);
    const int height = texture.height(level);
    if (colors.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        fail("texture level {} of {}x{} texels: {} colours given", level, width, height, colors.size());
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; x += kLanes) {
                const int count = std::min(kLanes, width - x);
                std::array<std::array<float, kLanes>, 4> lanes{};
                for (int i = 0; i < count; ++i) {
                    const glm::vec4& color = colors[static_cast<std::size_t>(y * width + x + i)];
                    for (int c = 0; c < 4; ++c) lanes[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] = color[c];
                }
                typename AnyCodec::template Texel<Float> texel;
                for (std::size_t c = 0; c < texel.size(); ++c) texel[c] = Float::load(lanes[c].data());
                if constexpr (AnyCodec::kIsDepth) texel[0] = saturate(texel[0]);
                store_row<AnyCodec>(texture.row(level, y, layer) + x * AnyCodec::kBytes, AnyCodec::encode(texel, narrowing),
                                    count);
            }
        }
    });
}

}  // namespace gnomon
