// Shadow mapping with one unfiltered comparison. [Donnelly06] section 4, alternate method 1; [Williams78]
#pragma once

#include "techniques/technique.h"

namespace gnomon::techniques {

struct ShadowMapReceiver {
    Lighting lighting{};
    TextureId map = TextureId::None;
    Sampler sampler{};

    static constexpr auto fields() {
        using R = ShadowMapReceiver;
        return std::tuple{Field{"lighting", &R::lighting}, Field{"map", &R::map}, Field{"sampler", &R::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const auto at = map_position(f);
        return shade(f, lighting, at.inside, f.sample_compare(map, sampler, at.uv, at.depth));
    }
};

extern const Technique kShadowMap;

}  // namespace gnomon::techniques
