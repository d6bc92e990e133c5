// The signed error of a shadow as a picture.
//
// White is right, red too bright (light leaks in), blue too dark (acne, or a shadow too wide), grey not judged, magenta not a
// number. Saturation grows with the square root of the error, so that 1 % is visible; docs/report.md has the legend.
#pragma once

#include "scenes/reference.h"
#include "studies/images.h"

#include <array>

namespace gnomon::studies {

using Rgb = std::array<std::uint8_t, 3>;

inline constexpr Rgb kTooBright{190, 0, 20};  // error +1 and above
inline constexpr Rgb kRight{255, 255, 255};   // error 0
inline constexpr Rgb kTooDark{0, 50, 190};    // error -1 and below
inline constexpr Rgb kNotJudged{150, 150, 150};
inline constexpr Rgb kNotFinite{255, 0, 255};

/// The colour of one error, visibility - truth.
Rgb error_color(float error);

/// One pixel each for a visibility image and its truth, of one size.
ByteImage difference_image(const FloatImage& visibility, const scenes::ReferenceImage& truth);

}  // namespace gnomon::studies
