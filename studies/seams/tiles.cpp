// Seams of repeating coordinates: tiles of an atlas, and a coordinate that wraps around.
#include "studies/seams/case_list.h"

namespace gnomon::studies {

namespace {

constexpr std::array<std::string_view, 3> kAtlasCures{"none", "explicit-gradients", "sample-level"};

/// A grid of cells, each with a tile of an atlas.
template <bool kProbes>
struct AtlasPixel {
    enum Cure : int { kNone, kExplicitGradients, kSampleLevel };  // in the order of kAtlasCures

    TextureId atlas = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kAtlasCures

    static constexpr auto fields() {
        using A = AtlasPixel;
        return std::tuple{Field{"atlas", &A::atlas}, Field{"sampler", &A::sampler}, Field{"cure", &A::cure}};
    }

    template <class Real>
    static Real modulo_tiles(const Real& x) {
        const Real tiles(static_cast<float>(kAtlasTiles));
        return x - tiles * floor(x / tiles);
    }
    /// Coordinates in the tile of a cell, which go on past its borders.
    template <class Real>
    static Vec3<Real> coordinate_in(const Vec2<Real>& cell, const Real& u, const Real& v) {
        const Real tile_x = modulo_tiles(Real(3.0f) * cell.x + Real(5.0f) * cell.y);
        const Real tile_y = modulo_tiles(Real(5.0f) * cell.x + Real(3.0f) * cell.y);
        const Real size(1.0f / kAtlasTiles);
        return flat_coordinate(((u - cell.x) + tile_x) * size, ((v - cell.y) + tile_y) * size);
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real& u = f.in.at.x;
        const Real& v = f.in.at.y;
        const Real size(1.0f / kAtlasTiles);
        const Vec2<Real> cell{floor(u), floor(v)};
        SeamLookup<Real> lookup{coordinate_in(cell, u, v), cure == kExplicitGradients};
        if (cure == kExplicitGradients) lookup.gradients = scaled(shader_gradients(f, u, v), size);

        const Vec2<Real> unwrapped{u * size, v * size};
        SampledLevel<Real> level;
        Real value;
        if (cure == kSampleLevel) {
            level = f.lod(atlas, sampler, unwrapped);
            value = f.sample_level(atlas, sampler, lookup.coordinate, level.unclamped).x;
        } else {
            value = look_up(f, atlas, sampler, lookup);
        }
        return seam_colors<kProbes>(f, value, [&] {
            const Real own = cell.y * Real(16.0f) + cell.x;
            const auto smooth = [&](const auto& of_lane) {
                SeamLookup<Real> in_tile{coordinate_in(Vec2<Real>{of_lane(cell.x), of_lane(cell.y)}, u, v),
                                         cure == kExplicitGradients};
                if (cure == kExplicitGradients)
                    in_tile.gradients = shader_gradients(f, in_tile.coordinate.x, in_tile.coordinate.y);
                return in_tile;
            };
            const Gradients<Real> exact = scaled(plane_gradients<Real>(kAtlasPlane), size);
            return SeamLanes<Real>{.own = own,
                                   .used = own,
                                   .sampled = cure == kSampleLevel ? level : level_of(f, atlas, sampler, lookup),
                                   .smooth_lod = smooth_lod_of(f, atlas, sampler, own, smooth),
                                   .exact_lod = f.lod(atlas, sampler, exact).unclamped,
                                   .outside = Mask(false),
                                   .value = value};
        });
    }
};

SeamImage draw_atlas(Device& device, std::string_view cure) {
    const int chosen = seam_cure("atlas", kAtlasCures, cure);
    const TextureId atlas = seam_texture(device, kAtlasSide);
    return draw_seam(device, "seam.atlas", kAtlasPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return AtlasPixel<kProbes>{.atlas = atlas, .sampler = seam_sampler(), .cure = chosen};
    });
}

constexpr std::array<std::string_view, 3> kWrapCures{"none", "explicit-gradients", "two-coordinates"};

/// A texture around something round.
template <bool kProbes>
struct WrapPixel {
    enum Cure : int { kNone, kExplicitGradients, kTwoCoordinates };  // in the order of kWrapCures

    TextureId texture = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kWrapCures

    static constexpr auto fields() {
        using W = WrapPixel;
        return std::tuple{Field{"texture", &W::texture}, Field{"sampler", &W::sampler}, Field{"cure", &W::cure}};
    }

    template <class Real>
    static Real smaller(const Real& a, const Real& b) {
        return gnomon::select(abs(a) <= abs(b), a, b);
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real turns = f.in.at.x;
        const Real v = f.in.at.y;
        const Real u = frac(turns);
        SeamLookup<Real> lookup{flat_coordinate(u, v), cure != 0};
        if (cure == kExplicitGradients) lookup.gradients = shader_gradients(f, turns, v);
        if (cure == kTwoCoordinates) {
            // Two coordinates of the same slope that jump in different places: the smaller derivative is the one that did not.
            const Real half_way = frac(u + Real(0.5f)) - Real(0.5f);
            const Gradients<Real> at_one = shader_gradients(f, u, v);
            lookup.gradients = {{smaller(at_one.dx.x, f.ddx(half_way)), at_one.dx.y},
                                {smaller(at_one.dy.x, f.ddy(half_way)), at_one.dy.y}};
        }
        const Real value = look_up(f, texture, sampler, lookup);
        return seam_colors<kProbes>(f, value, [&] {
            const Real own = floor(turns);
            const auto smooth = [&](const auto& of_lane) {
                SeamLookup<Real> in_turn{flat_coordinate(turns - of_lane(own), v), cure != 0};
                if (cure != 0) in_turn.gradients = shader_gradients(f, in_turn.coordinate.x, v);
                return in_turn;
            };
            return SeamLanes<Real>{.own = own,
                                   .used = own,
                                   .sampled = level_of(f, texture, sampler, lookup),
                                   .smooth_lod = smooth_lod_of(f, texture, sampler, own, smooth),
                                   .exact_lod = f.lod(texture, sampler, plane_gradients<Real>(kWrapPlane)).unclamped,
                                   .outside = Mask(false),
                                   .value = value};
        });
    }
};

SeamImage draw_wrap(Device& device, std::string_view cure) {
    const int chosen = seam_cure("wrap", kWrapCures, cure);
    const TextureId texture = seam_texture(device, kWrapSide);
    return draw_seam(device, "seam.wrap", kWrapPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return WrapPixel<kProbes>{.texture = texture, .sampler = seam_sampler(), .cure = chosen};
    });
}

}  // namespace

SeamCase atlas_seam() {
    return {
        .name = "atlas",
        .summary = "cells of a plane, each with a tile of an atlas: coordinates jump from tile to tile",
        .source = "texture atlases; layers of a shadow map packed into one texture",
        .expectation = "none: every pixel whose derivatives cross a border is bad; explicit-gradients, sample-level: none is",
        .cures = {kAtlasCures.begin(), kAtlasCures.end()},
        .reference = "explicit-gradients",
        .draw = draw_atlas};
}

SeamCase wrap_seam() {
    return {
        .name = "wrap",
        .summary = "a coordinate that goes around: it jumps from 1 to 0 where the texture has no border",
        .source = "angles of cylinders and spheres; frac() of a coordinate",
        .expectation = "none: every pixel whose derivatives cross a turn is bad; explicit-gradients, two-coordinates: none is",
        .cures = {kWrapCures.begin(), kWrapCures.end()},
        .reference = "explicit-gradients",
        .draw = draw_wrap};
}

}  // namespace gnomon::studies
