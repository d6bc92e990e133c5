// From a normalised coordinate to texel indices: range reduction, scale, fixed point, address mode. D3D11.3 7.18.5 to 7.18.9
#pragma once

#include "sim/double_lanes.h"
#include "sim/profile.h"
#include "texunit/sampler.h"

#include <array>

namespace gnomon {

/// Keeps a coordinate in the range the fixed-point conversion can hold, without changing which texels it selects.
/// D3D11.3 7.18.6
template <class Real>
GNOMON_INLINE Real reduce_range(const Real& u, AddressMode mode) {
    switch (mode) {
        case AddressMode::Wrap: return u - floor(u);
        case AddressMode::Mirror: {
            const Real half = u * Real(0.5f);
            const Real whole = floor(abs(half));
            return (half - select(half < Real(0.0f), -whole, whole)) * Real(2.0f);
        }
        case AddressMode::Clamp:
        case AddressMode::Border:
        case AddressMode::MirrorOnce: return select(is_nan(u), u, clamp(u, Real(-10.0f), Real(10.0f)));
    }
    __builtin_unreachable();
}

/// A coordinate in texels, split at the point: `texel + fraction`.
template <class Real>
struct TexelPosition {
    Int texel;
    Real fraction;  // [0, 1), or [0, 1] where the profile carries into the weight; a multiple of 2^-bits unless exact
};

/// Fixed-point conversion at the profile's precision; NaN gives 0. D3D11.3 7.18.7, 7.18.8, 3.2.4.1, 3.2.4.2
template <class Real>
GNOMON_INLINE TexelPosition<Real> to_texel(const Real& scaled, const Profile& profile) {
    const int bits = profile.texel_fraction_bits;
    if (bits == kExactBits) {
        const Real number = select(is_nan(scaled), Real(0.0f), scaled);
        const Real whole = floor(number);
        return {bounded_truncate_to_int(whole), number - whole};
    }
    const Real steps(static_cast<float>(1 << bits));
    const Real step(1.0f / static_cast<float>(1 << bits));
    const bool nearest = profile.texel_rounding == FixedRounding::NearestEven;
    if (profile.texel_carry == TexelCarry::Weight) {
        const Real number = select(is_nan(scaled), Real(0.0f), scaled);
        const Real whole = floor(number);
        const Real shifted = (number - whole) * steps;
        const Int fixed = nearest ? bounded_round_to_int(shifted) : bounded_truncate_to_int(shifted);
        return {bounded_truncate_to_int(whole), Real(fixed) * step};
    }
    const Real shifted = scaled * steps;
    const Int fixed = nearest ? bounded_round_to_int(shifted) : bounded_truncate_to_int(floor(shifted));
    return {shift_right(fixed, bits), Real(fixed & Int((1 << bits) - 1)) * step};
}

/// texel modulo size, in [0, size), for |texel| < 2^23.
GNOMON_INLINE Int modulo(Int texel, Int size) {
    // Half a texel away from every multiple of `size`, the rounded quotient cannot reach the next whole number.
    const Float tiles = floor((Float(texel) + Float(0.5f)) / Float(size));
    return texel - bounded_truncate_to_int(tiles) * size;
}

/// Index of the texel that `texel` stands for under the address mode, always inside [0, size). Coordinates come from
/// reduce_range, so that without an offset `texel` is within two sizes of the texture for wrap and mirror. D3D11.3 7.18.9
GNOMON_INLINE Int apply_address_mode(Int texel, Int size, AddressMode mode, bool offset = false) {
    switch (mode) {
        case AddressMode::Wrap: {
            if (offset) return modulo(texel, size);
            const Int low = select(texel < Int(0), texel + size, texel);
            return select(low >= size, low - size, low);
        }
        case AddressMode::Mirror: {
            const Int folded = select(texel < Int(0), ~texel, texel);
            const Int twice = size + size;
            const Int tile = offset ? modulo(folded, twice) : select(folded >= twice, folded - twice, folded);
            return select(tile >= size, twice - Int(1) - tile, tile);
        }
        case AddressMode::MirrorOnce: return min(select(texel < Int(0), ~texel, texel), size - Int(1));
        case AddressMode::Clamp:
        case AddressMode::Border: return clamp(texel, Int(0), size - Int(1));
    }
    __builtin_unreachable();
}

/// Lanes whose texel takes the border colour.
GNOMON_INLINE Mask outside(Int texel, Int size, AddressMode mode) {
    return mode == AddressMode::Border ? (texel < Int(0)) | (texel >= size) : Mask(false);
}

/// The texels of one axis under a linear filter, or the one under a nearest (only index 0 counts).
template <class Real>
struct AxisTexels {
    std::array<Int, 2> texel;     // address mode applied, [0, size)
    std::array<Mask, 2> outside;  // takes the border colour
    Real fraction;                // weight of texel 1, [0, 1]
};

/// `reduced` comes from reduce_range; `offset` is the instruction's, texels. D3D11.3 7.18.7, 7.18.8, 22.4.15
template <class Real>
GNOMON_INLINE AxisTexels<Real> fixed_point_texels(const Real& reduced, Int size, bool linear, AddressMode mode, int offset,
                                                  const Profile& profile) {
    // Scale by the level's size, go to the corner of the 2x2 block for linear, convert to fixed point.
    const Real corner(linear ? 0.5f : 0.0f);
    const TexelPosition<Real> at = to_texel(reduced * Real(size) - corner, profile);

    // Wrap each texel index separately.
    AxisTexels<Real> axis;
    axis.fraction = at.fraction;
    const Int first = at.texel + Int(offset);
    axis.texel[0] = apply_address_mode(first, size, mode, offset != 0);
    axis.outside[0] = outside(first, size, mode);
    if (linear) {
        const Int second = first + Int(1);
        axis.texel[1] = apply_address_mode(second, size, mode, offset != 0);
        axis.outside[1] = outside(second, size, mode);
    }
    return axis;
}

}  // namespace gnomon
