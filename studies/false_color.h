// Pictures in false colour: the signed error of a shadow, and what derivatives were taken over.
//
// Of errors, white is right, red too bright (light leaks in), blue too dark (acne, or a shadow too wide), grey not judged,
// magenta not a number. Saturation grows with the square root of the error, so that 1 % is visible; docs/report.md has the
// legend.
#pragma once

#include "pipeline/derivatives.h"
#include "scenes/reference.h"
#include "studies/images.h"

#include <array>
#include <cstdint>
#include <span>

namespace gnomon::studies {

using Rgb = std::array<std::uint8_t, 3>;

inline constexpr Rgb kTooBright{190, 0, 20};  // error +1 and above
inline constexpr Rgb kRight{255, 255, 255};   // error 0
inline constexpr Rgb kTooDark{0, 50, 190};    // error -1 and below
inline constexpr Rgb kNotJudged{150, 150, 150};
inline constexpr Rgb kNotFinite{255, 0, 255};

/// The colour of one error, visibility - truth.
Rgb error_color(float error);

/// What the derivatives of a pixel were taken over: bits of DerivativeCause (pipeline/derivatives.h). White: only pixels of the
/// primitive, or no derivative was taken. The three causes are blue, red and yellow and mix as paints do.
inline constexpr std::array<Rgb, 8> kDerivativeColors{{
    {255, 255, 255},  // sound
    {70, 130, 220},   // helper
    {210, 30, 40},    // killed
    {120, 50, 150},   // helper and killed
    {245, 200, 20},   // inactive
    {50, 150, 60},    // helper and inactive
    {240, 120, 20},   // killed and inactive
    {20, 20, 20},     // all three
}};
static_assert(kFromHelper == 1 && kFromKilled == 2 && kFromInactive == 4);

/// One pixel per element of `causes`, grey where `visibility` says that nothing was drawn.
ByteImage derivative_image(std::span<const std::uint32_t> causes, const FloatImage& visibility);

/// One pixel each for a visibility image and its truth, of one size.
ByteImage difference_image(const FloatImage& visibility, const scenes::ReferenceImage& truth);

}  // namespace gnomon::studies
