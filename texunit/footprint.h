// What one sample reads of one mip level: the texels and their weights, as a value. D3D11.3 7.18.7, 7.18.8
#pragma once

#include "texunit/address.h"
#include "texunit/texture.h"

#include <array>

namespace gnomon {

/// Where the level of each lane lies.
struct LevelLanes {
    Int offset;  // bytes from the start of the texture
    Int pitch;   // bytes per row
    Int width;   // texels
    Int height;  // texels
};

/// Lanes usually agree on the level; only where they do not are the tables gathered from.
GNOMON_INLINE LevelLanes locate_level(const LevelTable& table, Int level) {
    const int first = lane(level, 0);
    if (all(level == Int(first))) {
        const auto l = static_cast<std::size_t>(first);
        return {Int(table.offset[l]), Int(table.pitch[l]), Int(table.width[l]), Int(table.height[l])};
    }
    return {gather(table.offset.data(), level), gather(table.pitch.data(), level), gather(table.width.data(), level),
            gather(table.height.data(), level)};
}

/// The 2x2 texels around a position, or the one that holds it (`linear` false: only index 0 counts).
template <class Real>
struct Footprint {
    bool linear = false;
    std::array<Int, 2> column;           // byte offset of each texel column, address mode applied
    std::array<Int, 2> row;              // byte offset of each texel row
    std::array<Mask, 2> column_outside;  // border mode: the column or row takes the border colour
    std::array<Mask, 2> row_outside;
    Real fraction_u;  // weight of column 1, [0, 1)
    Real fraction_v;  // weight of row 1, [0, 1)
};

/// `reduced_u` and `reduced_v` come from reduce_range.
template <class Real>
GNOMON_INLINE Footprint<Real> make_footprint(const LevelLanes& level, const Vec2<Real>& reduced, bool linear,
                                             int bytes_per_texel, const Sampler& sampler, const Profile& profile) {
    // Scale by the level's size, go to the corner of the 2x2 block for linear, convert to fixed point.
    const Real corner(linear ? 0.5f : 0.0f);
    const TexelPosition<Real> u = to_texel(reduced.x * Real(level.width) - corner, profile);
    const TexelPosition<Real> v = to_texel(reduced.y * Real(level.height) - corner, profile);

    // Wrap each texel index separately.
    Footprint<Real> footprint{.linear = linear,
                              .column = {},
                              .row = {},
                              .column_outside = {},
                              .row_outside = {},
                              .fraction_u = u.fraction,
                              .fraction_v = v.fraction};
    const std::size_t taps = linear ? 2 : 1;
    for (std::size_t i = 0; i < taps; ++i) {
        const Int x = u.texel + Int(static_cast<int>(i));
        const Int y = v.texel + Int(static_cast<int>(i));
        footprint.column[i] = apply_address_mode(x, level.width, sampler.address_u) * Int(bytes_per_texel);
        footprint.row[i] = apply_address_mode(y, level.height, sampler.address_v) * level.pitch + level.offset;
        footprint.column_outside[i] = outside(x, level.width, sampler.address_u);
        footprint.row_outside[i] = outside(y, level.height, sampler.address_v);
    }
    return footprint;
}

}  // namespace gnomon
