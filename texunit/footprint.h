// What one sample reads of one mip level: the texels and their weights, as a value. D3D11.3 7.18.7, 7.18.8, 7.18.12
#pragma once

#include "texunit/address.h"
#include "texunit/cube.h"
#include "texunit/peer_address.h"
#include "texunit/view.h"

#include <glm/vec2.hpp>

#include <array>
#include <bit>

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

/// Everything about a sample instruction that its probes and levels share.
struct Lookup {
    const TextureView& view;
    const Sampler& sampler;
    const Profile& profile;
    glm::ivec2 offset;                 // texels
    Int layer;                         // slice of an array, face of a cube
    bool integer_coordinates = false;  // SwiftShader's 16-bit coordinates: UNORM formats under nearest filters
    bool fixed_coordinates = false;    // llvmpipe's 24.8 coordinates: its 8-bit filter
    bool gathers = false;              // footprints for gather
};

/// By the profile's arithmetic; `coordinate` has been through reduce_range where that is the specification's.
template <bool kStandard, class Real>
GNOMON_INLINE AxisTexels<Real> axis_texels(const Lookup& lookup, const Real& coordinate, Int size, int base_size, bool linear,
                                           bool vertical) {
    const AddressMode mode = vertical ? lookup.sampler.address_v : lookup.sampler.address_u;
    const int offset = vertical ? lookup.offset.y : lookup.offset.x;
    const AddressArithmetic arithmetic = lookup.profile.address_arithmetic;
    if (kStandard || arithmetic == AddressArithmetic::FixedPoint) [[likely]]
        return fixed_point_texels(coordinate, size, linear, mode, offset, lookup.profile);
    const PeerAxis axis{.size = size,
                        .base_power_of_two = (base_size & (base_size - 1)) == 0,
                        .linear = linear,
                        .mode = mode,
                        .offset = offset,
                        .gathers = lookup.gathers};
    const Float c = to_float(coordinate);
    const AxisTexels<Float> peer = lookup.fixed_coordinates ? llvmpipe_fixed_texels(c, axis)
                                   : arithmetic == AddressArithmetic::Llvmpipe
                                       ? llvmpipe_texels(c, axis)
                                       : swiftshader_texels(c, axis, lookup.integer_coordinates);
    return {peer.texel, peer.outside, Real(peer.fraction)};
}

/// The 2x2 texels around a position in the order (0, 0), (1, 0), (0, 1), (1, 1), or the one that holds it (`linear` false: only
/// index 0 counts).
template <class Real>
struct Footprint {
    bool linear = false;
    bool has_corner = false;
    std::array<Int, 4> offset;    // bytes from the start of the texture
    std::array<Mask, 4> outside;  // border mode: the texel takes the border colour
    std::array<Mask, 4> corner;   // cubes, where has_corner: there is no such texel, its neighbours stand in for it
    Real fraction_u;              // weight of the right column, [0, 1]
    Real fraction_v;              // weight of the lower row, [0, 1]
};

/// `kStandard`: by the specification's arithmetic, known when it is compiled.
/// Of `level` in the texture, at a coordinate that has been through reduce_range.
template <bool kStandard, class Real>
GNOMON_INLINE Footprint<Real> make_footprint(const Lookup& lookup, const LevelLanes& level, const Vec2<Real>& reduced,
                                             bool linear) {
    const AxisTexels<Real> u = axis_texels<kStandard>(lookup, reduced.x, level.width, lookup.view.width(), linear, false);
    const AxisTexels<Real> v = axis_texels<kStandard>(lookup, reduced.y, level.height, lookup.view.height(), linear, true);

    Footprint<Real> footprint;
    footprint.linear = linear;
    footprint.fraction_u = u.fraction;
    footprint.fraction_v = v.fraction;
    const Texture& texture = lookup.view.texture();
    Int origin = level.offset;
    if (texture.desc().layers > 1) origin += lookup.layer * Int(texture.layer_stride());
    // Texels take 1, 2, 4, 8 or 16 bytes: shifts instead of multiplications, which take ten cycles.
    const Int log2_bytes(std::countr_zero(static_cast<unsigned>(texture.info().bytes_per_texel)));
    const Int left = shift_left(u.texel[0], log2_bytes);
    const Int upper = v.texel[0] * level.pitch + origin;
    footprint.offset[0] = left + upper;
    footprint.outside[0] = u.outside[0] | v.outside[0];
    if (linear) {
        const Int right = shift_left(u.texel[1], log2_bytes);
        const Int lower = v.texel[1] * level.pitch + origin;
        footprint.offset[1] = right + upper;
        footprint.offset[2] = left + lower;
        footprint.offset[3] = right + lower;
        footprint.outside[1] = u.outside[1] | v.outside[0];
        footprint.outside[2] = u.outside[0] | v.outside[1];
        footprint.outside[3] = u.outside[1] | v.outside[1];
    }
    return footprint;
}

/// The same on a cube, whose edges are seams where the profile says so; the sampler's address modes do not count.
template <class Real>
[[gnu::noinline]] Footprint<Real> make_cube_footprint(const Lookup& lookup, const LevelLanes& level,
                                                      const Vec2<Real>& coordinate, bool linear) {
    const Profile& profile = lookup.profile;
    const Real corner(linear ? 0.5f : 0.0f);
    const Vec2<Real> reduced{reduce_range(coordinate.x, AddressMode::Clamp), reduce_range(coordinate.y, AddressMode::Clamp)};
    const TexelPosition<Real> u = to_texel(reduced.x * Real(level.width) - corner, profile);
    const TexelPosition<Real> v = to_texel(reduced.y * Real(level.height) - corner, profile);
    const Int size = level.width;
    const Int last = size - Int(1);

    Footprint<Real> footprint;
    footprint.linear = linear;
    footprint.fraction_u = u.fraction;
    footprint.fraction_v = v.fraction;
    const Texture& texture = lookup.view.texture();
    const bool seamless = linear && profile.cube_edges == CubeEdges::Seamless;
    for (std::size_t tap = 0; tap < (linear ? 4u : 1u); ++tap) {
        // One texel past an edge at most; a position on the far edge itself (u = 1) belongs to the last texel.
        const Int x = clamp(u.texel + Int(static_cast<int>(tap & 1)), Int(-1), size);
        const Int y = clamp(v.texel + Int(static_cast<int>(tap >> 1)), Int(-1), size);
        const Mask out_x = (x < Int(0)) | (x > last);
        const Mask out_y = (y < Int(0)) | (y > last);
        CubeTexel texel{lookup.layer, clamp(x, Int(0), last), clamp(y, Int(0), last)};
        if (seamless && any(out_x ^ out_y)) {
            const CubeTexel moved = across_edge(lookup.layer, x, y, size);
            const auto pick = [&](Int yes, Int no) { return select(out_x ^ out_y, yes, no); };
            texel = {pick(moved.face, texel.face), pick(moved.x, texel.x), pick(moved.y, texel.y)};
        }
        footprint.outside[tap] = Mask(false);
        footprint.corner[tap] = seamless ? out_x & out_y : Mask(false);
        footprint.has_corner = footprint.has_corner || any(footprint.corner[tap]);
        footprint.offset[tap] = level.offset + texel.face * Int(texture.layer_stride()) + texel.y * level.pitch +
                                texel.x * Int(texture.info().bytes_per_texel);
    }
    return footprint;
}

}  // namespace gnomon
