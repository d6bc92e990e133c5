// The models of driver_models.h: which driver, and pixels in lists and buffers.
#include "tests/agree/driver_models.h"

#include "sim/error.h"
#include "tests/agree/driver_model_parts.h"

namespace gnomon::agree {

std::optional<Driver> driver_of(const peer::PeerDevice& device) {
    if (device.name.find("llvmpipe") != std::string::npos) return Driver::Llvmpipe;
    if (device.name.find("SwiftShader") != std::string::npos) return Driver::SwiftShader;
    return std::nullopt;
}

std::vector<CoveredPixel> model_coverage(Driver driver, const ClipTriangle& triangle, const Viewport& viewport,
                                         const CoverageOptions& options) {
    const Window window{.viewport = viewport,
                        .scissor = {viewport.x + options.inset, viewport.y + options.inset, viewport.width - 2 * options.inset,
                                    viewport.height - 2 * options.inset},
                        .samples = options.samples};
    std::vector<CoveredPixel> pixels;
    const auto append = [&](int x, int y, std::uint32_t mask) { pixels.push_back({x - viewport.x, y - viewport.y, mask}); };
    if (driver == Driver::Llvmpipe)
        llvmpipe_coverage(triangle, window, append);
    else
        swiftshader_coverage(triangle, window, append);

    // A triangle that was clipped may have come in parts.
    const auto in_rows = [](const CoveredPixel& a, const CoveredPixel& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
    std::sort(pixels.begin(), pixels.end(), in_rows);
    std::vector<CoveredPixel> merged;
    for (const CoveredPixel& pixel : pixels) {
        if (!merged.empty() && merged.back().x == pixel.x && merged.back().y == pixel.y)
            merged.back().mask |= pixel.mask;
        else
            merged.push_back(pixel);
    }
    return merged;
}

std::vector<std::uint32_t> model_depth(Driver driver, const DepthDraw& draw) {
    const bool is_llvmpipe = driver == Driver::Llvmpipe;
    const auto code_of = is_llvmpipe ? llvmpipe_depth_code : swiftshader_depth_code;
    const auto width = static_cast<std::size_t>(draw.width);
    const auto samples = static_cast<std::size_t>(draw.samples);
    std::vector<std::uint32_t> codes(width * static_cast<std::size_t>(draw.height) * samples, code_of(draw.format, 1.0f));
    // Depths are not negative: the bits of floats compare as the floats do.
    const auto test = [&](int x, int y, int sample, float z) {
        std::uint32_t& stored = codes[(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * samples +
                                      static_cast<std::size_t>(sample)];
        stored = std::min(stored, code_of(draw.format, z));
    };
    for (std::size_t i = 0; i + 2 < draw.indices.size(); i += 3) {
        const ClipTriangle triangle{draw.vertices[draw.indices[i]], draw.vertices[draw.indices[i + 1]],
                                    draw.vertices[draw.indices[i + 2]]};
        if (is_llvmpipe)
            llvmpipe_depth(triangle, draw, test);
        else
            swiftshader_depth(triangle, draw, test);
    }
    return codes;
}

std::vector<Color> model_attributes(Driver driver, const ClipTriangle& triangle, const Viewport& viewport,
                                    Interpolation interpolation) {
    std::vector<Color> target(static_cast<std::size_t>(viewport.width) * static_cast<std::size_t>(viewport.height));
    if (driver == Driver::Llvmpipe)
        llvmpipe_attributes(triangle, viewport, interpolation, target);
    else
        swiftshader_attributes(triangle, viewport, interpolation, target);
    return target;
}

Codes model_blend(Driver driver, ColorFormat format, const BlendState& state, const BlendCase& blended) {
    return driver == Driver::Llvmpipe ? llvmpipe_blend(format, state, blended) : swiftshader_blend(format, state, blended);
}

Codes model_resolve(Driver driver, ColorFormat format, const SampleCodes& samples) {
    return driver == Driver::Llvmpipe ? llvmpipe_resolve(format, samples) : swiftshader_resolve(format, samples);
}

}  // namespace gnomon::agree
