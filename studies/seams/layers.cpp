// Seams between the layers of a layered variance shadow map: neighbouring lanes fall into different layers. [Lauritzen08] 4.1.3
#include "studies/seams/case_list.h"

namespace gnomon::studies {

namespace {

constexpr std::array<std::string_view, 4> kLayerCures{"none", "branches", "array-slice", "explicit-gradients"};

/// One sample of the layer that holds a depth. Layers lie 2x2 in one texture, or are slices of an array.
template <bool kProbes>
struct LayerPixel {
    enum Cure : int { kNone, kBranches, kArraySlice, kExplicitGradients };  // in the order of kLayerCures

    TextureId packed = TextureId::None;
    TextureId slices = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kLayerCures

    static constexpr auto fields() {
        using L = LayerPixel;
        return std::tuple{Field{"packed", &L::packed}, Field{"slices", &L::slices}, Field{"sampler", &L::sampler},
                          Field{"cure", &L::cure}};
    }

    /// Coordinates in the quarter of a layer.
    template <class Real>
    static Vec3<Real> packed_coordinate(const Real& layer, const Real& u, const Real& v) {
        const Real row = floor(layer * Real(0.5f));
        const Real column = layer - Real(2.0f) * row;
        return flat_coordinate((u + column) * Real(0.5f), (v + row) * Real(0.5f));
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real u = f.in.at.x;
        const Real v = f.in.at.y;
        const Real layer = floor(frac(f.in.at.z) * Real(static_cast<float>(kLayers)));
        const bool is_packed = cure == kNone || cure == kExplicitGradients;
        const TextureId texture = is_packed ? packed : slices;
        SeamLookup<Real> lookup{is_packed ? packed_coordinate(layer, u, v) : Vec3<Real>{u, v, layer},
                                cure == kExplicitGradients};
        if (cure == kExplicitGradients) lookup.gradients = scaled(shader_gradients(f, u, v), Real(0.5f));

        Real value(0.0f);
        if (cure == kBranches) {
            // A texture for each layer, which hardware without arrays chooses by branches; here they are slices.
            for (int i = 0; i < kLayers; ++i) {
                const Real slice(static_cast<float>(i));
                const Mask here = layer == slice;
                f.branch(here,
                         [&] { value = gnomon::select(here, f.sample(texture, sampler, Vec3<Real>{u, v, slice}).x, value); });
            }
        } else {
            value = look_up(f, texture, sampler, lookup);
        }
        return seam_colors<kProbes>(f, value, [&] {
            const auto smooth = [&](const auto& of_lane) {
                SeamLookup<Real> in_layer{is_packed ? packed_coordinate(of_lane(layer), u, v) : lookup.coordinate,
                                          cure == kExplicitGradients};
                if (cure == kExplicitGradients)
                    in_layer.gradients = shader_gradients(f, in_layer.coordinate.x, in_layer.coordinate.y);
                return in_layer;
            };
            const Gradients<Real> exact = scaled(plane_gradients<Real>(kLayerPlane), Real(is_packed ? 0.5f : 1.0f));
            return SeamLanes<Real>{.own = layer,
                                   .used = layer,
                                   .sampled = level_of(f, texture, sampler, lookup),
                                   .smooth_lod = smooth_lod_of(f, texture, sampler, layer, smooth),
                                   .exact_lod = f.lod(texture, sampler, exact).unclamped,
                                   .outside = Mask(false),
                                   .value = value};
        });
    }
};

SeamImage draw_layers(Device& device, std::string_view cure) {
    const int chosen = seam_cure("lvsm-layers", kLayerCures, cure);
    constexpr int kSide = kLayerSide;
    constexpr int kPackedSide = 2 * kSide;
    const int octaves = full_level_count(kSide, kSide) - 1;
    std::vector<float> slices(std::size_t{kLayers} * kSide * kSide);
    std::vector<float> packed(slices.size());
    for (int layer = 0; layer < kLayers; ++layer)
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float texel = seam_noise((x + 0.5) / kSide, (y + 0.5) / kSide, octaves, static_cast<unsigned>(layer));
                const int row = layer / 2 * kSide + y;
                const int column = layer % 2 * kSide + x;
                slices[static_cast<std::size_t>((layer * kSide + y) * kSide + x)] = texel;
                packed[static_cast<std::size_t>(row * kPackedSide + column)] = texel;
            }
    const TextureId packed_id = seam_texture(device, kPackedSide, 1, packed);
    const TextureId slices_id = seam_texture(device, kSide, kLayers, slices);
    return draw_seam(device, "seam.lvsm_layers", kLayerPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return LayerPixel<kProbes>{
            .packed = packed_id, .slices = slices_id, .sampler = seam_sampler(AddressMode::Clamp), .cure = chosen};
    });
}

}  // namespace

SeamCase lvsm_layers_seam() {
    return {.name = "lvsm-layers",
            .summary = "layers of a layered variance shadow map, packed into one texture or slices of an array",
            .source = "[Lauritzen08] 4.1.3",
            .expectation =
                "none (packed): every pixel whose derivatives cross a split is bad; branches (a texture for each "
                "layer): flagged, but none is bad, as all layers share their coordinates; array-slice, "
                "explicit-gradients (packed): none is bad or flagged",
            .cures = {kLayerCures.begin(), kLayerCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_layers};
}

}  // namespace gnomon::studies
