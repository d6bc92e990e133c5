// What raw passes share on all machines: the texture, and what a picture is judged by.
#include "sim/error.h"
#include "tests/peer/raw_pass.h"

#include <algorithm>
#include <cstring>

namespace gnomon::peer {

std::vector<std::uint8_t> raw_texels(int level) {
    const int side = std::max(1, kRawTextureSize >> level);
    std::vector<std::uint8_t> texels;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            // Gradients under a checkerboard, so that filters have something to do.
            const bool light = ((x ^ y) & 4) != 0;
            texels.push_back(static_cast<std::uint8_t>(x * 255 / side));
            texels.push_back(static_cast<std::uint8_t>(y * 255 / side));
            texels.push_back(light ? 220 : 90);
            texels.push_back(255);
        }
    }
    return texels;
}

RawImage raw_image(const RawPass& pass, const std::vector<std::byte>& texels) {
    const auto pixels = static_cast<std::size_t>(pass.width) * static_cast<std::size_t>(pass.height);
    if (texels.size() != 4 * pixels) fail("{} bytes are not {} pixels", texels.size(), pixels);
    RawImage image;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (pass.shading == RawShading::DepthOnly) {
            float depth = 0;
            std::memcpy(&depth, &texels[4 * i], sizeof(depth));
            image.covered += depth < 1.0f ? 1u : 0u;
            image.mean += static_cast<double>(depth);
        } else {
            image.covered += texels[4 * i + 3] != std::byte{0} ? 1u : 0u;
            for (std::size_t c = 0; c < 4; ++c) image.mean += std::to_integer<int>(texels[4 * i + c]) / 255.0;
        }
    }
    image.mean /= static_cast<double>(pixels);
    return image;
}

}  // namespace gnomon::peer
