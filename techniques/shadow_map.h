// Shadow mapping with one comparison. [Donnelly06] section 4, alternate methods 1 and 2; [Williams78]
#pragma once

#include "techniques/technique.h"

namespace gnomon::techniques {

/// One comparison sample: of the nearest texel, or what hardware calls PCF, the bilinear filter of four comparisons. With an
/// anisotropic sampler, the mean of such samples along the pixel's footprint. D3D11.3 22.4.19
struct CompareReceiver {
    Lighting lighting{};
    TextureId map = TextureId::None;
    Sampler sampler{};

    static constexpr auto fields() {
        using R = CompareReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"map", &R::map}, Field{"sampler", &R::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const auto at = map_position(f);
        return shade(f, lighting, at.inside, compare_sample(f, map, sampler, at));
    }
};

extern const Technique kShadowMap;
extern const Technique kPcfHardware;

}  // namespace gnomon::techniques
