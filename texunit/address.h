// From a normalised coordinate to texel indices: range reduction, scale, fixed point, address mode. D3D11.3 7.18.5 to 7.18.9
#pragma once

#include "sim/double_lanes.h"
#include "sim/profile.h"
#include "texunit/sampler.h"

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
        case AddressMode::Border: return select(is_nan(u), u, clamp(u, Real(-10.0f), Real(10.0f)));
    }
    __builtin_unreachable();
}

/// A coordinate in texels, split at the point: `texel + fraction`.
template <class Real>
struct TexelPosition {
    Int texel;
    Real fraction;  // [0, 1), a multiple of 2^-bits unless exact
};

/// Fixed-point conversion at the profile's precision; NaN gives 0. D3D11.3 7.18.7, 7.18.8, 3.2.4.1
template <class Real>
GNOMON_INLINE TexelPosition<Real> to_texel(const Real& scaled, const Profile& profile) {
    const int bits = profile.texel_fraction_bits;
    if (bits == kExactBits) {
        const Real number = select(is_nan(scaled), Real(0.0f), scaled);
        const Real whole = floor(number);
        return {bounded_truncate_to_int(whole), number - whole};
    }
    const Real shifted = scaled * Real(static_cast<float>(1 << bits));
    const Int fixed = profile.texel_rounding == FixedRounding::NearestEven ? bounded_round_to_int(shifted)
                                                                           : bounded_truncate_to_int(floor(shifted));
    return {shift_right(fixed, bits), Real(fixed & Int((1 << bits) - 1)) * Real(1.0f / static_cast<float>(1 << bits))};
}

/// Index of the texel that `texel` stands for under the address mode, always inside [0, size). Coordinates come from
/// reduce_range, so `texel` is within two sizes of the texture for wrap and mirror. D3D11.3 7.18.9
GNOMON_INLINE Int apply_address_mode(Int texel, Int size, AddressMode mode) {
    switch (mode) {
        case AddressMode::Wrap: {
            const Int low = select(texel < Int(0), texel + size, texel);
            return select(low >= size, low - size, low);
        }
        case AddressMode::Mirror: {
            const Int folded = select(texel < Int(0), ~texel, texel);
            const Int twice = size + size;
            const Int tile = select(folded >= twice, folded - twice, folded);
            return select(tile >= size, twice - Int(1) - tile, tile);
        }
        case AddressMode::Clamp:
        case AddressMode::Border: return clamp(texel, Int(0), size - Int(1));
    }
    __builtin_unreachable();
}

/// Lanes whose texel takes the border colour.
GNOMON_INLINE Mask outside(Int texel, Int size, AddressMode mode) {
    return mode == AddressMode::Border ? (texel < Int(0)) | (texel >= size) : Mask(false);
}

}  // namespace gnomon
