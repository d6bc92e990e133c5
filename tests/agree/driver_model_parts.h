// What the models of driver_models.h share.
#pragma once

#include "tests/agree/driver_models.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

namespace gnomon::agree {

/// minps and maxps: equal or unordered, the second.
inline float min_ps(float a, float b) { return a < b ? a : b; }
inline float max_ps(float a, float b) { return a > b ? a : b; }

/// cvtps2dq: to nearest, ties to even; what does not fit becomes the smallest integer.
inline std::int32_t round_to_int(float x) {
    if (!(x >= -0x1p31f && x < 0x1p31f)) return std::numeric_limits<std::int32_t>::min();
    const double floor = std::floor(static_cast<double>(x));
    const double rest = static_cast<double>(x) - floor;
    const auto whole = static_cast<std::int64_t>(floor);
    const bool up = rest > 0.5 || (rest == 0.5 && (whole & 1) != 0);
    return static_cast<std::int32_t>(whole + (up ? 1 : 0));
}

/// fp32 in which denormals are zero, as both drivers have it nearly everywhere; or, off, plain fp32.
struct Flushing {
    bool on = true;

    [[nodiscard]] float operator()(float x) const {
        return on && std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(0.0f, x) : x;
    }
    [[nodiscard]] float add(float a, float b) const { return (*this)((*this)(a) + (*this)(b)); }
    [[nodiscard]] float sub(float a, float b) const { return (*this)((*this)(a) - (*this)(b)); }
    [[nodiscard]] float mul(float a, float b) const { return (*this)((*this)(a) * (*this)(b)); }
    [[nodiscard]] float div(float a, float b) const { return (*this)((*this)(a) / (*this)(b)); }
    [[nodiscard]] float fused(float a, float b, float c) const { return (*this)(std::fma((*this)(a), (*this)(b), (*this)(c))); }
};

/// Sample i of four, in eighths of a pixel from its corner.
inline constexpr std::array<std::array<int, 2>, 4> kSampleEighths{{{3, 1}, {7, 3}, {1, 5}, {5, 7}}};

/// Where a triangle is drawn.
struct Window {
    Viewport viewport{};
    Viewport scissor{};
    int samples = 1;
};
inline Window whole_window(const Viewport& viewport, int samples) { return {viewport, viewport, samples}; }

/// Called per covered pixel, in rows.
using PixelSink = std::function<void(int x, int y, std::uint32_t mask)>;
/// Called per covered sample with its depth before it becomes a code.
using DepthSink = std::function<void(int x, int y, int sample, float z)>;

// Each driver's parts.
void llvmpipe_coverage(const ClipTriangle& triangle, const Window& window, const PixelSink& sink);
void llvmpipe_depth(const ClipTriangle& triangle, const DepthDraw& draw, const DepthSink& sink);
void llvmpipe_attributes(const ClipTriangle& triangle, const Viewport& viewport, Interpolation interpolation,
                         std::span<Color> target);
std::uint32_t llvmpipe_depth_code(DepthFormat format, float z);
Codes llvmpipe_blend(ColorFormat format, const BlendState& state, const BlendCase& blended);
Codes llvmpipe_resolve(ColorFormat format, const SampleCodes& samples);

void swiftshader_coverage(const ClipTriangle& triangle, const Window& window, const PixelSink& sink);
void swiftshader_depth(const ClipTriangle& triangle, const DepthDraw& draw, const DepthSink& sink);
void swiftshader_attributes(const ClipTriangle& triangle, const Viewport& viewport, Interpolation interpolation,
                            std::span<Color> target);
std::uint32_t swiftshader_depth_code(DepthFormat format, float z);
Codes swiftshader_blend(ColorFormat format, const BlendState& state, const BlendCase& blended);
Codes swiftshader_resolve(ColorFormat format, const SampleCodes& samples);

}  // namespace gnomon::agree
